"""Parameters (profiles, changes), tuning runs, layouts of panels."""

import sqlalchemy as sa
from alembic import op

revision = "0007"
down_revision = "0006"
branch_labels = None
depends_on = None


def upgrade() -> None:
    op.create_table(
        "profile",
        sa.Column("id", sa.Integer, primary_key=True, nullable=False),
        sa.Column("name", sa.String, nullable=False),
        sa.Column("note", sa.String, nullable=False),
        sa.Column("saved", sa.Float, nullable=False),
        sa.Column("parameters", sa.String, nullable=False),
        sa.UniqueConstraint("name", name="profile_name"),
    )
    op.create_table(
        "parameter_change",
        sa.Column("id", sa.Integer, primary_key=True, nullable=False),
        sa.Column("time", sa.Float, nullable=False),
        sa.Column("run", sa.String, nullable=False),
        sa.Column("who", sa.String, nullable=False),
        sa.Column("why", sa.String, nullable=False),
        sa.Column("changed", sa.String, nullable=False),
        sa.Column("undone", sa.String, nullable=False),
    )
    op.create_table(
        "tuning_run",
        sa.Column("id", sa.Integer, primary_key=True, nullable=False),
        sa.Column("name", sa.String, nullable=False),
        sa.Column("kind", sa.String, nullable=False),
        sa.Column("loop", sa.String, nullable=False),
        sa.Column("started", sa.Float, nullable=False),
        sa.Column("state", sa.String, nullable=False),
        sa.Column("problem", sa.String, nullable=False),
        sa.Column("settings", sa.String, nullable=False),
        sa.Column("parameters", sa.String, nullable=False),
        sa.Column("figures", sa.String, nullable=False),
        sa.Column("curve", sa.LargeBinary, nullable=False),
        sqlite_autoincrement=True,
    )
    op.create_table(
        "layout",
        sa.Column("id", sa.Integer, primary_key=True, nullable=False),
        sa.Column("name", sa.String, nullable=False),
        sa.Column("saved", sa.Float, nullable=False),
        sa.Column("document", sa.String, nullable=False),
        sa.UniqueConstraint("name", name="layout_name"),
    )


def downgrade() -> None:
    op.drop_table("layout")
    op.drop_table("tuning_run")
    op.drop_table("parameter_change")
    op.drop_table("profile")
