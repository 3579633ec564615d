"""`python -m server.openapi`: writes the OpenAPI document of the HTTP interface to standard output.

With `--reference` it writes the reference of the HTTP interface and of robot.toml instead, in docs/reference;
with `--reference --check` it only compares these pages.
"""

import argparse
import json
import sys
from pathlib import Path

from server.app import create_app
from server.configuration_page import configuration_page
from server.http.reference import http_page
from server.platform.settings import DataFolder, Settings

SOURCES = Path(__file__).resolve().parents[1]


def main() -> int:
    """Write the document, always in the same order.

    Return the exit status: 1 where `--check` finds a change.
    """
    parser = argparse.ArgumentParser(prog="python -m server.openapi", description=__doc__)
    parser.add_argument("--reference", action="store_true", help="write the pages of the reference")
    parser.add_argument("--check", action="store_true", help="write nothing; fail if the page is not current")
    options = parser.parse_args()
    everything = Settings(data=DataFolder(Path("data")), config=Path("robot.toml"), every_feature=True)
    app = create_app(everything)
    document = app.openapi()
    if options.reference:
        pages = {
            "docs/reference/http.md": http_page(document),
            "docs/reference/configuration.md": configuration_page(
                (SOURCES / "robot.toml").read_text("utf-8")
            ),
        }
        return max(_write(SOURCES / name, text, only_check=options.check) for name, text in pages.items())
    json.dump(document, sys.stdout, indent=2, sort_keys=True, ensure_ascii=False)
    sys.stdout.write("\n")
    return 0


def _write(page: Path, text: str, *, only_check: bool) -> int:
    """Write a page, or report that it is not current. Return the exit status."""
    if not only_check:
        page.write_text(text, encoding="utf-8")
    elif not page.is_file() or page.read_text(encoding="utf-8") != text:
        print(f"{page.name} is not current: run `make generate` and commit it")  # noqa: T201
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
