"""The test document: the thesis's own runs, and errors with their places."""

import json
import re
from dataclasses import asdict
from pathlib import Path
from typing import Any

import pytest

from robot_runtime.contract.limits import ConfigError
from robot_runtime.experiments.comm_test.document import CommTest, chip_baud, read_document
from robot_runtime.experiments.comm_test.faults import Faults
from robot_runtime.experiments.comm_test.results import GridCell

ROOT = Path(__file__).resolve().parents[4]
THESIS = (ROOT / "firmware/examples/comm_test/figure10.json").read_text()


def changed(**changes: Any) -> str:
    (entry,) = json.loads(THESIS)
    return json.dumps([entry | changes])


def problems(text: str) -> list[str]:
    with pytest.raises(ConfigError) as refused:
        read_document(text)
    return refused.value.texts


def test_the_thesis_s_own_example_is_75_cells() -> None:
    (test,) = read_document(THESIS)
    assert isinstance(test, CommTest)
    assert (test.framing, test.direction, test.expected) == ("thesis", "to_board", 100)
    assert len(test.cells) == 75
    assert test.cells[:4] == [
        GridCell(1200, 0.0, 0.0),
        GridCell(1200, 0.0, 0.5),
        GridCell(1200, 0.0, 1.0),
        GridCell(1200, 0.1, 0.0),
    ]


@pytest.mark.parametrize("changes", [{"name": "\ud800"}, {"\udfff": 1}, {"ino_path": "\ud800"}])
def test_lone_surrogates_are_refused(changes: dict[str, Any]) -> None:
    assert "surrogates not allowed" in problems(changed(**changes))[0]


def test_the_documents_print_the_example_that_ships() -> None:
    assert f"```json\n{THESIS}```" in (ROOT / "docs/use/comm-tests.md").read_text()


@pytest.mark.parametrize("path", ["comm_test/comm_test.ino", "/comm_test/comm_test.ino"])
def test_the_sketch_s_own_path_framing_and_direction(path: str) -> None:
    (test,) = read_document(changed(ino_path=path, framing="plain", direction="both"))
    assert (test.framing, test.direction) == ("plain", "both")


def test_faults_are_parsed_and_stored_documents_can_be_parsed_again() -> None:
    request = {"seed": 7, "bit_errors": 1e-3, "insert": 0.1, "burst": [1e-4, 20], "stall": [2, 0.25]}
    (test,) = read_document(changed(faults=request))
    assert test.faults == Faults(seed=7, bit_errors=1e-3, insert=0.1, burst=(1e-4, 20), stall=(2.0, 0.25))
    assert read_document(json.dumps([asdict(test)])) == [test]
    (clean,) = read_document(THESIS)
    assert clean.faults == Faults()
    assert read_document(json.dumps([asdict(clean)])) == [clean]


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"bauds": [1]}, "'bauds' is not known here; known are id, name, ino_path"),
        ({"id": "1"}, "id is '1'; it must be a whole number"),
        ({"id": True}, "id is True; it must be a whole number"),
        ({"name": " "}, "name must be a text of 1 to 200 characters"),
        ({"ino_path": "/etc/passwd"}, "ino_path is '/etc/passwd'; it must be comm_test/comm_test.ino"),
        ({"ino_path": "comm_test/../robot/robot.ino"}, "ino_path"),
        ({"ino_path": "/micro_cat_test/arduino/test_6/test_7.ino"}, "ino_path"),
        ({"ino_path": 3}, "ino_path is 3; it must be a text"),
        ({"delay": [0, -0.5]}, "delay[1] is -0.5; it must lie between 0 and 10"),
        ({"delay": [False]}, "delay[0] is False; it must be a number"),
        ({"delay": [11]}, "delay[0] is 11; it must lie"),
        ({"delay": []}, "delay must be a list of one or more"),
        ({"delay": 0.5}, "delay is 0.5; it must be a list"),
        ({"arduinodelay": [0.5, "1"]}, "arduinodelay[1] is '1'; it must be a number"),
        ({"arduinodelay": [0.5, 0.5]}, "arduinodelay[1] is 0.5, which the list already has"),
        ({"baud_rate": []}, "baud_rate must be a list"),
        (
            {"baud_rate": [9600, 230400]},
            "baud_rate[1] is 230400; the chip at 16 MHz makes 222222 of it, -3.5%",
        ),
        ({"baud_rate": [0]}, "baud_rate[0] is 0; it must lie between 1 and 16000000"),
        ({"baud_rate": [9600.0]}, "baud_rate[0] is 9600.0; it must be a whole number"),
        ({"baud_rate": [100]}, "baud_rate[0] is 100; the chip at 16 MHz cannot make it"),
        ({"baud_rate": [9600, 9600]}, "baud_rate[1] is 9600, which the list already has"),
        ({"from_val": -1}, "from_val is -1; it must lie between 0 and 32767"),
        ({"to_val": 40000}, "to_val is 40000; it must lie between 1 and 32768"),
        ({"to_val": 1}, "to_val is 1; it must be above from_val, 1"),
        ({"to_val": 20000}, "to_val is 20000; it must be above from_val, 1, by 1 to 5000"),
        ({"expected": 99}, "expected is 99; it must be 100, the count of numbers from from_val, 1, up to"),
        ({"framing": "morse"}, "framing is 'morse'; it must be one of 'plain', 'thesis', 'robot'"),
        (
            {"framing": "robot", "baud_rate": [600]},
            "baud_rate[0] is 600; with the framing robot it must lie",
        ),
        ({"framing": ["plain"]}, "framing is ['plain']; it must be one of"),
        ({"direction": "up"}, "direction is 'up'; it must be one of 'to_board', 'to_host', 'both'"),
        ({"faults": 3}, "faults must be a table"),
        ({"faults": {"noise": 1}}, "faults: 'noise' is not known here; known are seed, bit_errors"),
        ({"faults": {"seed": -1}}, "faults: seed is -1; it must lie between 0"),
        ({"faults": {"seed": 1.0}}, "faults: seed is 1.0; it must be a whole number"),
        ({"faults": {"bit_errors": 0.2}}, "faults: bit_errors is 0.2; it must lie between 0 and 0.1"),
        ({"faults": {"drop": "1"}}, "faults: drop is '1'; it must be a number"),
        ({"faults": {"double": True}}, "faults: double is True; it must be a number"),
        ({"faults": {"burst": 0.1}}, "faults: burst is 0.1; it must be a list"),
        ({"faults": {"burst": [0.11, 8]}}, "faults: burst[0] is 0.11; it must lie between 0 and 0.1"),
        ({"faults": {"burst": [0.1, 0]}}, "faults: burst[1] is 0; it must lie between 1 and 10000"),
        ({"faults": {"burst": [0.1, 1.5]}}, "faults: burst[1] is 1.5; it must be a whole number"),
        ({"faults": {"stall": [1]}}, "faults: stall is [1]; it must be a list of 2 numbers"),
        ({"faults": {"stall": [0, 0.1]}}, "faults: stall[0] is 0; it must lie between 0.05 and 3600"),
        (
            {"faults": {"stall": [2, 2]}},
            "faults: stall[1] is 2; it must be above 0 and below the period, 2 s",
        ),
        ({"faults": {"cut": [2, 0]}}, "faults: cut[1] is 0; it must be above 0"),
        ({"faults": {"cut": [2, "1"]}}, "faults: cut[1] is '1'; it must be a number"),
        (
            {"framing": "plain", "to_val": 256, "expected": 255},
            "to_val is 256; with the framing plain it must",
        ),
    ],
)
def test_an_error_is_reported_with_its_place(changes: dict[str, Any], message: str) -> None:
    (problem,) = problems(changed(**changes))
    assert problem.startswith(f"test 1: {message}")


