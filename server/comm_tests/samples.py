"""Runs that come with the program: the thesis's grid as this version's authors measured it.

Each file is what `mucat commtest export --format json` writes; its name is the sample's.
"""

import json
import logging
from collections.abc import Mapping
from importlib.resources import files
from typing import Any

from pydantic import ValidationError

from server.comm_tests.runs import Runs
from server.models import CommTestCell, CommTestRun

log = logging.getLogger(__name__)


async def import_samples(runs: Runs) -> None:
    """Store those that are not there yet. One that cannot be read is left out. Raises StoreError."""
    there = {run.sample for run in runs.list()}
    for file in sorted(
        files(__name__.rpartition(".")[0]).joinpath("samples").iterdir(), key=lambda one: one.name
    ):
        name, dot, suffix = file.name.rpartition(".")
        if not dot or suffix != "json" or name in there:
            continue
        try:
            run, cells = read_sample(json.loads(file.read_text(encoding="utf-8")))
        except (ValueError, KeyError, TypeError) as problem:
            log.warning("the sample run %s cannot be read: %s", file.name, problem)
            continue
        await runs.add_sample(run | {"sample": name}, cells)


def read_sample(whole: Mapping[str, Any]) -> tuple[dict[str, Any], list[dict[str, Any]]]:
    """A run's columns and those of its cells. Raises ValueError, KeyError, TypeError where they are not all
    there.
    """
    texts = {name: json.dumps(whole[name], ensure_ascii=False) for name in ("document", "tools")}
    try:
        run = CommTestRun.model_validate({**whole, **texts, "cells": len(whole["cells"])})
        cells = [CommTestCell.model_validate({**cell, "run_id": 0}) for cell in whole["cells"]]
    except ValidationError as problem:
        raise ValueError(str(problem)) from problem
    values = run.model_dump(exclude={"id"})
    return values, [cell.model_dump(exclude={"id", "run_id"}) for cell in cells]
