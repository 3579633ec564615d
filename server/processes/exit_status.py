"""The description of a process's end."""

from signal import Signals


def describe_status(status: int | None) -> str:
    """Describe the end of a process, as text that follows its name; `status` is None if unknown."""
    if status is None:
        return "has ended; its exit status is not known, because an earlier server had started it"
    if status >= 0:
        return f"has ended with exit status {status}"
    try:
        name = Signals(-status).name
    except ValueError:
        name = str(-status)
    return f"was ended by signal {name}"


def describe_end(status: int | None, last: str) -> str:
    """Return the description with the process's last output, if any."""
    return describe_status(status) + (f". Its last words: {last}" if last else "")
