"""The page's links into the help: each leads to an existing chapter and heading."""

import re

from tests.checks.links import anchors
from tests.documents.blocks import DOCS

PAGE = DOCS.parent / "frontend/src"


def test_every_page_links_to_a_chapter_that_exists() -> None:
    table = (PAGE / "shell/help.ts").read_text(encoding="utf-8")
    chapters = re.findall(r"^  '?[\w/-]+'?: '(.*)',$", table, re.MULTILINE)
    assert len(chapters) >= 10
    for file in PAGE.rglob("*.svelte"):
        chapters += re.findall(r'href="/help/([^"]*)"', file.read_text(encoding="utf-8"))
    for chapter in chapters:
        path, _, anchor = chapter.partition("#")
        page = DOCS / (path.rstrip("/") + ".md" if path else "index.md")
        assert page.is_file(), chapter
        assert not anchor or anchor in anchors(page.read_text(encoding="utf-8")), chapter
