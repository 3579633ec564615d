"""Removes a lab's second list of robots: those that have joined are in a file beside the archive."""

import sqlalchemy as sa
from alembic import op

revision = "0017"
down_revision = "0016"
branch_labels = None
depends_on = None


def upgrade() -> None:
    op.drop_table("lab_robot")


def downgrade() -> None:
    op.create_table(
        "lab_robot",
        sa.Column("id", sa.Integer, primary_key=True, nullable=False),
        sa.Column("name", sa.String, nullable=False),
        sa.Column("url", sa.String, nullable=False),
        sa.Column("token", sa.String, nullable=False),
        sa.Column("certificate", sa.String, nullable=False),
        sa.Column("added", sa.Float, nullable=False),
        sa.UniqueConstraint("name", name="lab_robot_name"),
        sqlite_autoincrement=True,
    )
