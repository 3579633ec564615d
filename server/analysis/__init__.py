"""Analysis of recorded sessions: signals on one time axis, figures, differences, reports."""
