"""The end of a process in words."""

from signal import Signals


def describe_status(status: int | None) -> str:
    """Describe the end of a process, in words that follow its name; `status` is None if it is not known."""
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
    """The same with its last words, if there are any."""
    return describe_status(status) + (f". Its last words: {last}" if last else "")
