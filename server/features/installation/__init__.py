"""Installation on a Raspberry Pi or any Debian: environments, services, and settings of the computer."""
