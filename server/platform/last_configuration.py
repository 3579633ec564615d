"""The last usable configuration: services and commands take it where robot.toml cannot be used.

A file that a power cut or a slip of the editor has damaged does not take the robot away from its lab; and the
default configuration would show emulated water where people stand before a real robot.
"""

import logging
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import replace
from pathlib import Path

from robot_runtime.durable_files import write_whole
from server.platform.settings import Settings, SetupError, data_folder, read_settings

log = logging.getLogger(__name__)


def read_usable_settings(
    config: Path | None,
    data: Path | None,
    host: str | None,
    port: int | None,
    environment: Mapping[str, str],
) -> Settings:
    """Return the settings as `read_settings`, else those of the last usable configuration.

    Then `configuration_problem` says so. Raise SetupError where there is no such configuration either.
    """
    last = data_folder(data, environment).last_config
    try:
        settings = read_settings(config, data, host, port, environment)
        _refuse_cut_off(settings.config, last)
        return settings
    except SetupError as problem:
        try:
            settings = read_settings(last, data, host, port, environment)
        except SetupError:
            raise problem from None
        text = f"{problem} Until then the last configuration that could be used is in force."
        return replace(settings, configuration_problem=text)


def _refuse_cut_off(config: Path, last: Path) -> None:
    """Raise SetupError for a file that is the beginning of the last one, even if it is valid or empty."""
    with suppress(OSError):
        text, before = config.read_bytes().rstrip(), last.read_bytes().rstrip()
        if text != before and before.startswith(text):
            raise SetupError(
                f"{config} has only the first {len(text)} of {len(before)} bytes that it had, and seems to "
                f"be cut off. Write the rest again, from {last}; or remove that copy, if that was meant."
            )


def keep_configuration(settings: Settings) -> None:
    """Copy a usable configuration. A failing disk does not prevent a start."""
    if settings.configuration_problem:
        return
    path = settings.data.last_config
    try:
        text = settings.config_text.encode()
        if not path.exists() or path.read_bytes() != text:
            write_whole(path, text)
    except OSError as problem:
        log.warning("the configuration was not copied to %s: %s", path, problem)
