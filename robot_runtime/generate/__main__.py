"""`python -m robot_runtime.generate`: write every generated file; with --check only say which differ."""

import argparse
import sys
from pathlib import Path

from robot_runtime.generate import cpp, hardware, json_schema, reference, typescript
from robot_runtime.generate.craft import craft_page
from robot_runtime.generate.hull import hull_page
from robot_runtime.generate.missions import missions_page
from robot_runtime.generate.mistakes import mistakes_page
from robot_runtime.generate.trim import trim_page

SOURCES = Path(__file__).resolve().parents[2]
ROOT = SOURCES
"""The folder of the generated files."""


def main() -> int:
    """Write the files. Return the exit status: 1 where --check finds a file that is not current."""
    parser = argparse.ArgumentParser(prog="python -m robot_runtime.generate", description=__doc__)
    parser.add_argument(
        "--check", action="store_true", help="write nothing; fail where a file is not current"
    )
    only_check = parser.parse_args().check
    files = {
        "firmware/src/packets.gen.h": cpp.header(),
        "firmware/emulator/calibration.gen.h": cpp.calibration(),
        "firmware/src/parameters.gen.h": cpp.parameters(),
        "robot_runtime/contract/packets/packets.schema.json": json_schema.schema(),
        "robot_runtime/contract/published_events.schema.json": json_schema.event_schema(),
        "frontend/src/generated/topics.ts": typescript.module(),
        "docs/reference/commands.md": reference.commands_page(),
        "docs/reference/craft.md": craft_page(),
        "docs/reference/events.md": reference.events_page(),
        "docs/reference/faults.md": reference.faults_page(),
        "docs/reference/missions.md": missions_page(),
        "docs/reference/mistakes.md": mistakes_page(),
        "docs/reference/packets.md": reference.packets_page(),
        "docs/reference/parameters.md": reference.parameters_page(),
        "docs/reference/topics.md": reference.topics_page(),
        "docs/run/hardware/hull.md": hull_page(),
        "docs/run/hardware/parts.md": hardware.parts_page(),
        "docs/run/hardware/trim.md": trim_page(),
        "docs/run/hardware/wiring.md": hardware.wiring_page(),
    }
    old = [name for name, text in files.items() if _read(ROOT / name) != text]
    for name in old:
        if only_check:
            print(f"{name} is not current: run `make generate` and commit it")  # noqa: T201
        else:
            (ROOT / name).parent.mkdir(parents=True, exist_ok=True)
            (ROOT / name).write_text(files[name], encoding="utf-8")
    return 1 if only_check and old else 0


def _read(path: Path) -> str | None:
    return path.read_text(encoding="utf-8") if path.exists() else None


if __name__ == "__main__":
    sys.exit(main())
