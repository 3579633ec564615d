"""The study of one session: spectra of its signals, and one signal against another."""

from collections.abc import Sequence

import numpy as np

from server.analysis.session_reader import SessionReader
from server.analysis.signals import Signal, list_signals, split
from server.analysis.spectrum import SEGMENT_MOST, NoSpectrumError, find_spectrum, pair
from server.analysis.story_schemas import SignalPair, Spectrum, StudyQuery
from server.library.content import Recording, reading_content
from server.metrics.series import Floats, Series
from server.platform.errors import NotFoundError

FREQUENCIES_MAX = SEGMENT_MOST // 2 + 1
PAIRS_MAX = 5000


class UnknownSignalError(NotFoundError):
    """The session has no such signal"""


class Study:
    """Spectra and pairs of the signals of sessions.

    Methods raise UnknownSessionError, UnknownSignalError, StoreError and RecordingError.
    """

    def __init__(self, reader: SessionReader) -> None:
        self._reader = reader

    def find_spectra(self, query: StudyQuery) -> list[Spectrum]:
        """Return the spectrum of each signal, in the requested order."""
        return [_describe_spectrum(signal, series) for signal, series in self._read(query)]

    def pair(self, query: StudyQuery) -> SignalPair:
        """Return one signal against another."""
        (x, across), (y, upward) = self._read(query)
        times, x_values, y_values = pair(across, upward, PAIRS_MAX, angle=_is_angle(x))
        return SignalPair(
            x=x, y=y, time=_numbers(times), x_values=_numbers(x_values), y_values=_numbers(y_values)
        )

    def _read(self, query: StudyQuery) -> list[tuple[Signal, Series]]:
        recording = self._reader.open(query.session)
        with reading_content(recording.row):
            known = _known(recording, query.signals)
            series = self._reader.samples.read(recording, known)
        for name in query.signals:
            if name not in known or name not in series:
                raise UnknownSignalError(f"This session has no signal “{name}”. Choose another.")
        part = query.part
        return [
            (known[name], series[name].within(part.start, part.end) if part else series[name])
            for name in query.signals
        ]


def _known(recording: Recording, names: Sequence[str]) -> dict[str, Signal]:
    topics = {split(name)[0] for name in names}
    return {signal.name: signal for signal in list_signals(recording, topics) if signal.name in names}


def _describe_spectrum(signal: Signal, series: Series) -> Spectrum:
    try:
        density = find_spectrum(series, angle=_is_angle(signal))
    except NoSpectrumError as problem:
        return Spectrum(
            signal=signal, frequency=[], density=[], rate=0, segments=0, peak=None, problem=str(problem)
        )
    return Spectrum(
        signal=signal,
        frequency=_numbers(density.frequency),
        density=_numbers(density.density),
        rate=density.rate,
        segments=density.segments,
        peak=density.peak,
        problem="",
    )


def _is_angle(signal: Signal) -> bool:
    return signal.unit == "rad"


def _numbers(values: Floats) -> list[float]:
    """Return the values with seven significant digits."""
    numbers: list[float] = np.char.mod("%.7g", values).astype(float).tolist() if values.size else []
    return numbers
