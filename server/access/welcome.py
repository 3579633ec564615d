"""What the server says when it has started: where the page is, who can reach it, and how to get in."""

from server import VERSION
from server.access.access import Access
from server.access.links import pairing_link, qr_text
from server.settings import Settings


def welcome(settings: Settings, access: Access, *, picture: bool) -> list[str]:
    """Lines for the terminal; `picture` says whether it can show one.

    Who holds the terminal of a server that only this computer reaches is its operator anyway, so each start
    gives a link, and nobody has to type a code. A server that others reach gives one only while there is no
    operator: its output may be kept in a log, and its reader is not always at the robot.
    """
    base = settings.base_url()
    reach = (
        "only this computer reaches it"
        if settings.only_here
        else f"listening on {settings.host}: whoever is in its network reaches it"
    )
    lines = [
        f"µ-CAT {VERSION} ({settings.mode}): {base}/ ({reach}; data in {settings.data.path})",
    ]
    if settings.only_here or not access.devices.operators:
        lines += invitation(pairing_link(base, access.codes.make("operator")), picture, settings.only_here)
    return lines


def invitation(link: str, picture: bool, only_here: bool) -> list[str]:
    """A pairing link for a person; as a picture too, where a telephone could follow it."""
    lines = ["To sign a browser in, open this link; it works once, for ten minutes:", f"  {link}"]
    if picture and not only_here:
        lines.append(qr_text(link))
    return lines
