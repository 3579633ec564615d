"""The pages of docs/reference that describe commands, topics, packets, faults and parameters."""

import types
import typing
from collections.abc import Iterator
from dataclasses import fields

from robot_runtime.clock import SimulatedClock
from robot_runtime.config import Config
from robot_runtime.contract.commands import COMMANDS, RobotCommand, StopCommand, http_commands, is_required
from robot_runtime.contract.documents import Document, TunableParameter
from robot_runtime.contract.limits import Range
from robot_runtime.contract.packets import DEFINITIONS_HASH, ENUMERATIONS, FRAME_BYTES_MAX, PACKETS, Packet
from robot_runtime.contract.packets.layout import C_TYPES, Record, Text, Wire
from robot_runtime.contract.published_events import PublishedEvent
from robot_runtime.contract.topics import TOPICS, AnyTopic, Kind
from robot_runtime.control.faults import FAULTS, FaultRule
from robot_runtime.control.transitions import TRANSITIONS
from robot_runtime.core import Core
from robot_runtime.generate.markdown import page, table
from robot_runtime.link.link_driver import LinkDriver
from robot_runtime.transport.outbox import Outbox

COMMANDS_SOURCE = "robot_runtime/contract/commands.py"
COMMANDS_INTRODUCTION = """\
Programs and the page send a command as `POST /api/robot/commands/NAME` with its fields as a JSON object;
fields that are optional may be left out. STOP has a faster way of its own, `POST /api/robot/stop`, and is
never refused. A command whose column *HTTP* is empty is sent by the server and by scenarios only. Scenarios
name a command in `do`. What a command changes about parameters is noted in their history, with the person who
sent it, and can be undone. While an experiment measures a loop, commands that would disturb it are refused.

The runtime checks every command again and answers why it refuses one. Between server and runtime a command
travels as a Zenoh query to `command/NAME`.
"""
_WORDS = {float: "number", int: "whole number", str: "text", bool: "true or false"}
TOPICS_SOURCE = "robot_runtime/contract/topics.py"
TOPICS_INTRODUCTION = """\
A topic is a stream of samples that one process sends and the others receive over Zenoh; the page receives it
on the [live socket](live-socket.md). *Rows* are fixed binary records, *documents* are JSON objects, a
*picture* is one JPEG file. A page that connects receives the last minute of rows, the documents of the last
ten minutes, and of *newest only* topics the newest document. *Lines* are shown one by one to a person, and
are the log of an MCAP export. Every sample has a time in s of the steady clock.
[The serial link's packets](packets.md) are topics, too.
"""
EVENTS_SOURCE = "robot_runtime/contract/published_events.py"
EVENTS_INTRODUCTION = """\
Each event is one JSON object, which MQTT carries at `mucat/ROBOT/event/EVENT`.
[Events](../use/events.md) says how they are switched on. The JSON Schema is
`robot_runtime/contract/published_events.schema.json`.
"""
EVENTS_RULES = """\
## Delivery

An event is sent at least once: `run` and `number` tell a repetition. Up to 200 wait while the other end is
away; further ones are lost and counted on **System**. At a start of the server, active alarms and a resumed
recording are sent again; what ended while the server was down is not sent. The robot never waits for a
broker.

| | |
|---|---|
| protocol | MQTT 3.1.1, quality of service 1 |
| accepted by | the broker's acknowledgement |
| again after a failure | 1 s to 60 s |
| longest wait | 5 s to connect |
| end of the server | waits up to 2 s |

## Retained topics

A program that connects to the broker finds these at once.

| topic | value |
|---|---|
| `mucat/ROBOT/status` | `online` or `offline`, plain text; `offline` by the broker 45 s after the last sign |
| `mucat/ROBOT/alarms` | a list of the active alarms, as in [state](topics.md#state) |
| `mucat/ROBOT/session` | `id` and `name` of the session that records, else `null` |
"""
PACKETS_SOURCE = "robot_runtime/contract/packets/definitions.py"
PACKETS_INTRODUCTION = f"""\
A message is the packet's type (one byte), then its fields, little-endian and without gaps. [The serial
link](link.md) says how messages travel in frames of at most {FRAME_BYTES_MAX} bytes. A *reliable* packet is
repeated until it is acknowledged. The definitions of this version have the hash `{DEFINITIONS_HASH:08x}`;
both ends compare it.
"""
FAULTS_SOURCE = "robot_runtime/control/transitions.py and faults.py"
STATES_INTRODUCTION = """\
The supervisor is always in one of five states. It starts in `disarmed`. A fault is a condition that the
runtime detects by itself. [Safety](safety.md) explains both and says what the chip does alone.
"""
FAULTS_INTRODUCTION = """\
The runtime checks these at least ten times a second, and at each message of the board. *Within* is
the time from the fault to the action, on a line of 115200 baud or more. *All-stop* sends STOP to the board
and no command after it; the robot floats up. The alarm stays until the fault is over and acknowledged.
*Consequences* are the faults that follow from it. Each is an alarm of its own, with its action and its event;
the page shows it beneath its cause.
"""
PARAMETERS_SOURCE = "the parameter registry (robot_runtime/parameters)"
PARAMETERS_INTRODUCTION = """\
These values may change while the robot runs: on the page under Tune, or with `PATCH /api/parameters`.
[Tune](../use/tune.md#change-parameters) says how, and how to undo a change. A gain's name is
`LOOP.CONTROLLER.GAIN`.

The default is that of a `robot.toml` that does not name the value. In the running robot a parameter's default
is its value at the start of the runtime.
"""


