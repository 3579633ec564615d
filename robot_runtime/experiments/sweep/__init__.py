"""Sweeps: one scenario with varied entries, each variant with the same seeds."""
