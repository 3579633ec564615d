"""The report of a bring-up as one HTML file, dark on white, for printing and keeping with the robot."""

from datetime import datetime
from html import escape
from math import degrees

from robot_runtime.contract.calibration import STEPS as CALIBRATION_STEPS
from robot_runtime.control.fin_check import FINS
from robot_runtime.experiments.bring_up.guide import STEPS
from robot_runtime.experiments.bring_up.procedure import BringUp
from robot_runtime.experiments.bring_up.results import Result, Verdict
from server import VERSION
from server.platform.report_page import report_page, report_table

STATES = {"open": "not done", "done": "done", "wrong": "something is wrong", "skipped": "skipped"}
MARKS = {"good": "✓", "note": "•", "wrong": "✗"}


def write_report(robot: str, when: datetime, procedure: BringUp) -> str:
    """Return the report: the calibration, then each step with expected and measured values."""
    wrong = [step.title for step in STEPS if procedure.state(step.name) == "wrong"]
    skipped = [step.title for step in STEPS if procedure.state(step.name) == "skipped"]
    missing = [CALIBRATION_STEPS[name] for name in procedure.calibration().missing]
    parts = [
        f"<h1>Bring-up of {escape(robot)}</h1>",
        f"<p>{when:%Y-%m-%d %H:%M} UTC, µ-CAT {VERSION}.</p>",
        _sentence("Something is wrong", wrong) if wrong else "<p>Nothing was found wrong.</p>",
        _sentence("Skipped", skipped, "note") if skipped else "",
        _sentence("Not calibrated", missing) if missing else "<p>The calibration is whole.</p>",
        "<h2>Calibration</h2>",
        _calibration(procedure),
        *(
            _step(step.title, STATES[procedure.state(step.name)], procedure.results(step.name))
            for step in STEPS
        ),
    ]
    return report_page(f"Bring-up of {robot}", parts)


def _sentence(text: str, things: list[str], kind: Verdict = "wrong") -> str:
    return f'<p class="{kind}">{text}: {escape("; ".join(things))}.</p>'


def _calibration(procedure: BringUp) -> str:
    values = procedure.calibration()
    ways = {True: "fall", False: "rise"}
    rows = [
        (
            f"{name} fin",
            f"zero at {zero}; counts {ways[encoder]} as its tip goes down, {ways[motor]} at positive drive",
        )
        for name, zero, encoder, motor in zip(
            FINS, values.fin_zeros, values.encoders_reversed, values.motors_reversed, strict=True
        )
    ]
    rows += [
        ("IMU's axes forward, right, down", ", ".join(values.axes)),
        ("gyroscope's offset", ", ".join(f"{degrees(part):.2f}" for part in values.gyro_bias) + " °/s"),
        ("pressure sensor's offset", f"{values.pressure_offset / 100:.1f} hPa"),
        ("factor of the battery's voltage", f"{values.battery_factor:.4f}"),
        ("beacon detectors", "low in the light" if values.beacons_inverted else "high in the light"),
    ]
    return report_table(("part", "value"), [tuple(map(escape, row)) for row in rows])


def _step(title: str, state: str, results: list[Result]) -> str:
    head = f"<h2>{escape(title)} <small>{state}</small></h2>"
    if not results:
        return head
    rows = [
        (
            f'<span class="{result.verdict}">{MARKS[result.verdict]}</span>',
            escape(result.what),
            escape(result.expected),
            f"{escape(result.measured)}<br>{escape(result.advice)}",
        )
        for result in results
    ]
    return head + report_table(("", "part", "expected", "measured"), rows)
