"""The bring-up: a robot's parts checked one after the other, and its calibration measured meanwhile."""
