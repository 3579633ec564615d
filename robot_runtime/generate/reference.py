"""The pages of docs/reference that describe commands, topics, packets, faults and parameters."""

from collections.abc import Iterator
from dataclasses import fields
from functools import partial

from robot_runtime.clock import Clock, SimulatedClock
from robot_runtime.config import Config
from robot_runtime.contract.commands import COMMANDS, RobotCommand, StopCommand, http_commands, is_required
from robot_runtime.contract.documents import Document, TunableParameter
from robot_runtime.contract.hints import Hint, read_fields
from robot_runtime.contract.packets import DEFINITIONS_HASH, ENUMERATIONS, FRAME_BYTES_MAX, PACKETS
from robot_runtime.contract.packets.layout import C_TYPES, Record, Text, Wire
from robot_runtime.contract.published_events import PublishedEvent
from robot_runtime.contract.topics import TOPICS, AnyTopic, Kind
from robot_runtime.control.faults import ROBOT_FAULTS, FaultRule
from robot_runtime.control.transitions import TRANSITIONS
from robot_runtime.core import Core
from robot_runtime.generate.markdown import entry, fill, page, table
from robot_runtime.link.link_driver import LinkDriver
from robot_runtime.transport.outbox import Outbox
from robot_runtime.vision.node import VisionNode

COMMANDS_SOURCE = "robot_runtime/contract/commands.py"
TOPICS_SOURCE = "robot_runtime/contract/topics.py"
EVENTS_SOURCE = "robot_runtime/contract/published_events.py"
PACKETS_SOURCE = "robot_runtime/contract/packets/definitions.py"
FAULTS_SOURCE = "robot_runtime/control/transitions.py and faults.py"
PARAMETERS_SOURCE = "the parameter registry (robot_runtime/parameters)"


def commands_page() -> str:
    """Return the whole text of commands.md."""
    head = ("command", "HTTP", "needs", "scenarios", "history", "during an experiment")
    parts = [fill("commands"), table(head, map(_command_row, COMMANDS.values()))]
    for name, cls in COMMANDS.items():
        parts += [f"## {name}\n", f"{_one_line(cls)}\n"]
        if lines := "".join(_command_fields(cls)):
            parts.append(lines)
    return page("Commands", COMMANDS_SOURCE, *parts)


def _command_row(cls: type[RobotCommand]) -> tuple[str, ...]:
    policy = cls.policy
    way = "`POST /api/robot/stop`" if cls is StopCommand else "yes" if cls in http_commands() else ""
    return (
        f"[{policy.name}](#{policy.name})",
        way,
        "" if policy.need is None else policy.need.name.lower(),
        "yes" if policy.in_scenarios else "",
        "yes" if policy.tunes else "",
        "refused" if policy.disturbs_experiment else "",
    )


def _command_fields(cls: type[RobotCommand]) -> Iterator[str]:
    hints = read_fields(cls)
    for field in fields(cls):
        type_ = describe_type(hints[field.name]) + ("" if is_required(field) else ", optional")
        yield entry(field.name, (type_,), field.metadata.get("description", ""))


def describe_type(hint: Hint) -> str:
    """Return a field's type in words, with its limits."""
    limits = f", {hint.limits.minimum:.4g} to {hint.limits.maximum:.4g}" if hint.limits else ""
    match hint.form:
        case "choice":
            text = " or ".join(f"`{choice}`" for choice in hint.choices)
        case "union":
            text = " or ".join(dict.fromkeys(map(describe_type, hint.members)))
        case "list" | "tuple":
            text = f"list of {' and '.join(dict.fromkeys(map(describe_type, hint.parts)))}"
        case "table":
            text = f"{describe_type(hint.parts[0])}, by name"
        case "object" | "class":
            text = f"`{hint.cls.__name__}`"
        case "switch":
            text = "true or false"
        case form:
            text = form
    return text + limits


def topics_page() -> str:
    """Return the whole text of topics.md."""
    head = ("topic", "number", "kind", "sender", "", "meaning")
    parts = [fill("topics"), table(head, map(_topic_row, TOPICS))]
    for topic in TOPICS:
        if topic.kind in (Kind.ROWS, Kind.DOCUMENTS):
            parts += [f"## {topic.name}\n", *_describe_record(topic.record)]
    return page("Topics", TOPICS_SOURCE, *parts)


def _topic_row(topic: AnyTopic) -> tuple[str, ...]:
    described = topic.kind in (Kind.ROWS, Kind.DOCUMENTS)
    name = f"[{topic.name}](#{topic.name})" if described else f"`{topic.name}`"
    rules = {
        "newest only": topic.newest_only,
        "lines": topic.lines,
        "not recorded": not topic.recorded,
    }
    return (
        name,
        str(topic.id),
        topic.kind.name.lower(),
        topic.sender,
        ", ".join(rule for rule, holds in rules.items() if holds),
        topic.meaning,
    )


