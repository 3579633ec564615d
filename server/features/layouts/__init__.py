"""Saved layouts of panels."""
