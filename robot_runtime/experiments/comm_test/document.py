"""The test document: JSON with the fields of the thesis's Figure 10, and three optional ones.

Each problem names its test and its field. All delays are seconds, as in Figure 10.
"""

import json
import re
from collections.abc import Iterator
from contextlib import suppress
from dataclasses import dataclass
from typing import Annotated, Any

from robot_runtime.config import BAUD_ERROR_MAX, CHIP_CLOCK
from robot_runtime.contract.limits import ConfigError, Range
from robot_runtime.contract.parsing import TOP, parse
from robot_runtime.contract.problems import DocumentEntry, EntryProblem
from robot_runtime.contract.text_input import TextError, read_json
from robot_runtime.experiments.comm_test.faults import Faults
from robot_runtime.experiments.comm_test.framings import FRAMINGS, NUMBER_MAX, FramingName
from robot_runtime.experiments.comm_test.results import Direction, GridCell

DOCUMENT_BYTES_MAX = 1_000_000
CELLS_MAX = 500
NUMBERS_MAX = 5000
NAME_CHARACTERS_MAX = 200
SLOWEST_DIVISOR = 4095
SKETCH = "comm_test/comm_test.ino"
THESIS_SKETCH = re.compile(r"micro_cat_test/arduino/(test_\d+)/\1\.ino")
"""The thesis's package has one sketch per test; all of them are the one sketch here."""
NO_FAULTS = Faults()

Delays = tuple[Annotated[float, Range(0, 10)], ...]


@dataclass(frozen=True, slots=True)
class CommTest:
    """One test: numbers from `from_val` up to, and without, `to_val`; delays in s, bauds in bit/s."""

    id: Annotated[int, Range(0, 1_000_000)]
    name: str
    ino_path: str
    delay: Delays
    baud_rate: tuple[Annotated[int, Range(1, CHIP_CLOCK)], ...]
    from_val: Annotated[int, Range(0, NUMBER_MAX)]
    to_val: Annotated[int, Range(1, NUMBER_MAX + 1)]
    expected: Annotated[int, Range(1, NUMBERS_MAX)]
    arduinodelay: Delays
    framing: FramingName = "thesis"
    direction: Direction = "to_board"
    faults: Faults = NO_FAULTS

    @property
    def cells(self) -> list[GridCell]:
        """The grid in the order in which it is run: baud, Arduino delay, Pi delay."""
        return [
            GridCell(baud, arduino_delay, pi_delay)
            for baud in self.baud_rate
            for arduino_delay in self.arduinodelay
            for pi_delay in self.delay
        ]


_STAND_IN: dict[str, Any] = {
    "id": 1,
    "name": "-",
    "ino_path": SKETCH,
    "delay": [0],
    "baud_rate": [9600],
    "from_val": 0,
    "to_val": 1,
    "expected": 1,
    "arduinodelay": [0],
}


def read_document(text: str) -> list[CommTest]:
    """Return the tests of a document. Raise ConfigError with all problems."""
    if len(text) > DOCUMENT_BYTES_MAX:
        raise ConfigError(f"the document is larger than {DOCUMENT_BYTES_MAX} bytes")
    try:
        entries = read_json(text)
        # JSON can name halves of characters, which no text can hold.
        json.dumps(entries, ensure_ascii=False).encode()
    except TextError as problem:
        raise ConfigError(f"the document {problem}") from problem
    except UnicodeEncodeError as problem:
        raise ConfigError(f"the document is not JSON: {problem}") from problem
    if not isinstance(entries, list) or not entries:
        raise ConfigError("the document must be a list of one or more tests")
    problems: list[str | EntryProblem] = []
    tests = []
    for index, entry in enumerate(entries):
        where = DocumentEntry(f"test {index + 1}", (index,))
        if not isinstance(entry, dict):
            problems.append(where.sentence("it must be an object in braces"))
            continue
        try:
            tests.append(test := parse(CommTest, entry, where))
            test_problems = [*_field_problems(test), *_number_problems(test)]
        except ConfigError as problem:
            problems += problem.problems
            test_problems = [*_field_problems(_with_stand_ins(entry))]
        problems += [problem.within(where) for problem in test_problems]
    cells = sum(len(test.baud_rate) * len(test.arduinodelay) * len(test.delay) for test in tests)
    if not problems and cells > CELLS_MAX:
        problems.append(f"the document has {cells} cells; at most {CELLS_MAX} can be run at once")
    if problems:
        raise ConfigError(*problems)
    return tests


