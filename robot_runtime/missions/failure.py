"""The step that failed a mission, found in the states of its steps."""

from collections.abc import Sequence

from robot_runtime.contract.documents import MissionStepState


def find_failed(steps: Sequence[MissionStepState]) -> MissionStepState | None:
    """Return the step by which the first of these failed; None where that has not failed.

    `steps` are all of a mission, in the document's order. A failure that a `try` or a `first_of` has passed
    over is another one.
    """
    failed = None
    candidate = steps[0] if steps and steps[0].status == "failed" else None
    while candidate is not None:
        failed = candidate
        # A step with words failed by itself, as a timeout does, whatever is below it.
        candidate = None if failed.text else _find_below(failed, steps)
    return failed


def _find_below(step: MissionStepState, steps: Sequence[MissionStepState]) -> MissionStepState | None:
    below = [
        child
        for child in steps[1:]
        if child.status == "failed" and child.path.rpartition(".")[0] == step.path
    ]
    return below[-1] if below else None
