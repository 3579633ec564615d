"""The proof of a whole lab: robots, lab and workers, while parts of it fail."""
