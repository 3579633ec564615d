"""Names of sessions, from what they hold."""

from server.recording.schemas import SessionSummary

NAME_LENGTH_MAX = 100
DEPTH_LEAST = 0.05
"""m; what floats has no depth in its name."""


def name_from(summary: SessionSummary) -> str:
    """Return a name such as "1.1 m, bang-bang and PID, yellow card"; empty for a robot that rested."""
    if summary.armed == 0:
        return ""
    deep = summary.depth is not None and summary.depth >= DEPTH_LEAST
    drivers = [_within_sentence(title) for title in summary.controllers]
    if not drivers and "manual" in summary.modes:
        drivers = ["by hand"]
    parts = [f"{summary.depth:.1f} m"] if deep else []
    parts += [_join(drivers)] if drivers else []
    parts += (
        [f"{_join(summary.cards)} {'card' if len(summary.cards) == 1 else 'cards'}"] if summary.cards else []
    )
    return ", ".join(parts)[:NAME_LENGTH_MAX]


def _within_sentence(title: str) -> str:
    """Return the title with a small letter, unless it is an abbreviation."""
    return title if title[1:2].isupper() else title[:1].lower() + title[1:]


def _join(names: list[str]) -> str:
    return " and ".join(filter(None, (", ".join(names[:-1]), names[-1])))
