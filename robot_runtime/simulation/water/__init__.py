"""The simulated water: the rigid body with four fins, its sensors, and the process that moves it."""
