"""Runs the programs that build, fetch, sign and pack."""

import os
import subprocess
from collections.abc import Sequence
from pathlib import Path

from packages.architectures import PackagingError

WORDS_MAX = 2000
"""Of a program that fails, its last words."""


def run(command: Sequence[str | Path], remedy: str, failure: str = "") -> str:
    """Runs a command; returns its output. Raises PackagingError.

    `remedy` says how the program is installed, `failure` what it means that it fails.
    """
    words = [str(one) for one in command]
    program = Path(words[0]).name
    # Another make's flags are not for one that this starts.
    alone = os.environ | {"MAKEFLAGS": ""}
    try:
        done = subprocess.run(words, capture_output=True, text=True, errors="replace", check=False, env=alone)
    except OSError as problem:
        raise PackagingError(f"{program} cannot be run ({problem.strerror}): {remedy}.") from problem
    if done.returncode:
        last = (done.stderr.strip() or done.stdout.strip())[-WORDS_MAX:]
        raise PackagingError(f"{failure or f'{program} failed'}: {last}")
    return done.stdout
