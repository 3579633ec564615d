"""Adds the place of a run, the mark of a shipped run, and the repeated frames of a cell."""

import sqlalchemy as sa
from alembic import op

revision = "0003"
down_revision = "0002"
branch_labels = None
depends_on = None


def upgrade() -> None:
    column = sa.Column("place", sa.String, nullable=False, server_default="emulated")
    op.add_column("comm_test_run", column)
    op.add_column("comm_test_run", sa.Column("sample", sa.String, nullable=False, server_default=""))
    op.add_column("comm_test_cell", sa.Column("repeated", sa.Integer, nullable=False, server_default="0"))


def downgrade() -> None:
    op.drop_column("comm_test_cell", "repeated")
    op.drop_column("comm_test_run", "sample")
    op.drop_column("comm_test_run", "place")
