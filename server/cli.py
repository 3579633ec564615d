"""`mucat`: the command line."""

import logging
import sys
from collections.abc import Sequence
from pkgutil import resolve_name

import click

from robot_runtime.durable_files import keep_private
from robot_runtime.transport.lifetime import limit_library_threads
from server import VERSION
from server.feature import list_features
from server.platform.terminal import PlainFormatter

COMMANDS = {
    "run": "server.startup:run",
    "lab run": "server.startup:run_lab",
    "runtime": "server.processes.runtime_service:run_runtime",
    "completion": "server.cli:completion",
}
"""Module and function of the server's own commands; a feature declares its own."""


def places_of_commands() -> dict[str, str]:
    """Return the location of each command's code.

    Only the called one is loaded: a Raspberry Pi Zero is slow at that.
    """
    places = dict(COMMANDS)
    for feature in list_features().values():
        places |= feature.commands
    return dict(sorted(places.items()))


class LazyGroup(click.Group):
    """Group of commands that are imported when they are needed."""

    def list_commands(self, ctx: click.Context) -> list[str]:  # noqa: ARG002 - click's signature
        """Return the names in alphabetical order."""
        return [name for name in places_of_commands() if " " not in name]

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:  # noqa: ARG002
        """Import a command; return None where there is none of this name."""
        places = places_of_commands()
        command: click.Command | None = None if cmd_name not in places else resolve_name(places[cmd_name])
        if isinstance(command, click.Group):
            # "scenario sweep": a feature may add to the group of another.
            for name, location in places.items():
                group, _, below = name.partition(" ")
                if group == cmd_name and below:
                    command.add_command(resolve_name(location), below)
        return command


GREETING = f"""µ-CAT {VERSION}: the software of an underwater robot turtle. What would you like to do?

  Dive now, in simulated water       mucat run
  Install it on a robot              sudo mucat install RELEASE
  Serve a lab with several robots    mucat lab run

mucat --help lists all commands; mucat COMMAND --help explains one."""


@click.group(
    cls=LazyGroup,
    invoke_without_command=True,
    context_settings={"help_option_names": ["-h", "--help"], "show_default": True},
)
@click.version_option(VERSION, message="mucat %(version)s")
@click.pass_context
def mucat(ctx: click.Context) -> None:
    """Server and tools of µ-CAT."""
    if ctx.invoked_subcommand is None:
        click.echo(GREETING)
        return
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
    """Run a command. Return the exit status: 0 for success, 1 for a failure, 2 for wrong usage."""
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
