"""The calibration that the board keeps, and what it is measured by."""
