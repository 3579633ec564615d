"""Topics for other programs: plain JSON schemas and Foxglove's well-known messages."""
