"""Scenarios on the whole stack: a short live run, its ends, refusals and undoing."""

import sqlite3
import time
from collections.abc import Callable
from contextlib import suppress
from typing import Any

import pytest

from robot_runtime.errors import NoAnswerError
from robot_runtime.transport.zenoh_transport import join
from tests.stack import Stack
from tests.waiting import SECONDS

pytestmark = pytest.mark.stack

SHORT = """
name = "short"
title = "A short one"
duration = 3
seed = 7
[scene]
kind = "pool"
depth = 2.0
length = 4.0
width = 3.0
beacons = [[1.0, 0.0, 0.5]]
[water.current]
north = 0.1
[control]
controller = "pid"
set_point = 0.3
gains.pid.kp = 4.0
[vision]
rate = 10
[[events]]
at = 0.2
do = "arm"
[[events]]
at = 1.5
do = "card"
colour = "yellow"
[[events]]
at = 1.6
do = "fault"
sensor = "beacon_left"
kind = "stuck"
[[events]]
at = 1.7
do = "line"
direction = "from_board"
kind = "bit_errors"
rate = 1e-5
[[events]]
at = 2
do = "marker"
text = "Nearly done"
"""
LONG = SHORT.replace("duration = 3", "duration = 600")


@pytest.fixture
def stack(shared_stack: Stack) -> Stack:
    return shared_stack


def wait(condition: Callable[[], object], what: str, why: Callable[[], object] = str) -> None:
    end = time.monotonic() + SECONDS
    while not condition():
        assert time.monotonic() < end, f"waited in vain for {what} {why()}"
        time.sleep(0.05)


def state(stack: Stack) -> dict[str, Any]:
    answer: dict[str, Any] = stack.api.get("/scenarios/state").json()
    return answer


def robot(stack: Stack) -> dict[str, Any]:
    answer: dict[str, Any] = stack.api.get("/robot").json()
    return answer


def start(stack: Stack, text: str) -> None:
    answer = stack.api.post("/scenarios/runs", json={"text": text, "place": "live"})
    assert answer.status_code == 201, answer.text


def refusal(stack: Stack, text: str) -> str:
    answer = stack.api.post("/scenarios/runs", json={"text": text, "place": "live"})
    assert answer.status_code == 409, answer.text
    detail: str = answer.json()["detail"]
    return detail


def ended(stack: Stack) -> dict[str, Any]:
    wait(lambda: state(stack)["active"] is None, "the end of the scenario")
    last: dict[str, Any] = state(stack)["last"]
    return last


def begin_long(stack: Stack) -> None:
    start(stack, LONG)
    wait(lambda: robot(stack)["armed"], "the scenario to arm the robot", lambda: state(stack))


def simulator_answers(stack: Stack) -> bool:
    """Return True where the simulator answers; its process was running a moment before."""
    runtime = f"unixsock-stream/{stack.data}/run/runtime.sock"
    with join("turtle", [runtime]) as messages, suppress(NoAnswerError):
        messages.query("simulator/surroundings", {})
        return True
    return False


def settings_of(stack: Stack) -> dict[str, Any]:
    """Return the robot's settings that a scenario may change."""
    names = ["loops", "set_point_default", "set_point_detected", "vision_rate"]
    result = robot(stack)
    return {name: result[name] for name in [*names, "vision_colour", "card", "armed"]}


def query(stack: Stack, question: str) -> list[Any]:
    with sqlite3.connect(stack.data / "mucat.db") as database:
        return database.execute(question).fetchall()


def test_the_shipped_scenarios_are_listed_and_valid(stack: Stack) -> None:
    answer = stack.api.get("/scenarios").json()
    assert answer[0]["name"] == "figure_14"
    assert len(answer) == 7
    for scenario in answer:
        checked = stack.api.post("/scenarios/check", json={"text": scenario["text"]}).json()
        assert checked == {"problems": [], "summary": scenario["summary"]}


def test_errors_of_a_scenario_are_reported(stack: Stack) -> None:
    wrong = SHORT.replace("[scene]", "[sea]").replace("duration = 3", "duration = -3")
    problems = stack.api.post("/scenarios/check", json={"text": wrong}).json()["problems"]
    assert {problem["text"].split(" ")[0] for problem in problems} == {"duration", "'sea'", "scene"}
    assert sorted(problem["path"] for problem in problems) == [["duration"], ["scene"], ["sea"]]
    answer = stack.api.post("/scenarios/runs", json={"text": wrong, "place": "live"})
    assert (answer.status_code, answer.json()["detail"]) == (
        422,
        "\n".join(problem["text"] for problem in problems),
    )
    assert state(stack)["active"] is None


