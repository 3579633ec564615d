"""The other processes: started, watched, adopted and ended."""
