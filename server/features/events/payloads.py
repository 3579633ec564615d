"""Events as JSON."""

import json
from dataclasses import asdict

from robot_runtime.contract.published_events import PublishedEvent


def event_json(event: PublishedEvent) -> bytes:
    """The JSON of an event."""
    return json.dumps(asdict(event), ensure_ascii=False, separators=(",", ":")).encode()
