"""The recorded streams of a session, cut into windows on a common grid of time."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Self

import numpy as np
from scipy.interpolate import BSpline, make_interp_spline, make_smoothing_spline
from scipy.ndimage import maximum_filter1d, minimum_filter1d, uniform_filter1d

from robot_runtime.contract.craft import Craft
from robot_runtime.contract.packets import Depth, Imu
from robot_runtime.experiments.identification.bodies import CHANNELS, STATES, FinMotions, Floats

STEP = 0.01
"""s of the simulation's steps in a fit: five of them in a fin's quickest turn of 0.3 rad."""
EVERY = 2
"""Steps between two moments that are compared."""
WINDOW = 8.0
"""s. Longer than the hull's memory of its start (1 s), shorter than the time in which errors add up."""
WINDOWS_MAX = 60
"""Of a fit: more cost time, and say little more."""
GAP = 0.1
"""s without a sample across which no window reaches."""
COVERED = 0.08
"""m of the pressure sensor's depth from which the hull is surely under water."""
FIN_SAMPLES_MIN = 100
"""Of a session: two seconds, a quarter of a window."""
DEPTH_LATENCY = 0.010
"""s from the pressure to its sample, which is read in the tick after the conversion began."""
FIN_CUTOFF = 18.0
"""Hz above which a fin's angle is smoothed.

A fin's own motion falls with the frequency, its power spectrum with the fourth power; at 14 Hz it is as large
as the encoder's noise and steps, which are white (measured on the emulated board). A spline through every
sample takes this noise for motion, and finds too much damping. Smoothing above 14 Hz takes away more motion
than it leaves noise; above 18 Hz as much, so that the mean square speed, and with it the thrust, is right."""
RESTING_RANGE, RESTING_SAMPLES = 0.02, 11
"""rad that the angle of a resting fin covers at most in so many samples: seven deviations of its noise."""
RESTING_WEIGHT = 1e-4
"""Of a sample of a fin at rest, which is smoothed above a tenth of `FIN_CUTOFF`.

There noise that is taken for motion drags at the hull as linear damping does, with half as much as yaw's."""
ACTIVITY_TIME = 0.3
"""s over which the activity of the fins is a mean: as long as the hull shows an error of their speeds."""
_TRIMMED = 0.623
"""Mean of the 90 % smallest squares of a standard normal variable: (0.9 - 2·1.645·φ(1.645)) / 0.9."""
MEAN_AGE = 0.0025
"""s: specific forces are means over the time since the reading before."""
MEASURED_AGE = 0.005
"""s by which readings lie behind the fins' angles of the same time stamp (measured on the emulated board)."""
AGE_DEVIATION = 0.0005
"""s, standard deviation of these ages: the board reads its encoders within a millisecond."""


@dataclass(frozen=True, slots=True)
class SessionStreams:
    """The measured streams of one session: times in s, SI units, one row for each sample."""

    name: str
    motor_times: Floats
    angles: Floats
    """rad, of the four fins as their encoders measured them."""
    imu_times: Floats
    rates: Floats
    """rad/s."""
    forces: Floats
    """m/s²."""
    attitudes: Floats
    """Quaternions as the board estimates them; a first guess of roll and pitch."""
    depth_times: Floats
    depths: Floats
    """m, of the pressure sensor below the surface."""
    pressures: Floats
    """Pa."""


