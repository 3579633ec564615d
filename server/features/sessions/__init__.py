"""Sessions: recorded, kept, found again and replayed."""
