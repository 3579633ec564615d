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
from robot_runtime.generate.markdown import page, table

SOURCE = "robot_runtime/generate/trim.py"
RISE = 0.5
"""m, of the timed rise."""
WATERS = (("fresh", 0), ("pool with salt", 4), ("Baltic", 6), ("ocean", 35))
"""Waters and their salinity, g/kg."""
METALS = (("steel", 7850), ("brass", 8500), ("lead", 11340))
"""Weights and their density, kg/m³."""

INTRODUCTION = """\
STOP, a fault and an empty battery all end alike: the fins rest, and the robot floats up. A few grams do
that. Set them here with a scale, and check them with a watch. *Not tried.*

The **reserve** is what the robot is lighter than the water that it displaces, in grams. **Set {grams:.0f}
g**, {share:.0f} % of a robot of {mass:g} kg. You cannot see it from above: with {grams:.0f} g a hull of
this size floats only {freeboard:.0f} mm higher than with nothing.

You need a kitchen scale (5 kg, 1 g), a hanging scale (1 g), a sinker of 200 to 300 g, thread, weights of 2
to 50 g, a thermometer, a stick with marks, and a tub in which the robot fits under water. Take the water
that you will dive in.

## Weigh

1. Close the robot as it dives: battery, card, all screws. Dry it. Weigh it.
2. Hang the sinker alone from the hanging scale, under water. Write down the reading A.
3. Tie the robot above the sinker with a short thread. Lower both until its back is 10 cm under. Turn it
   and stroke it until no bubble comes: a millilitre of air is a gram that you lose later.
4. Wait until it is still. Write down the reading B.
5. **The reserve is A - B.** Repeat from step 3: two results may differ by 2 g.
6. More than {grams:.0f} g: add the difference inside, at the bottom. A weight that is outside counts less,
   because it displaces water: see the table.
7. Less than {grams:.0f} g: take weight out. If there is none to take, the hull is too small for what it
   carries.
8. Weigh it dry again. Note mass, reserve, temperature and salt of the water.
"""
WEIGHTS_NOTE = """
Without a hanging scale, lay small weights on its back, under water, until it neither rises nor sinks in
ten seconds. The reserve is their mass times the second column.

After **every** dive weigh the closed, dry robot. Each gram more than before is a millilitre of water
inside. Open it and find the leak before it swims again.

## Time the rise

This checks what STOP relies on. Do it after each trim, and before the first dive of a day. WiFi does not
reach the robot down there: a stick and a watch do, and the recording on board tells more.

1. Stand the stick in still water of 1 m, with marks at {end:.1f} m and {start:.1f} m below the surface.
2. Start a recording on Operate, disarmed. Hold the robot level, its back at the lower mark, until it is
   still.
3. Let go without a push. Time its back from mark to mark: {rise:g} m. Do it three times, then stop the
   recording.
4. Compare with the table, which is computed from the craft's drag. The session's depth shows the same
   times.
"""
RISE_NOTE = """
The last column is for the drag at the ends of the [craft's spread](../../reference/craft.md). So for a
craft that nobody has fitted, the scale knows the reserve and the watch confirms it. For a fitted one
([Identify](../../use/identify.md)) the watch is as good as the scale.

**Slower than {slow:.0f} s: do not dive.** Weigh again.

## Level it

Under water, from the same recording: attitude of the second half of each rise. At the surface an error of
up to {hidden:.0f}° does not show, because the part of the hull that is out of the water presses it flat.

1. Nose up: move weight forward. Right side up: move weight to the right.
2. The table says how much. Moved weight counts as grams times millimetres.
3. Time another rise. Repeat until pitch and roll are within 3°.
"""
LEVEL_NOTE = """
The table holds for a centre of buoyancy {height:.0f} mm above the centre of mass, which is assumed.
**Measure yours.** Level it, then move a weight *w* forward by *x* and read the angle *θ*. The height is
*w·x* / (*mass* · tan *θ*). If it is {height:.0f} mm, 50 g moved by {example_move:.0f} mm tilt {mass:g} kg
by {example:.0f}°. Below 5 mm put weight lower.

Four millimetres between the centres tilt the hull by {four:.0f}°; while it rises it shows about a tenth
less. A tilted hull swims away, and no controller's gain mends that.

## What changes the reserve

{mass:g} kg trimmed to {grams:.0f} g in fresh water of 10 °C have these grams in other water. Bold: trim
again.
"""
WATER_NOTE = """
- **From 10 to 25 °C fresh water takes {warming:.0f} g.** A hull that is as warm as the water has expanded
  and gives some of it back: {aluminium:.0f} g if it is of aluminium, about {plastic:.0f} g if it is of
  PVC. It warms slowly: do not count on that.
- **From the sea into fresh water it sinks.** Trimmed to {grams:.0f} g in the ocean at 10 °C, it is
  {ocean_to_fresh:.0f} g too heavy in fresh water. Trim again in each water.
- A leak of {grams:.0f} mL takes all of it.
- Air under a fin or in a screw's hole lifts until it goes. Foam and bags of air are squeezed with depth.
  Use none of them to float.
- Another battery, card or weight: weigh again.
- Plates give way with depth. For the [reference hull](hull.md) that is {squeeze:.0f} g at {depth:g} m.

The default craft, which simulations swim with, has {default:.0f} g at 10 °C and {default_warm:.1f} g at 25
°C. Do not dive with that.

## Tell the software
"""
SOFTWARE_NOTE = """
`mucat doctor` and System say what is left of the reserve in warm fresh water, and when a real robot's
reserve is not known. The model-based controller takes mass and buoyancy from the craft. To hold
{grams:.0f} g down takes {holding:.2f} N: {effort:.0f} % of what four fins can push, or {weak_effort:.0f} %
with the lower of the two published drag coefficients.

Densities in kg/L, by the equation of state EOS-80 (Millero and Poisson, 1981):
"""
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
        "four": rest_angle(0.004, craft.buoyancy_height) * 180 / pi,
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
    metals = table(
        ("weight", "counts under water"),
        ((name, f"{1 - 1000 / density:.2f} of its grams") for name, density in METALS),
    )
    rises = table(
        ("reserve", "rises at last at", f"time for {RISE:g} m", "spread"),
        (_rise_row(craft, reserve) for reserve in (5, 10, 15, 20, 30, 40, 60)),
    )
    levels = table(
        ("it tilts by", "centres are apart by", "move"),
        (_level_row(craft, degrees) for degrees in (2, 5, 10, 15, 22, 30)),
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
            for celsius in range(5, 31, 5)
        ),
    )
    return page(
        "Trim",
        SOURCE,
        INTRODUCTION.format(**values),
        metals + WEIGHTS_NOTE.format(**values),
        rises + RISE_NOTE.format(**values),
        levels + LEVEL_NOTE.format(**values),
        waters + WATER_NOTE.format(**values),
        settings + SOFTWARE_NOTE.format(**values),
        densities,
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
