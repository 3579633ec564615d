"""The check of how many modules one imports."""

from pathlib import Path

import pytest

from tests.checks.fan_out import IMPORTS_MAX, find_crowded_modules


def _make_modules(root: Path) -> None:
    (root / "server/http").mkdir(parents=True)
    for number in range(IMPORTS_MAX + 1):
        (root / f"server/http/part{number}.py").touch()


@pytest.mark.parametrize(
    ("line", "more"),
    [
        ("from server.http import part{}", "import click\nfrom server.http.part0 import A, B\n"),
        ("import server.http.part{}", "from collections import abc\n"),
        ("def load():\n    from server.http.part{} import A", ""),
    ],
)
def test_a_module_imports_at_most_twenty_of_ours(tmp_path: Path, line: str, more: str) -> None:
    _make_modules(tmp_path)
    path = tmp_path / "server/app.py"
    path.write_text(more + "\n".join(line.format(number) for number in range(IMPORTS_MAX)))
    assert find_crowded_modules(tmp_path) == []
    path.write_text(path.read_text() + "\n" + line.format(IMPORTS_MAX))
    [problem] = find_crowded_modules(tmp_path)
    assert problem.startswith(f"server/app.py: imports {IMPORTS_MAX + 1} modules")
