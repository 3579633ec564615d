"""`mucat lab lake`: the archive as Parquet files."""

from pathlib import Path

import click

from server.platform.command_line import FILE, RowCommand, with_settings
from server.platform.settings import Settings, SetupError
from server.platform.terminal import echo

TOPICS = ("control", "depth", "turning")


@click.command("lake", cls=RowCommand)
@click.argument("folder", type=FILE)
@click.option("--topics", multiple=True, default=TOPICS, metavar="TOPIC...", help="Topics of each session.")
@with_settings
def lake(settings: Settings, folder: Path, topics: tuple[str, ...]) -> None:
    """Write the figures of all sessions, and topics of each, as Parquet files for DuckDB and notebooks.

    What is in FOLDER already stays: the next call adds what is new.
    """
    from server.features.exports.lake import write_lake
    from server.platform.shell_store import open_reader

    try:
        with open_reader(settings.data) as store:
            sessions = write_lake(store, folder, topics)
    except OSError as problem:
        raise SetupError(f"{folder} cannot be written: {problem}.") from problem
    echo(f"{folder}: figures.parquet, and {', '.join(topics)} of {sessions} sessions.")
