"""The fin check: each axis for a moment, and whether every fin's encoder followed what was wanted of it."""

from robot_runtime.clock import Clock
from robot_runtime.contract.packets import FIN_COUNT, Motor, Navigation
from robot_runtime.control.pilot import AXES, NEUTRAL

FINS = ("front right", "back right", "back left", "front left")
_STEP = 1.3
"""s for each axis: one and a half strokes."""
_SHARE = 0.5
_FOLLOWED = 0.5
"""Share of the wanted swing that a sound fin shows at least."""
_SWING_MIN = 0.2
"""rad, of what is wanted: below, nothing was asked of the fin."""


class FinCheck:
    """One check after the other; `step` belongs to the control loop, `see` to whoever hears the board."""

    def __init__(self, clock: Clock) -> None:
        self._clock = clock
        self.begin()

    def begin(self) -> None:
        """Forget the last check; the next begins now."""
        self._began = self._clock.now()
        self._least = [[float("inf")] * FIN_COUNT for _ in range(2)]
        self._most = [[float("-inf")] * FIN_COUNT for _ in range(2)]

    def step(self) -> Navigation | None:
        """The command for now; None when it is over. Upwards and not down, so as not to dive."""
        number = int((self._clock.now() - self._began) / _STEP)
        if number >= len(AXES):
            return None
        name = AXES[number]
        axes = {one: getattr(NEUTRAL, one) for one in AXES}
        return Navigation(**axes | {name: -_SHARE if name == "z" else _SHARE})

    def see(self, motor: Motor) -> None:
        """Take in where the fins are, and where they should be."""
        for row, angles in enumerate((motor.wanted, motor.angle)):
            self._least[row] = [min(pair) for pair in zip(self._least[row], angles, strict=True)]
            self._most[row] = [max(pair) for pair in zip(self._most[row], angles, strict=True)]

    def failed(self) -> dict[str, str]:
        """The fins that did not follow, by name, and in words how far they moved."""
        found = {}
        for fin, name in enumerate(FINS):
            wanted, angle = (max(self._most[row][fin] - self._least[row][fin], 0.0) for row in range(2))
            if wanted < _SWING_MIN or angle < _FOLLOWED * wanted:
                found[name] = f"moved {angle:.2f} of {wanted:.2f} rad"
        return found
