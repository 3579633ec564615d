"""The board's calibration, and the measurements that it needs."""
