"""Stores what the list of sessions says about each: depths, controllers, cards, alarms, as JSON."""

import sqlalchemy as sa
from alembic import op

revision = "0014"
down_revision = "0013"
branch_labels = None
depends_on = None


def upgrade() -> None:
    op.create_table(
        "session_summary",
        sa.Column("session_id", sa.Integer, sa.ForeignKey("session.id"), primary_key=True),
        sa.Column("document", sa.String, nullable=False),
    )


def downgrade() -> None:
    op.drop_table("session_summary")
