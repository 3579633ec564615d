from pathlib import Path

import pytest

from tests.checks.links import anchors, find_dead_links


@pytest.mark.parametrize(
    ("link", "reason"),
    [
        ("[a](gone.md)", "docs/page.md: gone.md leads to no file"),
        ("![a](gone.png)", "docs/page.md: gone.png leads to no file"),
        ("[a](other.md#gone)", "docs/page.md: other.md#gone names no heading of that page"),
        ("[a](#gone)", "docs/page.md: #gone names no heading of that page"),
        ("[a](../code.py)", "docs/page.md: ../code.py leads out of docs/, which the help pages do not have"),
        ("`server/gone.py`", "docs/page.md: there is no server/gone.py"),
        ("[a](../../etc)", "docs/page.md: ../../etc leads to no file"),
    ],
)
def test_a_dead_link_is_found(tmp_path: Path, link: str, reason: str) -> None:
    write_pages(tmp_path, link)
    assert find_dead_links(tmp_path) == [reason]


@pytest.mark.parametrize(
    "text",
    [
        "[a](other.md)",
        "[a](other.md#two-words-i2c)",
        "[a](#page)",
        "[a](https://example.org/gone)",
        "`[a](gone.md)`",
        "```\n[a](gone.md)\n```",
    ],
)
def test_a_link_that_leads_somewhere_is_none(tmp_path: Path, text: str) -> None:
    write_pages(tmp_path, text)
    assert find_dead_links(tmp_path) == []


def test_a_heading_within_a_block_of_code_is_no_anchor() -> None:
    assert anchors("# One\n```sh\n# two\n```\n") == {"one"}


def write_pages(root: Path, text: str) -> None:
    (root / "docs").mkdir()
    (root / "code.py").write_text("")
    (root / "docs/page.md").write_text(f"# Page\n\n{text}\n")
    (root / "docs/other.md").write_text("# Other\n\n## Two words: `I2C`\n")
