"""Stores sweeps: their documents, their runs, and the figures of each run by what it follows from."""

import sqlalchemy as sa
from alembic import op

revision = "0015"
down_revision = "0014"
branch_labels = None
depends_on = None


def upgrade() -> None:
    op.create_table(
        "sweep",
        sa.Column("id", sa.Integer, primary_key=True),
        sa.Column("name", sa.String, nullable=False),
        sa.Column("title", sa.String, nullable=False),
        sa.Column("scenario", sa.String, nullable=False),
        sa.Column("text", sa.String, nullable=False),
        sa.Column("scenario_text", sa.String, nullable=False),
        sa.Column("craft", sa.String, nullable=False),
        sa.Column("who", sa.String, nullable=False),
        sa.Column("state", sa.String, nullable=False),
        sa.Column("problem", sa.String, nullable=False),
        sa.Column("runs", sa.Integer, nullable=False),
        sa.Column("done", sa.Integer, nullable=False),
        sa.Column("failed", sa.Integer, nullable=False),
        sa.Column("best", sa.String, nullable=False),
        sa.Column("best_figure", sa.String, nullable=False),
        sa.Column("parameters", sa.String, nullable=False),
        sa.Column("made", sa.Float, nullable=False),
        sa.Column("started", sa.Float),
        sa.Column("ended", sa.Float),
        sqlite_autoincrement=True,
    )
    op.create_table(
        "run_figures",
        sa.Column("key", sa.String, primary_key=True),
        sa.Column("firmware", sa.String, nullable=False),
        sa.Column("software", sa.String, nullable=False),
        sa.Column("simulated", sa.Float, nullable=False),
        sa.Column("seconds", sa.Float, nullable=False),
        sa.Column("problem", sa.String, nullable=False),
        sa.Column("figures", sa.String, nullable=False),
        sa.Column("words", sa.String, nullable=False),
    )
    op.create_table(
        "sweep_run",
        sa.Column("id", sa.Integer, primary_key=True),
        sa.Column("sweep_id", sa.Integer, sa.ForeignKey("sweep.id"), nullable=False),
        sa.Column("number", sa.Integer, nullable=False),
        sa.Column("variant", sa.Integer, nullable=False),
        sa.Column("seed", sa.Integer, nullable=False),
        sa.Column("parameter_values", sa.String, nullable=False),
        sa.Column("key", sa.String, sa.ForeignKey("run_figures.key"), nullable=False),
        sa.UniqueConstraint("sweep_id", "number", name="sweep_run_place"),
    )
    op.create_index("ix_sweep_run_key", "sweep_run", ["key"])


def downgrade() -> None:
    op.drop_table("sweep_run")
    op.drop_table("run_figures")
    op.drop_table("sweep")
