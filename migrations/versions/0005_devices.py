"""Paired browsers and programs, their roles, and hashes of their secrets."""

import sqlalchemy as sa
from alembic import op

revision = "0005"
down_revision = "0004"
branch_labels = None
depends_on = None


def upgrade() -> None:
    op.create_table(
        "device",
        sa.Column("id", sa.Integer, primary_key=True, nullable=False),
        sa.Column("name", sa.String, nullable=False),
        sa.Column("role", sa.String, nullable=False),
        sa.Column("kind", sa.String, nullable=False),
        sa.Column("secret", sa.String, nullable=False),
        sa.Column("paired", sa.Float, nullable=False),
        sa.Column("seen", sa.Float, nullable=False),
        sqlite_autoincrement=True,
    )
    op.create_index("device_secret", "device", ["secret"], unique=True)


def downgrade() -> None:
    op.drop_table("device")
