"""The water's bounds: the surface, on which the hull floats, and the floor."""

from robot_runtime.simulation.parameters import Parameters


class World:
    """Water between the surface and the floor.

    The hull counts as an upright box: what of its height is above the surface does not float, and while it
    breaks the surface it makes waves, which takes energy. Fins work everywhere alike.
    """

    def __init__(self, parameters: Parameters) -> None:
        self._height = parameters.height
        self._damping = parameters.surface_damping
        self._lowest = parameters.floor - parameters.height / 2
        self._floating = parameters.height / parameters.buoyancy - parameters.height / 2

    @property
    def floating_depth(self) -> float:
        """Depth (m) of the hull's centre where it floats at rest; of one that sinks, just covered."""
        return min(self._floating, self._height / 2)

    @property
    def lowest_depth(self) -> float:
        """Depth (m) of the hull's centre where it lies on the floor."""
        return self._lowest

    def submerged(self, depth: float) -> float:
        """Share of the hull under water, 0 to 1, when its centre is at this depth (m)."""
        return min(max(depth / self._height + 0.5, 0.0), 1.0)

    def wave_drag(self, depth: float, sinking: float) -> float:
        """Force (N, downwards) of the waves on a hull that sinks at this speed (m/s) through the surface."""
        half = self._height / 2
        return -self._damping * sinking if -half < depth < half else 0.0
