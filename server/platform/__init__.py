"""The platform floor: settings, the data folder, the database, notices."""
