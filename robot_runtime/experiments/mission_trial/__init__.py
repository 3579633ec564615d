"""A mission tried in simulated water, once for each of many seeds."""
