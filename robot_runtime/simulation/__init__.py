"""The simulated water: a rigid body with four fins, what its sensors feel, and the process that swims it."""