@dataclass(frozen=True, slots=True)
class Windows:
    """Windows of one length, of one or more sessions: the last axis counts them."""

    measured: Floats
    """The channels of shape (CHANNELS, moments, windows)."""
    splines: tuple[BSpline, ...]
    """Each window's fin angles over time."""
    starts: tuple[float, ...]
    """Each window's first moment (s of its session)."""
    sessions: tuple[int, ...]
    """Each window's session, counted from 0."""
    states: Floats
    """A first guess of each window's state at its start, of shape (STATES, windows)."""

    def __len__(self) -> int:
        return len(self.starts)

    def fins(self, delay: float, zeros: Floats) -> FinMotions:
        """Return the fins at every half step, as they act on the water after this delay (s).

        `zeros` (rad), of shape (sessions, fins), are what the encoders show at angle 0.
        """
        half_steps = 2 * EVERY * (self.measured.shape[1] - 1) + 1
        grid = np.arange(half_steps) * STEP / 2 - delay
        angles = [spline(start + grid) for spline, start in zip(self.splines, self.starts, strict=True)]
        speeds = [spline(start + grid, 1) for spline, start in zip(self.splines, self.starts, strict=True)]
        shown = np.stack(angles, axis=2) - zeros[list(self.sessions)].T
        return FinMotions(shown, np.stack(speeds, axis=2))

    def activity(self) -> Floats:
        """Return the fins' mean square speed (rad²/s²) at the moments, of shape (windows, moments)."""
        speeds = self.fins(0.0, np.zeros((max(self.sessions) + 1, 4))).speeds[:: 2 * EVERY]
        squares = (speeds**2).mean(axis=1)
        return np.asarray(uniform_filter1d(squares, round(ACTIVITY_TIME / (STEP * EVERY)), axis=0).T)

    def chosen(self, places: Sequence[int]) -> "Windows":
        """Return some of the windows."""
        return Windows(
            self.measured[:, :, places],
            tuple(self.splines[index] for index in places),
            tuple(self.starts[index] for index in places),
            tuple(self.sessions[index] for index in places),
            self.states[:, places],
        )


def cut(sessions: Sequence[SessionStreams], craft: Craft) -> Windows:
    """Return the windows of these sessions in which the hull is under water and nothing is missing.

    Of more than `WINDOWS_MAX` an even choice is taken. Raise ValueError with the reason where there is none.
    """
    pieces = [
        (index, spline, start, *_sample(session, readings, start, craft))
        for index, session in enumerate(sessions)
        if len(session.motor_times) >= FIN_SAMPLES_MIN
        for starts in [tuple(_starts(session))]
        if starts
        for spline, readings in [(_smooth_fins(session), _Readings.of(session))]
        for start in starts
    ]
    if not pieces:
        raise ValueError(
            "No part of these sessions can be used: it takes depth, IMU and fins without a gap for "
            f"{WINDOW:g} s, with the robot deeper than {100 * COVERED:.0f} cm."
        )
    if len(pieces) > WINDOWS_MAX:
        pieces = [pieces[int(position)] for position in np.linspace(0, len(pieces) - 1, WINDOWS_MAX).round()]
    places, splines, starts, measured, states = zip(*pieces, strict=True)
    return Windows(np.stack(measured, axis=2), splines, starts, places, np.stack(states, axis=1))


def _starts(session: SessionStreams) -> Iterator[float]:
    """Yield the first moments of windows that follow each other."""
    streams = (session.motor_times, session.imu_times, session.depth_times)
    if any(len(times) < 2 for times in streams):
        return
    # Time for the interpolation, and for a delay of the fins.
    first, last = max(times[0] for times in streams) + 0.3, min(times[-1] for times in streams) - 0.1
    gaps = [(times[:-1][np.diff(times) > GAP], times[1:][np.diff(times) > GAP]) for times in streams]
    shallow = session.depth_times[session.depths < COVERED]
    bad_from = np.concatenate([shallow, *(before for before, _ in gaps)])
    bad_to = np.concatenate([shallow, *(after for _, after in gaps)])
    start = float(first)
    while start + WINDOW <= last:
        overlapping = bad_to[(bad_to >= start - 0.3) & (bad_from <= start + WINDOW + 0.1)]
        if len(overlapping):
            start = float(overlapping.max()) + 0.31
        else:
            yield start
            start += WINDOW


@dataclass(frozen=True, slots=True)
class _Readings:
    """Cubic splines through the readings of a session.

    Straight lines between them would take 3 % of a motion of 8 Hz away, and the hull would seem inert.
    """

    depth: BSpline
    inertial: BSpline
    """Turn rates (rad/s), then specific forces (m/s²)."""

    @classmethod
    def of(cls, session: SessionStreams) -> Self:
        inertial = np.concatenate((session.rates, session.forces), axis=1)
        return cls(
            make_interp_spline(*_ascending(session.depth_times, session.depths)),
            make_interp_spline(*_ascending(session.imu_times, inertial)),
        )


