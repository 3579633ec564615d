import pytest

from tests.server.serving import Served


@pytest.mark.parametrize(
    ("method", "path", "status", "message"),
    [
        ("POST", "/robot/commands/fly", 404, "There is no command 'fly'."),
        ("POST", "/robot/commands/parameter", 404, "Did you mean 'parameters'?"),
        ("POST", "/robot/commands/set_points", 404, "'set_points' is for scenarios and the server alone"),
        ("POST", "/robot/commands/stop", 404, "STOP is POST /api/robot/stop."),
        ("POST", "/robot/fly", 404, "There is no such address."),
        ("GET", "/robot/commands/arm", 405, "GET is not possible here. Possible: POST."),
        ("PUT", "/missions", 405, "PUT is not possible here. Possible: GET, POST."),
        ("GET", "/robot?limit=1", 422, "The operation has no query parameter 'limit'. It has none."),
        ("GET", "/sessions?delete=true", 422, "Did you mean 'deleted'? There are: "),
        ("GET", "/sessions?page=2", 422, "The operation has no query parameter 'page'. There are: "),
        ("GET", "/compare/report?sessions=1&signals=depth.depth&whole=1", 422, "no query parameter 'whole'"),
        ("POST", "/control/take?Over=true", 422, "Did you mean 'over'?"),
    ],
)
async def test_what_there_is_not_is_refused_in_words(
    method: str, path: str, status: int, message: str, served: Served
) -> None:
    answer = await served.api.request(method, path, json={} if method == "POST" else None)
    assert (answer.status_code, message in answer.json()["detail"]) == (status, True), answer.text


async def test_options_and_allow_name_every_method(served: Served) -> None:
    for path, methods in (
        ("/missions", "GET, POST, OPTIONS"),
        ("/sessions/7", "DELETE, GET, PATCH, OPTIONS"),
        ("/robot/stop", "POST, OPTIONS"),
    ):
        answer = await served.api.options(path)
        assert (answer.status_code, answer.headers["allow"]) == (204, methods)
        answer = await served.api.put(path)
        assert (answer.status_code, answer.headers["allow"]) == (405, methods)


async def test_stop_stops_whatever_else_it_says(served: Served) -> None:
    answer = await served.api.post("/robot/stop?now=1")
    assert answer.status_code == 204
    assert served.runtime.asked == [("stop", {})]
