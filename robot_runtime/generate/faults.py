"""docs/reference/faults.md: the supervisor's states and transitions, and the faults of the runtime."""

from robot_runtime.control.faults import FAULTS, FaultRule
from robot_runtime.control.transitions import TRANSITIONS
from robot_runtime.generate.markdown import page, table

SOURCE = "robot_runtime/control/transitions.py and faults.py"
INTRODUCTION = """\
The supervisor is always in one of five states. It starts in `disarmed`. A fault is a condition that the
runtime detects by itself. [Safety](safety.md) explains both and says what the chip does alone.
"""
FAULTS_INTRODUCTION = """\
The runtime checks these at least ten times a second, and at each message of the board. *Within* is
the time from the fault to the action, on a line of 115200 baud or more. *All-stop* sends STOP to the board
and no command after it; the robot floats up. The alarm stays until the fault is over and acknowledged.
"""


def faults_page() -> str:
    """The whole text of faults.md."""
    return page(
        "States and faults",
        SOURCE,
        INTRODUCTION,
        "## States\n",
        _states(),
        "## Transitions\n",
        table(
            ("from", "trigger", "to", "why"),
            ((f"`{one.before}`", one.trigger, f"`{one.after}`", one.why) for one in TRANSITIONS),
        ),
        "## Faults\n",
        FAULTS_INTRODUCTION,
        table(("fault", "within", "action", "alarm", "message"), map(_fault, FAULTS)),
    )


def _states() -> str:
    """One row for each state, one column for each trigger, and the next state where they meet."""
    states = list(dict.fromkeys(one.before for one in TRANSITIONS))
    triggers = list(dict.fromkeys(one.trigger for one in TRANSITIONS))
    after = {(one.before, one.trigger): one.after for one in TRANSITIONS}
    rows = [(f"`{state}`", *(after.get((state, one), "") for one in triggers)) for state in states]
    return table(("state", *triggers), rows)


def _fault(fault: FaultRule) -> tuple[str, ...]:
    action = f"{fault.action}; alarm only in manual" if fault.automatic_only else fault.action
    message = f"{fault.what} {fault.cause} *{fault.remedy}*"
    return f"`{fault.name}`", f"{fault.limit:g} s", action, fault.severity, message