def test_a_live_run_is_recorded_and_undoes_its_set_up(stack: Stack) -> None:
    chosen = {"name": "depth", "controller": "pid", "gains": {"kp": 7}}
    stack.api.post("/robot/commands/loop", json=chosen).raise_for_status()
    points = {"control.set_point": 0.9, "control.set_point_detected": 1.1}
    stack.api.post("/robot/commands/parameters", json={"values": points}).raise_for_status()
    # The depth loop takes its set point up with the next control step.
    wait(lambda: robot(stack)["loops"][0]["set_point"] == 0.9, "the set points")
    before = settings_of(stack)
    ((newest_session,),) = query(stack, "SELECT coalesce(max(id), 0) FROM session")
    start(stack, SHORT)
    assert refusal(stack, SHORT).startswith("“A short one” is running.")
    wait(lambda: robot(stack)["armed"], "the scenario to arm the robot")
    during = settings_of(stack)
    assert (during["set_point_default"], during["vision_rate"]) == (0.3, 10)
    last = ended(stack)
    assert (last["state"], last["problem"], last["name"]) == ("complete", "", "short")
    wait(lambda: settings_of(stack) == before, f"{before}", lambda: f"instead of {settings_of(stack)}")
    # Nothing stays changed, so that the change before the scenario can be undone.
    newest = stack.api.get("/parameters/changes").json()[0]
    assert {value["name"] for value in newest["values"]} == set(points)
    stack.api.post("/parameters/undo", json={"change": newest["id"]}).raise_for_status()

    columns = "id, state, origin, scenario_name, seed, scenario, started_steady, samples"
    (session,) = query(stack, f"SELECT {columns} FROM session WHERE id > {newest_session}")
    assert session[:6] == (last["session"], "complete", "scenario", "short", 7, SHORT)
    assert session[7] > 500
    marks = query(stack, f"SELECT time, text FROM marker WHERE session_id = {session[0]} ORDER BY time")
    message = ["Arm", "Yellow card", "Beacon left: stuck", "Line from the board: bit errors", "Nearly done"]
    assert [text for _, text in marks] == message
    assert all(0 <= moment - session[6] <= 3.5 for moment, _ in marks)


def test_stop_ends_it(stack: Stack) -> None:
    begin_long(stack)
    stack.api.post("/robot/stop").raise_for_status()
    last = ended(stack)
    assert (last["state"], last["problem"]) == ("cancelled", "STOP was pressed.")
    assert not robot(stack)["armed"]
    session = last["session"]
    marks = query(stack, f"SELECT text FROM marker WHERE session_id = {session} ORDER BY id")
    assert marks[-1] == ("STOP was pressed.",)
    assert query(stack, f"SELECT state FROM session WHERE id = {session}") == [("complete",)]


def test_a_run_ends_with_its_recording_and_on_cancellation(stack: Stack) -> None:
    begin_long(stack)
    session = state(stack)["active"]["session"]
    stack.api.post(f"/sessions/{session}/stop").raise_for_status()
    assert ended(stack)["problem"] == "The recording was stopped."
    begin_long(stack)
    stack.api.post("/scenarios/cancel").raise_for_status()
    assert (ended(stack)["state"], ended(stack)["problem"]) == ("cancelled", "It was cancelled.")


def test_the_end_of_the_simulator_fails_the_run(stack: Stack) -> None:
    begin_long(stack)
    stack.part("simulator").kill()
    last = ended(stack)
    assert (last["state"], last["problem"]) == (
        "failed",
        "The simulator ended during the run, and its settings are lost.",
    )
    stack.wait_ready()
    wait(lambda: simulator_answers(stack), "the next simulator to answer")


def test_after_a_kill_the_next_server_undoes_the_set_up(stack: Stack) -> None:
    wait(lambda: not (stack.data / "scenario-before.json").exists(), "the run before to be undone")
    # The depth loop takes its set point up with the next control step.
    wait(lambda: settings_of(stack)["loops"][0]["set_point"] != 0.3, "the set point from before that run")
    before = settings_of(stack)
    begin_long(stack)
    session = state(stack)["active"]["session"]
    stack.kill()
    stack.wait_ready()
    wait(
        lambda: settings_of(stack) == before,
        "everything to be as before:",
        lambda: f"{before}, but there is {settings_of(stack)}",
    )
    wait(lambda: not (stack.data / "scenario-before.json").exists(), "nothing to be left to put back")
    marks = query(stack, f"SELECT text FROM marker WHERE session_id = {session} ORDER BY id")
    assert marks[-1] == ("The server was killed; the scenario ends here.",)
    assert query(stack, f"SELECT state FROM session WHERE id = {session}") == [("complete",)]


def test_a_refusal_gives_the_reason(stack: Stack) -> None:
    hull = SHORT + "[robot]\nmass = 3.1\n"
    assert refusal(stack, hull) == "It changes the hull's parameters, which needs simulated time."
    mistaken = 'mistakes = ["imu-strap"]\n' + SHORT
    assert refusal(stack, mistaken) == "Its board has mistakes, which needs simulated time."
    fast = SHORT.replace("[control]", "[control]\nrate = 20")
    assert refusal(stack, fast).startswith("It needs control at 20 Hz; this robot's runs at 10 Hz")
    session = stack.api.post("/sessions", json={"name": "mine"}).json()["id"]
    stack.arm()
    wait(lambda: robot(stack)["armed"], "the robot to be armed")
    text = refusal(stack, SHORT)
    assert "“mine” is being recorded." in text
    assert "The robot is armed." in text
    stack.api.post("/robot/stop").raise_for_status()
    stack.api.post(f"/sessions/{session}/stop").raise_for_status()


def test_own_scenarios_are_stored(stack: Stack) -> None:
    answer = stack.api.post("/scenarios", json={"text": SHORT})
    assert answer.status_code == 201
    result = stack.api.get("/scenarios").json()
    assert [(scenario["name"], scenario["shipped"]) for scenario in result][-1] == ("short", False)
    taken = stack.api.post("/scenarios", json={"text": SHORT.replace('"short"', '"lost_link"')})
    assert taken.status_code == 409
    (stack.data / "scenarios" / "broken.toml").write_text("name = [")
    result = {scenario["name"]: scenario["summary"] for scenario in stack.api.get("/scenarios").json()}
    assert result["broken"] is None
