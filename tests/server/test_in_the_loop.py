"""Hardware in the loop on the whole stack: the robot on one host, its simulator on another."""

import csv
import io
import json
import subprocess
import sys
import zipfile
from typing import Any

import pytest

from robot_runtime.control.faults import ROBOT_FAULTS
from tests.in_the_loop import CUT_SECONDS
from tests.stack import ROOT
from tests.two_hosts import available

pytestmark = pytest.mark.stack


def table(archive: zipfile.ZipFile, name: str) -> list[dict[str, str]]:
    return list(csv.DictReader(io.StringIO(archive.read(f"{name}.csv").decode())))


@pytest.fixture(scope="module")
def swum(tmp_path_factory: pytest.TempPathFactory) -> tuple[dict[str, Any], zipfile.ZipFile]:
    """Answers and session file of a dive in the loop, over a poor network that was cut for a while."""
    obstacle = available()
    if obstacle:
        pytest.skip(f"no two hosts on this computer: {obstacle}")
    folder = tmp_path_factory.mktemp("loop") / "robot"
    command = ["unshare", "--user", "--map-root-user", "--net", sys.executable, "-m", "tests.in_the_loop"]
    ended = subprocess.run([*command, str(folder)], cwd=ROOT, capture_output=True, text=True, check=False)
    assert ended.returncode == 0, ended.stderr[-4000:]
    return json.loads(ended.stdout), zipfile.ZipFile(folder / "session.zip")


def test_without_a_simulator_the_robot_reports_it_and_does_not_arm(
    swum: tuple[dict[str, Any], zipfile.ZipFile],
) -> None:
    report, _ = swum
    assert report["alone"] == [
        "There is no simulator. Start it with “mucat simulator --connect ...”, or on the System page."
    ]
    assert report["simulator"] == "ok: Simulates the water."


def test_it_dives_to_its_set_point_through_delay_jitter_and_loss(
    swum: tuple[dict[str, Any], zipfile.ZipFile],
) -> None:
    report, archive = swum
    assert report["armed"]
    carried, lost = report["packets"]
    assert carried > 500
    assert lost > 5
    truth = [float(line["position_2 [m]"]) for line in table(archive, "truth")]
    shown = [float(line["depth [m]"]) for line in table(archive, "depth")]
    assert 0.5 < max(truth) < 0.9
    assert 0.45 < max(shown) < 0.85
    assert len(set(shown)) > 50


def test_a_lost_simulator_is_a_fault_and_stops_the_robot(
    swum: tuple[dict[str, Any], zipfile.ZipFile],
) -> None:
    report, archive = swum
    assert report["cut"][1:] == report["alone"]
    assert report["back"] == "failsafe"
    events = table(archive, "event")
    lost = next(event for event in events if "The simulator has been silent for 0.5 s" in event["text"])
    assert (lost["kind"], lost["severity"]) == ("simulator_silent", "alarm")
    # What else it brings is a consequence of it: the page shows the cause first.
    faults = {
        event["kind"] for event in events if float(event["time [s]"]) >= float(lost["time [s]"])
    } & ROBOT_FAULTS.keys()
    assert faults <= {"simulator_silent", *ROBOT_FAULTS["simulator_silent"].consequences}
    armed = next(float(event["time [s]"]) for event in events if event["kind"] == "armed")
    disarmed = next(float(event["time [s]"]) for event in events if event["kind"] == "disarmed")
    times = [float(line["time [s]"]) for line in table(archive, "depth")]
    # How soon it stops is measured in simulated time: tests/runtime/control/test_hil_feed.py.
    deepest = max(table(archive, "depth"), key=lambda line: float(line["depth [m]"]))
    assert armed < float(deepest["time [s]"]) < disarmed
    assert not [time for time in times if disarmed + 1 < time < disarmed + CUT_SECONDS]
