"""Fits a craft's numbers to windows of recorded sessions.

The windows' starts are eliminated from each window's residuals by a projection (variable projection, G. H.
Golub and V. Pereyra, SIAM J. Numer. Anal. 10, 1973), so that `scipy.optimize.least_squares` sees the craft's
numbers and the IMU's offsets alone. What is known before, each number's spread, counts as a measurement.

Residuals are whitened (whitening.py). Confidence follows from the Jacobian at the solution.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.optimize import least_squares

from robot_runtime.contract.craft import Craft
from robot_runtime.experiments.identification.bodies import STATES, Floats
from robot_runtime.experiments.identification.quantities import OFFSET_SPREADS, QUANTITIES, CraftQuantity
from robot_runtime.experiments.identification.shooting import OF_A_SESSION, OFFSETS, START_SPREADS, Shooting
from robot_runtime.experiments.identification.streams import Windows
from robot_runtime.experiments.identification.whitening import Whitening

ROUNDS = 3
"""Of a fit; each begins with the whitening and the starts that the one before has found."""
STEPS_MAX = 6
"""Of a round."""
SEEN = 0.5
"""A number is seen if its standard deviation is less than this share of that before the fit."""
FIRST_WEIGHTS = np.array([0.01, 0.1, 0.1, 0.1, 0.2, 0.2, 0.2])
"""Standard deviations of the residuals with a craft that is not fitted yet: m, rad/s, m/s²."""

Progress = Callable[[float], None]
"""Called with the share that is done, 0 to 1. What it raises ends the fit."""


@dataclass(frozen=True, slots=True)
class FitSolution:
    """The solution: scaled numbers of the fitted quantities, and their standard deviations."""

    craft: Craft
    fitted: tuple[CraftQuantity, ...]
    scaled: Floats
    deviations: Floats
    """Of the scaled numbers; before the fit they are 1."""
    offsets: Floats
    """Of each session's IMU, in rad/s and m/s², of shape (sessions, 6)."""
    offset_deviations: Floats
    unseen: tuple[CraftQuantity, ...]
    """Quantities that these windows do not show; they stay as they were."""


