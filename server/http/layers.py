"""The layers around the routes: security, sign-in, turns and audit."""

from fastapi import FastAPI

from server.http.audit import AuditMiddleware
from server.http.head_requests import HeadRequests
from server.http.proxies import RequestsOfAddress
from server.http.security import SecurityMiddleware
from server.http.sign_in.middleware import SignInMiddleware
from server.http.start_problems import StartProblems
from server.http.turns import RequestTurns
from server.platform.settings import Settings


def add_layers(app: FastAPI, settings: Settings) -> None:
    """Put the layers around the application, the innermost first."""
    # The middleware added last runs first.
    app.add_middleware(RequestTurns)
    app.add_middleware(SignInMiddleware)
    app.add_middleware(
        SecurityMiddleware,
        allowed_hosts=settings.server.allowed_hosts,
        port=settings.server.port,
        public_url=settings.server.origin,
    )
    if settings.server.proxies:
        app.add_middleware(RequestsOfAddress)
    app.add_middleware(HeadRequests)
    app.add_middleware(AuditMiddleware)
    app.add_middleware(StartProblems)
