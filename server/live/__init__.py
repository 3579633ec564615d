"""What is live: blocks from the other processes, and everything of it to every open page."""
