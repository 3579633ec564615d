"""`mucat upload`: the robot's firmware onto its board."""

import asyncio
from pathlib import Path
from typing import TYPE_CHECKING

import click

from server.platform.command_line import with_settings
from server.platform.folder_lock import claim
from server.platform.settings import Settings, SetupError
from server.platform.terminal import echo

if TYPE_CHECKING:
    from server.board_reservation import RobotBoard


@click.command()
@click.option("--previous", is_flag=True, help="Put the firmware back that was there before the last upload.")
@with_settings
def upload(settings: Settings, previous: bool) -> None:
    """Upload the robot's firmware to its board, and verify it.

    The board's previous firmware is stored as firmware-previous.hex in the data folder. The board's
    calibration stays. Beside a running server, press the button on the System page.
    """
    from robot_runtime.errors import RefusedError
    from robot_runtime.places import FIRMWARE_REMEDY
    from server.board_reservation import RobotBoard
    from server.platform.pidfile import end_parts

    if settings.emulated_board:
        raise SetupError(
            "The emulated board gets its firmware at each start. robot.mode in robot.toml is emulated."
        )
    board = RobotBoard(settings, lambda *_: None)
    if not board.built.exists():
        raise SetupError(f"There is no {board.built}; {FIRMWARE_REMEDY}.")
    older = settings.data.firmware_previous
    if previous and not older.exists():
        raise SetupError(f"There is no {older}: nothing was replaced yet.")
    firmware = older if previous else board.built
    with claim(settings.data):
        end_parts(settings.data.run)
        try:
            asyncio.run(_upload(board, settings, firmware, None if previous else older))
        except RefusedError as problem:
            raise SetupError(str(problem)) from problem
    if board.problem:
        raise SetupError(board.problem)
    echo("It is on the board, read back and compared.")


async def _upload(board: "RobotBoard", settings: Settings, firmware: Path, older: Path | None) -> None:
    """Upload the firmware; store the board's previous firmware as `older`, if that is given."""
    from server.features.board.firmware_upload import store_previous

    async with board.reserve("The upload of firmware", firmware):
        if older is not None:
            echo(await store_previous(board, settings.data.path, older))
        echo(f"Uploading {firmware} to {settings.link.port}.")
