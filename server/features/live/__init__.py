"""The live socket of a page: samples and news to it, driving and STOP from it."""
