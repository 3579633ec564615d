"""`python -m tests.proofs`: the proofs of the link at full length; status 1 where one fails."""

import sys

from tests.proofs import corruption, resets

FRAMES = 10_500_000
RESETS = 1000


def main() -> int:
    """Exit status."""
    print(f"{FRAMES} corrupted frames through each end's decoder ...", flush=True)
    counts = corruption.measure_all(FRAMES)
    print(corruption.table(counts))
    print(f"\n{RESETS} resets of either side ...", flush=True)
    report = resets.measure_all(RESETS)
    print(report.table())
    undetected = sum(number.undetected for number in counts.values())
    return 1 if undetected or report.problems else 0


if __name__ == "__main__":
    sys.exit(main())
