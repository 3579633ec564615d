"""`session.json`: everything about a session except its samples; and the names of exported files."""

import json
import re
from collections.abc import Sequence
from datetime import UTC, datetime
from typing import Any

from sqlmodel import col, select

from server.features.exports.zip_stream import ZipWriter
from server.features.sessions.crafts import RecordedCraft, read_crafts
from server.features.sessions.recording import Recording
from server.platform.models import BookmarkRow, Gap, SessionTag
from server.platform.store import Reader


def describe_session(store: Reader, recording: Recording) -> dict[str, Any]:
    """The session as a JSON object; times of bookmarks and gaps in s since its start. Raises StoreError."""
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
        words = sorted(tags)
    plain = row.model_dump(exclude={"started", "ended", "deleted", "kept", "robot_state", "topics"})
    return {
        **plain,
        "started": _iso(row.started),
        "ended": None if row.ended is None else _iso(row.ended),
        "tags": words,
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
    """The object as indented JSON."""
    return json.dumps(described, indent=2, ensure_ascii=False) + "\n"


def craft_files(crafts: Sequence[RecordedCraft]) -> list[tuple[str, str]]:
    """Names and texts of craft files."""
    names = ["craft.toml", *(f"craft-{number}.toml" for number in range(2, len(crafts) + 1))]
    return [(name, craft.file) for name, craft in zip(names, crafts, strict=False)]


def write_about(store: Reader, recording: Recording, packing: ZipWriter) -> None:
    """Write `session.json` and the session's craft files. Raises StoreError, RecordingError."""
    packing.text("session.json", dump_readable(describe_session(store, recording)))
    for name, text in craft_files(read_crafts(recording)):
        packing.text(name, text)


def file_name(recording: Recording, ending: str) -> str:
    """The name of a session's file: its start and name, in characters that every file system allows."""
    started = datetime.fromtimestamp(recording.row.started, UTC)
    words = re.sub(r"[^A-Za-z0-9]+", "-", recording.row.name).strip("-")[:50].strip("-")
    return f"{started:%Y-%m-%d_%H-%M-%S}_{words or recording.row.id}{ending}"


def _iso(time: float) -> str:
    return datetime.fromtimestamp(time, UTC).isoformat().replace("+00:00", "Z")
