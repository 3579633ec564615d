"""Adds the scope and the end of tokens; those of today keep their rights and never end."""

import sqlalchemy as sa
from alembic import op

revision = "0010"
down_revision = "0009"
branch_labels = None
depends_on = None


def upgrade() -> None:
    op.add_column("device", sa.Column("limited", sa.Boolean, nullable=False, server_default=sa.false()))
    op.add_column("device", sa.Column("ends", sa.Float, nullable=True))


def downgrade() -> None:
    op.drop_column("device", "ends")
    op.drop_column("device", "limited")
