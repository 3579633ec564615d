"""The database's history, one revision for each change of `server.platform.models`."""

from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from alembic.config import Config

HEAD = "0018"
"""The newest revision: what a database of this version must be at."""
FOLDER = Path(__file__).parent


def known_revisions() -> set[str]:
    """Return the revisions that this version can read or upgrade."""
    # Alembic is loaded only where there is something to do: it costs a Raspberry Pi time and memory.
    from alembic.script import ScriptDirectory

    return {script.revision for script in ScriptDirectory(FOLDER).walk_revisions()}


def make_config() -> "Config":
    """Return Alembic's configuration, with the migrations."""
    from alembic.config import Config

    config = Config()
    config.set_main_option("script_location", str(FOLDER))
    config.set_main_option("path_separator", "os")
    return config
