"""Adds the second secret of browsers; those of today have none, and sign in again."""

import sqlalchemy as sa
from alembic import op

revision = "0011"
down_revision = "0010"
branch_labels = None
depends_on = None


def upgrade() -> None:
    op.add_column("device", sa.Column("page_secret", sa.String, nullable=True))


def downgrade() -> None:
    op.drop_column("device", "page_secret")
