"""Runs the programs that build, fetch, sign and pack."""

import os
import subprocess
from collections.abc import Sequence
from pathlib import Path

from packages.architectures import PackagingError

WORDS_MAX = 2000
"""Of a program that fails, its last words."""


def run(command: Sequence[str | Path], remedy: str, failure: str = "") -> str:
    """Run a command; return its output. Raise PackagingError.

    `remedy` is the way to install the program, `failure` the meaning of its failure.
    """
    arguments = [str(argument) for argument in command]
    program = Path(arguments[0]).name
    # Another make's flags are not for one that this starts.
    alone = os.environ | {"MAKEFLAGS": ""}
    try:
        done = subprocess.run(
            arguments, capture_output=True, text=True, errors="replace", check=False, env=alone
        )
    except OSError as problem:
        raise PackagingError(f"{program} cannot be run ({problem.strerror}): {remedy}.") from problem
    if done.returncode:
        last = (done.stderr.strip() or done.stdout.strip())[-WORDS_MAX:]
        raise PackagingError(f"{failure or f'{program} failed'}: {last}")
    return done.stdout
