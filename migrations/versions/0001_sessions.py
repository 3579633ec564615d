"""Sessions, their chunks and their gaps."""

import sqlalchemy as sa
from alembic import op

revision = "0001"
down_revision = None
branch_labels = None
depends_on = None


def upgrade() -> None:
    op.create_table(
        "session",
        sa.Column("id", sa.Integer, primary_key=True, nullable=False),
        sa.Column("name", sa.String, nullable=False),
        sa.Column("note", sa.String, nullable=False),
        sa.Column("state", sa.String, nullable=False, index=True),
        sa.Column("robot", sa.String, nullable=False),
        sa.Column("version", sa.String, nullable=False),
        sa.Column("definitions", sa.String, nullable=False),
        sa.Column("started", sa.Float, nullable=False),
        sa.Column("started_steady", sa.Float, nullable=False),
        sa.Column("ended", sa.Float),
        sa.Column("duration", sa.Float, nullable=False),
        sa.Column("samples", sa.Integer, nullable=False),
        sa.Column("bytes", sa.Integer, nullable=False),
        sa.Column("configuration", sa.String, nullable=False),
        sa.Column("robot_state", sa.String, nullable=False),
        sa.Column("topics", sa.String, nullable=False),
    )
    op.create_table(
        "chunk",
        sa.Column("id", sa.Integer, primary_key=True, nullable=False),
        sa.Column("session_id", sa.Integer, sa.ForeignKey("session.id"), nullable=False),
        sa.Column("topic", sa.String, nullable=False),
        sa.Column("number", sa.Integer, nullable=False),
        sa.Column("first_time", sa.Float, nullable=False),
        sa.Column("last_time", sa.Float, nullable=False),
        sa.Column("first", sa.Integer, nullable=False),
        sa.Column("count", sa.Integer, nullable=False),
        sa.Column("encoding", sa.String, nullable=False),
        sa.Column("data", sa.LargeBinary, nullable=False),
        sa.UniqueConstraint("session_id", "topic", "number", name="chunk_place"),
    )
    op.create_table(
        "gap",
        sa.Column("id", sa.Integer, primary_key=True, nullable=False),
        sa.Column("session_id", sa.Integer, sa.ForeignKey("session.id"), nullable=False, index=True),
        sa.Column("topic", sa.String, nullable=False),
        sa.Column("kind", sa.String, nullable=False),
        sa.Column("time", sa.Float, nullable=False),
        sa.Column("missed", sa.Integer, nullable=False),
    )


def downgrade() -> None:
    op.drop_table("gap")
    op.drop_table("chunk")
    op.drop_table("session")
