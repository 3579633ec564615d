"""The counts of a communication test's cell, and their explanation."""

from collections.abc import Mapping
from dataclasses import asdict, dataclass, fields, replace
from typing import Any, Literal

Direction = Literal["to_board", "to_host", "both"]
Finding = tuple[str, str]
"""A cause by name, and what it did, in words."""
RING_BYTES = 63
"""What the Arduino core's ring of 64 holds."""


@dataclass(frozen=True, slots=True)
class Counts:
    """One end's count of what it received; `bytes_read` without the question for the result.

    `right`: numbers of the test, each above all right ones before it. `ring_full`: times that the chip found
    its ring full; 0 on the host.
    """

    right: int = 0
    out_of_sequence: int = 0
    checksum_errors: int = 0
    framing_errors: int = 0
    ring_full: int = 0
    bytes_read: int = 0

    def __add__(self, other: "Counts") -> "Counts":
        mine, theirs = asdict(self), asdict(other)
        return Counts(**{field.name: mine[field.name] + theirs[field.name] for field in fields(Counts)})


@dataclass(frozen=True, slots=True)
class FaultCounts:
    """The injected faults of both directions together; `cuts` are bytes lost while the line was cut."""

    bit_errors: int = 0
    drops: int = 0
    doubles: int = 0
    inserts: int = 0
    bursts: int = 0
    cuts: int = 0
    stalls: int = 0

    @classmethod
    def add_up(cls, counts: Mapping[str, int]) -> "FaultCounts":
        """From counters whose names begin with the direction, as the emulated board has them."""
        return cls(
            **{
                field.name: counts[f"to_board_{field.name}"] + counts[f"from_board_{field.name}"]
                for field in fields(cls)
            }
        )

    @property
    def words(self) -> str:
        """The faults as text; empty if there were none."""
        words = (
            (self.bit_errors, "wrong bits"),
            (self.bursts, "bursts of errors"),
            (self.drops, "dropped bytes"),
            (self.doubles, "doubled bytes"),
            (self.inserts, "bytes put in"),
            (self.cuts, "bytes lost while it was cut"),
            (self.stalls, "stalls"),
        )
        return ", ".join(f"{count} {what}" for count, what in words if count)


NO_FAULT_COUNTS = FaultCounts()


@dataclass(frozen=True, slots=True)
class LineErrors:
    """Errors on the wire, as the UARTs counted them where they can be read."""

    framing_board: int = 0
    framing_host: int = 0
    overruns: int = 0
    faults: FaultCounts = NO_FAULT_COUNTS


@dataclass(frozen=True, slots=True)
class GridCell:
    """One cell of the grid: baud in bit/s, delays in s."""

    baud: int
    arduino_delay: float
    pi_delay: float


