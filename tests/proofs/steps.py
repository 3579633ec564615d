"""Steps of a proof on an installed computer: lines of shell, and what must come of them."""

import re
import time
from collections.abc import Callable

from tests.documents.blocks import read_blocks
from tests.proofs.container import SystemdContainer

PATIENCE = 90.0
PAGES = ("run/sd-card.md", "run/troubleshoot.md")


class Steps:
    """The steps, each with what it must print or leave."""

    def __init__(self, container: SystemdContainer) -> None:
        self._container = container
        self.failed = 0

    def take(self, name: str, message: str, expected: str, *, status: int = 0) -> None:
        """Run a line of shell, which must end with this status and print what matches."""
        began = time.monotonic()
        result, answer = self._container.order(message)
        good = result == status and re.search(expected, answer) is not None
        self._tell(name, good, time.monotonic() - began, answer)

    def follow(self, title: str, expected: str = "") -> None:
        """Run the lines of the manual's block with this title; the last one must print what matches."""
        (block,) = [block for page in PAGES for block in read_blocks(page) if block.title == title]
        *before, last = block.text.replace("sudo ", "").replace("mucat-*/", "/releases/first/").splitlines()
        for line in before:
            self.take(line, line, "")
        self.take(last, last, expected)

    def wait(self, name: str, condition: Callable[[], bool]) -> None:
        """Wait until something is so."""
        began = time.monotonic()
        patience = PATIENCE * self._container.patience
        while not (good := condition()) and time.monotonic() - began < patience:
            time.sleep(0.2)
        self._tell(name, good, time.monotonic() - began, "it did not come")

    def check(self, name: str, good: bool) -> None:
        """Something that must be so now."""
        self._tell(name, good, 0.0, "it is not")

    def _tell(self, name: str, good: bool, seconds: float, answer: str) -> None:
        self.failed += not good
        last = "" if good else "\n" + answer[-2000:]
        print(f"{'good' if good else 'BAD '} {name} ({seconds:.0f} s){last}", flush=True)

    def runs(self, version: str) -> None:
        """Both services of this version must run, and the server say that it is well."""
        self.wait(f"{version} runs", lambda: self._is_well(version))

    def _is_well(self, version: str) -> bool:
        question = (
            "MUCAT_DATA=/var/lib/mucat MUCAT_CONFIG=/etc/mucat/robot.toml runuser -u mucat --"
            " /opt/mucat/current/bin/python -I -m server.features.installation.survey"
        )
        answer = self._container.order(question)[1]
        return f'"running": "{version}", "problem": ""' in answer


def ask_server(program: str) -> str:
    """Return the line of shell by which the user of the data runs these requests to the server."""
    head = (
        "from pathlib import Path; from server.platform.running_server import ask, send_file;"
        ' from server.platform.settings import DataFolder; data = DataFolder(Path("/var/lib/mucat"))'
    )
    return f"runuser -u mucat -- /opt/mucat/current/bin/python -I -c '{head}{program}'"