def commands_page() -> str:
    """The whole text of commands.md."""
    head = ("command", "HTTP", "needs", "scenarios", "history", "during an experiment")
    parts = [COMMANDS_INTRODUCTION, table(head, map(_command_row, COMMANDS.values()))]
    for name, cls in COMMANDS.items():
        parts += [f"## {name}\n", f"{_one_line(cls)}\n"]
        if rows := list(_command_fields(cls)):
            parts.append(table(("field", "type", "", "meaning"), rows))
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


def _command_fields(cls: type[RobotCommand]) -> Iterator[tuple[str, ...]]:
    hints = typing.get_type_hints(cls, include_extras=True)
    for one in fields(cls):
        need = "" if is_required(one) else "optional"
        yield f"`{one.name}`", describe_type(hints[one.name]), need, one.metadata.get("description", "")


def describe_type(hint: typing.Any) -> str:
    """A field's type in words, with its limits."""
    origin, inner = typing.get_origin(hint), typing.get_args(hint)
    if origin is typing.Annotated:
        span = next((one for one in inner[1:] if isinstance(one, Range)), None)
        limits = f", {span.minimum:.4g} to {span.maximum:.4g}" if span else ""
        return describe_type(inner[0]) + limits
    if origin is typing.Literal:
        return " or ".join(f"`{one}`" for one in inner)
    if origin in (types.UnionType, typing.Union):
        return " or ".join(dict.fromkeys(describe_type(one) for one in inner if one is not types.NoneType))
    if origin in (list, tuple):
        kinds = dict.fromkeys(describe_type(one) for one in inner if one is not Ellipsis)
        return f"list of {' and '.join(kinds)}"
    if origin is dict:
        return f"{describe_type(inner[1])}, by name"
    return _WORDS.get(hint) or f"`{hint.__name__}`"


def topics_page() -> str:
    """The whole text of topics.md."""
    head = ("topic", "number", "kind", "sender", "recorded", "", "meaning")
    parts = [TOPICS_INTRODUCTION, table(head, map(_topic_row, TOPICS))]
    for topic in TOPICS:
        if topic.kind is not Kind.PICTURE:
            parts += [f"## {topic.name}\n", f"{_one_line(topic.record)}\n"]
            parts.append(table(("field", "type", "meaning"), _topic_fields(topic.record)))
    return page("Topics", TOPICS_SOURCE, *parts)


def _topic_row(topic: AnyTopic) -> tuple[str, ...]:
    name = f"`{topic.name}`" if topic.kind is Kind.PICTURE else f"[{topic.name}](#{topic.name})"
    rules = [words for words, holds in (("newest only", topic.newest_only), ("lines", topic.lines)) if holds]
    return (
        name,
        str(topic.id),
        topic.kind.name.lower(),
        topic.sender,
        "yes" if topic.recorded else "",
        ", ".join(rules),
        topic.meaning,
    )


def _topic_fields(record: type[Record] | type[Document] | type[PublishedEvent]) -> Iterator[tuple[str, ...]]:
    if issubclass(record, Record):
        for name, wire in record.wires.items():
            count = f" × {wire.count}" if wire.count > 1 else ""
            yield f"`{name}`", f"number{count}", ", ".join(part for part in (wire.unit, wire.meaning) if part)
        return
    hints = typing.get_type_hints(record, include_extras=True)
    for one in fields(record):
        yield f"`{one.name}`", describe_type(hints[one.name]), one.metadata.get("meaning", "")


def events_page() -> str:
    """The whole text of events.md."""
    rows = [*_topic_fields(PublishedEvent)]
    fields_table = table(("field", "type", "meaning"), rows)
    return page("Events", EVENTS_SOURCE, EVENTS_INTRODUCTION, "## Fields\n", fields_table, EVENTS_RULES)


