"""The base of all documents of the HTTP interface, and of those that processes and files exchange."""

from pydantic import BaseModel, ConfigDict


class Schema(BaseModel):
    """A document. Its validator is built at its first use: all together are a tenth of a server's start.

    Those of a request's body and query set `defer_build` to False: FastAPI builds them with their route, and
    passes over what pydantic then warns of.
    """

    model_config = ConfigDict(defer_build=True)
