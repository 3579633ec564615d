"""The part of docs/reference/parameters.md that says what may be tuned."""

from robot_runtime.clock import SimulatedClock
from robot_runtime.config import Config
from robot_runtime.contract.documents import Parameter
from robot_runtime.core import Core
from robot_runtime.link.link_driver import LinkDriver
from robot_runtime.transport.outbox import Outbox

_BEGIN, _END = "<!-- parameters: from the code -->\n", "<!-- parameters: end -->\n"


def weave(text: str) -> str:
    """The document with the parameters between its marks. Raises ValueError where one is missing."""
    before, _, rest = text.partition(_BEGIN)
    _, found, after = rest.partition(_END)
    if not found:
        raise ValueError("docs/reference/parameters.md lacks its marks")
    rows = "".join(_row(one) for one in _listed())
    head = "| parameter | range | default | meaning |\n|---|---|---|---|\n"
    return before + _BEGIN + head + rows + _END + after


def _listed() -> list[Parameter]:
    clock, config = SimulatedClock(), Config()
    line = LinkDriver("", config.link.baud, clock, 1, lambda _: None, lambda: None)
    outbox = Outbox(lambda *_: None, lambda _: False)
    robot = Core(config, clock, "", line, outbox, watched=lambda _: False)
    return robot.parameters.listed()


def _row(one: Parameter) -> str:
    if one.type == "choice":
        span = ", ".join(one.choices)
    elif one.type == "switch":
        span = "on, off"
    else:
        span = f"{one.minimum:g} to {one.maximum:g} {one.unit}".strip()
    default = f"{one.default:g}" if isinstance(one.default, float) else str(one.default)
    only = "" if one.while_armed else "; only while disarmed"
    return f"| `{one.name}` | {span} | {default} | {one.meaning}{only} |\n"
