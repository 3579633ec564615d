"""Adoptions: twice, beside a configuration that was edited, beside a resting simulator; a worse fit."""

import asyncio
import sys
from dataclasses import replace
from typing import Any, cast

import pytest

from robot_runtime.contract.commands import ControllerCommand
from server.features.identification.adoption import CraftAdoption
from server.features.identification.schemas import describe_improvement
from server.platform.settings import Settings
from server.processes.managed_process import ProcessCommand
from server.processes.supervisor import SIMULATION_ELSEWHERE, ProcessSupervisor
from tests.server.serving import serve

LIGHT = 'title = "Light"\n[craft]\nmass = 2.5\n'
HEAVY = 'title = "Heavy"\n[craft]\nmass = 3.1\n'


def test_a_fit_that_predicts_worse_is_not_called_better() -> None:
    assert describe_improvement(12.04) == "12.0 times better"
    assert describe_improvement(0.5) == "2.0 times worse"


class DisarmedRobot:
    """A disarmed robot without a simulator of its own; records the gains that it gets."""

    def __init__(self) -> None:
        self.gains: list[dict[str, float]] = []

    def state(self) -> dict[str, Any]:
        return {"armed": False}

    def get(self, _: str) -> None:
        return None

    async def command(self, _: str, command: ControllerCommand) -> None:
        self.gains.append(dict(command.gains))


@pytest.fixture
def robot() -> DisarmedRobot:
    return DisarmedRobot()


@pytest.fixture
def adoption(settings: Settings, robot: DisarmedRobot) -> CraftAdoption:
    part = cast(Any, robot)
    return CraftAdoption(settings, part, part, part)


async def test_a_second_adoption_of_the_same_craft_leaves_the_one_before_to_be_restored(
    settings: Settings, adoption: CraftAdoption
) -> None:
    await adoption.adopt(LIGHT, "")
    await adoption.adopt(HEAVY, "")
    assert await adoption.adopt(HEAVY, "") == ["Nothing: it is the craft in force."]
    assert settings.data.craft.read_text() == HEAVY
    await adoption.undo("")
    assert settings.data.craft.read_text() == LIGHT


def test_an_adoption_follows_the_configuration_in_force_and_not_its_file(
    settings: Settings, robot: DisarmedRobot
) -> None:
    part = cast(Any, robot)
    in_force = "[control.gains.predictive]\nthrust = 0.3\n"
    adoption = CraftAdoption(replace(settings, config_text=in_force), part, part, part)
    settings.config.write_text("[control]\nrate = 0\n")
    asyncio.run(adoption.adopt(HEAVY, ""))
    (gains,) = robot.gains
    assert "thrust" not in gains
    assert "drag" in gains


@pytest.mark.parametrize(
    ("why", "restart"), [(SIMULATION_ELSEWHERE, True), ("The emulated robot lies on a workbench.", False)]
)
async def test_only_a_simulator_on_another_computer_must_be_started_again(
    settings: Settings, why: str, restart: bool
) -> None:
    asleep = (sys.executable, "-c", "import time; time.sleep(600)")

    simulator = ProcessCommand("simulator", "simulator", asleep)
    async with serve(replace(settings, robot=replace(settings.robot, mode="hil")), [simulator]) as served:
        await served.get(ProcessSupervisor).pause("simulator", why)
        effects = " ".join(await served.get(CraftAdoption).adopt(HEAVY, ""))
        assert ("must be started again with this craft" in effects) == restart
        assert "was started again" not in effects
