"""TLS with a certificate of the robot's own.

It is signed by an authority that is made for it alone, and whose key is destroyed at once. Phones and tablets
trust authorities only; whoever trusts this one trusts nothing but this certificate.
"""

import shutil
import ssl
import time
from dataclasses import dataclass, replace
from hashlib import sha256
from ipaddress import ip_address
from pathlib import Path
from secrets import token_hex

from robot_runtime.durable_files import PART, put_in_place
from server.platform.openssl import (
    BROWSER_DAYS,
    CERTIFICATE,
    KEY,
    LEAF,
    SIGNS,
    Signer,
    make_certificate,
    read_validity,
)
from server.platform.settings import DataFolder, Settings, SetupError

AUTHORITY, AUTHORITY_KEY = "authority.pem", "authority.key"
RENEW_DAYS = 90
"""A server that runs for three months without a start still has a valid certificate."""
SECONDS_OF_DAY = 86_400
NO_CHECK_TIME = 0x200000
"""X509_V_FLAG_NO_CHECK_TIME of OpenSSL (x509_vfy.h), which Python has no name for."""


@dataclass(frozen=True, slots=True)
class Certificate:
    """A certificate's two files, and its fingerprint for people: SHA-256 over DER, as browsers show it."""

    file: Path
    key: Path
    fingerprint: str
    renewed: bool = False
    """It replaces one of the same key since this start, so that who trusted that one must trust it anew."""


def prepare_certificate(settings: Settings) -> Certificate:
    """Return the robot's certificate, made at its first start and renewed with the same key near its end.

    One that signs others, or is valid for longer than browsers accept, is renewed as well. Raise SetupError
    where it cannot be had.
    """
    folder = settings.data.tls
    try:
        if not folder.exists():
            _make(folder, settings)
        renewed = _renew(folder, settings)
        return replace(_read(folder), renewed=renewed)
    except (OSError, ValueError) as problem:
        raise SetupError(
            f"The robot's certificate in {folder} cannot be had: {problem}. "
            "Remove that folder to have another made, or set server.tls to false in robot.toml."
        ) from problem


def read_fingerprint(folder: DataFolder) -> str:
    """Return the fingerprint of this folder's certificate. Raise OSError where there is none."""
    return _read(folder.tls).fingerprint


def fingerprint_of(certificate: bytes) -> str:
    """Return the fingerprint of a certificate in DER."""
    digest = sha256(certificate).hexdigest().upper()
    return ":".join(digest[index : index + 2] for index in range(0, len(digest), 2))


def trust_only(folder: DataFolder) -> ssl.SSLContext:
    """Return the TLS context for requests to this folder's server: it trusts only that certificate.

    Raise OSError where there is none.
    """
    context = ssl.create_default_context(cafile=str(folder.tls / CERTIFICATE))
    context.check_hostname = False
    # The certificate is this file's own, whatever date a clock has that nobody has set yet.
    context.verify_flags |= NO_CHECK_TIME
    return context


def _make(folder: Path, settings: Settings) -> None:
    part = folder.with_suffix(".part")
    shutil.rmtree(part, ignore_errors=True)
    part.mkdir(mode=0o700)
    _sign(part / CERTIFICATE, part / KEY, settings)
    part.rename(folder)


def _sign(certificate: Path, key: Path, settings: Settings) -> None:
    """Make an authority and a certificate by it, both in one file; the authority's key is destroyed."""
    authority = Signer(certificate.with_name(AUTHORITY), certificate.with_name(AUTHORITY_KEY))
    authority.key.unlink(missing_ok=True)
    try:
        # Devices that have trusted an earlier authority must not take it for this one.
        name = f"{settings.robot.name} {token_hex(4)}"
        make_certificate(authority.certificate, authority.key, name, SIGNS, days=BROWSER_DAYS)
        names = ",".join(_alternative(name) for name in settings.server.allowed_hosts)
        extensions = [f"subjectAltName={names}", "extendedKeyUsage=serverAuth", *LEAF]
        make_certificate(certificate, key, settings.robot.name, extensions, authority, BROWSER_DAYS)
    finally:
        authority.key.unlink(missing_ok=True)
    with certificate.open("ab") as file:
        file.write(authority.certificate.read_bytes())


def _renew(folder: Path, settings: Settings) -> bool:
    """Replace a certificate that browsers refuse, or soon will. Return True if it was replaced."""
    valid = read_validity(folder / CERTIFICATE)
    lasts = valid.ends - valid.begins <= (BROWSER_DAYS + 1) * SECONDS_OF_DAY
    # A clock that was not set yet lies long before: then nothing is known of the certificate's end.
    ends_soon = time.time() > valid.ends - RENEW_DAYS * SECONDS_OF_DAY
    if valid.is_leaf and lasts and not ends_soon:
        return False
    part = folder / (CERTIFICATE + PART)
    _sign(part, folder / KEY, settings)
    put_in_place(part, folder / CERTIFICATE)
    return True


def _read(folder: Path) -> Certificate:
    text = (folder / CERTIFICATE).read_text(encoding="ascii")
    own = text.partition(ssl.PEM_FOOTER)[0] + ssl.PEM_FOOTER
    (folder / KEY).read_bytes()
    fingerprint = fingerprint_of(ssl.PEM_cert_to_DER_cert(own))
    return Certificate(folder / CERTIFICATE, folder / KEY, fingerprint)


def _alternative(name: str) -> str:
    try:
        return f"IP:{ip_address(name.strip('[]'))}"
    except ValueError:
        return f"DNS:{name}"
