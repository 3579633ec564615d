"""The application and its web server. Importing this loads all libraries of a server."""

import sys

import click
from fastapi import FastAPI

from robot_runtime.service_manager import ServiceManager
from server.app import create_app
from server.container import Container
from server.http.serving import WebServer, make_server
from server.http.sign_in.access import Access
from server.http.sign_in.welcome import shows_pictures, welcome
from server.platform.certificate import Certificate
from server.platform.settings import Settings
from server.processes.supervisor import plan


def load(settings: Settings, certificate: Certificate | None) -> tuple[FastAPI, WebServer]:
    """Make the application and its web server."""

    def started(container: Container) -> None:
        container.warm_up()
        app.state.note_serving()
        ServiceManager().ready()
        if not app.state.ended:
            _greet(settings, container.services.get(Access), certificate)

    app = create_app(settings, plan(settings), started)
    server = make_server(app, certificate, settings.server.proxies)
    server.config.load()
    return app, server


def _greet(settings: Settings, access: Access, certificate: Certificate | None) -> None:
    lines = welcome(settings, access, certificate, picture=shows_pictures(sys.stdout))
    click.echo("\n".join(lines))
