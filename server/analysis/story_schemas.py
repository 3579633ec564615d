"""Answers about a session as one dive: its story, figures, tracks, spectra and pairs of signals."""

from pydantic import Field

from server.analysis.flags import Flag
from server.analysis.schemas import SignalLine, TimeRange
from server.analysis.segment import SEGMENTS_MAX, Segment
from server.analysis.signals import Signal
from server.library.crafts import Water
from server.metrics.figure import Figure, FigureMeaning
from server.platform.schema_base import Schema

SPECTRA_MAX = 6


class Story(Schema):
    """A session as one dive; times are s since its start."""

    duration: float
    water: Water
    depth: SignalLine | None = Field(description="m; null where the session has none")
    set_point: SignalLine | None = Field(description="m, while the depth was held; null where it never was")
    segments: list[Segment] = Field(description=f"in order of time, the first {SEGMENTS_MAX}")
    segment_count: int = Field(description="number of all segments")
    flags: list[Flag] = Field(description="in order of time; of too many the gravest")


class StoryFigures(Schema):
    """The figures of a dive, by name."""

    meanings: list[FigureMeaning]
    whole: dict[str, Figure] = Field(description="of the armed time, or of the chosen part")
    segments: list[dict[str, Figure]] = Field(
        description=f"in the order of the story's segments, the first {SEGMENTS_MAX}; empty for a chosen part"
    )


class Way(Schema):
    """Points of a track, in order of time."""

    time: list[float] = Field(description="s since the session's start")
    x: list[float] = Field(description="m, along heading 0")
    y: list[float] = Field(description="m, along heading 90°")
    depth: list[float] = Field(description="m")


class SwumTrack(Schema):
    """The track from an arming to the disarming."""

    estimate: Way = Field(description="by dead reckoning: its error grows")
    deviation: tuple[float, float] = Field(description="m, standard deviations of the last x and y")
    truth: Way | None = Field(description="null where it was not simulated")


class StudyQuery(Schema):
    """Signals of a session within a part of its time, or all of it; of a pair first the one across."""

    session: int
    signals: list[str]
    part: TimeRange | None


class SpectrumPeak(Schema):
    """The highest place of a spectrum, as the sine that would make it."""

    frequency: float = Field(description="Hz")
    amplitude: float = Field(description="in the signal's unit")
    share: float = Field(description="of the signal's variance, 0 to 1")


class Spectrum(Schema):
    """The one-sided power spectral density of a signal by Welch's method; its integral is the variance."""

    signal: Signal
    frequency: list[float] = Field(description="Hz")
    density: list[float] = Field(description="in the signal's unit, squared, per Hz")
    rate: float = Field(description="Hz, of the even grid that the samples were laid on")
    segments: int = Field(description="number of averaged periodograms")
    peak: SpectrumPeak | None = Field(description="null for a constant")
    problem: str = Field(description="why there is no spectrum; empty if there is one")


class SignalPair(Schema):
    """Two signals at the same times, in order of time."""

    x: Signal
    y: Signal
    time: list[float] = Field(description="s since the session's start")
    x_values: list[float]
    y_values: list[float]
