"""The robots of a lab."""
