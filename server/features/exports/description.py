"""`session.json`: everything about a session except its samples; and the names of exported files."""

import json
import re
from collections.abc import Sequence
from datetime import UTC, datetime
from typing import Any

from sqlmodel import col, select

from server.features.exports.zip_stream import ZipWriter
from server.library.content import Recording
from server.library.crafts import RecordedCraft, read_crafts
from server.platform.models import BookmarkRow, Gap, SessionTag
from server.platform.store import Reader


def describe_session(store: Reader, recording: Recording) -> dict[str, Any]:
    """Return the session as a JSON object; bookmarks and gaps in s since its start. Raise StoreError."""
    row = recording.row
    with store.read() as database:
        gaps = database.exec(select(Gap).where(Gap.session_id == row.id).order_by(col(Gap.id))).all()
        bookmarks = database.exec(
            select(BookmarkRow).where(BookmarkRow.session_id == row.id).order_by(col(BookmarkRow.time))
        )
        tags = database.exec(select(SessionTag.tag).where(SessionTag.session_id == row.id))
        marks = [
            {"time": bookmark.time - row.started_steady, "text": bookmark.text, "made": _iso(bookmark.made)}
            for bookmark in bookmarks
        ]
        names = sorted(tags)
    plain = row.model_dump(exclude={"started", "ended", "deleted", "kept", "robot_state", "topics"})
    return {
        **plain,
        "started": _iso(row.started),
        "ended": None if row.ended is None else _iso(row.ended),
        "tags": names,
        "marks": marks,
        "gaps": [
            {
                "topic": gap.topic,
                "kind": gap.kind,
                "time": gap.time - row.started_steady,
                "missed": gap.missed,
            }
            for gap in gaps
        ],
        "robot_state": json.loads(row.robot_state),
        "topics": recording.topics,
    }


def dump_readable(described: dict[str, Any]) -> str:
    """Return the object as indented JSON."""
    return json.dumps(described, indent=2, ensure_ascii=False) + "\n"


def craft_files(crafts: Sequence[RecordedCraft]) -> list[tuple[str, str]]:
    """Return names and texts of craft files."""
    names = ["craft.toml", *(f"craft-{number}.toml" for number in range(2, len(crafts) + 1))]
    return [(name, craft.file) for name, craft in zip(names, crafts, strict=False)]


def write_about(store: Reader, recording: Recording, packing: ZipWriter) -> None:
    """Write `session.json` and the session's craft files. Raise StoreError, RecordingError."""
    packing.text("session.json", dump_readable(describe_session(store, recording)))
    for name, text in craft_files(read_crafts(recording)):
        packing.text(name, text)


def file_name(recording: Recording, ending: str) -> str:
    """Return the name of a session's file: its start and name, in characters of every file system."""
    started = datetime.fromtimestamp(recording.row.started, UTC)
    slug = re.sub(r"[^A-Za-z0-9]+", "-", recording.row.name).strip("-")[:50].strip("-")
    return f"{started:%Y-%m-%d_%H-%M-%S}_{slug or recording.row.id}{ending}"


def _iso(time: float) -> str:
    return datetime.fromtimestamp(time, UTC).isoformat().replace("+00:00", "Z")
