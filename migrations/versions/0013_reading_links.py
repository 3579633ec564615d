"""Adds the session of a reading link to the devices; those of today have none."""

import sqlalchemy as sa
from alembic import op

revision = "0013"
down_revision = "0012"
branch_labels = None
depends_on = None


def upgrade() -> None:
    op.add_column("device", sa.Column("session_id", sa.Integer, nullable=True))


def downgrade() -> None:
    op.drop_column("device", "session_id")