def _sample(
    session: SessionStreams, readings: _Readings, start: float, craft: Craft
) -> tuple[Floats, Floats]:
    """Return the measured channels on the grid, and a guess of the state at its start."""
    grid = start + np.arange(round(WINDOW / STEP) // EVERY + 1) * STEP * EVERY + MEASURED_AGE
    measured = np.empty((CHANNELS, len(grid)))
    measured[0] = readings.depth(grid + DEPTH_LATENCY)
    measured[1:4] = readings.inertial(grid + craft.gyroscope.latency)[:, :3].T
    measured[4:] = readings.inertial(grid + craft.accelerometer.latency + MEAN_AGE)[:, 3:].T
    attitude = session.attitudes[np.searchsorted(session.imu_times, start)]
    w, x, y, z = attitude / np.linalg.norm(attitude)
    roll = np.arctan2(2 * (w * x + y * z), 1 - 2 * (x * x + y * y))
    pitch = np.arcsin(np.clip(2 * (w * y - z * x), -1, 1))
    first = slice(0, 26)
    sinking = np.polyfit(grid[first] - grid[0], measured[0, first], 1)
    state = np.zeros(STATES)
    state[0] = sinking[1] - craft.pressure_position[2]
    state[3] = sinking[0]
    state[4:6] = roll, pitch
    state[6:9] = measured[1:4, :3].mean(axis=1)
    return measured, state


def _smooth_fins(session: SessionStreams) -> BSpline:
    """Return the fin angles over time, smoothed above `FIN_CUTOFF`.

    A smoothing spline that charges λ for each unit of ∫θ̈² passes the share 1 / (1 + λ·Δt·(2πf)⁴) of a
    frequency f (P. Craven and G. Wahba, Numerische Mathematik 31, 1979).
    """
    times, angles = _ascending(session.motor_times, np.unwrap(session.angles, axis=0))
    interval = float(np.median(np.diff(times)))
    charge = 1 / (interval * (2 * np.pi * FIN_CUTOFF) ** 4)
    covered = maximum_filter1d(angles, RESTING_SAMPLES, axis=0)
    covered -= minimum_filter1d(angles, RESTING_SAMPLES, axis=0)
    weights = np.where(covered > RESTING_RANGE, 1.0, RESTING_WEIGHT)
    fins = [
        make_smoothing_spline(times, column, weight, charge)
        for column, weight in zip(angles.T, weights.T, strict=True)
    ]
    return BSpline(fins[0].t, np.stack([fin.c for fin in fins], axis=1), fins[0].k)


def _ascending(times: Floats, values: Floats) -> tuple[Floats, Floats]:
    """Return the stream without samples whose time is not after the previous one's."""
    later = np.concatenate(([True], np.diff(np.maximum.accumulate(times)) > 0))
    return times[later], values[later]


def sensor_noise(session: SessionStreams) -> dict[str, float]:
    """Return the noise (σ) of pressure (Pa), turn rate (rad/s) and specific force (m/s²), without a model.

    A fourth difference removes what the hull does (less than 0.1 % of a stroke's motion remains at 100 Hz)
    and leaves white noise √70 times as large. The least of the axes counts, since strokes shake some of them.
    """
    columns = {"pressure": session.pressures[:, None], "gyroscope": session.rates}
    columns["accelerometer"] = session.forces
    wires = {
        "pressure": Depth.wires["pressure"],
        "gyroscope": Imu.wires["rate"],
        "accelerometer": Imu.wires["force"],
    }
    noise = {}
    for name, values in columns.items():
        if len(values) < 100:
            continue
        fourth = np.diff(values, 4, axis=0) / np.sqrt(70)
        # The quietest 90 %: where a fin turns round, the hull jerks.
        quiet = np.sort(fourth**2, axis=0)[: int(0.9 * len(fourth))]
        variance = float(np.min(quiet.mean(axis=0))) / _TRIMMED
        noise[name] = float(np.sqrt(max(variance - wires[name].scale ** 2 / 12, 0.0)))
    return noise
