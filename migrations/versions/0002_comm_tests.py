"""Runs of the communication test, and their cells."""

import sqlalchemy as sa
from alembic import op

revision = "0002"
down_revision = "0001"
branch_labels = None
depends_on = None


def upgrade() -> None:
    op.create_table(
        "comm_test_run",
        sa.Column("id", sa.Integer, primary_key=True, nullable=False),
        sa.Column("name", sa.String, nullable=False),
        sa.Column("document", sa.String, nullable=False),
        sa.Column("framing", sa.String, nullable=False),
        sa.Column("direction", sa.String, nullable=False),
        sa.Column("cells", sa.Integer, nullable=False),
        sa.Column("firmware", sa.String, nullable=False),
        sa.Column("tools", sa.String, nullable=False),
        sa.Column("host", sa.String, nullable=False),
        sa.Column("started", sa.Float, nullable=False),
        sa.Column("ended", sa.Float),
        sa.Column("state", sa.String, nullable=False),
        sa.Column("problem", sa.String, nullable=False),
    )
    op.create_table(
        "comm_test_cell",
        sa.Column("id", sa.Integer, primary_key=True, nullable=False),
        sa.Column("run_id", sa.Integer, sa.ForeignKey("comm_test_run.id"), nullable=False),
        sa.Column("number", sa.Integer, nullable=False),
        sa.Column("baud", sa.Integer, nullable=False),
        sa.Column("arduino_delay", sa.Float, nullable=False),
        sa.Column("pi_delay", sa.Float, nullable=False),
        sa.Column("rate", sa.Float, nullable=False),
        sa.Column("answered", sa.Boolean, nullable=False),
        sa.Column("right", sa.Integer, nullable=False),
        sa.Column("out_of_sequence", sa.Integer, nullable=False),
        sa.Column("checksum_errors", sa.Integer, nullable=False),
        sa.Column("framing_errors", sa.Integer, nullable=False),
        sa.Column("ring_full", sa.Integer, nullable=False),
        sa.Column("bytes_read", sa.Integer, nullable=False),
        sa.Column("bytes_lost", sa.Integer, nullable=False),
        sa.Column("line_errors", sa.Integer, nullable=False),
        sa.Column("uart_overruns", sa.Integer, nullable=False),
        sa.Column("seconds", sa.Float, nullable=False),
        sa.Column("causes", sa.String, nullable=False),
        sa.Column("explanation", sa.String, nullable=False),
        sa.UniqueConstraint("run_id", "number", name="comm_test_cell_place"),
    )


def downgrade() -> None:
    op.drop_table("comm_test_cell")
    op.drop_table("comm_test_run")
