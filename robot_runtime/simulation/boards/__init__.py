"""Boards without hardware: the firmware on the emulated chip, and compiled for this computer."""
