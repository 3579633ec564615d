"""`mucat`: the command line."""

import logging
import sys
from collections.abc import Sequence
from pkgutil import resolve_name

import click

from robot_runtime.durable_files import keep_private
from robot_runtime.transport.lifetime import limit_library_threads
from server import VERSION
from server.platform.terminal import PlainFormatter

COMMANDS = {
    "run": "server.startup:run",
    "runtime": "server.processes.runtime_service:run_runtime",
    "install": "server.features.installation.command:install",
    "update": "server.features.installation.command:update",
    "rollback": "server.features.installation.command:rollback",
    "uninstall": "server.features.installation.command:uninstall",
    "doctor": "server.features.doctor.command:doctor",
    "bring-up": "server.features.bring_up.command:bring_up",
    "upload": "server.features.board.command:upload",
    "commtest": "server.features.comm_tests.command:commtest",
    "simulator": "server.features.simulator.command:simulator",
    "scenario": "server.features.scenarios.command:scenario",
    "mission": "server.features.missions.command:mission",
    "report": "server.features.comparison.command:report",
    "identify": "server.features.identification.command:identify",
    "export": "server.features.exports.command:export_session",
    "import": "server.features.exports.command:import_session",
    "sessions": "server.features.sessions.command:sessions",
    "record": "server.features.sessions.command:record",
    "backup": "server.features.backup.command:backup",
    "restore": "server.features.backup.command:restore",
    "pair": "server.features.people.command:pair",
    "access": "server.features.people.command:access",
    "certificate": "server.features.simulator.certificates:certificate",
    "completion": "server.cli:completion",
}
"""Module and function of each command. Only the called one is loaded: a Raspberry Pi Zero is slow at that."""


class LazyGroup(click.Group):
    """Commands that are imported when they are needed."""

    def list_commands(self, ctx: click.Context) -> list[str]:  # noqa: ARG002 - click's signature
        """Return the names in the order of the table."""
        return list(COMMANDS)

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:  # noqa: ARG002
        """Import a command; None where there is none of this name."""
        command: click.Command | None = resolve_name(COMMANDS[cmd_name]) if cmd_name in COMMANDS else None
        return command


@click.group(cls=LazyGroup, context_settings={"help_option_names": ["-h", "--help"], "show_default": True})
@click.version_option(VERSION, message="mucat %(version)s")
def mucat() -> None:
    """Server and tools of µ-CAT."""
    printed = logging.StreamHandler()
    printed.setFormatter(PlainFormatter("%(asctime)s %(levelname)s %(name)s: %(message)s"))
    logging.basicConfig(level=logging.WARNING, handlers=[printed])


@click.command()
@click.argument("shell", type=click.Choice(["bash", "zsh", "fish"]))
def completion(shell: str) -> None:
    """Print the completion script of a shell.

    For bash, put this into ~/.bashrc: eval "$(mucat completion bash)"
    """
    from click.shell_completion import get_completion_class

    complete = get_completion_class(shell)
    assert complete is not None
    click.echo(complete(mucat, {}, "mucat", "_MUCAT_COMPLETE").source())


def main(arguments: Sequence[str] | None = None) -> int:
    """Exit status: 0 after an orderly end, 1 where the command cannot be carried out, 2 for wrong usage."""
    keep_private()
    limit_library_threads()
    try:
        return mucat.main(arguments, "mucat", standalone_mode=False) or 0
    except click.ClickException as problem:
        problem.show()
        return problem.exit_code
    except click.Abort:
        return 130  # ended by Ctrl-C


if __name__ == "__main__":
    sys.exit(main())
