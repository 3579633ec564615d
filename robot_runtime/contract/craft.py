"""The craft: the physical numbers of one robot in water, of its fins and of its sensors, and their file.

Three origins occur. *Published*: from the robot's own published code. *Assumed*: estimated from the hull's
size and shape, since nobody published it. *Data sheet*: of the part named; its values are typical, and a
single part may differ by a factor of two. The spread is where the number of a real robot is expected. Numbers
of the large U-CAT (19 kg), which circulate under this robot's name, are not used.

Fins: front right, back right, back left, front left. Body axes: forward, right, down.
"""

from collections.abc import Mapping
from dataclasses import asdict, dataclass, field, fields, is_dataclass
from math import cos, pi, sin
from pathlib import Path
from typing import Annotated, Any

from robot_runtime.contract.limits import ConfigError, Range
from robot_runtime.contract.parsing import TOP, parse
from robot_runtime.contract.problems import DocumentEntry
from robot_runtime.contract.text_input import TextError, load_text
from robot_runtime.contract.toml_text import TomlError, read_toml

Vector = tuple[float, float, float]
Six = tuple[float, float, float, float, float, float]

Length = Annotated[float, Range(0.02, 1)]
Place = Annotated[float, Range(-0.5, 0.5)]
Inertia = Annotated[float, Range(0.0005, 0.2)]
AddedMass = Annotated[float, Range(0, 15)]
AddedInertia = Annotated[float, Range(0, 0.06)]
Damping = Annotated[float, Range(0, 12)]
TurnDamping = Annotated[float, Range(0, 0.06)]
Drag = Annotated[float, Range(0, 200)]
TurnDrag = Annotated[float, Range(0, 0.6)]
RateOffset = Annotated[float, Range(-0.5, 0.5)]
ForceOffset = Annotated[float, Range(-2, 2)]
TRIM = Range(-0.05, 0.05)
TITLE_MAX, ORIGIN_MAX = 100, 2000


def _number(default: Any, unit: str, meaning: str, origin: str, spread: str) -> Any:
    """Return a field whose unit, meaning, origin and spread the reference shows."""
    return field(
        default=default, metadata={"unit": unit, "meaning": meaning, "origin": origin, "spread": spread}
    )


@dataclass(frozen=True, slots=True, kw_only=True)
class SensorQuality:
    """The error model of a sensor, in the units of its reading. Raises ValueError below 0."""

    rate: float = 200.0
    """Hz of new readings, at most 200, the rate of the simulation; faster sensors have that."""
    latency: float = 0.0
    """s from input to reading, besides the delay of the emulated part; in steps of 5 ms."""
    noise: float = 0.0
    """Standard deviation of each reading: Gaussian, without memory."""
    bias: float = 0.0
    """Standard deviation of the offset that is drawn at the start."""
    walk: float = 0.0
    """Standard deviation of the offset's random walk after one second; it grows with √time."""
    step: float = 0.0
    """Quantization of the readings; 0: they are not rounded."""

    def __post_init__(self) -> None:
        if not self.rate > 0:
            raise ValueError(f"a sensor's rate is {self.rate} Hz; it must be above 0")
        for name in ("latency", "noise", "bias", "walk", "step"):
            if not getattr(self, name) >= 0:
                raise ValueError(f"a sensor's {name} is {getattr(self, name)}; it must not be below 0")


