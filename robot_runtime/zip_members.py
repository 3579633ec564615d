"""Finds the members of a zip file again that a person has unpacked and packed."""

import re
from zipfile import ZipFile, ZipInfo

_ADDED = re.compile(r"(?:.*/)?(?:__MACOSX/.*|\._[^/]*|\.DS_Store|Thumbs\.db|desktop\.ini|)", re.IGNORECASE)
"""Folders, and the files that macOS and Windows put beside others."""


def find_members(files: ZipFile, known: str) -> dict[str, ZipInfo]:
    """The members by their names in the folder in which `known` lies, which is none as first packed.

    What lies elsewhere has its whole name. Raises ValueError where two members have the same name.
    """
    found = [(info.filename.replace("\\", "/"), info) for info in files.infolist()]
    found = [(name, info) for name, info in found if not _ADDED.fullmatch(name)]
    places = [name.removesuffix(known) for name, _ in found if f"/{name}".endswith(f"/{known}")]
    folder = min(places, key=len, default="")
    members = {name.removeprefix(folder): info for name, info in found}
    if len(members) < len(found):
        raise ValueError("it holds two members of the same name")
    return members
