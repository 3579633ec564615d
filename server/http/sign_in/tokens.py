"""Random secrets of devices: shown once, and stored only as SHA-256."""

import secrets
from hashlib import sha256

TOKEN_BYTES = 32
TOKEN_PREFIX = "mucat_"
CODE_ALPHABET = "23456789ABCDEFGHJKMNPQRSTUVWXYZ"
"""Without characters that look alike: 0 and O, 1, I and L."""
CODE_LENGTH = 10
"""49 bits: guessing one within its ten minutes is hopeless, at any number of tries."""


def make_token(prefix: str = "") -> str:
    """Return 256 random bits as text."""
    return prefix + secrets.token_urlsafe(TOKEN_BYTES)


def derive_secret(purpose: str, token: str) -> str:
    """Return a secret for this purpose that whoever has the token can compute, and nobody from it another."""
    return sha256(f"{purpose} {token}".encode()).hexdigest()


def make_code() -> str:
    """Return a code that can also be read aloud, such as 7K3PX-Q2M9D."""
    letters = "".join(secrets.choice(CODE_ALPHABET) for _ in range(CODE_LENGTH))
    return f"{letters[: CODE_LENGTH // 2]}-{letters[CODE_LENGTH // 2 :]}"


def normal_code(typed: str) -> str:
    """Return a typed code in its original form."""
    return "".join(letter for letter in typed.upper() if letter.isalnum())


def digest(secret: str) -> str:
    """Return the SHA-256 of a secret, which is random enough to need no salt."""
    return sha256(secret.encode()).hexdigest()