@dataclass(frozen=True, slots=True, kw_only=True)
class Craft:
    """The numbers of one robot; the defaults are those of µ-CAT. Raises ValueError for a mass of 0."""

    mass: Annotated[float, Range(0.75, 12)] = _number(3.0, "kg", "mass", "published", "5 %")
    size: tuple[Length, Length, Length] = _number(
        (0.24, 0.13, 0.10),
        "m",
        "hull along forward, right, down. At the surface an upright box, at walls an ellipsoid",
        "length and height published; width assumed: the published fins' shafts are 0.13 apart. A published "
        "width of 0.10 leaves 2.4 litres, which cannot carry 3 kg; this box has 3.1, and displaces 3.0",
        "5 %; width 0.13 to 0.16",
    )
    inertia: tuple[Inertia, Inertia, Inertia] = _number(
        (0.0067, 0.0169, 0.0186),
        "kg m²",
        "about forward, right, down",
        "assumed: an even box of this size and mass",
        "half (batteries at the middle) to 1.5 times (at the ends)",
    )
    buoyancy: Annotated[float, Range(0.9, 1.1)] = _number(
        1.003,
        "",
        "buoyancy under water as a share of the weight",
        "assumed; published is: slightly positive",
        "1.001 to 1.01, by trim weights",
    )
    buoyancy_forward: Annotated[float, TRIM] = _number(
        0.0, "m", "centre of buoyancy before the centre of mass", "assumed: trimmed", "±3 mm"
    )
    buoyancy_right: Annotated[float, TRIM] = _number(
        0.0, "m", "centre of buoyancy to the right of the centre of mass", "assumed: trimmed", "±3 mm"
    )
    buoyancy_height: Annotated[float, TRIM] = _number(
        0.010,
        "m",
        "centre of buoyancy above the centre of mass. Below 0 it capsizes",
        "assumed: a tenth of the height, with batteries at the bottom",
        "5 to 20 mm",
    )
    restitution: Annotated[float, Range(0, 1)] = _number(
        0.2, "", "share of the speed towards a wall that comes back", "assumed: plastic on tiles", "0 to 0.5"
    )
    friction: Annotated[float, Range(0, 2)] = _number(
        0.3, "", "Coulomb's, of the hull on walls and floor", "assumed: wet plastic", "0.1 to 0.6"
    )
    added_mass: tuple[AddedMass, AddedMass, AddedMass, AddedInertia, AddedInertia, AddedInertia] = _number(
        (0.9, 2.6, 3.2, 0.0023, 0.012, 0.0083),
        "kg, kg m²",
        "water that moves along in surge, sway, heave, roll, pitch, yaw",
        "assumed: between an ellipsoid within the hull (Lamb, *Hydrodynamics*, 1932, 114 and 121) and a "
        "box with four plates as fins (coefficients of DNV-RP-H103, 2011, appendix A)",
        "0.32 to 1.1, 0.91 to 3.0, 1.5 to 5.3 kg; 0.0001 to 0.0054, 0.0022 to 0.026, 0.0010 to 0.014 kg m²",
    )
    damping_linear: tuple[Damping, Damping, Damping, TurnDamping, TurnDamping, TurnDamping] = _number(
        (0.6, 1.5, 1.5, 0.004, 0.006, 0.006),
        "N s/m, N m s",
        "damping for each m/s and rad/s",
        "assumed: a fifth to two fifths of all damping at 0.1 m/s and 0.5 rad/s",
        "a factor of two",
    )
    damping_quadratic: tuple[Drag, Drag, Drag, TurnDrag, TurnDrag, TurnDrag] = _number(
        (10.0, 25.0, 35.0, 0.02, 0.05, 0.05),
        "N s²/m², N m s²",
        "damping for each (m/s)² and (rad/s)²",
        "assumed: coefficients of 1.5, 2.1 and 2.2 on the box's sides, which are those of a box (1 to 1.3) "
        "and of what stands out from it",
        "half to 1.2 times; turns: a factor of two",
    )
    fin_positions: tuple[
        tuple[Place, Place], tuple[Place, Place], tuple[Place, Place], tuple[Place, Place]
    ] = _number(
        ((0.110, 0.065), (-0.110, 0.065), (-0.110, -0.065), (0.110, -0.065)),
        "m",
        "forward and right, of the fins' shafts",
        "published",
        "3 mm",
    )
    fin_mount: Annotated[float, Range(0, 1.5)] = _number(
        pi / 6, "rad", "between a fin at angle 0 and the long axis", "published", "0.03 rad"
    )
    fin_area: Annotated[float, Range(0.001, 0.02)] = _number(0.0045, "m²", "of one fin", "published", "5 %")
    fin_centre: Annotated[float, Range(0.011, 0.18)] = _number(
        0.045, "m", "from the shaft to where a fin's force acts", "published", "10 %"
    )
    fin_drag: Annotated[float, Range(0.03, 1.24)] = _number(
        0.31,
        "",
        "C_d of the published thrust formula",
        "published, with 0.15 or 0.31. The thrust of 0.39 N a fin that follows from 0.31 is two to three "
        "times that of Lighthill's theory of slender fins, to which 0.15 is near",
        "0.10 to 0.35",
    )
    fin_thrust_per_drag: Annotated[float, Range(3.5, 56)] = _number(
        13.95, "", "C_T / C_d", "derived from the published formula", "15 %, by the amplitude"
    )
    fin_normal: Annotated[float, Range(0.5, 8)] = _number(
        2.0, "", "C_N, drag of a fin across its blade", "assumed: a flat plate", "1.2 (steady) to 4 (strokes)"
    )
    fin_delay: Annotated[float, Range(0, 0.2)] = _number(
        0.0, "s", "from a fin's motion to the water's force on the hull", "assumed: none", "0 to 0.1 s"
    )
    pressure_position: tuple[Place, Place, Place] = _number(
        (0.0, 0.0, -0.05),
        "m",
        "of the pressure sensor; the IMU is at the centre of mass",
        "assumed: on the back",
        "1 cm; forward 5 cm",
    )
    gyroscope_offset: tuple[RateOffset, RateOffset, RateOffset] = _number(
        (0.0, 0.0, 0.0),
        "rad/s",
        "fixed offset of the turn rate, beside the one drawn at the start",
        "assumed: calibrated",
        "±0.35 rad/s without a calibration (data sheet)",
    )
    accelerometer_offset: tuple[ForceOffset, ForceOffset, ForceOffset] = _number(
        (0.0, 0.0, 0.0),
        "m/s²",
        "fixed offset of the specific force, beside the one drawn",
        "assumed: calibrated",
        "±0.5 m/s² without a calibration (data sheet)",
    )
    pressure: SensorQuality = SensorQuality(noise=42.0, walk=1.0, step=0.67)
    """Pa. MS5837-30BA: noise by its data sheet 20 Pa at OSR 8192, twice that at the firmware's 2048, which
    takes a quarter of the samples; step one count of its 24-bit converter. Walk assumed, within a factor of
    five: temperature and gel. No offset, as the firmware takes the surface as its zero. The emulated part
    adds its 4.5 ms of conversion."""
    gyroscope: SensorQuality = SensorQuality(
        latency=0.005, noise=2e-4, bias=2e-3, walk=2e-5, step=pi / 180 / 65.536
    )
    """rad/s. MPU-6050: noise of its class (by the data sheet up to 7e-4 behind the 44 Hz filter); latency of
    that filter 4.8 ms, step at ±500 °/s, both data sheet. Bias and walk assumed, after a calibration at rest:
    the data sheet allows 0.35 rad/s without one."""
    accelerometer: SensorQuality = SensorQuality(
        latency=0.005, noise=1.7e-2, bias=2e-2, walk=1e-4, step=9.80665 / 8192
    )
    """m/s². MPU-6050: noise of its class (by the data sheet 3.3e-2 behind the 44 Hz filter); latency of that
    filter 4.9 ms, step at ±4 g, both data sheet. Bias and walk assumed, after a calibration at rest: the data
    sheet allows 0.5 m/s² without one."""
    encoder: SensorQuality = SensorQuality(noise=2.1e-3, bias=3e-3)
    """rad, each fin's. AS5040: noise data sheet, 0.12°. Bias assumed: half a tick of the calibrated zero; the
    data sheet allows 0.5° for a centred magnet. The emulated part has the 1024 ticks of a turn; the real
    part's delay of 0.1 ms is left out."""

    def __post_init__(self) -> None:
        for name in ("mass", "buoyancy", "fin_area", "fin_centre"):
            if not getattr(self, name) > 0:
                raise ValueError(f"{name} is {getattr(self, name)}; it must be above 0")
        if not all(value > 0 for value in self.inertia) or not all(value >= 0 for value in self.added_mass):
            raise ValueError("inertia must be above 0, added_mass not below 0")
        if not all(length > 0 for length in self.size):
            raise ValueError(f"size is {self.size}; each length must be above 0")
        if not 0 <= self.restitution <= 1 or not self.friction >= 0:
            raise ValueError("restitution must be 0 to 1, friction not below 0")

    @property
    def volume(self) -> float:
        """The volume, m³, of the fresh water that the hull displaces under water."""
        return self.mass * self.buoyancy / 1000

    @property
    def height(self) -> float:
        """The height, m, of the upright hull."""
        return self.size[2]

    @property
    def total_mass(self) -> Six:
        """The mass (kg) and inertia (kg m²) of the hull and the water that must move along."""
        own = (self.mass, self.mass, self.mass, *self.inertia)
        surge, sway, heave, roll, pitch, yaw = (a + b for a, b in zip(own, self.added_mass, strict=True))
        return surge, sway, heave, roll, pitch, yaw

    @property
    def thrust_coefficient(self) -> float:
        """C_T of a fin's thrust ½ρ·C_T·S·(r_c·θ̇)².

        For θ = a·sin(2πft) the mean of θ̇²·cos θ along the mount is a·(2πf)²·J₁(a), J₁ being Bessel's. Set
        equal to the published mean thrust 8ρ·C_d·S·r_c²·π²f²·(1 - cos 2a), where 2a is the amplitude from
        peak to peak, that gives C_T = 4·C_d·(1 - cos 2a) / (a·J₁(a)): 13.95·C_d at the largest, 2a = 1.6 rad.
        """
        return self.fin_thrust_per_drag * self.fin_drag

    @property
    def fin_directions(self) -> tuple[tuple[float, float], ...]:
        """Each fin's direction at angle 0 from shaft to tip, forward and right: outwards, to the middle."""
        along, across = cos(self.fin_mount), sin(self.fin_mount)
        return tuple(
            (-along if x > 0 else along, across if y > 0 else -across) for x, y in self.fin_positions
        )


