"""Runs pytest again and again in forks of a process that has loaded other people's packages.

It reads lines of JSON, {"folder", "options", "output"}, runs pytest in the folder, with its output in that
file, and prints the exit status. Before the fork it loads nothing of this repository, and starts no thread.
"""

import json
import os
import sys

import alembic.command  # noqa: F401
import fastapi  # noqa: F401
import httpx  # noqa: F401
import hypothesis  # noqa: F401
import psutil  # noqa: F401
import pytest
import segno  # noqa: F401
import serial  # noqa: F401
import sqlalchemy.dialects.sqlite  # noqa: F401
import sqlmodel  # noqa: F401
import uvicorn.protocols.http.h11_impl
import uvicorn.protocols.websockets.websockets_sansio_impl  # noqa: F401
import websockets.asyncio.client  # noqa: F401
import zenoh  # noqa: F401


def main() -> None:
    for line in sys.stdin:
        asked = json.loads(line)
        process = os.fork()
        if process == 0:
            sys.exit(run(asked["folder"], asked["options"], asked["output"]))
        _, status = os.waitpid(process, 0)
        print(os.waitstatus_to_exitcode(status), flush=True)  # noqa: T201 - it speaks to who started it


def run(folder: str, options: list[str], output: str) -> int:
    """Exit status of `python -m pytest` in this folder, which comes first where modules are looked for."""
    answer = os.open(output, os.O_WRONLY | os.O_CREAT | os.O_TRUNC, 0o600)
    for index, file in enumerate((os.open(os.devnull, os.O_RDONLY), answer, answer)):
        os.dup2(file, index)
    os.chdir(folder)
    os.environ |= {"PYTHONPATH": folder, "PYTHONDONTWRITEBYTECODE": "1"}
    sys.dont_write_bytecode = True
    sys.path.insert(0, folder)
    sys.argv[1:] = options
    return pytest.main(options)


if __name__ == "__main__":
    main()
