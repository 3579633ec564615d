"""Runs of the thesis's grid that ship with the program, as `mucat commtest export` writes them.

`python -m server.features.comm_tests.samples` makes them anew.
"""
