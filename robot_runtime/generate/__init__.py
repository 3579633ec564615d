"""Writers of the files that other languages read: the definitions in Python are their only source."""
