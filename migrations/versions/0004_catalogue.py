"""Adds origin and provenance of sessions, tags, bookmarks, and an index of times."""

import sqlalchemy as sa
from alembic import op

revision = "0004"
down_revision = "0003"
branch_labels = None
depends_on = None

TEXTS = ("identifier", "boot", "origin", "scenario", "scenario_name", "firmware", "software")


def upgrade() -> None:
    for name in TEXTS:
        default = "operator" if name == "origin" else ""
        op.add_column("session", sa.Column(name, sa.String, nullable=False, server_default=default))
    op.add_column("session", sa.Column("seed", sa.Integer))
    op.add_column("session", sa.Column("kept", sa.Boolean, nullable=False, server_default="0"))
    op.add_column("session", sa.Column("deleted", sa.Float))
    op.execute("UPDATE session SET identifier = lower(hex(randomblob(16)))")
    op.create_index("session_identifier", "session", ["identifier"], unique=True)
    op.create_index("chunk_time", "chunk", ["session_id", "topic", "first_time"])
    op.create_table(
        "session_tag",
        sa.Column("id", sa.Integer, primary_key=True, nullable=False),
        sa.Column("session_id", sa.Integer, sa.ForeignKey("session.id"), nullable=False),
        sa.Column("tag", sa.String, nullable=False),
        sa.UniqueConstraint("session_id", "tag", name="session_tag_place"),
    )
    op.create_table(
        "marker",
        sa.Column("id", sa.Integer, primary_key=True, nullable=False),
        sa.Column("session_id", sa.Integer, sa.ForeignKey("session.id"), nullable=False, index=True),
        sa.Column("time", sa.Float, nullable=False),
        sa.Column("text", sa.String, nullable=False),
        sa.Column("made", sa.Float, nullable=False),
    )


def downgrade() -> None:
    op.drop_table("marker")
    op.drop_table("session_tag")
    op.drop_index("chunk_time", "chunk")
    op.drop_index("session_identifier", "session")
    for name in (*TEXTS, "seed", "kept", "deleted"):
        op.drop_column("session", name)
