"""The refusal to replace a text that somebody else has changed since the editing began."""

import hashlib

from server.platform.errors import ConflictError

MARK_CHARACTERS = 16


class ChangedMeanwhileError(ConflictError):
    """Somebody else has changed it meanwhile"""

    kind = "changed"

    def __init__(self, what: str, author: str, *, gone: bool = False) -> None:
        act = "deleted" if gone else "saved"
        by = f" by {author}" if author and not gone else ""
        super().__init__(
            f"{what} was {act}{by} since you opened it. Save yours over it, or load it again first."
        )


def mark_text(text: str) -> str:
    """Return a mark that distinguishes this text from others; empty for no text."""
    return hashlib.sha256(text.encode()).hexdigest()[:MARK_CHARACTERS] if text else ""
