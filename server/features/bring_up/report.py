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

STATES = {"open": "not done", "done": "done", "wrong": "something is wrong", "skipped": "skipped"}
MARKS = {"good": "✓", "note": "•", "wrong": "✗"}

PAGE = """<!doctype html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width">
<title>{title}</title>
<style>
body {{ max-width: 52rem; margin: 2rem auto; padding: 0 1rem; font: 16px/1.5 Inter, Helvetica, sans-serif;
  color: #1c262c; background: #fff; }}
h1 {{ font-size: 1.6rem; }}
h2 {{ margin: 1.6rem 0 .3rem; font-size: 1.1rem; }}
h2 small {{ font-weight: 400; color: #55636b; }}
table {{ width: 100%; border-collapse: collapse; }}
th, td {{ padding: .3rem .6rem .3rem 0; border-top: 1px solid #d6dde1; text-align: left; }}
td {{ vertical-align: top; }}
th {{ font-weight: 600; }}
.wrong {{ color: #a32020; }}
.note {{ color: #7a5a00; }}
.good {{ color: #1d6b45; }}
</style>
</head>
<body>
{body}
</body>
</html>
"""


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
    return PAGE.format(title=escape(f"Bring-up of {robot}"), body="\n".join(parts))


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
    return (
        "<table>"
        + "".join(f"<tr><th>{escape(a)}</th><td>{escape(b)}</td></tr>" for a, b in rows)
        + "</table>"
    )


def _step(title: str, state: str, results: list[Result]) -> str:
    head = f"<h2>{escape(title)} <small>{state}</small></h2>"
    if not results:
        return head
    rows = "".join(
        f'<tr><td class="{result.verdict}">{MARKS[result.verdict]}</td><td>{escape(result.what)}</td>'
        f"<td>{escape(result.expected)}</td><td>{escape(result.measured)}<br>{escape(result.advice)}</td></tr>"
        for result in results
    )
    return f"{head}<table><tr><th></th><th>part</th><th>expected</th><th>measured</th></tr>{rows}</table>"
