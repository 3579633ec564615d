from fastapi import APIRouter, FastAPI

from server.http.operation import Operation


def test_an_operation_is_named_by_its_function_and_described_by_its_docstring() -> None:
    router = APIRouter(route_class=Operation)

    @router.get("/things")
    def list_all_things() -> None:
        """List the things, newest first.

        Old ones are left out.
        """

    @router.get("/others", summary="The others", operation_id="others")
    def list_others() -> None:
        """Those that are left."""

    app = FastAPI()
    app.include_router(router, prefix="/api")
    paths = app.openapi()["paths"]
    things, others = paths["/api/things"]["get"], paths["/api/others"]["get"]
    assert (things["operationId"], things["summary"]) == ("listAllThings", "List the things, newest first")
    assert things["description"] == "List the things, newest first.\n\nOld ones are left out."
    assert (others["operationId"], others["summary"]) == ("others", "The others")
