"""Databases as older versions left them."""

from alembic import command
from alembic.config import Config
from sqlalchemy import create_engine, pool

from server import schema
from server.settings import Settings


def upgrade_to(settings: Settings, revision: str) -> None:
    """Make the database, with the tables of this revision."""
    engine = create_engine(f"sqlite:///{settings.data.database}", poolclass=pool.NullPool)
    config = Config()
    config.set_main_option("script_location", str(schema._scripts()))
    config.set_main_option("path_separator", "os")
    with engine.connect() as connection:
        config.attributes["connection"] = connection
        command.upgrade(config, revision)
        connection.commit()