@dataclass(frozen=True, slots=True)
class CellResult:
    """The result of a cell.

    `board` is None where the chip's answer never came; `lost_to_...` are bytes that were written to the line
    and not read from it. `seconds` is emulated time, `repeated` are frames that either end sent again.
    """

    cell: GridCell
    direction: Direction
    expected: int
    board: Counts | None
    host: Counts
    lost_to_board: int
    lost_to_host: int
    line: LineErrors
    seconds: float
    repeated: int = 0

    @property
    def rate(self) -> float:
        """Share of the expected numbers that arrived right, 0 to 1; 0 where the result is lost."""
        if self.direction == "to_host":
            return self.host.right / self.expected
        if self.board is None:
            return 0.0
        if self.direction == "to_board":
            return self.board.right / self.expected
        return (self.board.right + self.host.right) / (2 * self.expected)

    @property
    def counts(self) -> Counts:
        """Returns the counts of the receiving ends, added up where both receive."""
        if self.direction == "to_host":
            return self.host
        return (self.board or Counts()) + self.host

    @property
    def causes(self) -> tuple[str, ...]:
        """The names of the causes; none where every number arrived."""
        return tuple(dict.fromkeys(cause for cause, _ in self._findings()))

    @property
    def explanation(self) -> str:
        """Why the rate is what it is, for a person."""
        findings = [f"{cause}: {words}" for cause, words in self._findings()]
        return "; ".join([*(findings or ["every number arrived"]), *self._remarks()])

    @property
    def values(self) -> dict[str, Any]:
        """The result as plain values by name, as it is stored; both directions added up."""
        return {
            **asdict(self.cell),
            **asdict(self.counts),
            "rate": self.rate,
            "answered": self.board is not None,
            "bytes_lost": max(self.lost_to_board, 0) + max(self.lost_to_host, 0),
            "line_errors": self.line.framing_board + self.line.framing_host,
            "uart_overruns": self.line.overruns,
            "repeated": self.repeated,
            "seconds": self.seconds,
            "causes": ", ".join(self.causes),
            "explanation": self.explanation,
        }

    def _remarks(self) -> list[str]:
        faults = self.line.faults.words
        return [f"on the line there were {faults}"] if faults else []

    @property
    def harmed(self) -> bool:
        """True if the test injected faults that change bytes."""
        return replace(self.line.faults, stalls=0) != NO_FAULT_COUNTS

    def _findings(self) -> list[Finding]:
        findings = []
        if self.board is None:
            findings.append(("lost result", "the chip did not answer when it was asked for its counts"))
        if self.direction != "to_host" and self.board:
            findings += _explain(self.board, self.expected, self.lost_to_board, "the chip", self.harmed)
        if self.direction != "to_board":
            findings += _explain(self.host, self.expected, self.lost_to_host, "the host", self.harmed)
        if self.line.framing_board or self.line.framing_host:
            where = f"{self.line.framing_board} at the chip, {self.line.framing_host} at the host"
            findings.append(("line", f"stop bits were not where they belong, {where}"))
        if self.line.overruns:
            findings.append(
                ("UART overrun", f"{self.line.overruns} bytes came before the chip had fetched those before")
            )
        return findings


@dataclass(frozen=True, slots=True)
class LinkCellResult(CellResult):
    """The result of a cell over the robot's own link, where damaged frames are no failure.

    `trouble` says why there is no result.
    """

    trouble: tuple[Finding, ...] = ()

    def _findings(self) -> list[Finding]:
        findings = list(self.trouble)
        ends = {"the chip": self.board} if self.direction != "to_host" else {}
        if self.direction != "to_board":
            ends["the host"] = self.host
        for who, counts in ends.items():
            if counts and counts.right < self.expected:
                missing = f"{self.expected - counts.right} of {self.expected} numbers did not reach {who}"
                findings.append(("lost numbers", missing))
            if counts and counts.out_of_sequence:
                words = f"numbers that came twice or out of their order at {who}: {counts.out_of_sequence}"
                findings.append(("out of sequence", words))
        return findings

    def _remarks(self) -> list[str]:
        remarks = CellResult._remarks(self)
        if self.repeated:
            remarks.append(f"frames sent again: {self.repeated}")
        damaged = self.counts.checksum_errors
        return [*remarks, f"damaged frames thrown away: {damaged}"] if damaged else remarks


def _explain(counts: Counts, expected: int, lost: int, who: str, harmed: bool) -> list[Finding]:
    findings = []
    missing = f"{expected - counts.right} of {expected} numbers did not reach {who}"
    if lost > 0 and counts.ring_full:
        findings.append(
            (
                "ring overrun",
                f"the bytes came faster than the sketch read them, its ring of {RING_BYTES} bytes was full "
                f"and {lost} bytes were dropped; {missing}",
            )
        )
    elif lost > 0:
        findings.append(("lost bytes", f"{lost} bytes did not reach {who}; {missing}"))
    if counts.framing_errors:
        why = "bytes of theirs were missing" if lost > 0 else "a byte within was the end mark \\n"
        why = "the line had harmed them, or a byte within was the end mark \\n" if harmed else why
        findings.append(
            ("framing error", f"messages of the wrong length at {who}: {counts.framing_errors}; {why}")
        )
    if counts.checksum_errors:
        findings.append(("checksum", f"packets that were not what had been sent: {counts.checksum_errors}"))
    if counts.out_of_sequence:
        findings.append(
            (
                "out of sequence",
                f"numbers that were not among those still to come: {counts.out_of_sequence}, as when halves "
                "of two numbers are read as one",
            )
        )
    return findings or ([("lost numbers", missing)] if counts.right < expected else [])
