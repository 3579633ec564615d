"""The library of recorded sessions: lists, contents, replay, texts, bookmarks and retention."""
