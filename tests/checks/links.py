"""Dead links of README, CONTRIBUTING, CHANGELOG and docs/, and names of source files that do not exist."""

import re
from collections.abc import Iterator
from pathlib import Path
from urllib.parse import unquote

PAGES = ("README.md", "CONTRIBUTING.md", "CHANGELOG.md", "docs/**/*.md")
_FENCE = re.compile(r"^(```|~~~).*?^\1", re.MULTILINE | re.DOTALL)
_CODE = re.compile(r"`[^`\n]*`")
_LINK = re.compile(r"!?\[[^\]]*\]\(([^)\s]+)\)")
_HEADING = re.compile(r"^#+ (.*)$", re.MULTILINE)
_SOURCE = re.compile(r"`((?:robot_runtime|server|frontend|firmware|tests|bench|migrations)/[a-z][\w./-]*)")
_ELSEWHERE = re.compile(r"[a-z]+:")


def find_dead_links(root: Path) -> list[str]:
    """Return one line for each link that leads nowhere: page, target and reason."""
    pages = sorted(page for pattern in PAGES for page in root.glob(pattern))
    return [problem for page in pages for problem in _problems(root, page)]


def _problems(root: Path, page: Path) -> Iterator[str]:
    without_blocks = _FENCE.sub("", page.read_text(encoding="utf-8"))
    for source in _SOURCE.findall(without_blocks):
        if not (root / source).exists() and page.name != "CHANGELOG.md":
            yield f"{page.relative_to(root)}: there is no {source}"
    text = _CODE.sub("", without_blocks)
    for target in _LINK.findall(text):
        if _ELSEWHERE.match(target):
            continue
        name, _, anchor = unquote(target).partition("#")
        goal = (page.parent / name).resolve() if name else page
        where = f"{page.relative_to(root)}: {target}"
        if not goal.is_file() or not goal.is_relative_to(root.resolve()):
            yield f"{where} leads to no file"
        elif page.is_relative_to(root / "docs") and not goal.is_relative_to(root.resolve() / "docs"):
            yield f"{where} leads out of docs/, which the help pages do not have"
        elif anchor and anchor not in anchors(goal.read_text(encoding="utf-8")):
            yield f"{where} names no heading of that page"


def anchors(text: str) -> set[str]:
    """Return the anchors of a page's headings, as GitHub and the help pages make them."""
    headings = _HEADING.findall(_FENCE.sub("", text))
    return {re.sub(r"[^\w\- ]", "", heading.lower()).strip().replace(" ", "-") for heading in headings}
