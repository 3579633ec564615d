"""The server: serves the page, records, exports, and keeps the other processes running."""

VERSION = "0.1.0"
