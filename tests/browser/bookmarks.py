"""The bookmarks of a session, as the server has them."""

from tests.browser.site import Site


def notes(site: Site, session: int) -> list[str]:
    """Return the texts of the session's bookmarks, in order of time."""
    return [mark["text"] for mark in site.api.get(f"/sessions/{session}/timeline").json()["markers"]]
