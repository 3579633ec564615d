"""The test document: the thesis's own runs, and every mistake is told where it is."""

import json
from dataclasses import asdict
from pathlib import Path
from typing import Any

import pytest

from robot_runtime.experiments.comm_test.document import CommTest, DocumentError, chip_baud, read_document
from robot_runtime.experiments.comm_test.faults import Faults
from robot_runtime.experiments.comm_test.results import GridCell

ROOT = Path(__file__).resolve().parents[4]
THESIS = (ROOT / "firmware/examples/comm_test/figure10.json").read_text()


def changed(**changes: Any) -> str:
    (entry,) = json.loads(THESIS)
    return json.dumps([entry | changes])


def problems(text: str) -> list[str]:
    with pytest.raises(DocumentError) as refused:
        read_document(text)
    return refused.value.problems


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
def test_halves_of_characters_are_refused(changes: dict[str, Any]) -> None:
    assert "surrogates not allowed" in problems(changed(**changes))[0]


def test_the_documents_print_the_example_that_ships() -> None:
    assert f"```json\n{THESIS}```" in (ROOT / "docs/use/comm-tests.md").read_text()


@pytest.mark.parametrize("path", ["comm_test/comm_test.ino", "/comm_test/comm_test.ino"])
def test_the_sketch_s_own_path_framing_and_direction(path: str) -> None:
    (test,) = read_document(changed(ino_path=path, framing="plain", direction="both"))
    assert (test.framing, test.direction) == ("plain", "both")


