"""The description of what the live socket sends, for programs of other versions."""

from typing import Literal

from pydantic import Field

from robot_runtime.contract.chunks import describe_topic
from robot_runtime.contract.topics import TOPICS
from server.http.operations import Operations
from server.http.sign_in.policy import Need
from server.platform.schema_base import Schema

router = Operations()


class LiveTopicField(Schema):
    """A field of a topic: of rows `count` numbers of struct's type `code`, each times `scale` in `unit`."""

    name: str
    code: str = Field(default="", description="empty in documents, whose fields are JSON")
    count: int = 1
    scale: float = 1
    unit: str = ""
    meaning: str = ""


class LiveTopic(Schema):
    """A topic of the live socket."""

    id: int = Field(description="its number in the header of a block")
    name: str
    meaning: str
    kind: Literal["rows", "documents", "picture"]
    newest_only: bool = Field(description="whether each document states everything")
    fields: list[LiveTopicField] = Field(description="in their order; after the time, 8 bytes, in a row")


@router.operation("GET /api/topics", Need.VIEWER, tags=["live"])
async def list_topics() -> list[LiveTopic]:
    """List the topics of the live socket with their fields.

    A program that reads blocks by them also understands a robot of another version.
    """
    return [
        LiveTopic.model_validate(
            {
                "id": topic.id,
                "name": topic.name,
                "newest_only": topic.newest_only,
                **describe_topic(topic),
            }
        )
        for topic in TOPICS
        if not topic.only_recorded
    ]
