"""Streams: blocks received from the other processes and sent to every open page."""
