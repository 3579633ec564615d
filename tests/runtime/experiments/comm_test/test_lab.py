"""The lab process: its input and its events."""

import platform
from pathlib import Path

import pytest

from robot_runtime.experiments.comm_test.builder import Builder
from tests.runtime.experiments.comm_test.conftest import Run, make_test
from tests.runtime.experiments.comm_test.lab_process import (
    cancel,
    cancel_by_other_threads,
    lab,
    read_until,
    run_lab,
    write_document,
)

pytestmark = pytest.mark.usefixtures("program")
EMULATED = ("--where", "emulated")


def test_every_step_and_the_cells_are_reported_in_order(builder: Builder, run: Run) -> None:
    changes = {"framing": "plain", "baud_rate": (9600, 115200), "delay": (0.0, 0.01)}
    first, second = make_test(**changes), make_test(name="next", direction="both")
    status, events = run_lab(write_document(first, second), *EMULATED)
    assert status == 0
    started, ended = events[0], [event for event in events if event["event"] == "ended"]
    assert (started["event"], started["test"], started["firmware"]) == ("started", 0, builder.firmware_hash)
    assert started["tools"]["compiler"] == builder.compiler
    assert {"emulated board", "avrdude", "boot loader"} <= started["tools"].keys()
    assert started["host"].startswith(platform.node())
    assert ended == [{"event": "ended", "test": test, "state": "complete", "problem": ""} for test in (0, 1)]
    cells = [event for event in events if event["event"] == "cell"]
    assert [(cell["test"], cell["number"]) for cell in cells] == [(0, 0), (0, 1), (0, 2), (0, 3), (1, 0)]
    assert [cell["values"] for cell in cells[:4]] == [result.values for result in run(**changes)]
    for number in range(4):
        notices = [event for event in events if event["test"] == 0 and event.get("number") == number]
        assert [event.get("phase", "done") for event in notices] == ["compile", "upload", "run", "done"]


def test_a_bad_document_is_refused_with_every_problem() -> None:
    document = write_document(make_test(delay=(-1.0,), baud_rate=(230400,)))
    status, (event,) = run_lab(document, *EMULATED)
    assert status == 2
    assert event["event"] == "refused"
    named = [problem.removeprefix("test 1: ").split(" is ")[0] for problem in event["problems"]]
    assert named == ["delay[0]", "baud_rate[0]"]


def test_bytes_that_are_no_text_are_refused() -> None:
    status, (event,) = run_lab(b"[\xff]", *EMULATED)
    assert (status, event["event"]) == (2, "refused")
    assert event["problems"][0].startswith("the document has a byte in line 1 that is not UTF-8")


@pytest.mark.parametrize("thread", ["main", "other"])
def test_cancelled_in_the_middle_of_a_long_cell(thread: str) -> None:
    # More than two hours of emulated time, a minute and more to compute.
    slow = make_test(delay=(10.0,), to_val=1001, expected=1000)
    with lab(write_document(slow, make_test()), *EMULATED) as process:
        read_until(process.stdout, phase="run")
        status, events = cancel(process) if thread == "main" else cancel_by_other_threads(process)
    assert status == 1
    assert events == [{"event": "ended", "test": 0, "state": "cancelled", "problem": ""}]


def test_without_the_emulated_board_the_remedy_is_named(tmp_path: Path) -> None:
    status, events = run_lab(write_document(make_test()), "--where", "emulated", "--build", str(tmp_path))
    assert (status, events[-1]["state"]) == (1, "failed")
    assert "`make firmware`" in events[-1]["problem"]
