"""The simulator of a robot with hardware in the loop: on this computer or another one."""
