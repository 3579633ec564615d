"""Identification: fits a craft's numbers to recorded sessions."""
