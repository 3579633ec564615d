"""The simulation: a rigid body with four fins in water, its sensors, the emulated board and the scene."""
