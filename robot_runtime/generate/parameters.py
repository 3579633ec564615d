"""docs/reference/parameters.md: every parameter that may change while the robot runs."""

from robot_runtime.clock import SimulatedClock
from robot_runtime.config import Config
from robot_runtime.contract.documents import TunableParameter
from robot_runtime.core import Core
from robot_runtime.generate.markdown import page, table
from robot_runtime.link.link_driver import LinkDriver
from robot_runtime.transport.outbox import Outbox

SOURCE = "the parameter registry (robot_runtime/parameters)"
INTRODUCTION = """\
These values may change while the robot runs: on the page under Tune, or with `PATCH /api/parameters`.
[Tune](../use/tune.md#change-parameters) says how, and how to undo a change. A gain's name is
`LOOP.CONTROLLER.GAIN`.

The default is that of a `robot.toml` that does not name the value. In the running robot a parameter's default
is its value at the start of the runtime.
"""


def parameters_page() -> str:
    """The whole text of parameters.md."""
    rows = map(_row, _registered())
    return page("Parameters", SOURCE, INTRODUCTION, table(("parameter", "range", "default", "meaning"), rows))


def _registered() -> list[TunableParameter]:
    clock, config = SimulatedClock(), Config()
    line = LinkDriver("", config.link.baud, clock, 1, lambda _: None, lambda: None)
    outbox = Outbox(lambda *_: None, lambda _: False)
    robot = Core(config, clock, "", line, outbox, watched=lambda _: False)
    return robot.parameters.listed()


def _row(one: TunableParameter) -> tuple[str, ...]:
    if one.type == "choice":
        span = ", ".join(one.choices)
    elif one.type == "switch":
        span = "on, off"
    else:
        span = f"{one.minimum:g} to {one.maximum:g} {one.unit}".strip()
    default = f"{one.default:g}" if isinstance(one.default, float) else str(one.default)
    only = "" if one.while_armed else "; only while disarmed"
    return f"`{one.name}`", span, default, f"{one.meaning}{only}"
