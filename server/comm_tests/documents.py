"""The test documents that come with the program."""

import json
from importlib.resources import files

from robot_runtime.comm_test.builder import SKETCHES
from server.comm_tests.shapes import TestDocument

THESIS = SKETCHES / "comm_test/figure10.json"
READY_MADE = ("quick", "plain", "robot", "both-ways", "noisy-line")


def shipped_documents() -> list[TestDocument]:
    """All of them, the thesis's own example (Figure 10) first."""
    texts = {"figure10": THESIS.read_text(encoding="utf-8")}
    folder = files("server.comm_tests") / "documents"
    texts |= {name: (folder / f"{name}.json").read_text(encoding="utf-8") for name in READY_MADE}
    return [
        TestDocument(name=name, title=json.loads(text)[0]["name"], text=text) for name, text in texts.items()
    ]
