"""The supervisor's states and transitions; docs/reference/faults.md shows this table."""

from typing import Literal, NamedTuple

from robot_runtime.contract.documents import Mode

Trigger = Literal[
    "arm", "arm manual", "check fins", "take over", "hand back", "checked", "stop", "fault", "acknowledge"
]
ARMED: tuple[Mode, ...] = ("manual", "automatic", "test")
"""The states in which the board is armed, and fins are commanded."""


class Transition(NamedTuple):
    """From `before` to `after` when `trigger` happens."""

    before: Mode
    trigger: Trigger
    after: Mode
    why: str


TRANSITIONS = (
    Transition("disarmed", "arm", "automatic", "no reason against it, and the board is armed"),
    Transition("disarmed", "arm manual", "manual", "the same"),
    Transition("disarmed", "check fins", "test", "the same"),
    Transition("automatic", "take over", "manual", "the operator takes the sticks"),
    Transition("manual", "hand back", "automatic", "the operator hands back, and the depth is fresh"),
    Transition("test", "checked", "disarmed", "the fin check is over"),
    Transition("automatic", "stop", "disarmed", "STOP, or the end of a scenario or of the runtime"),
    Transition("manual", "stop", "disarmed", "the same"),
    Transition("test", "stop", "disarmed", "the same"),
    Transition("disarmed", "stop", "disarmed", "STOP is never refused; it goes to the board each time"),
    Transition("failsafe", "stop", "failsafe", "the same"),
    Transition("automatic", "fault", "failsafe", "a fault whose action is all-stop"),
    Transition("manual", "fault", "failsafe", "the same"),
    Transition("test", "fault", "failsafe", "the same"),
    Transition("failsafe", "acknowledge", "disarmed", "the operator has seen the alarms"),
)
_AFTER = {(transition.before, transition.trigger): transition.after for transition in TRANSITIONS}


def follow(mode: Mode, trigger: Trigger) -> Mode | None:
    """Return the state after the trigger; None if it cannot happen in this state."""
    return _AFTER.get((mode, trigger))
