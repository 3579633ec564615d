"""HEAD requests to every route that answers GET, and their answers beside those of GET."""

from server.http.sign_in.middleware import OPEN
from server.platform.settings import Settings
from tests.server.test_matrix import ABSENT, ROUTES, Somebody, open_house

PRESENT = ABSENT | {"session": "1"}
QUERIES = {"/api/sessions/{session}/blocks": "start=0&end=100", "/api/past": "topic=depth&until=100"}


async def test_every_get_answers_head_with_the_same_status_and_headers_and_without_a_body(
    settings: Settings,
) -> None:
    surprises = []
    async with open_house(settings) as house:
        right = house.places("right", "right")
        for template in sorted(path for method, path in ROUTES if method == "GET"):
            path, query = template.replace(":path", "").format(**PRESENT), QUERIES.get(template, "")
            answers = [
                await house.ask(house.shell, method, path, right, query=query) for method in ("GET", "HEAD")
            ]
            (status, headers, _), (head_status, head_headers, body) = answers
            if (status, headers.keys(), b"") != (head_status, head_headers.keys(), body):
                surprises.append((path, status, head_status, headers, head_headers, body[:80]))
        assert not surprises
        for method, path in OPEN:
            if method == "GET":
                # A runtime that says nothing for long is not alive: 503, to both.
                opened, _, _ = await house.ask(Somebody(), "GET", path, right)
                status, _, body = await house.ask(Somebody(), "HEAD", path, right)
                assert (status, body) == (opened, b"")
                assert status in (200, 204, 503)
        status, _, _ = await house.ask(Somebody(), "HEAD", "/api/robot", right)
        assert status == 401