@pytest.mark.parametrize("number", [float("nan"), float("inf")])
def test_what_is_no_number_of_json_is_refused(number: float) -> None:
    (problem,) = problems(changed(delay=[number]))
    assert re.fullmatch(r"the document holds (NaN|Infinity) in line \d+; a number must be finite", problem)


@pytest.mark.parametrize(
    ("changes", "path", "message"),
    [
        ({"speed": 1}, (0, "speed"), "is not known here"),
        ({"name": " "}, (0, "name"), "must be a text"),
        ({"delay": [0, -0.5]}, (0, "delay", 1), "is -0.5; it must"),
        ({"baud_rate": [9600, 9600]}, (0, "baud_rate", 1), "is 9600, which"),
        ({"expected": 99}, (0, "expected"), "is 99; it must"),
        ({"faults": 3}, (0, "faults"), "must be a table"),
        ({"faults": {"burst": [0.1, 0]}}, (0, "faults", "burst", 1), "is 0; it must"),
        ({"faults": {"cut": [2, 0]}}, (0, "faults", "cut", 1), "is 0; it must"),
        ({"delay": [number / 1000 for number in range(501)]}, (), "the document has"),
    ],
)
def test_a_mistake_carries_the_path_to_it(
    changes: dict[str, Any], path: tuple[str | int, ...], message: str
) -> None:
    with pytest.raises(ConfigError) as refused:
        read_document(changed(**changes))
    (problem,) = refused.value.problems
    assert (problem.path, problem.words.startswith(message)) == (path, True)
    assert problem.text.endswith(problem.words)


def test_all_errors_are_reported_together() -> None:
    result = problems('[{"id": 1, "delay": [-1]}, 3]')
    assert "test 1: name is missing" in result
    assert "test 1: delay[0] is -1; it must lie between 0 and 10" in result
    assert result[-1] == "test 2: it must be an object in braces"
    several = problems(changed(delay=[-1], baud_rate=[9600, 9600], faults={"drop": 1}, name=" ", expected=7))
    assert [problem.removeprefix("test 1: ").split(" is ")[0].split(" must ")[0] for problem in several] == [
        "delay[0]",
        "faults: drop",
        "name",
        "baud_rate[1]",
    ]


@pytest.mark.parametrize("text", ["", "{}", "[]", "nonsense", "[" * 100_000, " " * 1_000_001])
def test_a_document_that_is_no_list_is_refused(text: str) -> None:
    assert len(problems(text)) == 1


def test_500_cells_are_run_and_501_are_not() -> None:
    delays = [number / 1000 for number in range(501)]
    test = {"baud_rate": [9600], "arduinodelay": [0]}
    assert len(read_document(changed(delay=delays[:500], **test))[0].cells) == 500
    assert "at most 500" in problems(changed(delay=delays, **test))[0]
    assert (
        "has 510 cells"
        in problems(changed(delay=delays[:102], arduinodelay=[0], baud_rate=[300, 600, 1200, 2400, 4800]))[0]
    )


@pytest.mark.parametrize(
    ("baud", "made"), [(115200, 117647), (250000, 250000), (500000, 500000), (57600, 58824), (300, 300)]
)
def test_the_actual_speed_of_the_chip_for_a_baud_rate(baud: int, made: int) -> None:
    assert round(chip_baud(baud)) == made
