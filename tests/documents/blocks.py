"""Code blocks of a page, and their changes to files.

A block with a title is a new file, or what is added at the end of a file. A `diff` block with a title changes
a file: its lines without `+` are searched for, and replaced by its lines without `-`.
"""

import re
from dataclasses import dataclass
from pathlib import Path

DOCS = Path(__file__).parents[2] / "docs"
_BLOCK = re.compile(r'^( *)```(\w+)(?: title="([^"]+)")?\n(.*?)^\1```$', re.MULTILINE | re.DOTALL)


@dataclass(frozen=True)
class CodeBlock:
    """One block of code; `title` names a file of the repository, or is empty."""

    language: str
    title: str
    text: str


def read_blocks(page: str) -> list[CodeBlock]:
    """Return the blocks of a page of docs/, in their order."""
    text = (DOCS / page).read_text(encoding="utf-8")
    return [
        CodeBlock(language, title or "", re.sub(rf"^{indent}", "", code, flags=re.MULTILINE))
        for indent, language, title, code in _BLOCK.findall(text)
    ]


def read_commands(page: str) -> list[str]:
    """Return the lines of a page's `sh` blocks."""
    return [line for block in read_blocks(page) if block.language == "sh" for line in block.text.splitlines()]


def apply(block: CodeBlock, tree: Path) -> None:
    """Carry out a block with a title. Raise ValueError where a diff does not fit exactly one place."""
    file = tree / block.title
    if block.language != "diff":
        before = file.read_text(encoding="utf-8") if file.exists() else ""
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(before + ("\n\n" if before else "") + block.text, encoding="utf-8")
        return
    lines = block.text.splitlines()
    old = "".join(line[1:] + "\n" for line in lines if not line.startswith("+"))
    new = "".join(line[1:] + "\n" for line in lines if not line.startswith("-"))
    text = file.read_text(encoding="utf-8")
    if text.count(old) != 1:
        raise ValueError(f"{block.title}: the page's lines occur {text.count(old)} times:\n{old}")
    file.write_text(text.replace(old, new), encoding="utf-8")
