"""The step that failed a mission, found in the states of its steps."""

from collections.abc import Sequence

from robot_runtime.contract.documents import MissionStepState


def find_failed(steps: Sequence[MissionStepState]) -> MissionStepState | None:
    """Returns the step by which the first of these failed; None where that has not failed.

    `steps` are all of a mission, in the document's order. A failure that a `try` or a `first_of` has passed
    over is another one.
    """
    failed = None
    found = steps[0] if steps and steps[0].status == "failed" else None
    while found is not None:
        failed = found
        # A step with words failed by itself, as a timeout does, whatever is below it.
        found = None if failed.text else _find_below(failed, steps)
    return failed


def _find_below(step: MissionStepState, steps: Sequence[MissionStepState]) -> MissionStepState | None:
    below = [one for one in steps[1:] if one.status == "failed" and one.path.rpartition(".")[0] == step.path]
    return below[-1] if below else None
