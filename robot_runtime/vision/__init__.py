"""Vision: cameras, and the search for colours and markers in their pictures."""
