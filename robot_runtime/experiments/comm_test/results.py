"""The result of a communication test's cell: counts, causes of losses, and an explanation."""

from collections.abc import Mapping
from dataclasses import asdict, astuple, dataclass, fields, replace
from typing import Any, Literal

Direction = Literal["to_board", "to_host", "both"]
Finding = tuple[str, str]
"""A cause by name, and its effect in words."""
RING_BYTES = 63
"""Capacity of the Arduino core's receive buffer, a ring of 64."""


@dataclass(frozen=True, slots=True)
class Counts:
    """The counts of one receiving end; `bytes_read` excludes the request for the result.

    `right`: numbers of the test, each above all right ones before it. `ring_full`: times that the chip found
    its receive buffer full; 0 on the host.
    """

    right: int = 0
    out_of_sequence: int = 0
    checksum_errors: int = 0
    framing_errors: int = 0
    ring_full: int = 0
    bytes_read: int = 0

    def __add__(self, other: "Counts") -> "Counts":
        return Counts(*map(sum, zip(astuple(self), astuple(other), strict=True)))


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
        """Add the emulated board's counters, whose names begin with the direction."""
        return cls(
            **{
                field.name: counts[f"to_board_{field.name}"] + counts[f"from_board_{field.name}"]
                for field in fields(cls)
            }
        )

    @property
    def text(self) -> str:
        """The faults as text; empty if there were none."""
        counts = (
            (self.bit_errors, "wrong bits"),
            (self.bursts, "bursts of errors"),
            (self.drops, "dropped bytes"),
            (self.doubles, "doubled bytes"),
            (self.inserts, "inserted bytes"),
            (self.cuts, "bytes lost while the line was cut"),
            (self.stalls, "stalls"),
        )
        return ", ".join(f"{count} {what}" for count, what in counts if count)


NO_FAULT_COUNTS = FaultCounts()


@dataclass(frozen=True, slots=True)
class LineErrors:
    """Errors on the wire, from the UARTs' counters where they can be read."""

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

    `board` is None if the chip did not answer; `lost_to_...` are bytes that were written to the line and not
    read from it. `seconds` is emulated time; `repeated` counts the retransmitted frames of both ends.
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
        """Share of the expected numbers that arrived right, 0 to 1; 0 if the result is lost."""
        if self.direction == "to_host":
            return self.host.right / self.expected
        if self.board is None:
            return 0.0
        if self.direction == "to_board":
            return self.board.right / self.expected
        return (self.board.right + self.host.right) / (2 * self.expected)

    @property
    def counts(self) -> Counts:
        """The counts of the receiving end, or of both together."""
        if self.direction == "to_host":
            return self.host
        return (self.board or Counts()) + self.host

    @property
    def causes(self) -> tuple[str, ...]:
        """The names of the causes; none if every number arrived."""
        return tuple(dict.fromkeys(cause for cause, _ in self._findings()))

    @property
    def explanation(self) -> str:
        """The explanation of the rate, for a person: a reason on each line, which begins with its cause."""
        findings = [f"{cause}: {reason}" for cause, reason in self._findings()]
        return "\n".join([*(findings or ["every number arrived"]), *self._remarks()])

    @property
    def values(self) -> dict[str, Any]:
        """The values that are stored, by name; both directions are added."""
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
        faults = self.line.faults.text
        return [f"injected faults: {faults}"] if faults else []

    @property
    def harmed(self) -> bool:
        """True if the test injected faults that change bytes."""
        return replace(self.line.faults, stalls=0) != NO_FAULT_COUNTS

    def _findings(self) -> list[Finding]:
        findings = []
        if self.board is None:
            findings.append(("lost result", "the chip did not answer the request for its counts"))
        if self.direction != "to_host" and self.board:
            findings += _explain(self.board, self.expected, self.lost_to_board, "the chip", self.harmed)
        if self.direction != "to_board":
            findings += _explain(self.host, self.expected, self.lost_to_host, "the host", self.harmed)
        if self.line.framing_board or self.line.framing_host:
            where = f"{self.line.framing_board} at the chip, {self.line.framing_host} at the host"
            findings.append(("line", f"wrong stop bits: {where}"))
        if self.line.overruns:
            reason = f"{self.line.overruns} bytes arrived before the chip had read the byte before"
            findings.append(("UART overrun", reason))
        return findings


@dataclass(frozen=True, slots=True)
class LinkCellResult(CellResult):
    """The result of a cell over the robot's own link, which repeats damaged frames.

    `failures` say why there is no result.
    """

    failures: tuple[Finding, ...] = ()

    def _findings(self) -> list[Finding]:
        findings = list(self.failures)
        ends = {"the chip": self.board} if self.direction != "to_host" else {}
        if self.direction != "to_board":
            ends["the host"] = self.host
        for who, counts in ends.items():
            if counts and counts.right < self.expected:
                findings.append(("lost numbers", _missing(counts, self.expected, who)))
            if counts and counts.out_of_sequence:
                reason = f"repeated or reordered numbers at {who}: {counts.out_of_sequence}"
                findings.append(("out of sequence", reason))
        return findings

    def _remarks(self) -> list[str]:
        remarks = CellResult._remarks(self)
        if self.repeated:
            remarks.append(f"retransmitted frames: {self.repeated}")
        damaged = self.counts.checksum_errors
        return [*remarks, f"discarded damaged frames: {damaged}"] if damaged else remarks


def _missing(counts: Counts, expected: int, who: str) -> str:
    return f"{expected - counts.right} of {expected} numbers did not reach {who}"


def _explain(counts: Counts, expected: int, lost: int, who: str, harmed: bool) -> list[Finding]:
    findings = []
    missing = _missing(counts, expected, who)
    if lost > 0 and counts.ring_full:
        reason = f"the sketch read too slowly: its receive buffer of {RING_BYTES} bytes was full"
        findings.append(("ring overrun", f"{reason} and {lost} bytes were lost; {missing}"))
    elif lost > 0:
        findings.append(("lost bytes", f"{lost} bytes did not reach {who}; {missing}"))
    if counts.framing_errors:
        why = "some of their bytes were lost" if lost > 0 else "a byte within was the end mark \\n"
        why = "damaged on the line, or a byte within was the end mark \\n" if harmed else why
        reason = f"messages of the wrong length at {who}: {counts.framing_errors}; {why}"
        findings.append(("framing error", reason))
    if counts.checksum_errors:
        findings.append(("checksum", f"packets with a wrong checksum: {counts.checksum_errors}"))
    if counts.out_of_sequence:
        why = "for example when halves of two numbers are read as one"
        findings.append(("out of sequence", f"unexpected numbers: {counts.out_of_sequence}, {why}"))
    return findings or ([("lost numbers", missing)] if counts.right < expected else [])
