"""Releases for computers with 32 bits; `make services` installs one."""

from pathlib import Path

import pytest

from packages.architectures import PackagingError
from packages.constraints import FROM_APT, small_requirements
from packages.release import build_release


def test_with_32_bits_nothing_is_needed_that_lacks_wheels_there() -> None:
    needed = dict(requirement.split("==") for requirement in small_requirements())
    assert not needed.keys() & {*FROM_APT, "mcap", "lz4", "zstandard", "greenlet"}
    assert {"eclipse-zenoh", "fastapi", "uvicorn", "websockets"} <= needed.keys()
    # The last ones that take Debian 13's pydantic.
    assert (needed["sqlalchemy"], needed["sqlmodel"]) == ("2.0.40", "0.0.24")


def test_with_32_bits_another_python_than_debian_13_s_is_refused(tmp_path: Path) -> None:
    with pytest.raises(PackagingError, match=r"need Debian 13, whose Python is 3\.13"):
        build_release(tmp_path / "key.pem", "armv6l", "3.11", tmp_path)
    assert list(tmp_path.iterdir()) == []
