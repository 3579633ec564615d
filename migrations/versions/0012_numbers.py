"""Numbers of sessions, bookmarks, communication tests, profiles and layouts never return; authors.

A layout counts its versions. SQLite knows the greatest number of a table only where the table was made with
AUTOINCREMENT: each is copied. The samples (`chunk`) stay where they are.
"""

import sqlalchemy as sa
from alembic import op

revision = "0012"
down_revision = "0011"
branch_labels = None
depends_on = None

TABLES = ("session", "marker", "comm_test_run", "parameter_change", "profile", "layout")


def upgrade() -> None:
    for table in TABLES:
        with op.batch_alter_table(
            table, recreate="always", table_kwargs={"sqlite_autoincrement": True}
        ) as batch:
            if table in ("profile", "layout"):
                batch.add_column(sa.Column("author", sa.String, nullable=False, server_default=""))
            if table == "layout":
                batch.add_column(sa.Column("version", sa.Integer, nullable=False, server_default="1"))


def downgrade() -> None:
    for table in TABLES:
        with op.batch_alter_table(
            table, recreate="always", table_kwargs={"sqlite_autoincrement": False}
        ) as batch:
            if table in ("profile", "layout"):
                batch.drop_column("author")
            if table == "layout":
                batch.drop_column("version")
