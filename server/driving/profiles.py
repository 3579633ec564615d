"""Profiles: parameters saved under a name, in the database and as files."""

import json
import re
from collections.abc import Mapping
from datetime import UTC, datetime
from time import time
from typing import Annotated, Any

from pydantic import ConfigDict, Field, StringConstraints, ValidationError
from sqlalchemy import Connection, delete
from sqlmodel import col, select

from robot_runtime.contract.text_input import TextError, read_json
from robot_runtime.errors import RefusedError
from server import VERSION
from server.driving.schemas import Value
from server.platform.errors import InvalidError, NotFoundError
from server.platform.models import ProfileRow
from server.platform.schema_base import Schema
from server.platform.store import Store, insert_row

FORMAT = 1
"""The format of profiles' files; a file of another format is refused."""
PROFILES_MAX = 500
PARAMETERS_MAX = 1000

ParameterName = Annotated[str, StringConstraints(min_length=1, max_length=100)]
Values = Annotated[dict[ParameterName, Value], Field(max_length=PARAMETERS_MAX)]
ProfileName = Annotated[str, StringConstraints(strip_whitespace=True, min_length=1, max_length=100)]
ProfileNote = Annotated[str, StringConstraints(strip_whitespace=True, max_length=1000)]


class Profile(Schema):
    """Parameters saved under a name."""

    id: int
    name: str
    note: str
    author: str = Field(description="the person who saved it; empty where it is not known")
    saved: datetime = Field(description="UTC")
    values: dict[str, Value]


class UnknownProfileError(NotFoundError):
    """There is no such profile"""


class ProfileError(InvalidError):
    """The file is no profile of this version"""


class ProfileFile(Schema):
    """Content of a profile's file; `version` is that of the software that wrote it."""

    model_config = ConfigDict(extra="ignore")
    name: ProfileName
    note: ProfileNote = ""
    version: str = ""
    parameters: Values


class Profiles:
    """The saved profiles. Every method raises StoreError, and UnknownProfileError for a missing profile."""

    def __init__(self, store: Store) -> None:
        self._store = store

    def list(self) -> list[Profile]:
        """Return all profiles, in alphabetical order. Blocks."""
        with self._store.read() as database:
            rows = database.exec(select(ProfileRow)).all()
        return sorted((_show(row) for row in rows), key=lambda profile: profile.name.casefold())

    def find(self, profile: int) -> Profile:
        """Return the profile of this number. Blocks."""
        with self._store.read() as database:
            row = database.get(ProfileRow, profile)
        if row is None:
            raise UnknownProfileError("There is no such profile; somebody may have deleted it.")
        return _show(row)

    async def save(self, name: str, note: str, values: Mapping[str, Value], author: str = "") -> Profile:
        """Save these values. Raise RefusedError if the name is taken, or if there are too many profiles."""
        row = ProfileRow(
            name=name, note=note, saved=time(), parameters=json.dumps(dict(values)), author=author
        )

        def write(connection: Connection) -> Profile:
            names = connection.execute(select(ProfileRow.name)).scalars().all()
            if name in names:
                raise RefusedError(
                    f"There is a profile “{name}” already. Delete it first, or choose another name."
                )
            if len(names) >= PROFILES_MAX:
                raise RefusedError(f"There are {PROFILES_MAX} profiles already. Delete some first.")
            row.id = insert_row(connection, ProfileRow, row.model_dump(exclude={"id"}))
            return _show(row)

        return await self._store.write(write)

    async def delete(self, profile: int) -> None:
        """Delete a profile for good."""

        def write(connection: Connection) -> None:
            result = connection.execute(delete(ProfileRow).where(col(ProfileRow.id) == profile))
            if result.rowcount == 0:
                raise UnknownProfileError("There is no such profile; somebody may have deleted it.")

        await self._store.write(write, frees=True)


def write_file(profile: Profile) -> str:
    """Return the file of a profile, which `read_file` reads."""
    content = {
        "format": FORMAT,
        "name": profile.name,
        "note": profile.note,
        "saved": profile.saved.isoformat(),
        "version": VERSION,
        "parameters": profile.values,
    }
    return json.dumps(content, indent=2, ensure_ascii=False) + "\n"


def file_name(profile: Profile) -> str:
    """Return a file name for the profile, with characters that every file system takes."""
    slug = re.sub(r"[^A-Za-z0-9]+", "-", profile.name).strip("-")[:50].strip("-")
    return f"profile-{slug or profile.id}.json"


def read_file(text: str) -> ProfileFile:
    """Return the profile in a file. Raise ProfileError."""
    try:
        content: Any = read_json(text)
    except TextError as problem:
        raise ProfileError(f"The file is not a profile: it {problem}.") from problem
    if not isinstance(content, dict) or "format" not in content:
        raise ProfileError(
            "The file is not a profile: it has no format. Save a profile here to see its form."
        )
    if content["format"] != FORMAT or isinstance(content["format"], bool):
        raise ProfileError(
            f"The file is a profile of format {content['format']!r}{_writer(content)}. This is version "
            f"{VERSION}, which reads format {FORMAT}: open the file with the version that wrote it."
        )
    try:
        return ProfileFile.model_validate(content)
    except ValidationError as problem:
        reasons = "; ".join(
            f"{'.'.join(str(part) for part in error['loc'][:2])}: {error['msg']}"
            for error in problem.errors()[:5]
        )
        raise ProfileError(f"The profile in the file cannot be used. {reasons}.") from problem


def _writer(content: Mapping[str, Any]) -> str:
    version = content.get("version")
    return f", written by version {version} of µ-CAT" if version and isinstance(version, str) else ""


def _show(row: ProfileRow) -> Profile:
    return Profile(
        id=row.id or 0,
        name=row.name,
        note=row.note,
        author=row.author,
        saved=datetime.fromtimestamp(row.saved, UTC),
        values=json.loads(row.parameters),
    )
