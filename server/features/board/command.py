"""`mucat upload`: the robot's firmware onto its board."""

import asyncio

import click

from server.platform.command_line import with_settings
from server.platform.folder_lock import claim
from server.platform.settings import Settings, SetupError
from server.platform.terminal import echo


@click.command()
@with_settings
def upload(settings: Settings) -> None:
    """Upload the robot's firmware to its board, and verify it.

    The board's calibration stays. Beside a running server, press the button on the System page.
    """
    from robot_runtime.places import FIRMWARE_REMEDY
    from robot_runtime.simulation.boards.firmware import firmware_path
    from server.features.board.reservation import RobotBoard
    from server.platform.pidfile import end_parts

    if settings.emulated_board:
        raise SetupError(
            "The emulated board gets its firmware at each start. robot.mode in robot.toml is emulated."
        )
    firmware = firmware_path(settings.build, settings.link.baud, ".hex", hil=settings.in_the_loop)
    if not firmware.exists():
        raise SetupError(f"There is no {firmware}; {FIRMWARE_REMEDY}.")
    board = RobotBoard(settings, lambda *_: None)
    with claim(settings.data):
        end_parts(settings.data.run)
        echo(f"{firmware} is uploaded to {settings.link.port}.")
        asyncio.run(board.restore())
    if board.problem:
        raise SetupError(board.problem)
    echo("It is on the board, read back and compared.")
