"""The robot's runtime: serial link, vision, control, and simulated water to stand in for the sea."""
