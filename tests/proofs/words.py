"""Hostile words and numbers, thousands of them from a seed."""

import random
from pathlib import Path
from typing import TypeVar
from urllib.parse import quote

T = TypeVar("T")

SHELL = (
    "$(touch {canary})",
    "`touch {canary}`",
    ";touch {canary};",
    "|touch {canary}",
    "&&touch {canary}&&",
    "\ntouch {canary}\n",
    "'; touch {canary}; '",
    '"; touch {canary}; "',
    "${{IFS}}touch${{IFS}}{canary}",
    ">{canary}",
    "<{secret}",
    "$(cat {secret})",
    "{{touch,{canary}}}",
    "\0;touch {canary}",
    "\r\n\r\ntouch {canary}",
    "~",
    "*",
    "$HOME",
    "%COMSPEC%",
)
OPTIONS = (
    "-o{canary}",
    "-o {canary}",
    "--output={canary}",
    "@{secret}",
    "-include{secret}",
    "-wrapper touch,{canary}",
    "-fplugin={canary}",
    "-Uflash:r:{canary}:r",
    "-DX='\"$(touch {canary})\"'",
    "--help",
    "--",
    "-",
)
TEMPLATES = (
    "{{{{7*7}}}}",
    "{{0.__class__.__mro__}}",
    "${{jndi:ldap://127.0.0.1/x}}",
    "%s%n%x",
    "<%= system('touch {canary}') %>",
    "#{{`touch {canary}`}}",
    "__import__('os').system('touch {canary}')",
    "<script>fetch('/api/robot/stop')</script>",
    "'; ATTACH DATABASE '{canary}' AS other; --",
    "' OR 1=1; DROP TABLE session; --",
    "#include <{secret}>",
    '"\n#include "{secret}',
)
PATHS = (
    "{secret}",
    "../{name}",
    "../../{name}",
    "../../../../../../../..{secret}",
    "..\\..\\{name}",
    "....//....//{name}",
    "..;/{name}",
    "./../{name}",
    "x/../../{name}",
    "%2e%2e%2f{name}",
    "%2e%2e/{name}",
    "..%2f..%2f{name}",
    "..%252f{name}",
    "..%c0%af{name}",
    "%c0%ae%c0%ae/{name}",
    "..%u2215{name}",
    "\uff0e\uff0e\uff0f{name}",
    "\u2025/{name}",
    "../{name}\0.toml",
    "../{name}%00",
    "file://{secret}",
    "//{secret}",
    "/proc/self/root{secret}",
    "/dev/stdin",
    "C:\\{name}",
    "\\\\host\\share\\{name}",
    "CON",
    ".",
    "..",
    "/",
    "",
)
STRANGE = (
    "NaN",
    "-Infinity",
    "1e999",
    "-1",
    "0x10",
    "1_000",
    "１２３",
    "+1",
    " 1",
    "9" * 400,
    "\u202egpj.exe",
    "a\u200bb",
    "é" * 60,
    "e\u0301",
    "\ud800",
    "\udcff",
    "\ufeff",
    "\u2028",
    "🐢",
    "\x1b[2J",
    "\x7f",
    "\0",
    "a" * 5000,
    " " * 100,
)
NUMBERS: tuple[object, ...] = (
    float("nan"),
    float("inf"),
    -float("inf"),
    1e308,
    -1e308,
    5e-324,
    -1,
    0,
    2**31,
    2**63 - 1,
    2**63,
    2**64,
    -(2**63) - 1,
    10**300,
    True,
    None,
    [],
    [[1]],
    {},
)


class Words:
    """Hostile words without end; a command in one would create `canary`, a path would lead to `secret`."""

    def __init__(self, canary: Path, secret: Path, seed: int) -> None:
        self._names = {"canary": str(canary), "secret": str(secret), "name": secret.name}
        self._chance = random.Random(seed)
        self._plain = [template.format(**self._names) for template in (*SHELL, *OPTIONS, *TEMPLATES, *PATHS)]
        self._plain += STRANGE

    def word(self) -> str:
        """Return a hostile word, plain or mutated."""
        chance, word = self._chance, self._chance.choice(self._plain)
        match chance.randrange(8):
            case 0:
                return quote(word.encode(errors="surrogatepass"), safe="")
            case 1:
                return word + chance.choice(self._plain)
            case 2:
                return f"a{word}"
            case 3:
                return f"{word}{chance.choice(' /.;&|#')}"
            case 4:
                return f"turtle-{chance.randrange(1000)}{word}"
            case _:
                return word

    def choose(self, among: tuple[T, ...]) -> T:
        """Return one of these choices."""
        return self._chance.choice(among)

    def value(self) -> object:
        """Return a hostile word, or an odd value in place of a number."""
        return self.word() if self._chance.random() < 0.6 else self._chance.choice(NUMBERS)