def _describe_record(record: type[Record] | type[Document]) -> Iterator[str]:
    if record in PACKETS.values():
        yield f"The packet [{record.__name__}](packets.md#{record.__name__.lower()}).\n"
        return
    yield f"{_one_line(record)}\n"
    if issubclass(record, Record):
        yield "".join(_row_fields(record))
    else:
        yield "".join(_document_fields(record))


def _row_fields(record: type[Record]) -> Iterator[str]:
    for name, wire in record.wires.items():
        yield entry(name, (wire.unit, f"{wire.count} numbers" if wire.count > 1 else ""), wire.meaning)


def _document_fields(record: type[Document] | type[PublishedEvent]) -> Iterator[str]:
    """Yield a line for each field but a document's time, which all of them have."""
    hints = read_fields(record)
    for field in fields(record):
        if field.name != "time" or record is PublishedEvent:
            yield entry(field.name, (describe_type(hints[field.name]),), field.metadata.get("meaning", ""))


def events_page() -> str:
    """Return the whole text of events.md."""
    return page("Events", EVENTS_SOURCE, fill("events", fields="".join(_document_fields(PublishedEvent))))


def packets_page() -> str:
    """Return the whole text of packets.md."""
    parts = [fill("packets", frame=FRAME_BYTES_MAX, definitions=DEFINITIONS_HASH)]
    for packet in PACKETS.values():
        reliable = ", reliable" if packet.reliable else ""
        lead = f"`0x{packet.type:02X}`, {packet.describe_size()}{reliable}. {_one_line(packet)}\n"
        parts += [f"## {packet.__name__}\n", lead]
        lines = [_number_line(name, wire) for name, wire in packet.wires.items()]
        lines += [_text_line(*packet.tail)] if packet.tail else []
        if lines:
            parts.append("".join(lines))
    parts.append("## Flags and codes\n")
    for enumeration in ENUMERATIONS:
        members = ", ".join(f"{member.value} `{member.name}`" for member in enumeration)
        parts += [f"### {enumeration.__name__}\n", f"{_one_line(enumeration)}\n", f"{members}\n"]
    return page("Packets", PACKETS_SOURCE, *parts)


def _number_line(name: str, wire: Wire) -> str:
    type_ = f"`{C_TYPES[wire.code]}`" + (f" × {wire.count}" if wire.count > 1 else "")
    step = f"{wire.scale:.6g} {wire.unit}".rstrip() if wire.scale != 1 or wire.unit else ""
    return entry(name, (type_, step), wire.meaning)


def _text_line(name: str, text: Text) -> str:
    return entry(name, (f"`uint8_t` length, then at most {text.max_bytes} bytes of UTF-8",), text.meaning)


def faults_page() -> str:
    """Return the whole text of faults.md."""
    transitions = table(
        ("from", "trigger", "to", "why"),
        (
            (f"`{transition.before}`", transition.trigger, f"`{transition.after}`", transition.why)
            for transition in TRANSITIONS
        ),
    )
    faults = table(
        ("fault", "within", "action", "alarm", "message", "consequences"),
        (_fault_row(name, fault) for name, fault in ROBOT_FAULTS.items()),
    )
    text = fill("faults", transitions=transitions, faults=faults)
    return page("States and faults", FAULTS_SOURCE, text)


def _fault_row(name: str, fault: FaultRule) -> tuple[str, ...]:
    action = f"{fault.action}; alarm only in manual" if fault.automatic_only else fault.action
    message = f"{fault.what} {fault.cause} *{fault.remedy}*"
    consequences = ", ".join(f"`{consequence}`" for consequence in fault.consequences)
    return f"`{name}`", f"{fault.limit:g} s", action, fault.severity, message, consequences


def parameters_page() -> str:
    """Return the whole text of parameters.md."""
    rows = map(_parameter_row, make_core(SimulatedClock()).parameters.listed())
    parameters = table(("parameter", "range", "default", "meaning"), rows)
    return page("Parameters", PARAMETERS_SOURCE, fill("parameters", parameters=parameters))


def make_core(clock: Clock) -> Core:
    """Return the core of a default robot that is joined to no board."""
    config = Config()
    line = LinkDriver("", config.link.baud, clock, 1, lambda _: None, lambda: None)
    outbox = Outbox(lambda *_: None, lambda _: False)
    open_vision = partial(VisionNode, config.vision, clock)
    return Core(config, clock, "", line, outbox, watched=lambda _: False, open_vision=open_vision)


def _parameter_row(parameter: TunableParameter) -> tuple[str, ...]:
    if parameter.type == "choice":
        span = ", ".join(parameter.choices)
    elif parameter.type == "switch":
        span = "on, off"
    else:
        span = f"{parameter.minimum:g} to {parameter.maximum:g} {parameter.unit}".strip()
    default = f"{parameter.default:g}" if isinstance(parameter.default, float) else str(parameter.default)
    only = "" if parameter.while_armed else "; only while disarmed"
    return f"`{parameter.name}`", span, default, f"{parameter.meaning}{only}"


def _one_line(cls: type) -> str:
    return " ".join((cls.__doc__ or "").split())
