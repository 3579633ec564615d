"""Every optical property of the water, with its origin.

A picture is taken through I·e^(-βz) + B·(1 - e^(-βz)), for each of the three colours: the water
attenuates the light I of an object by β (1/m) along the distance z (m), and adds its own light B
(D. Akkaynak and T. Treibitz, A Revised Underwater Image Formation Model, CVPR 2018, with one β for both
terms). The camera is taken to have balanced white at its own depth, as cameras do: light is not lost on its
way down.
"""

from dataclasses import dataclass
from typing import Literal

from robot_runtime.contract.limits import Range

Kind = Literal["pool", "natural"]
Colours = tuple[float, float, float]
"""One value each for blue, green and red."""

TURBIDITY = Range(0, 1)
TURBIDITY_ATTENUATION = 30.0
"""1/m that a turbidity of 1 adds to all colours: black on pale ground is invisible at 0.1 m. Chosen."""
TURBIDITY_POWER = 3
"""Exponent of the turbidity, so that 0.1 is hardly visible and 0.3 is a harbour. Chosen."""
SILT: Colours = (135.0, 132.0, 70.0)
"""The light of particles. Assumed: pale, and greenish as the water around them."""
SCATTERING = 0.04
"""1/m, share of the light that is scattered forwards, and blurs. Assumed: a tenth of pure sea water's β."""
TURBIDITY_SCATTERING = 0.3
"""Share of the added attenuation that only blurs. Assumed, within a factor of two."""
NOISE = 2.5
"""Standard deviation of each byte of the camera's picture. Assumed: a small sensor in dim light."""


@dataclass(frozen=True, slots=True)
class WaterOptics:
    """Optical properties of the water."""

    attenuation: Colours
    """β, 1/m."""
    glow: Colours
    """B, 0 to 255, of the water itself, looking level."""
    scattering: float
    """1/m, loss of sharpness."""
    caustics: float
    """Contrast, 0 to 1, of caustics just below the surface."""

    def with_visibility(self, factor: float) -> "WaterOptics":
        """Return water with this factor of visibility."""
        blue, green, red = (beta / factor for beta in self.attenuation)
        return WaterOptics((blue, green, red), self.glow, self.scattering / factor, self.caustics)


CLEAN = {
    # Pure water absorbs 0.009, 0.043 and 0.28 (450, 530, 620 nm; R. M. Pope and E. S. Fry, Applied Optics 36,
    # 1997, 8710); the rest is scattering, assumed. Its own light is chosen: tiles in daylight.
    "pool": WaterOptics((0.030, 0.055, 0.30), (190.0, 164.0, 44.0), SCATTERING, 0.5),
    # Chosen: as the card camera's, coastal water in which yellow turns green at about 3 m.
    "natural": WaterOptics((0.06, 0.09, 0.60), (150.0, 128.0, 30.0), 1.5 * SCATTERING, 0.7),
}
"""Clean water of each kind of scene."""


def water(kind: Kind, turbidity: float) -> WaterOptics:
    """Return the water of this kind of scene with this turbidity, 0 to 1."""
    clean = CLEAN[kind]
    added = TURBIDITY_ATTENUATION * turbidity**TURBIDITY_POWER
    blue, green, red = (beta + added for beta in clean.attenuation)
    glow = tuple(own + (silt - own) * turbidity for own, silt in zip(clean.glow, SILT, strict=True))
    return WaterOptics(
        (blue, green, red),
        (glow[0], glow[1], glow[2]),
        clean.scattering + TURBIDITY_SCATTERING * added,
        clean.caustics * (1 - turbidity),
    )
