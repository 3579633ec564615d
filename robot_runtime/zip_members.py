"""The members of a zip file, also of one that a person has unpacked and packed again."""

import re
from zipfile import ZipFile, ZipInfo

_ADDED = re.compile(r"(?:.*/)?(?:__MACOSX/.*|\._[^/]*|\.DS_Store|Thumbs\.db|desktop\.ini|)", re.IGNORECASE)
"""Folders, and the files that macOS and Windows put beside others."""


def find_members(files: ZipFile, known: str) -> dict[str, ZipInfo]:
    """Return the members by their names in the folder of `known`, which is the top one as first packed.

    Members elsewhere have their whole names. Raise ValueError where two members have the same name.
    """
    packed = [(info.filename.replace("\\", "/"), info) for info in files.infolist()]
    packed = [(name, info) for name, info in packed if not _ADDED.fullmatch(name)]
    folders = [name.removesuffix(known) for name, _ in packed if f"/{name}".endswith(f"/{known}")]
    folder = min(folders, key=len, default="")
    members = {name.removeprefix(folder): info for name, info in packed}
    if len(members) < len(packed):
        raise ValueError("it holds two members of the same name")
    return members
