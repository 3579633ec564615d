"""`python -m server.openapi`: the description of the HTTP interface, for whoever generates types from it."""

import json
import sys
from pathlib import Path

from server.app import create_app
from server.platform.settings import DataFolder, Settings


def main() -> None:
    """Write the document to standard output, always in the same order."""
    app = create_app(Settings(data=DataFolder(Path("data")), config=Path("robot.toml")))
    json.dump(app.openapi(), sys.stdout, indent=2, sort_keys=True, ensure_ascii=False)
    sys.stdout.write("\n")


if __name__ == "__main__":
    main()
