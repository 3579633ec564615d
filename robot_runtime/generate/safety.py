"""The generated parts of docs/reference/safety.md: the supervisor's states, and the faults."""

from robot_runtime.control.faults import FAULTS, FaultRule
from robot_runtime.control.transitions import TRANSITIONS

PARTS = ("states", "faults")


def weave(text: str) -> str:
    """The document with what the code says now between its marks. Raises ValueError where one is missing."""
    for part, made in zip(PARTS, (_states(), _faults()), strict=True):
        begin, end = f"<!-- {part}: from the code -->\n", f"<!-- {part}: end -->\n"
        before, _, rest = text.partition(begin)
        _, found, after = rest.partition(end)
        if not found:
            raise ValueError(f"docs/reference/safety.md lacks its marks of {part}")
        text = before + begin + made + end + after
    return text


def _states() -> str:
    drawn = "".join(f"    {one.before} --> {one.after}: {one.trigger}\n" for one in TRANSITIONS)
    rows = "".join(f"| {one.before} | {one.trigger} | {one.after} | {one.why} |\n" for one in TRANSITIONS)
    return (
        f"```mermaid\nstateDiagram-v2\n    [*] --> disarmed\n{drawn}```\n\n"
        f"| from | when | to | why |\n|---|---|---|---|\n{rows}"
    )


def _faults() -> str:
    rows = "".join(_row(one) for one in FAULTS)
    return f"| fault | within | action | alarm | what a person is told |\n|---|---|---|---|---|\n{rows}"


def _row(fault: FaultRule) -> str:
    action = f"{fault.action}; alarm only by hand" if fault.steered_by else fault.action
    words = f"{fault.what} {fault.cause} *{fault.remedy}*"
    return f"| `{fault.name}` | {fault.limit:g} s | {action} | {fault.severity} | {words} |\n"