def chip_baud(baud: int) -> float:
    """Return the speed, bit/s, of the chip's UART for a baud rate by the Arduino core; 0 for none."""
    divisor = (CHIP_CLOCK // 4 // baud - 1) // 2
    step = 8
    if divisor > SLOWEST_DIVISOR or baud == 57600:
        divisor = (CHIP_CLOCK // 8 // baud - 1) // 2
        step = 16
    return CHIP_CLOCK / (step * (divisor + 1)) if 0 <= divisor <= SLOWEST_DIVISOR else 0.0


def _with_stand_ins(entry: dict[str, Any]) -> CommTest:
    """Return the test with stand-ins for missing and wrong fields, so that the others can be checked."""
    sound = dict(_STAND_IN)
    for name, value in entry.items():
        with suppress(ConfigError):
            parse(CommTest, _STAND_IN | {name: value})
            sound[name] = value
    return parse(CommTest, sound)


def _field_problems(test: CommTest) -> Iterator[EntryProblem]:
    """Yield the problems that types and limits of single fields do not find."""
    if not test.name.strip() or len(test.name) > NAME_CHARACTERS_MAX:
        yield TOP.field("name").problem(f"must be a text of 1 to {NAME_CHARACTERS_MAX} characters")
    path = test.ino_path.lstrip("/")
    if path != SKETCH and not THESIS_SKETCH.fullmatch(path):
        yield TOP.field("ino_path").problem(
            f"is {test.ino_path!r}; it must be {SKETCH}, or the thesis's "
            "/micro_cat_test/arduino/test_N/test_N.ino, which stands for the same"
        )
    yield from _list_problems("delay", test.delay)
    yield from _list_problems("arduinodelay", test.arduinodelay)
    yield from _list_problems("baud_rate", test.baud_rate)
    yield from _baud_problems(test)


def _number_problems(test: CommTest) -> Iterator[EntryProblem]:
    count = test.to_val - test.from_val
    if test.to_val > (highest := FRAMINGS[test.framing].number_max + 1):
        text = f"is {test.to_val}; with the framing {test.framing} it must be at most {highest}"
        yield TOP.field("to_val").problem(text)
    elif not 1 <= count <= NUMBERS_MAX:
        yield TOP.field("to_val").problem(
            f"is {test.to_val}; it must be above from_val, {test.from_val}, by 1 to {NUMBERS_MAX}, "
            "as it is the first number that is not sent"
        )
    elif test.expected != count:
        yield TOP.field("expected").problem(
            f"is {test.expected}; it must be {count}, the count of numbers from from_val, "
            f"{test.from_val}, up to, and without, to_val, {test.to_val}"
        )


def _list_problems(name: str, values: tuple[float, ...]) -> Iterator[EntryProblem]:
    where = TOP.field(name)
    if not values:
        yield where.problem("must be a list of one or more numbers")
    seen: set[float] = set()
    for index, value in enumerate(values):
        if value in seen:
            yield where.item(index).problem(f"is {value:g}, which the list already has")
        seen.add(value)


def _baud_problems(test: CommTest) -> Iterator[EntryProblem]:
    lowest, highest = FRAMINGS[test.framing].bauds
    for index, baud in enumerate(test.baud_rate):
        made = chip_baud(baud)
        where = TOP.field("baud_rate").item(index)
        if not lowest <= baud <= highest:
            limits = f"between {lowest} and {highest}"
            yield where.problem(f"is {baud}; with the framing {test.framing} it must lie {limits}")
        elif abs(made / baud - 1) > BAUD_ERROR_MAX:
            does = f"makes {made:.0f} of it, {made / baud - 1:+.1%}" if made else "cannot make it"
            limit = f"it must be within {BAUD_ERROR_MAX:.1%}"
            yield where.problem(f"is {baud}; the chip at 16 MHz {does}; {limit}")