def packets_page() -> str:
    """The whole text of packets.md."""
    parts = [
        PACKETS_INTRODUCTION,
        table(("type", "packet", "bytes", "reliable"), map(_packet_row, PACKETS.values())),
    ]
    for packet in PACKETS.values():
        parts += [f"## {packet.__name__}\n", f"`0x{packet.type:02X}`. {_one_line(packet)}\n"]
        rows = [_number_row(name, wire) for name, wire in packet.wires.items()]
        rows += [_text_row(*packet.tail)] if packet.tail else []
        if rows:
            parts.append(table(("field", "on the wire", "one count is", "meaning"), rows))
    parts.append("## Flags and codes\n")
    for enumeration in ENUMERATIONS:
        members = ((str(one.value), f"`{one.name}`") for one in enumeration)
        parts += [f"### {enumeration.__name__}\n", f"{enumeration.__doc__}\n"]
        parts.append(table(("value", "name"), members))
    return page("Packets", PACKETS_SOURCE, *parts)


def _packet_row(packet: type[Packet]) -> tuple[str, ...]:
    reliable = "yes" if packet.reliable else ""
    link = f"[{packet.__name__}](#{packet.__name__.lower()})"
    return f"`0x{packet.type:02X}`", link, packet.describe_size(), reliable


def _number_row(name: str, wire: Wire) -> tuple[str, ...]:
    type_ = C_TYPES[wire.code] + (f" × {wire.count}" if wire.count > 1 else "")
    step = f"{wire.scale:.6g} {wire.unit}".strip() if wire.scale != 1 or wire.unit else ""
    return f"`{name}`", f"`{type_}`", step, wire.meaning


def _text_row(name: str, text: Text) -> tuple[str, ...]:
    return f"`{name}`", f"`uint8_t` length, then at most {text.max_bytes} bytes of UTF-8", "", text.meaning


def faults_page() -> str:
    """The whole text of faults.md."""
    return page(
        "States and faults",
        FAULTS_SOURCE,
        STATES_INTRODUCTION,
        "## States\n",
        _states(),
        "## Transitions\n",
        table(
            ("from", "trigger", "to", "why"),
            ((f"`{one.before}`", one.trigger, f"`{one.after}`", one.why) for one in TRANSITIONS),
        ),
        "## Faults\n",
        FAULTS_INTRODUCTION,
        table(("fault", "within", "action", "alarm", "message", "consequences"), map(_fault_row, FAULTS)),
    )


def _states() -> str:
    """One row for each state, one column for each trigger, and the next state where they meet."""
    states = list(dict.fromkeys(one.before for one in TRANSITIONS))
    triggers = list(dict.fromkeys(one.trigger for one in TRANSITIONS))
    after = {(one.before, one.trigger): one.after for one in TRANSITIONS}
    rows = [(f"`{state}`", *(after.get((state, one), "") for one in triggers)) for state in states]
    return table(("state", *triggers), rows)


def _fault_row(fault: FaultRule) -> tuple[str, ...]:
    action = f"{fault.action}; alarm only in manual" if fault.automatic_only else fault.action
    message = f"{fault.what} {fault.cause} *{fault.remedy}*"
    consequences = ", ".join(f"`{one}`" for one in fault.consequences)
    return f"`{fault.name}`", f"{fault.limit:g} s", action, fault.severity, message, consequences


def parameters_page() -> str:
    """The whole text of parameters.md."""
    rows = map(_parameter_row, _registered())
    return page(
        "Parameters",
        PARAMETERS_SOURCE,
        PARAMETERS_INTRODUCTION,
        table(("parameter", "range", "default", "meaning"), rows),
    )


def _registered() -> list[TunableParameter]:
    clock, config = SimulatedClock(), Config()
    line = LinkDriver("", config.link.baud, clock, 1, lambda _: None, lambda: None)
    outbox = Outbox(lambda *_: None, lambda _: False)
    robot = Core(config, clock, "", line, outbox, watched=lambda _: False)
    return robot.parameters.listed()


def _parameter_row(one: TunableParameter) -> tuple[str, ...]:
    if one.type == "choice":
        span = ", ".join(one.choices)
    elif one.type == "switch":
        span = "on, off"
    else:
        span = f"{one.minimum:g} to {one.maximum:g} {one.unit}".strip()
    default = f"{one.default:g}" if isinstance(one.default, float) else str(one.default)
    only = "" if one.while_armed else "; only while disarmed"
    return f"`{one.name}`", span, default, f"{one.meaning}{only}"


def _one_line(cls: type) -> str:
    return " ".join((cls.__doc__ or "").split())
