"""The underwater scene, rendered by MuJoCo for the robot's camera and for an observer.

MuJoCo moves nothing here; the simulator's `truth` says where the robot is. This package alone needs MuJoCo,
and no other process of the robot does.
"""
