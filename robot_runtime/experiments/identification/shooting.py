"""Compares crafts with the windows of recorded sessions: residuals and their derivatives.

Multiple shooting: each window has a start of its own, so that no error adds up for longer than a window
(H. G. Bock, Recent Advances in Parameter Identification Techniques for O.D.E., 1983).
"""

from collections.abc import Sequence

import numpy as np

from robot_runtime.contract.craft import Craft
from robot_runtime.experiments.identification.bodies import STATES, Bodies, Floats
from robot_runtime.experiments.identification.quantities import (
    OFFSET_SPREADS,
    ZERO_SPREAD,
    CraftQuantity,
    put_all,
)
from robot_runtime.experiments.identification.streams import EVERY, STEP, Windows

START_SPREADS = np.array([0.05, 0.3, 0.3, 0.1, 0.15, 0.15, 0.05, 0.05, 0.05])
"""Standard deviations of the guessed starts, as `STATES`."""
OFFSETS = len(OFFSET_SPREADS)
FINS = 4
OF_A_SESSION = OFFSETS + FINS
"""Numbers of each session: the IMU's offsets and the encoders' zeros."""
_SMALL = 1e-4
"""Step of a difference quotient, in standard deviations."""


class Shooting:
    """The windows, and the craft from which scaled numbers count.

    `numbers` are the scaled numbers of the fitted quantities, then for each session the scaled offsets of its
    IMU and the scaled zeros of its encoders. Without these, a zero of 3 mrad would turn the strong strokes of
    diving into a push forwards that is as large as the drag of slow swimming.
    `states` are the windows' starts, which its user moves.
    """

    def __init__(self, windows: Windows, start: Craft) -> None:
        self.windows = windows
        self.start = start
        self.guess = windows.states
        self.states = windows.states
        self.sessions = max(windows.sessions) + 1
        self.evaluations = 0
        self._last: tuple[tuple[object, ...], tuple[Floats, Floats]] | None = None

    def craft(self, fitted: Sequence[CraftQuantity], numbers: Floats) -> Craft:
        """Return the craft with these scaled numbers."""
        return put_all(self.start, fitted, numbers[: len(fitted)].tolist())

    def errors(self, fitted: Sequence[CraftQuantity], numbers: Floats) -> tuple[Floats, Floats]:
        """Return simulated less measured, of shape (windows, CHANNELS, moments), and its derivatives.

        These have one more axis: the scaled starts of the window, then the scaled numbers.
        """
        key = (tuple(fitted), numbers.tobytes(), self.states.tobytes())
        if self._last is None or self._last[0] != key:
            self._last = key, self._evaluate(fitted, numbers)
        return self._last[1]

    def _evaluate(self, fitted: Sequence[CraftQuantity], numbers: Floats) -> tuple[Floats, Floats]:
        self.evaluations += 1
        windows, count = self.windows, len(fitted)
        craft = self.craft(fitted, numbers)
        of_sessions = numbers[count:].reshape(-1, OF_A_SESSION)
        offsets, zeros = (
            of_sessions[:, :OFFSETS] * np.array(OFFSET_SPREADS),
            of_sessions[:, OFFSETS:] * ZERO_SPREAD,
        )
        crafts, motions = [craft] * (1 + STATES), [windows.fins(craft.fin_delay, zeros)]
        which = [0] * (1 + STATES)
        for index, quantity in enumerate(fitted):
            moved = numbers[:count].copy()
            moved[index] += _SMALL
            crafts.append(put_all(self.start, fitted, moved.tolist()))
            which.append(len(motions) if quantity.entry == "fin_delay" else 0)
            if which[-1]:
                motions.append(windows.fins(crafts[-1].fin_delay, zeros))
        for fin in range(FINS):
            crafts.append(craft)
            which.append(len(motions))
            moved = zeros.copy()
            moved[:, fin] += _SMALL * ZERO_SPREAD
            motions.append(windows.fins(craft.fin_delay, moved))
        starts = np.repeat(self.states[:, None, :], len(crafts), axis=1)
        for state in range(STATES):
            starts[state, 1 + state] += _SMALL * START_SPREADS[state]
        with np.errstate(over="ignore", invalid="ignore"):
            channels = Bodies(crafts, motions, which).simulate(starts, STEP, EVERY)
        base = channels[:, :, 0] - windows.measured
        base[1:] += offsets.T[:, list(windows.sessions)][:, None, :]
        slopes = (channels[:, :, 1:] - channels[:, :, :1]) / _SMALL
        # A craft without sense may move without bounds, and the fit must be able to go back.
        base, slopes = np.nan_to_num(base, posinf=1e6, neginf=-1e6), np.nan_to_num(slopes)
        slopes = slopes.transpose(3, 0, 1, 2)
        common, of_zeros = slopes[..., :-FINS], slopes[..., -FINS:]
        return base.transpose(2, 0, 1), np.concatenate((common, self._of_sessions(of_zeros)), axis=3)

    def _of_sessions(self, of_zeros: Floats) -> Floats:
        """Return the errors' derivatives by the sessions' scaled numbers: a window has its session's."""
        windows = self.windows
        derivatives = np.zeros((*of_zeros.shape[:3], OF_A_SESSION * self.sessions))
        for window, session in enumerate(windows.sessions):
            first = session * OF_A_SESSION
            for axis, spread in enumerate(OFFSET_SPREADS):
                derivatives[window, 1 + axis, :, first + axis] = spread
            derivatives[window, :, :, first + OFFSETS : first + OF_A_SESSION] = of_zeros[window]
        return derivatives
