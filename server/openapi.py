"""`python -m server.openapi`: writes the OpenAPI document of the HTTP interface to standard output.

With `--reference` it writes the reference of the HTTP interface and of robot.toml instead, in docs/reference,
and the tables of a new database, in migrations; with `--reference --check` it only compares these files.
"""

import argparse
import json
import sys
from pathlib import Path

from server.app import create_app
from server.configuration_page import configuration_page
from server.http.reference import http_page
from server.platform.schema import write_schema
from server.platform.settings import DataFolder, Settings

SOURCES = Path(__file__).resolve().parents[1]


def main() -> int:
    """Write the document, always in the same order.

    Return the exit status: 1 where `--check` finds a change.
    """
    parser = argparse.ArgumentParser(prog="python -m server.openapi", description=__doc__)
    parser.add_argument("--reference", action="store_true", help="write the files, not the document")
    parser.add_argument("--check", action="store_true", help="write nothing; fail if a file is not current")
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
            "migrations/schema.sql": write_schema(),
        }
        return max(_write(SOURCES / name, text, only_check=options.check) for name, text in pages.items())
    json.dump(document, sys.stdout, indent=2, sort_keys=True, ensure_ascii=False)
    sys.stdout.write("\n")
    return 0


def _write(file: Path, text: str, *, only_check: bool) -> int:
    """Write a file, or report that it is not current. Return the exit status."""
    if not only_check:
        file.write_text(text, encoding="utf-8")
    elif not file.is_file() or file.read_text(encoding="utf-8") != text:
        print(f"{file.name} is not current: run `make generate` and commit it")  # noqa: T201
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
