"""docs/run/hardware/trim.md: buoyancy in grams, with the tables of the default craft."""

from dataclasses import replace
from math import pi, tan

from robot_runtime.contract.buoyancy import (
    GRAVITY,
    RESERVE,
    buoyancy_reserve,
    rest_angle,
    rise_speed,
    rise_time,
    water_density,
)
from robot_runtime.contract.craft import Craft
from robot_runtime.contract.hull import DEPTH_MAX, squeeze
from robot_runtime.contract.power_budget import AMPLITUDE_MAX, flap_thrust
from robot_runtime.generate.markdown import fill, page, table

SOURCE = "robot_runtime/generate/pages/trim.md.in"
RISE = 0.5
"""m, of the timed rise."""
WATERS = (("fresh", 0), ("pool with salt", 4), ("Baltic", 6), ("ocean", 35))
"""Waters and their salinity, g/kg."""
METALS = (("steel", 7850), ("brass", 8500), ("lead", 11340))
"""Weights and their density, kg/m³."""

PLASTIC, ALUMINIUM = 6e-5, 2.3e-5
"""1/K: the lengths by which PVC and aluminium expand."""


def trim_page() -> str:
    """Return the whole text of trim.md."""
    craft, heavy = trimmed(Craft(), water_density(10)), trimmed(Craft(), water_density(10, 35))
    grams = 1000 * RESERVE * craft.mass
    length, width, _ = craft.size
    expansion = 3 * 15 * craft.volume * 1e6
    push = 4 * flap_thrust(craft, AMPLITUDE_MAX)
    values = {
        "grams": grams,
        "share": 100 * RESERVE,
        "mass": craft.mass,
        "freeboard": grams / (length * width * 1000),
        "start": 0.6,
        "end": 0.1,
        "rise": RISE,
        "slow": rise_time(craft, grams / 2, RISE),
        "height": craft.buoyancy_height * 1000,
        "example": 10,
        "example_move": craft.mass * craft.buoyancy_height * tan(10 * pi / 180) / 0.05 * 1000,
        "warming": grams - buoyancy_reserve(craft, water_density(25)),
        "aluminium": expansion * ALUMINIUM,
        "plastic": expansion * PLASTIC,
        "ocean_to_fresh": -buoyancy_reserve(heavy, water_density(10)),
        "depth": DEPTH_MAX,
        "hidden": rest_angle(RESERVE * length / 2, craft.buoyancy_height) * 180 / pi,
        "squeeze": squeeze(DEPTH_MAX) * 1e6,
        "default": buoyancy_reserve(Craft(), water_density(10)),
        "default_warm": buoyancy_reserve(Craft(), water_density(25)),
        "holding": grams * GRAVITY / 1000,
        "effort": 100 * grams * GRAVITY / 1000 / push,
        "weak_effort": 100 * grams * GRAVITY / 1000 / (push * 0.15 / craft.fin_drag),
    }
    metals = ", ".join(f"{name} {1 - 1000 / density:.2f} of its grams" for name, density in METALS)
    rises = table(
        ("reserve", "rises at last at", f"time for {RISE:g} m", "spread"),
        (_rise_row(craft, reserve) for reserve in (5, 10, 15, 20, 30, 40)),
    )
    levels = table(
        ("it tilts by", "centres are apart by", "move"),
        (_level_row(craft, degrees) for degrees in (2, 5, 10, 20)),
    )
    waters = table(
        ("temperature", *(f"{name}, {salt} g/kg" if salt else name for name, salt in WATERS)),
        (
            (f"{celsius} °C", *(_reserve_text(craft, celsius, salt, grams) for _, salt in WATERS))
            for celsius in range(5, 31, 5)
        ),
    )
    settings = table(
        ("what", "where", "example"),
        (
            (
                "density of the water, kg/L, for the depth",
                "[parameter](../../reference/parameters.md) `water.density`",
                f"{water_density(20) / 1000:.3f}: fresh, 20 °C",
            ),
            ("reserve, g", "`reserve` under `[craft]` in [robot.toml](../configure.md)", f"{grams:.0f}.0"),
            ("the water it was weighed in, °C and g/kg", "`temperature`, `salinity` there", "12.0, 0.0"),
            ("mass, kg", "`mass` in the [craft file](../../reference/craft.md)", "3.012"),
            (
                "1 + reserve / mass",
                "`buoyancy` there",
                f"{1 + RESERVE:.3f}: {grams:.0f} g of {craft.mass:g} kg",
            ),
            ("height of the centre of buoyancy, m", "`buoyancy_height` there", "0.010"),
        ),
    )
    densities = table(
        ("temperature", *(name for name, _ in WATERS)),
        (
            (f"{celsius} °C", *(f"{water_density(celsius, salt) / 1000:.4f}" for _, salt in WATERS))
            for celsius in range(5, 31, 10)
        ),
    )
    return page(
        "Trim",
        SOURCE,
        fill(
            "trim",
            **values,
            metals=metals,
            rises=rises,
            levels=levels,
            waters=waters,
            settings=settings,
            densities=densities,
        ),
    )


def trimmed(craft: Craft, density: float) -> Craft:
    """Return the craft with the recommended reserve in water of this density (kg/m³)."""
    return replace(craft, buoyancy=(1 + RESERVE) * 1000 / density)


def _rise_row(craft: Craft, reserve: float) -> tuple[str, ...]:
    time, early, late = (
        rise_time(with_drag, reserve, RISE)
        for with_drag in (craft, _with_drag(craft, 0.5, 0.5), _with_drag(craft, 2, 1.2))
    )
    speed = f"{rise_speed(craft, reserve) * 100:.1f} cm/s"
    return f"{reserve} g", speed, f"{time:.1f} s", f"{early:.1f} to {late:.1f} s"


def _with_drag(craft: Craft, linear: float, quadratic: float) -> Craft:
    """Return the craft with these times its heave damping: the ends of the spread that the craft names."""
    surge, sway, heave, roll, pitch, yaw = craft.damping_linear
    fast_surge, fast_sway, fast_heave, fast_roll, fast_pitch, fast_yaw = craft.damping_quadratic
    return replace(
        craft,
        damping_linear=(surge, sway, heave * linear, roll, pitch, yaw),
        damping_quadratic=(fast_surge, fast_sway, fast_heave * quadratic, fast_roll, fast_pitch, fast_yaw),
    )


def _level_row(craft: Craft, degrees: float) -> tuple[str, ...]:
    offset = craft.buoyancy_height * tan(degrees * pi / 180)
    moment = craft.mass * offset * 1e6
    return (
        f"{degrees:g}°",
        f"{offset * 1000:.1f} mm",
        f"{moment:.0f} g·mm, such as 50 g by {moment / 50:.0f} mm",
    )


def _reserve_text(craft: Craft, celsius: float, salt: float, grams: float) -> str:
    reserve = buoyancy_reserve(craft, water_density(celsius, salt))
    text = f"{reserve:.0f} g"
    return f"**{text}**" if reserve < 2 / 3 * grams else text
