"""The route class of the HTTP interface."""

from collections.abc import Callable
from inspect import cleandoc
from typing import Any

from fastapi.routing import APIRoute


class Operation(APIRoute):
    """A route that has its name from its function, and its summary from the first line of the docstring."""

    def __init__(self, path: str, endpoint: Callable[..., Any], **options: Any) -> None:
        first, *words = endpoint.__name__.split("_")
        options["operation_id"] = options["operation_id"] or first + "".join(map(str.capitalize, words))
        summary = cleandoc(endpoint.__doc__ or "").partition("\n")[0]
        options["summary"] = options["summary"] or summary.removesuffix(".")
        super().__init__(path, endpoint, **options)
