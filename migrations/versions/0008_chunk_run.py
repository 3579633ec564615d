"""Adds to each chunk the run of the runtime or simulator that sent it."""

import sqlalchemy as sa
from alembic import op

revision = "0008"
down_revision = "0007"
branch_labels = None
depends_on = None


def upgrade() -> None:
    op.add_column("chunk", sa.Column("run", sa.String, nullable=False, server_default=""))


def downgrade() -> None:
    op.drop_column("chunk", "run")
