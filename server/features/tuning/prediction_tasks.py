"""The tasks of the predicting process, and their answers."""

import json
import traceback
from collections.abc import Iterable
from pathlib import Path
from typing import Any

from robot_runtime.config import craft_document_in
from robot_runtime.contract.limits import ConfigError
from robot_runtime.errors import RefusedError
from robot_runtime.experiments.scenario.boards import boards
from robot_runtime.link.link_driver import PortError
from robot_runtime.simulation.boards.emulator_process import BoardError
from server.features.tuning.prediction import predict_step
from server.features.tuning.schemas import PredictionQuery
from server.processes.task_process import write_answer


def answer_all(craft: Path, tasks: Iterable[bytes]) -> None:
    """Answer each task, a line of JSON, on the standard output; `craft` is the craft's file."""
    for line in tasks:
        write_answer(*_answer(craft, json.loads(line)))


def _answer(craft: Path, task: dict[str, Any]) -> tuple[int, bytes]:
    try:
        query = PredictionQuery.model_validate(task["query"])
        prediction = predict_step(query, task["control"], craft_document_in(craft), boards()["host"])
    except (BoardError, PortError) as problem:
        return 503, f"The step cannot be predicted: {problem}".encode()
    except (ConfigError, RefusedError, ValueError) as problem:
        return 422, f"The step cannot be predicted: {problem}".encode()
    except Exception as problem:
        # Whatever it is, the server says it, and the next task is answered.
        traceback.print_exc()
        why = f"The step cannot be predicted: {type(problem).__name__}: {problem}"
        return 503, why.encode(errors="replace")
    return 200, prediction.model_dump_json().encode()
