"""Tunable parameters: each described once, read and changed in one place."""
