"""A serial line with faults: what passes is harmed at chosen rates."""
