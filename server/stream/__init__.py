"""Streams: blocks from the other processes, and all of them to every open page."""
