"""Adds when a lab took a session into its archive; and a lab's robots, and what it has pulled from them."""

import sqlalchemy as sa
from alembic import op

revision = "0016"
down_revision = "0015"
branch_labels = None
depends_on = None

FIGURES = (
    "duration",
    "deepest",
    "rmse",
    "cycle_amplitude",
    "overshoot",
    "settling_time",
    "fin_strokes",
    "frames_lost",
    "alarms",
)


def upgrade() -> None:
    op.add_column("session", sa.Column("archived", sa.Float))
    op.create_table(
        "lab_robot",
        sa.Column("id", sa.Integer, primary_key=True, nullable=False),
        sa.Column("name", sa.String, nullable=False),
        sa.Column("url", sa.String, nullable=False),
        sa.Column("token", sa.String, nullable=False),
        sa.Column("certificate", sa.String, nullable=False),
        sa.Column("added", sa.Float, nullable=False),
        sa.UniqueConstraint("name", name="lab_robot_name"),
        sqlite_autoincrement=True,
    )
    op.create_table(
        "pulled_session",
        sa.Column("identifier", sa.String, primary_key=True, nullable=False),
        sa.Column("robot", sa.String, nullable=False),
        sa.Column("pulled", sa.Float, nullable=False),
    )

    op.create_table(
        "session_figures",
        sa.Column("session_id", sa.Integer, sa.ForeignKey("session.id"), primary_key=True, nullable=False),
        sa.Column("segment", sa.Integer, primary_key=True, nullable=False),
        *(sa.Column(name, sa.String, nullable=False) for name in ("controller", "gains", "craft")),
        *(sa.Column(name, sa.Float) for name in FIGURES),
    )


def downgrade() -> None:
    op.drop_table("session_figures")
    op.drop_table("pulled_session")
    op.drop_table("lab_robot")
    op.drop_column("session", "archived")