@dataclass(frozen=True, slots=True, kw_only=True)
class CraftDocument:
    """A craft file: a title, where its numbers come from, and the numbers that differ from the default."""

    title: str
    origin: str = ""
    craft: Craft = Craft()

    def __post_init__(self) -> None:
        if not 1 <= len(self.title.strip()) <= TITLE_MAX:
            raise ConfigError(TOP.field("title").problem(f"must be a text of 1 to {TITLE_MAX} characters"))
        if len(self.origin) > ORIGIN_MAX:
            raise ConfigError(TOP.field("origin").problem(f"has more than {ORIGIN_MAX} characters"))


DEFAULT_DOCUMENT = CraftDocument(title="Default craft")


def read_craft(text: str) -> CraftDocument:
    """Return the craft in a TOML text; missing entries are the default craft's. Raise ConfigError."""
    try:
        table = read_toml(text)
    except TomlError as problem:
        raise ConfigError(f"the craft file {problem}") from problem
    numbers = table.get("craft")
    if isinstance(numbers, dict):
        table["craft"] = complete_sensors(Craft(), numbers)
    return parse(CraftDocument, table)


def load_craft(path: Path) -> CraftDocument:
    """Read a craft file. Raise ConfigError where it cannot be read or used, with the file's name."""
    try:
        return read_craft(load_text(path))
    except OSError as problem:
        raise ConfigError(f"the craft file {path} cannot be read: {problem}") from problem
    except TextError as problem:
        raise ConfigError(f"the craft file {path} cannot be read: it {problem}") from problem
    except ConfigError as problem:
        file = DocumentEntry(path.name)
        named = [
            problem.within(file) if problem.path else file.sentence(problem.text)
            for problem in problem.problems
        ]
        raise ConfigError(*named) from problem


def complete_sensors(plain: Craft, table: Mapping[str, Any]) -> dict[str, Any]:
    """Return the table; entries that its sensors' tables lack are those of `plain`."""
    whole = dict(table)
    for name, value in table.items():
        default = getattr(plain, name, None)
        if is_dataclass(default) and isinstance(value, dict):
            whole[name] = asdict(default) | value  # type: ignore[arg-type]
    return whole


def craft_table(craft: Craft) -> dict[str, Any]:
    """Return the entries of `craft` that differ from the default, as TOML has them."""
    plain, table = Craft(), {}
    for entry in fields(Craft):
        value, default = getattr(craft, entry.name), getattr(plain, entry.name)
        if isinstance(value, SensorQuality):
            value, default = asdict(value), asdict(default)
            value = {name: number for name, number in value.items() if number != default[name]}
            default = {}
        if value != default:
            table[entry.name] = value
    return table
