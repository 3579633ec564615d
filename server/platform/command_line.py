"""The parts that the commands of `mucat` share."""

import os
import re
from collections.abc import Callable, Mapping
from functools import wraps
from pathlib import Path
from typing import IO, Any

import click
from click.exceptions import Exit

from robot_runtime.errors import RefusedError
from server.platform.errors import ApiError
from server.platform.terminal import plain

FILE = click.Path(path_type=Path)
data_option = click.option("--data", type=FILE, help="The data folder.  [default: $MUCAT_DATA, or data]")
config_option = click.option(
    "--config",
    type=FILE,
    envvar="MUCAT_CONFIG",
    help="The robot's configuration.  [default: $MUCAT_CONFIG, or robot.toml here or in the data folder]",
)

TAKE_OVER = click.option(
    "--take-over", is_flag=True, help="Take control of the robot also from somebody else. Agree with them."
)


class NumberType(click.ParamType[float]):
    """A number with a decimal point; Python's own notations, such as 1_0 and nan, are refused."""

    name = "float"

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> float:
        """Return the number, or fail with the accepted notation."""
        if isinstance(value, float):
            return value
        if not re.fullmatch(r"[-+]?([0-9]+\.?[0-9]*|\.[0-9]+)(e[-+]?[0-9]+)?", str(value), re.IGNORECASE):
            self.fail(f"{value!r} is not a number. Write a decimal point, not a comma: 1.5.", param, ctx)
        return float(value)


NUMBER = NumberType()


class CommandError(click.ClickException):
    """The command cannot be carried out; the text says why and what to do."""

    def show(self, file: IO[Any] | None = None) -> None:
        """Print the text to the standard error."""
        click.echo(plain(f"mucat: {self.message}"), file=file, err=True)


class RowCommand(click.Command):
    """A command whose repeatable options take several values in a row: `--topics depth imu`."""

    def parse_args(self, ctx: click.Context, args: list[str]) -> list[str]:
        """Repeat the option before each value after the first, as click expects it."""
        repeatable = {
            name
            for parameter in self.params
            if getattr(parameter, "multiple", False)
            for name in parameter.opts
        }
        spread: list[str] = []
        option, values = "", 0
        for word in args:
            if word.startswith("-"):
                option, values = word, 0
            elif option in repeatable:
                values += 1
                spread += [option] if values > 1 else []
            spread.append(word)
        return super().parse_args(ctx, spread)


def with_settings(command: Callable[..., int | None]) -> Callable[..., int | None]:
    """Add --data and --config to a command, and call it with the settings that follow from them.

    The function returns the exit status, or None for 0. An error of the server ends it with status 1.
    Where the present configuration cannot be used, it gets those of the last one, and the reason is printed;
    but a person who starts a server at a shell is refused.
    """

    @data_option
    @config_option
    @wraps(command)
    def run(*, data: Path | None, config: Path | None, **options: Any) -> int | None:
        # Only a command that runs needs them: a shell completes names without.
        from server.platform.last_configuration import read_usable_settings
        from server.platform.settings import SetupError, read_settings

        host, port = options.pop("host", None), options.pop("port", None)
        read = read_usable_settings if options.get("external_runtime", True) else read_settings
        try:
            settings = read(config, data, host, port, os.environ)
            if settings.configuration_problem:
                click.echo(plain(f"mucat: {settings.configuration_problem}"), err=True)
            status = command(settings, **options)
        except (SetupError, ApiError, RefusedError) as problem:
            raise CommandError(str(problem)) from problem
        if status:
            # As an end of its own, so that the audit log does not say "done".
            raise Exit(status)
        return status

    return run


def name_error(error: Mapping[str, Any]) -> str:
    """Return a line for an error of pydantic's: the path of the value, and its problem."""
    return f"{'.'.join(str(part) for part in error['loc'])}: {error['msg']}"
