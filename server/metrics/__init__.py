"""Figures computed from signals over time, for comparisons of sessions and for tuning runs."""
