"""The test document: JSON with the fields of the thesis's Figure 10, and three more that may be left out.

Every problem is told with the place where it is. All delays are seconds, as in Figure 10.
"""

import json
import re
from collections.abc import Mapping
from dataclasses import dataclass, fields
from math import isfinite
from typing import Any, get_args

from robot_runtime.config import BAUD_ERROR_MAX, CHIP_CLOCK
from robot_runtime.experiments.comm_test.faults import RATE_KINDS, Faults
from robot_runtime.experiments.comm_test.framings import FRAMINGS
from robot_runtime.experiments.comm_test.results import Direction, GridCell

DOCUMENT_BYTES_MAX = 1_000_000
CELLS_MAX = 500
NUMBERS_MAX = 5000
DELAY_MAX = 10.0
"""s."""
FAULT_RATE_MAX = 0.1
BURST_BITS_MAX = 10_000
PERIOD_MIN, PERIOD_MAX = 0.05, 3600.0
"""s between two stalls, or two cuts, from beginning to beginning."""
SEED_MAX = 2**32 - 1
NAME_CHARACTERS_MAX = 200
SLOWEST_DIVISOR = 4095
SKETCH = "comm_test/comm_test.ino"
THESIS_SKETCH = re.compile(r"micro_cat_test/arduino/(test_\d+)/\1\.ino")
"""The thesis's package has one sketch per test; all of them are the one sketch here."""

NEEDED = ("id", "name", "ino_path", "delay", "baud_rate", "from_val", "to_val", "expected", "arduinodelay")
OPTIONAL = ("framing", "direction", "faults")
NO_FAULTS = Faults()


class DocumentError(ValueError):
    """A document that cannot be run; `problems` says in words what is wrong, place by place."""

    def __init__(self, problems: list[str]) -> None:
        super().__init__("; ".join(problems))
        self.problems = problems


@dataclass(frozen=True, slots=True)
class CommTest:
    """One test: numbers from `from_val` up to, and without, `to_val`; delays in s, bauds in bit/s."""

    id: int
    name: str
    ino_path: str
    delay: tuple[float, ...]
    baud_rate: tuple[int, ...]
    from_val: int
    to_val: int
    expected: int
    arduinodelay: tuple[float, ...]
    framing: str = "thesis"
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


def read_document(text: str) -> list[CommTest]:
    """The tests of a document. Raises DocumentError."""
    if len(text) > DOCUMENT_BYTES_MAX:
        raise DocumentError([f"the document is larger than {DOCUMENT_BYTES_MAX} bytes"])
    try:
        entries = json.loads(text)
        # JSON can name halves of characters, which no text can hold.
        json.dumps(entries, ensure_ascii=False).encode()
    except (ValueError, RecursionError) as problem:
        raise DocumentError([f"the document is not JSON: {problem}"]) from problem
    if not isinstance(entries, list) or not entries:
        raise DocumentError(["the document must be a list of one or more tests"])
    problems: list[str] = []
    tests = []
    for number, entry in enumerate(entries, 1):
        reader = _Reader(entry if isinstance(entry, dict) else {})
        if isinstance(entry, dict):
            tests.append(reader.read())
        else:
            reader.problems.append("it must be an object in braces")
        problems += [f"test {number}: {problem}" for problem in reader.problems]
    if not problems and sum(len(test.cells) for test in tests) > CELLS_MAX:
        cells = sum(len(test.cells) for test in tests)
        problems.append(f"the document has {cells} cells; at most {CELLS_MAX} can be run at once")
    if problems:
        raise DocumentError(problems)
    return tests


