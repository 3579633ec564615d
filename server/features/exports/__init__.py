"""Sessions taken home as files of many formats, and brought back from archives."""
