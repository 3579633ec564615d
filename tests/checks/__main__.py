"""`python -m tests.checks`: every check of the repository; exit status 1 with a line for each problem."""

import gc
import sys
from collections.abc import Callable
from pathlib import Path

from tests.checks.changelog import find_changelog_problems
from tests.checks.fan_out import find_crowded_modules
from tests.checks.links import find_dead_links
from tests.checks.names import find_bad_names
from tests.checks.pictures import find_foreign_photographs, find_needless_pictures
from tests.checks.topics import find_compared_names
from tests.checks.version import find_other_versions
from tests.checks.words import find_needless_words

ROOT = Path(__file__).parents[2]
CHECKS: tuple[Callable[[Path], list[str]], ...] = (
    find_changelog_problems,
    find_bad_names,
    find_crowded_modules,
    find_dead_links,
    find_needless_pictures,
    find_foreign_photographs,
    find_other_versions,
    find_compared_names,
    find_needless_words,
)


def main() -> int:
    """Run all checks."""
    # Syntax trees stay to the end: looking through them for garbage would take most of the time.
    gc.disable()
    problems = [problem for check in CHECKS for problem in check(ROOT)]
    for problem in problems:
        print(problem)  # noqa: T201 - it is run from a shell
    return 1 if problems else 0


if __name__ == "__main__":
    sys.exit(main())
