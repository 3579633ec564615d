"""Sessions laid over each other: signals on one time axis, figures, and what was different."""
