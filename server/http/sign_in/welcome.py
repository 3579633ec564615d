"""The text that the server prints at its start: address, reachability, pairing code."""

from typing import TextIO
from urllib.parse import urlsplit

from server import VERSION
from server.http.sign_in.access import Access
from server.http.sign_in.pairing_links import pairing_link, qr_text
from server.platform.certificate import Certificate
from server.platform.settings import Settings, is_loopback


def welcome(
    settings: Settings, access: Access, certificate: Certificate | None, *, picture: bool
) -> list[str]:
    """Return lines for the terminal; with `picture` also a QR code.

    If only this computer reaches the server, the person at the terminal is its operator anyway, so each start
    prints a link. A server that others reach prints one only while there is no operator: its output may be
    stored in a log, and is not always read at the robot.
    """
    base = settings.base_url()
    kind = "lab" if settings.lab else settings.robot.mode
    lines = [
        f"µ-CAT {VERSION} ({kind}): {base}/ (data in {settings.data.path})",
        f"Its configuration is {settings.config}.",
        _reach(settings),
    ]
    if certificate is not None:
        lines += [
            "Browsers will not know its certificate. Compare the SHA-256 fingerprint before you trust it:",
            f"  {certificate.fingerprint}",
        ]
        if certificate.renewed:
            lines.append("It was renewed: whatever trusted the one before must trust it anew.")
    if settings.only_here or not access.devices.operators:
        code = access.codes.make("operator")
        links = [pairing_link(url, code) for url in settings.base_urls()]
        lines += invitation(links[0], links[1:], picture=picture)
    return lines


def invitation(link: str, others: list[str], *, picture: bool) -> list[str]:
    """Return a pairing link for a person; also as a picture, where another device can use it.

    The `others` are links to other addresses of the server, in case the first does not work.
    """
    lines = ["To sign a browser in, open this link. It works once, for ten minutes:", f"  {link}"]
    if is_loopback(urlsplit(link).hostname or ""):
        return lines
    if others:
        lines += ["If it does not open on the other device:", *(f"  {other}" for other in others)]
    if picture:
        lines.append(qr_text(link))
    return lines


def shows_pictures(stream: TextIO) -> bool:
    """Return True where the stream's encoding has the characters of a QR code."""
    return stream.encoding.lower().startswith("utf")


def _reach(settings: Settings) -> str:
    server = settings.server
    server = settings.server
    if server.origin and is_loopback(server.host):
        return f"It listens on {server.host}: others reach it by the proxy of {server.origin}."
    if settings.only_here:
        return f"It listens on {server.host}: only this computer reaches it."
    where = "all networks" if server.host in ("0.0.0.0", "::") else "its network"
    read = "" if server.tls else ", and read along what others ask: server.tls in robot.toml hides it"
    return f"It listens on {server.host}: every computer in {where} can ask for a sign-in{read}."
