"""Steering while the depth is held: none, or towards a light beacon.

Each of the two detectors reports whether it sees a light on its side; both see a light ahead. The robot swims
straight on while both see one, and turns towards the side that sees one alone. With no light it turns to the
side that saw one last, for a limited time.
"""

from typing import get_args

from robot_runtime.contract.documents import Steering

STEERINGS: tuple[Steering, ...] = get_args(Steering)

SURGE = 0.6
"""Share of the full command, forwards, towards a light ahead."""
SURGE_TURNING = 0.3
YAW = 0.5
"""Share of the full command, towards a light that one detector sees."""
SEARCH_SECONDS = 20.0
"""s for which it turns without a light; afterwards it rests until a light is seen."""


class BeaconSteering:
    """Steering towards a light beacon by the newest readings of the detectors."""

    def __init__(self) -> None:
        self.start()

    def start(self) -> None:
        """Reset the search; it starts to the right."""
        self._side = 1.0
        self._searched = 0.0

    def step(self, right: bool, left: bool, seconds: float) -> tuple[float, float]:
        """Return the commands of surge and yaw, -1 to 1; `seconds` is the time since the last step."""
        if right or left:
            self._searched = 0.0
            if right and left:
                return SURGE, 0.0
            self._side = 1.0 if right else -1.0
            return SURGE_TURNING, self._side * YAW
        self._searched += seconds
        return 0.0, self._side * YAW if self._searched <= SEARCH_SECONDS else 0.0