def chip_baud(baud: int) -> float:
    """Returns the speed, bit/s, of the chip's UART for a baud rate by the Arduino core; 0 for none."""
    divisor = (CHIP_CLOCK // 4 // baud - 1) // 2
    step = 8
    if divisor > SLOWEST_DIVISOR or baud == 57600:
        divisor = (CHIP_CLOCK // 8 // baud - 1) // 2
        step = 16
    return CHIP_CLOCK / (step * (divisor + 1)) if 0 <= divisor <= SLOWEST_DIVISOR else 0.0


class _Reader:
    def __init__(self, entry: Mapping[str, Any]) -> None:
        self._entry = entry
        self.problems: list[str] = []

    def read(self) -> CommTest:
        """The test; only of use where no problems were found."""
        for name in self._entry:
            if name not in NEEDED + OPTIONAL:
                self.problems.append(
                    f"{name}: there is no such field; known are {', '.join(NEEDED + OPTIONAL)}"
                )
        for name in NEEDED:
            if name not in self._entry:
                self.problems.append(f"{name}: it is missing")
        framing = self._choice("framing", "thesis", tuple(FRAMINGS))
        from_val, to_val, expected = self._numbers(framing)
        return CommTest(
            id=self._whole("id", 0, 1_000_000),
            name=self._name(),
            ino_path=self._path(),
            delay=self._delays("delay"),
            baud_rate=self._bauds(framing),
            from_val=from_val,
            to_val=to_val,
            expected=expected,
            arduinodelay=self._delays("arduinodelay"),
            framing=framing,
            direction=self._choice("direction", "to_board", get_args(Direction)),  # type: ignore[arg-type]
            faults=self._faults(),
        )

    def _faults(self) -> Faults:
        value = self._entry.get("faults", {})
        if not isinstance(value, dict):
            self.problems.append("faults: it must be an object in braces")
            return Faults()
        reader = _FaultReader(value)
        faults = reader.read()
        self.problems += [f"faults.{problem}" for problem in reader.problems]
        return faults

    def _whole(self, name: str, minimum: int, maximum: int) -> int:
        value = self._entry.get(name, minimum)
        if type(value) is not int or not minimum <= value <= maximum:
            self.problems.append(f"{name}: {value!r} is not a whole number from {minimum} to {maximum}")
            return minimum
        return value

    def _numbers(self, framing: str) -> tuple[int, int, int]:
        before = len(self.problems)
        highest = FRAMINGS[framing].number_max
        from_val = self._whole("from_val", 0, highest)
        to_val = self._whole("to_val", 1, highest + 1)
        expected = self._whole("expected", 1, NUMBERS_MAX)
        count = to_val - from_val
        complete = {"from_val", "to_val", "expected"} <= self._entry.keys()
        if not complete or len(self.problems) > before:
            return from_val, to_val, expected
        if not 1 <= count <= NUMBERS_MAX:
            self.problems.append(
                f"to_val: {to_val} must be above from_val, {from_val}, by 1 to {NUMBERS_MAX}; "
                "it is the first number that is not sent"
            )
        elif expected != count:
            self.problems.append(
                f"expected: {expected} numbers, but from_val {from_val} up to, and without, to_val {to_val} "
                f"are {count}"
            )
        return from_val, to_val, expected

    def _name(self) -> str:
        value = self._entry.get("name", "-")
        if not isinstance(value, str) or not value.strip() or len(value) > NAME_CHARACTERS_MAX:
            self.problems.append(f"name: it must be a text of 1 to {NAME_CHARACTERS_MAX} characters")
            return ""
        return value

    def _path(self) -> str:
        value = self._entry.get("ino_path", SKETCH)
        path = value.lstrip("/") if isinstance(value, str) else ""
        if path != SKETCH and not THESIS_SKETCH.fullmatch(path):
            self.problems.append(
                f"ino_path: {value!r} is not among the sketches; use {SKETCH}, or the thesis's "
                "/micro_cat_test/arduino/test_N/test_N.ino, which stands for the same"
            )
        return value if isinstance(value, str) else ""

    def _choice(self, name: str, default: str, allowed: tuple[str, ...]) -> str:
        value = self._entry.get(name, default)
        if not isinstance(value, str) or value not in allowed:
            self.problems.append(f"{name}: {value!r} must be one of {', '.join(allowed)}")
            return default
        return value

    def _list(self, name: str) -> list[Any]:
        value = self._entry.get(name)
        if name not in self._entry:
            return []
        if not isinstance(value, list) or not value:
            self.problems.append(f"{name}: it must be a list of one or more numbers")
            return []
        if len(value) > CELLS_MAX:
            self.problems.append(f"{name}: it has {len(value)} entries; a test has at most {CELLS_MAX} cells")
            return []
        return value

    def _delays(self, name: str) -> tuple[float, ...]:
        delays: list[float] = []
        for place, value in enumerate(self._list(name)):
            if not _is_number(value) or not 0 <= value <= DELAY_MAX:
                self.problems.append(
                    f"{name}[{place}]: {value!r} is not a delay from 0 to {DELAY_MAX:g} seconds"
                )
            elif float(value) in delays:
                self.problems.append(f"{name}[{place}]: {value!r} is there twice")
            else:
                delays.append(float(value))
        return tuple(delays)

    def _bauds(self, framing: str) -> tuple[int, ...]:
        bauds: list[int] = []
        lowest, highest = FRAMINGS[framing].bauds
        for place, value in enumerate(self._list("baud_rate")):
            if type(value) is not int or not 1 <= value <= CHIP_CLOCK:
                self.problems.append(f"baud_rate[{place}]: {value!r} is not a baud rate")
                continue
            if not lowest <= value <= highest:
                self.problems.append(
                    f"baud_rate[{place}]: {value} is not a baud rate of this framing, {lowest} to {highest}"
                )
                continue
            made = chip_baud(value)
            if abs(made / value - 1) > BAUD_ERROR_MAX:
                made_words = f"makes {made:.0f} of it, {made / value - 1:+.1%}" if made else "cannot make it"
                self.problems.append(
                    f"baud_rate[{place}]: the chip at 16 MHz {made_words}; it must be within "
                    f"{BAUD_ERROR_MAX:.1%}"
                )
            elif value in bauds:
                self.problems.append(f"baud_rate[{place}]: {value} is there twice")
            else:
                bauds.append(value)
        return tuple(bauds)


class _FaultReader:
    def __init__(self, entry: Mapping[str, Any]) -> None:
        # A test that was stored says null where there is none.
        self._entry = {name: value for name, value in entry.items() if value is not None}
        self.problems: list[str] = []

    def read(self) -> Faults:
        """The faults; only of use where no problems were found."""
        known = [field.name for field in fields(Faults)]
        for name in self._entry:
            if name not in known:
                self.problems.append(f"{name}: there is no such fault; known are {', '.join(known)}")
        return Faults(
            seed=self._seed(),
            **{kind: self._rate(kind, self._entry.get(kind, 0.0)) for kind in RATE_KINDS},
            burst=self._burst(),
            stall=self._recurring("stall"),
            cut=self._recurring("cut"),
        )

    def _seed(self) -> int:
        value = self._entry.get("seed", 0)
        if type(value) is not int or not 0 <= value <= SEED_MAX:
            self.problems.append(f"seed: {value!r} is not a whole number from 0 to {SEED_MAX}")
            return 0
        return value

    def _rate(self, name: str, value: Any) -> float:
        if not _is_number(value) or not 0 <= value <= FAULT_RATE_MAX:
            self.problems.append(f"{name}: {value!r} is not a rate from 0 to {FAULT_RATE_MAX:g}")
            return 0.0
        return float(value)

    def _burst(self) -> tuple[float, int] | None:
        pair = self._pair("burst", "a rate and a length in bits")
        if pair is None:
            return None
        rate = self._rate("burst[0]", pair[0])
        if type(pair[1]) is not int or not 1 <= pair[1] <= BURST_BITS_MAX:
            self.problems.append(
                f"burst[1]: {pair[1]!r} is not a whole number of bits, 1 to {BURST_BITS_MAX}"
            )
            return None
        return rate, pair[1]

    def _recurring(self, name: str) -> tuple[float, float] | None:
        pair = self._pair(name, "how often and for how long, both in seconds")
        if pair is None:
            return None
        every, seconds = pair
        if not _is_number(every) or not PERIOD_MIN <= every <= PERIOD_MAX:
            limits = f"from {PERIOD_MIN:g} to {PERIOD_MAX:g} seconds"
            self.problems.append(f"{name}[0]: {every!r} is not a time {limits}")
        elif not _is_number(seconds) or not 0 < seconds < every:
            self.problems.append(
                f"{name}[1]: {seconds!r} is not a time above 0 and below faults.{name}[0], {every}"
            )
        else:
            return float(every), float(seconds)
        return None

    def _pair(self, name: str, meaning: str) -> list[Any] | None:
        value = self._entry.get(name)
        if value is None:
            return None
        if not isinstance(value, list) or len(value) != 2:
            self.problems.append(f"{name}: it must be a list of two numbers, {meaning}")
            return None
        return value


def _is_number(value: Any) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool) and isfinite(value)