class Fit:
    """One fit; `run` performs all of it."""

    def __init__(self, windows: Windows, start: Craft, progress: Progress = lambda _share: None) -> None:
        self._shooting = Shooting(windows, start)
        self._progress = progress
        self._whitening = Whitening.none(FIRST_WEIGHTS)
        self._activity = windows.activity()

    def run(self) -> FitSolution:
        """Fit all numbers, and then once more those that the windows show. Raise the errors of `progress`."""
        fitted: list[CraftQuantity] = list(QUANTITIES)
        unseen: list[CraftQuantity] = []
        numbers = np.zeros(len(fitted) + OF_A_SESSION * self._shooting.sessions)
        for round_ in range(ROUNDS):
            numbers = self._solve(fitted, numbers)
            if round_ != ROUNDS - 2:
                continue
            weak = self._find_unseen(fitted, numbers)
            # They go back to where they were: the last round fits the rest to that.
            unseen += [fitted[index] for index in weak]
            numbers = np.delete(numbers, weak)
            fitted = [quantity for index, quantity in enumerate(fitted) if index not in weak]
        deviations = self._deviations(fitted, numbers)
        count, spreads = len(fitted), np.array(OFFSET_SPREADS)
        self._progress(1.0)
        return FitSolution(
            craft=self._shooting.craft(fitted, numbers),
            fitted=tuple(fitted),
            scaled=numbers[:count],
            deviations=deviations[:count],
            offsets=numbers[count:].reshape(-1, OF_A_SESSION)[:, :OFFSETS] * spreads,
            offset_deviations=deviations[count:].reshape(-1, OF_A_SESSION)[:, :OFFSETS] * spreads,
            unseen=tuple(unseen),
        )

    def _solve(self, fitted: Sequence[CraftQuantity], numbers: Floats) -> Floats:
        """Return the best scaled numbers from these on; move the starts, and model the residuals anew."""
        low, high = self._bounds(fitted)
        solution = least_squares(
            lambda at: self._project(fitted, at)[0],
            np.clip(numbers, low + 1e-6, high - 1e-6),
            jac=lambda at: self._project(fitted, at)[1],
            bounds=(low, high),
            max_nfev=STEPS_MAX,
            xtol=1e-3,
            ftol=1e-4,
        )
        numbers = np.asarray(solution.x)
        for _ in range(2):
            self._move_starts(fitted, numbers)
        self._whitening = Whitening.of(self._shooting.errors(fitted, numbers)[0], self._activity)
        return numbers

    def _bounds(self, fitted: Sequence[CraftQuantity]) -> tuple[Floats, Floats]:
        """Return the craft's ranges as scaled numbers, with room for a number that begins at its limit."""
        start = self._shooting.start
        pairs = [quantity.scaled_limits(start) for quantity in fitted]
        pairs += [(-np.inf, np.inf)] * (OF_A_SESSION * self._shooting.sessions)
        low, high = np.array(pairs).T
        return low - 1e-5, high + 1e-5

    def _project(self, fitted: Sequence[CraftQuantity], numbers: Floats) -> tuple[Floats, Floats]:
        """Return residuals and Jacobian, with priors, without the part that the windows' starts explain."""
        residuals, of_starts, of_numbers = self._whiten(fitted, numbers)
        basis, _ = np.linalg.qr(of_starts)
        projected = residuals - np.einsum("wmk,wk->wm", basis, np.einsum("wmk,wm->wk", basis, residuals))
        cleaned = of_numbers - basis @ (basis.transpose(0, 2, 1) @ of_numbers)
        return (
            np.concatenate((projected.ravel(), numbers)),
            np.concatenate((cleaned.reshape(-1, len(numbers)), np.eye(len(numbers)))),
        )

    def _whiten(self, fitted: Sequence[CraftQuantity], numbers: Floats) -> tuple[Floats, Floats, Floats]:
        """Return each window's whitened residuals, and their derivatives by its start and by the numbers.

        The last residuals are the distance of its start from the guess.
        """
        shooting = self._shooting
        errors, slopes = shooting.errors(fitted, numbers)
        expected = ROUNDS * (STEPS_MAX + 3)
        self._progress(min(shooting.evaluations / expected, 0.99))
        windows = len(errors)
        residuals = self._whitening.apply(errors).reshape(windows, -1)
        slopes = self._whitening.apply(slopes).reshape(*residuals.shape, -1)
        away = ((shooting.states - shooting.guess) / START_SPREADS[:, None]).T
        own = np.zeros((windows, STATES, slopes.shape[2]))
        own[:, :, :STATES] = np.eye(STATES)
        residuals, slopes = np.concatenate((residuals, away), axis=1), np.concatenate((slopes, own), axis=1)
        return residuals, slopes[:, :, :STATES], slopes[:, :, STATES:]

    def _move_starts(self, fitted: Sequence[CraftQuantity], numbers: Floats) -> None:
        """Move the windows' starts by one step of Gauss and Newton."""
        residuals, of_starts, _ = self._whiten(fitted, numbers)
        basis, upper = np.linalg.qr(of_starts)
        step = np.linalg.solve(upper, np.einsum("wmk,wm->wk", basis, residuals)[:, :, None])[:, :, 0]
        self._shooting.states = self._shooting.states - step.T * START_SPREADS[:, None]

    def _deviations(self, fitted: Sequence[CraftQuantity], numbers: Floats) -> Floats:
        """Return standard deviations: the larger of the Jacobian's and those of the windows' scatter.

        The second is the sandwich estimate with windows as clusters (H. White, Econometrica 48, 1980): the
        pulls of the windows on a number must cancel, and how far they differ shows errors that no weight
        knows, such as those of an encoder's zero.
        """
        residuals, jacobian = self._project(fitted, numbers)
        inverse = np.linalg.inv(jacobian.T @ jacobian)
        windows = len(self._shooting.windows)
        measured = len(residuals) - len(numbers)
        shape = windows, measured // windows
        pulls = np.einsum(
            "wmp,wm->wp",
            jacobian[:measured].reshape(*shape, -1),
            residuals[:measured].reshape(shape),
        )
        scatter = inverse @ (pulls.T @ pulls) @ inverse * windows / max(windows - 1, 1)
        return np.asarray(np.sqrt(np.maximum(np.diag(inverse), np.diag(scatter))))

    def _find_unseen(self, fitted: Sequence[CraftQuantity], numbers: Floats) -> list[int]:
        """Find the indices of the quantities that the windows do not show, the weakest first.

        Each is taken out before the next is judged: of two that show only together, one may be seen alone.
        """
        _, jacobian = self._project(fitted, numbers)
        information = jacobian.T @ jacobian
        there = list(range(len(numbers)))
        weak: list[int] = []
        while True:
            deviations = np.sqrt(np.diag(np.linalg.inv(information[np.ix_(there, there)])))
            judged = [(float(deviations[at]), index) for at, index in enumerate(there) if index < len(fitted)]
            worst, index = max(judged, default=(0.0, -1))
            if worst < SEEN:
                return weak
            weak.append(index)
            there.remove(index)
