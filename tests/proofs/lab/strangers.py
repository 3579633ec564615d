"""Strangers on the lab's network: none may get in."""

import json
import sys
from pathlib import Path

from robot_runtime.transport.network import AUTHORITY
from tests.proofs.lab.network import LabComputer
from tests.proofs.lab.whole_lab import WholeLab


def refuse_strangers(whole: WholeLab, stranger: LabComputer, folder: Path) -> None:
    """Run all tries of `tests.proofs.lab.stranger` on a stranger's computer."""
    arguments = [whole.lab.computer.address, whole.swimmers[0].computer.address]
    arguments += [str(whole.lab.data.zenoh / AUTHORITY), str(folder)]
    tried = stranger.run(sys.executable, "-m", "tests.proofs.lab.stranger", *arguments)
    whole.report.check(tried.returncode == 0, tried.stderr[-2000:])
    answers: dict[str, str] = json.loads(tried.stdout or "{}")
    for what, answer in answers.items():
        whole.report.check(bool(answer), f"a stranger got in: {what}")
        whole.report.facts[f"stranger: {what}"] = answer[:160]
    for robot in whole.swimmers:
        whole.report.check(robot.is_armed, f"a stranger stopped {robot.computer.name}")
