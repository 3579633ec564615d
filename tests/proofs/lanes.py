"""The mission `three_lanes` in simulated water, measured by the simulator's truth, seed by seed."""

from dataclasses import dataclass, replace
from itertools import pairwise
from math import cos, hypot, pi, remainder, sin, sqrt
from random import Random
from statistics import fmean

from robot_runtime.contract.craft import Craft, Six
from robot_runtime.contract.documents import Track, Truth
from robot_runtime.contract.missions import NO_LIMITS
from robot_runtime.control.attitude import euler_angles
from robot_runtime.experiments.mission_trial.trial import trial_scenario
from robot_runtime.experiments.scenario.boards import boards
from robot_runtime.experiments.scenario.run import ScenarioRun
from robot_runtime.missions.library import shipped_missions
from tests.proofs.pool import processes
from tests.runtime.experiments.scenario.staging import Output
from tests.runtime.missions.water import end_of

LANES = ("2", "4", "6")
"""The steps of the mission that swim a lane."""
SPACING, TOLERANCE = 1.0, 0.3
"""m between two lanes as planned, and the share of it by which they may be closer or farther apart."""
MIDDLE = (0.5, 1.5)
"""m along a lane between which it is measured: outside of that the robot still turns into it."""
CRAFT_ERROR = 0.1
"""Standard deviation of thrust and of damping as a share, where the hull is not the craft that it is taken
for."""
SETTLED = 1.0
"""s after the first sample from which on the estimate is compared."""


@dataclass(frozen=True, slots=True)
class LaneSurvey:
    """A mission's lanes: true distances (m) between neighbours; errors of the estimate by its deviations."""

    spacings: list[float]
    errors: list[float]

    @property
    def covered(self) -> float:
        """The share of the errors within two standard deviations."""
        return _share([abs(error) <= 2 for error in self.errors])

    @property
    def spread(self) -> float:
        """The root mean square of the errors; 1 where the deviations are those of the errors."""
        return hypot(*self.errors) / sqrt(len(self.errors))


@dataclass(frozen=True, slots=True)
class TruePoint:
    """A true point of the way, m along headings 0 and 90° of the robot from where it was armed."""

    time: float
    x: float
    y: float


def survey(seed: int, craft_error: float = 0.0) -> LaneSurvey:
    """Swim the lanes with a hull whose numbers are drawn about the craft's with this share."""
    draw, craft = Random(f"{seed} hull"), Craft()
    thrust, damping = (1 + draw.gauss(0, craft_error) for _ in range(2))
    scenario = trial_scenario(shipped_missions()["three_lanes"], {}, NO_LIMITS, seed, craft)
    hull = replace(
        scenario.robot,
        fin_drag=craft.fin_drag * thrust,
        damping_linear=_scale(craft.damping_linear, damping),
        damping_quadratic=_scale(craft.damping_quadratic, damping),
    )
    output = Output()
    run = ScenarioRun(replace(scenario, robot=hull), boards()["host"], output)
    output.on_event = lambda _: run.cancel() if _has_ended(output) else None
    run.perform(lambda _: {})
    assert end_of(output)["phase"] == "succeeded", end_of(output)["text"]
    tracks = [(time, track) for time, track in output.rows["track"] if isinstance(track, Track)]
    points = _find_points(output, tracks[0][0])
    return LaneSurvey(_measure_spacings(output, points), _compare(tracks, points))


def _scale(values: Six, factor: float) -> Six:
    a, b, c, d, e, f = (factor * value for value in values)
    return a, b, c, d, e, f


def _has_ended(output: Output) -> bool:
    missions = output.documents.get("mission")
    return missions is not None and missions[-1]["phase"] not in ("running", "paused")


def _find_points(output: Output, start: float) -> list[TruePoint]:
    """Return the true way from `start` (s) on, in the axes of the robot's own heading at that time."""
    truths = [(time, truth) for time, truth in output.rows["truth"] if isinstance(truth, Truth)]
    first = next(truth for time, truth in truths if time >= start)
    own = next(imu for time, imu in output.rows["imu"] if time >= start)
    turn = remainder(euler_angles(own.attitude)[0] - euler_angles(first.attitude)[0], 2 * pi)
    points = []
    for time, truth in truths:
        if time >= start:
            north, east = (truth.position[axis] - first.position[axis] for axis in range(2))
            x, y = north * cos(turn) - east * sin(turn), north * sin(turn) + east * cos(turn)
            points.append(TruePoint(time, x, y))
    return points


def _measure_spacings(output: Output, points: list[TruePoint]) -> list[float]:
    """Return the true distances, m, between the middles of neighbouring lanes."""
    middles = []
    for lane in LANES:
        times = [
            document["time"]
            for document in output.documents["mission"]
            for step in document["steps"]
            if step["path"] == lane and step["status"] == "running"
        ]
        low, high = MIDDLE
        middles.append(
            fmean(
                point.y for point in points if times[0] <= point.time <= times[-1] and low <= point.x <= high
            )
        )
    return [after - before for before, after in pairwise(middles)]


def _compare(tracks: list[tuple[float, Track]], points: list[TruePoint]) -> list[float]:
    """Return the errors of the estimate in x and y, each as a multiple of its standard deviation."""
    errors: list[float] = []
    following = iter(points)
    point = next(following)
    for time, track in tracks:
        if time < tracks[0][0] + SETTLED:
            continue
        while point.time < time and (later := next(following, None)) is not None:
            point = later
        errors += (track.x - point.x) / track.deviation_x, (track.y - point.y) / track.deviation_y
    return errors


def prove_lanes(seeds: int, workers: int = 2) -> list[str]:
    """Swim the lanes over so many seeds, with the craft's own hull and with others; return the problems."""
    problems = []
    for craft_error in (0.0, CRAFT_ERROR):
        with processes(workers) as pool:
            surveys = list(pool.map(survey, range(1, seeds + 1), [craft_error] * seeds))
        spacings = [spacing for lanes in surveys for spacing in lanes.spacings]
        apart = _share([abs(spacing - SPACING) <= TOLERANCE * SPACING for spacing in spacings])
        errors = [error for lanes in surveys for error in lanes.errors]
        whole = LaneSurvey(spacings, errors)
        what = f"{seeds} seeds, hull {'as its craft' if not craft_error else f'±{craft_error:.0%}'}"
        print(
            f"{what}: lanes {min(spacings):.2f} to {max(spacings):.2f} m apart, {apart:.1%} within"
            f" {TOLERANCE:.0%}; {whole.covered:.1%} of the estimates within two deviations,"
            f" errors of {whole.spread:.2f} deviations",
            flush=True,
        )
        if apart < (1.0 if not craft_error else 0.9):
            problems.append(f"{what}: only {apart:.1%} of the lanes lie apart as planned")
        if whole.covered < 0.95:
            problems.append(f"{what}: only {whole.covered:.1%} of the estimates lie within two deviations")
        if craft_error and whole.spread < 0.5:
            problems.append(f"{what}: the deviations are much larger than the errors")
    return problems


def _share(values: list[bool]) -> float:
    return sum(values) / len(values)