def test_faults_are_read_and_what_was_stored_can_be_read_again() -> None:
    wanted = {"seed": 7, "bit_errors": 1e-3, "insert": 0.1, "burst": [1e-4, 20], "stall": [2, 0.25]}
    (test,) = read_document(changed(faults=wanted))
    assert test.faults == Faults(seed=7, bit_errors=1e-3, insert=0.1, burst=(1e-4, 20), stall=(2.0, 0.25))
    assert read_document(json.dumps([asdict(test)])) == [test]
    (clean,) = read_document(THESIS)
    assert clean.faults == Faults()
    assert read_document(json.dumps([asdict(clean)])) == [clean]


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"bauds": [1]}, "bauds: there is no such field"),
        ({"id": "1"}, "id: '1' is not a whole number"),
        ({"id": True}, "id: True is not a whole number"),
        ({"name": " "}, "name: it must be a text"),
        ({"ino_path": "/etc/passwd"}, "ino_path: '/etc/passwd' is not among the sketches"),
        ({"ino_path": "comm_test/../robot/robot.ino"}, "ino_path"),
        ({"ino_path": "/micro_cat_test/arduino/test_6/test_7.ino"}, "ino_path"),
        ({"ino_path": 3}, "ino_path: 3 is not"),
        ({"delay": [0, -0.5]}, "delay[1]: -0.5 is not a delay"),
        ({"delay": [float("nan")]}, "delay[0]: nan"),
        ({"delay": [float("inf")]}, "delay[0]: inf"),
        ({"delay": [False]}, "delay[0]: False"),
        ({"delay": [11]}, "delay[0]: 11"),
        ({"delay": []}, "delay: it must be a list of one or more"),
        ({"delay": 0.5}, "delay: it must be a list of one or more"),
        ({"arduinodelay": [0.5, "1"]}, "arduinodelay[1]: '1' is not a delay"),
        ({"arduinodelay": [0.5, 0.5]}, "arduinodelay[1]: 0.5 is there twice"),
        ({"baud_rate": []}, "baud_rate: it must be a list"),
        ({"baud_rate": [9600, 230400]}, "baud_rate[1]: the chip at 16 MHz makes 222222 of it, -3.5%"),
        ({"baud_rate": [0]}, "baud_rate[0]: 0 is not a baud rate"),
        ({"baud_rate": [9600.0]}, "baud_rate[0]: 9600.0 is not a baud rate"),
        ({"baud_rate": [100]}, "baud_rate[0]: the chip at 16 MHz cannot make it"),
        ({"baud_rate": [9600, 9600]}, "baud_rate[1]: 9600 is there twice"),
        ({"from_val": -1}, "from_val: -1 is not a whole number from 0 to 32767"),
        ({"to_val": 40000}, "to_val: 40000 is not a whole number from 1 to 32768"),
        ({"to_val": 1}, "to_val: 1 must be above from_val, 1"),
        ({"to_val": 20000}, "to_val: 20000 must be above from_val, 1, by 1 to 5000"),
        ({"expected": 99}, "expected: 99 numbers, but from_val 1 up to, and without, to_val 101 are 100"),
        ({"framing": "morse"}, "framing: 'morse' must be one of plain, thesis, robot"),
        ({"framing": "robot", "baud_rate": [600]}, "baud_rate[0]: 600 is not a baud rate of this framing"),
        ({"framing": ["plain"]}, "framing: ['plain'] must be one of"),
        ({"direction": "up"}, "direction: 'up' must be one of to_board, to_host, both"),
        ({"faults": 3}, "faults: it must be an object in braces"),
        ({"faults": {"noise": 1}}, "faults.noise: there is no such fault; known are seed, bit_errors"),
        ({"faults": {"seed": -1}}, "faults.seed: -1 is not a whole number"),
        ({"faults": {"seed": 1.0}}, "faults.seed: 1.0 is not a whole number"),
        ({"faults": {"bit_errors": 0.2}}, "faults.bit_errors: 0.2 is not a rate from 0 to 0.1"),
        ({"faults": {"drop": "1"}}, "faults.drop: '1' is not a rate"),
        ({"faults": {"double": True}}, "faults.double: True is not a rate"),
        ({"faults": {"insert": float("nan")}}, "faults.insert: nan is not a rate"),
        ({"faults": {"burst": 0.1}}, "faults.burst: it must be a list of two numbers, a rate and a length"),
        ({"faults": {"burst": [0.11, 8]}}, "faults.burst[0]: 0.11 is not a rate"),
        ({"faults": {"burst": [0.1, 0]}}, "faults.burst[1]: 0 is not a whole number of bits"),
        ({"faults": {"burst": [0.1, 1.5]}}, "faults.burst[1]: 1.5 is not a whole number of bits"),
        ({"faults": {"stall": [1]}}, "faults.stall: it must be a list of two numbers, how often"),
        ({"faults": {"stall": [0, 0.1]}}, "faults.stall[0]: 0 is not a time from 0.05 to 3600 seconds"),
        (
            {"faults": {"stall": [2, 2]}},
            "faults.stall[1]: 2 is not a time above 0 and below faults.stall[0], 2",
        ),
        ({"faults": {"cut": [2, 0]}}, "faults.cut[1]: 0 is not a time"),
        ({"faults": {"cut": [2, "1"]}}, "faults.cut[1]: '1' is not a time"),
        ({"framing": "plain", "to_val": 256, "expected": 255}, "to_val: 256 is not a whole number"),
    ],
)
def test_a_mistake_is_told_where_it_is(changes: dict[str, Any], words: str) -> None:
    (problem,) = problems(changed(**changes))
    assert problem.startswith(f"test 1: {words}")


def test_all_mistakes_are_told_at_once() -> None:
    found = problems('[{"id": 1, "delay": [-1]}, 3]')
    assert "test 1: name: it is missing" in found
    assert "test 1: delay[0]: -1 is not a delay from 0 to 10 seconds" in found
    assert found[-1] == "test 2: it must be an object in braces"


@pytest.mark.parametrize("text", ["", "{}", "[]", "nonsense", "[" * 100_000, " " * 1_000_001])
def test_what_is_no_list_of_tests(text: str) -> None:
    assert len(problems(text)) == 1


def test_500_cells_are_run_and_501_are_not() -> None:
    delays = [number / 1000 for number in range(501)]
    one = {"baud_rate": [9600], "arduinodelay": [0]}
    assert len(read_document(changed(delay=delays[:500], **one))[0].cells) == 500
    assert "at most 500" in problems(changed(delay=delays, **one))[0]
    assert (
        "has 510 cells"
        in problems(changed(delay=delays[:102], arduinodelay=[0], baud_rate=[300, 600, 1200, 2400, 4800]))[0]
    )


@pytest.mark.parametrize(
    ("baud", "made"), [(115200, 117647), (250000, 250000), (500000, 500000), (57600, 58824), (300, 300)]
)
def test_what_the_chip_makes_of_a_baud_rate(baud: int, made: int) -> None:
    assert round(chip_baud(baud)) == made
