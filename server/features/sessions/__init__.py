"""Sessions: recording, search, annotation, replay and retention."""
