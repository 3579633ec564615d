"""The emulated board, prepared before the processes start."""

from server.platform.settings import Settings, SetupError


def prepare_board(settings: Settings) -> None:
    """Build firmware and emulator where they are missing or old. Raise SetupError."""
    from robot_runtime.simulation.boards.emulator_process import BoardError, check_emulator
    from robot_runtime.simulation.boards.firmware import FirmwareBuildError, build_firmware

    try:
        build_firmware(settings.build, settings.link.baud, hil=settings.in_the_loop)
        check_emulator(settings.build / "board")
    except (FirmwareBuildError, BoardError) as problem:
        raise SetupError(str(problem)) from problem
