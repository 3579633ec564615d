"""Links that pair a browser, and pictures of them for a telephone's camera."""

import io

import segno


def pairing_link(base: str, code: str) -> str:
    """`base` is the server's address as a browser calls it. What follows # is never sent to a server, so
    that the code gets into no log and no Referer."""
    return f"{base}/#pair={code}"


def qr_svg(link: str) -> str:
    """A whole SVG element of this link, black on white: what a camera reads best in any theme."""
    picture = io.BytesIO()
    segno.make(link, micro=False).save(picture, kind="svg", xmldecl=False, scale=4, border=4, light="white")
    return picture.getvalue().decode().strip()


def qr_text(link: str) -> str:
    """This link as lines of half blocks, to be printed on a terminal."""
    text = io.StringIO()
    segno.make(link, micro=False).terminal(out=text, compact=True, border=2)
    return text.getvalue()
