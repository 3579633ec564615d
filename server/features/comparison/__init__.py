"""Comparison of sessions: signals on one time axis, figures, differences."""
