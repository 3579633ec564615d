"""`python -m server.openapi`: writes the OpenAPI document of the HTTP interface to standard output.

With `--reference` it writes docs/reference/http.md instead; with `--reference --check` it only compares that
page.
"""

import argparse
import json
import sys
from pathlib import Path

from server.app import create_app
from server.http.reference import http_page
from server.platform.settings import DataFolder, Settings

REFERENCE = Path(__file__).resolve().parents[1] / "docs/reference/http.md"


def main() -> int:
    """Write the document, always in the same order. Exit status: 1 where `--check` finds another page."""
    parser = argparse.ArgumentParser(prog="python -m server.openapi", description=__doc__)
    parser.add_argument("--reference", action="store_true", help="write docs/reference/http.md")
    parser.add_argument("--check", action="store_true", help="write nothing; fail if the page is not current")
    options = parser.parse_args()
    app = create_app(Settings(data=DataFolder(Path("data")), config=Path("robot.toml")))
    document = app.openapi()
    if options.reference:
        return _write_reference(http_page(document), only_check=options.check)
    json.dump(document, sys.stdout, indent=2, sort_keys=True, ensure_ascii=False)
    sys.stdout.write("\n")
    return 0


def _write_reference(text: str, *, only_check: bool) -> int:
    if only_check:
        current = REFERENCE.is_file() and REFERENCE.read_text(encoding="utf-8") == text
        if not current:
            print(f"{REFERENCE.name} is not current: run `make generate` and commit it")  # noqa: T201
        return 0 if current else 1
    REFERENCE.write_text(text, encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main())
