"""Alembic's entry point: upgrades the database of the given connection to the requested revision."""

from alembic import context


def migrate() -> None:
    """Run the migrations in one transaction. Raise KeyError where no connection was handed over."""
    connection = context.config.attributes["connection"]
    context.configure(connection=connection, render_as_batch=True)
    with context.begin_transaction():
        context.run_migrations()


migrate()
