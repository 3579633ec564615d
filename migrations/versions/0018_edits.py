"""Counts a session's edits, so that a lab need not fetch it again; and notes what a lab has fetched last."""

import sqlalchemy as sa
from alembic import op

revision = "0018"
down_revision = "0017"
branch_labels = None
depends_on = None


def upgrade() -> None:
    op.add_column("session", sa.Column("edits", sa.Integer, nullable=False, server_default="0"))
    op.add_column("pulled_session", sa.Column("edits", sa.Integer, nullable=False, server_default="0"))
    op.add_column("pulled_session", sa.Column("texts", sa.String, nullable=False, server_default="{}"))


def downgrade() -> None:
    op.drop_column("pulled_session", "texts")
    op.drop_column("pulled_session", "edits")
    op.drop_column("session", "edits")
