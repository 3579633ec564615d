"""The shipped runs are complete."""

import json
from typing import Any

import pytest

from bench.samples import FOLDER, SAMPLES
from robot_runtime.experiments.comm_test.document import read_document
from server.features.comm_tests.reference import GridPlace


def read(name: str) -> dict[str, Any]:
    run: dict[str, Any] = json.loads((FOLDER / f"{name}.json").read_text(encoding="utf-8"))
    return run


def rates(name: str) -> dict[GridPlace, float]:
    cells = read(name)["cells"]
    return {(cell["baud"], cell["arduino_delay"], cell["pi_delay"]): cell["rate"] for cell in cells}


@pytest.mark.parametrize("name", SAMPLES)
def test_a_sample_is_a_complete_run_of_the_grid(name: str) -> None:
    run = read(name)
    framing, direction, _ = SAMPLES[name]
    (test,) = read_document(json.dumps([run["document"]]))
    assert (run["framing"], run["direction"]) == (framing, direction) == (test.framing, test.direction)
    assert list(rates(name)) == [(cell.baud, cell.arduino_delay, cell.pi_delay) for cell in test.cells]
    assert [cell["number"] for cell in run["cells"]] == list(range(75))
    assert all(cell["answered"] for cell in run["cells"])
    assert (run["state"], run["problem"], run["host"]) == ("complete", "", "emulated board")
    tools = {"compiler", "avrdude", "boot loader", "emulated board", "mucat", "python"}
    assert set(run["tools"]) == tools
    assert len({read(other)["firmware"] for other in SAMPLES}) == 1


@pytest.mark.parametrize("name", ["grid-robot", "grid-robot-to-host", "grid-robot-both"])
def test_over_the_robot_s_link_every_number_arrives_in_every_cell(name: str) -> None:
    assert set(rates(name).values()) == {1.0}
    ends = 2 if name.endswith("both") else 1
    assert {cell["right"] for cell in read(name)["cells"]} == {100 * ends}
    assert {cell["out_of_sequence"] for cell in read(name)["cells"]} == {0}
