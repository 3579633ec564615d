"""`python -m tests.proofs.page`: the manual's table of the proofs, with their last results.

`make proofs` stores each result in results.json beside this module and writes the page anew; `make generate`
writes it from the stored results.
"""

import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TypedDict

from tests.proofs.stages import STAGES, Proof

PAGE, RESULTS = Path("docs/develop/proofs.md"), Path("tests/proofs/results.json")
TEMPLATE = Path(__file__).with_name("proofs.md.in")


class StoredResult(TypedDict):
    """The last result of a proof."""

    held: bool
    minutes: int


def store(target: str, held: bool, seconds: float) -> None:
    """Store a proof's result, and write the page."""
    results = read()
    results[target] = {"held": held, "minutes": round(seconds / 60)}
    RESULTS.write_text(json.dumps(results, indent=2, sort_keys=True) + "\n", encoding="utf-8")
    write()


def read() -> dict[str, StoredResult]:
    """Return the stored results by target."""
    results: dict[str, StoredResult] = json.loads(RESULTS.read_text(encoding="utf-8"))
    return results


def write() -> None:
    """Write the page."""
    proofs = [proof for stage in STAGES for lane in stage for proof in lane.proofs]
    PAGE.write_text(text(proofs, read()), encoding="utf-8")


def text(proofs: Sequence[Proof], results: Mapping[str, StoredResult]) -> str:
    """Return the page."""
    rows = "".join(_row(proof, results.get(proof.target)) for proof in proofs)
    return TEMPLATE.read_text(encoding="utf-8").format(rows=rows)


def _row(proof: Proof, result: StoredResult | None) -> str:
    verdict = "not run" if result is None else "held" if result["held"] else "**failed**"
    minutes = "" if result is None else str(result["minutes"])
    command = " ".join(("make", proof.target, *proof.options))
    return f"| {proof.statement} | {proof.how} | {verdict} | {minutes} | `{command}` |\n"


if __name__ == "__main__":
    write()
