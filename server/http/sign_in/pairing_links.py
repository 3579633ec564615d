"""Pairing links, and QR codes of them for a phone's camera."""

import io

import segno


def pairing_link(base: str, code: str) -> str:
    """Return the link for a code; `base` is the server's address for the browser.

    Browsers never send the part after #, so that the code is in no log and no Referer.
    """
    return f"{base}/#pair={code}"


def qr_svg(link: str) -> str:
    """Return the QR code of a link as an SVG element, black on white in any theme."""
    picture = io.BytesIO()
    segno.make(link, micro=False).save(picture, kind="svg", xmldecl=False, scale=4, border=4, light="white")
    return picture.getvalue().decode().strip()


def qr_text(link: str) -> str:
    """Return the QR code of a link as text for a terminal."""
    text = io.StringIO()
    segno.make(link, micro=False).terminal(out=text, compact=True, border=2)
    return text.getvalue()
