"""The fin check: moves each axis briefly and compares each fin's angle with its set point."""

from robot_runtime.clock import Clock
from robot_runtime.contract.packets import FIN_COUNT, Motor, Navigation
from robot_runtime.control.pilot import AXES, NEUTRAL

FINS = ("front right", "back right", "back left", "front left")
_STEP = 1.3
"""s for each axis: one and a half strokes."""
_SHARE = 0.5
_FOLLOWED = 0.5
"""Share of the commanded swing that a sound fin reaches at least."""
_SWING_MIN = 0.2
"""rad; with less commanded swing, the fin counts as not commanded."""


class FinCheck:
    """Runs fin checks; `step` is called by the control loop, `see` by the receiver of messages."""

    def __init__(self, clock: Clock) -> None:
        self._clock = clock
        self.begin()

    def begin(self) -> None:
        """Starts a new check."""
        self._began = self._clock.now()
        self._least = [[float("inf")] * FIN_COUNT for _ in range(2)]
        self._most = [[float("-inf")] * FIN_COUNT for _ in range(2)]

    def step(self) -> Navigation | None:
        """Returns the present command; None when the check is over. It swims up, so as not to dive."""
        number = int((self._clock.now() - self._began) / _STEP)
        if number >= len(AXES):
            return None
        name = AXES[number]
        axes = {one: getattr(NEUTRAL, one) for one in AXES}
        return Navigation(**axes | {name: -_SHARE if name == "z" else _SHARE})

    def see(self, motor: Motor) -> None:
        """Takes the fins' angles and their set points."""
        for row, angles in enumerate((motor.wanted, motor.angle)):
            self._least[row] = [min(pair) for pair in zip(self._least[row], angles, strict=True)]
            self._most[row] = [max(pair) for pair in zip(self._most[row], angles, strict=True)]

    def failed(self) -> dict[str, str]:
        """Returns the fins that did not follow, by name, with how far they moved."""
        found = {}
        for fin, name in enumerate(FINS):
            commanded, angle = (max(self._most[row][fin] - self._least[row][fin], 0.0) for row in range(2))
            if commanded < _SWING_MIN or angle < _FOLLOWED * commanded:
                found[name] = f"moved {angle:.2f} of {commanded:.2f} rad"
        return found
