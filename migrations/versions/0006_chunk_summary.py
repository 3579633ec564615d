"""Adds an index with a summary of a session's topics, so that the summary needs no chunks."""

from alembic import op

revision = "0006"
down_revision = "0005"
branch_labels = None
depends_on = None

PLACE = ["session_id", "topic", "first_time"]


def upgrade() -> None:
    op.drop_index("chunk_time", "chunk")
    op.create_index("chunk_time", "chunk", [*PLACE, "last_time", "count"])


def downgrade() -> None:
    op.drop_index("chunk_time", "chunk")
    op.create_index("chunk_time", "chunk", PLACE)
