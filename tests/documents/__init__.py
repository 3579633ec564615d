"""Tests of the documents' own commands and code."""
