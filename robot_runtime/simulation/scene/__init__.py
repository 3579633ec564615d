"""The underwater scene, rendered by MuJoCo for the robot's camera and for an observer.

MuJoCo computes no motion here; the simulator's `truth` gives the robot's pose. Only this package uses MuJoCo.
"""
