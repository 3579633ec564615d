"""Layouts for Foxglove and Lichtblick: sent to them as assets; people import the files."""

from pathlib import Path

FOLDER = Path(__file__).parent / "documents"
ASSETS = {f"package://mucat/{name}.json": FOLDER / f"{name}.json" for name in ("foxglove", "lichtblick")}


def read_asset(uri: str) -> bytes:
    """The bytes of an asset. Raises KeyError where there is no such one."""
    return ASSETS[uri].read_bytes()
