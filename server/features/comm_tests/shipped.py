"""Test documents and measured runs that ship with the program."""

import json
import logging
from collections.abc import Iterator, Mapping
from importlib.resources import files
from importlib.resources.abc import Traversable
from typing import Any

from robot_runtime.experiments.comm_test.builder import SKETCHES
from server.features.comm_tests.runs import CommTestStore
from server.features.comm_tests.schemas import TestDocument
from server.platform.models import CommTestCell, CommTestRun

log = logging.getLogger(__name__)

THESIS = SKETCHES / "comm_test/figure10.json"
"""Beside its sketch; missing in an installation without the firmware's sources."""
DOCUMENTS = {
    "figure10": "The thesis's own example (Figure 10)",
    "plain": "The thesis's grid with plain numbers (Table 5)",
    "robot": "The thesis's grid over the robot's own link",
    "both-ways": "Both ways at once over the robot's own link",
    "noisy-line": "A line with errors: plain numbers, the thesis's packets, the robot's own link",
    "quick": "Quick: three bauds over the robot's own link",
}


def shipped_documents() -> list[TestDocument]:
    """Return the shipped documents, the thesis's own example first."""
    folder = files(__package__) / "documents"
    sources = {name: THESIS if name == "figure10" else folder / f"{name}.json" for name in DOCUMENTS}
    return [
        TestDocument(name=name, title=DOCUMENTS[name], text=source.read_text(encoding="utf-8"))
        for name, source in sources.items()
        if source.is_file()
    ]


async def import_samples(runs: CommTestStore, folder: Traversable | None = None) -> None:
    """Store the missing sample runs; unreadable ones are left out. Raise StoreError.

    Each file is what `mucat commtest export --format json` writes; its name is the sample's.
    """
    there = {run.sample for run in runs.list()}
    for name, file in _samples(folder or files(__package__) / "samples"):
        if name in there:
            continue
        try:
            run, cells = _read_sample(json.loads(file.read_text(encoding="utf-8")))
        except (OSError, ValueError, KeyError, TypeError, RecursionError) as problem:
            log.warning("the sample run %s cannot be read: %s", file.name, problem)
            continue
        await runs.add_sample(run | {"sample": name}, cells)


def _samples(folder: Traversable) -> Iterator[tuple[str, Traversable]]:
    for file in sorted(folder.iterdir(), key=lambda path: path.name):
        name, dot, suffix = file.name.rpartition(".")
        if dot and suffix == "json":
            yield name, file


def _read_sample(whole: Mapping[str, Any]) -> tuple[dict[str, Any], list[dict[str, Any]]]:
    """Return a run's columns and those of its cells. Raise ValueError, KeyError, TypeError."""
    texts = {name: json.dumps(whole[name], ensure_ascii=False) for name in ("document", "tools")}
    run = CommTestRun.model_validate({**whole, **texts, "cells": len(whole["cells"])})
    cells = [CommTestCell.model_validate({**cell, "run_id": 0}) for cell in whole["cells"]]
    return run.model_dump(exclude={"id"}), [cell.model_dump(exclude={"id", "run_id"}) for cell in cells]
