"""Puts each reason of a cell's explanation on its own line; before, "; " was between them and in some."""

import sqlalchemy as sa
from alembic import op

revision = "0009"
down_revision = "0008"
branch_labels = None
depends_on = None

CELL = sa.table(
    "comm_test_cell",
    sa.column("id", sa.Integer),
    sa.column("causes", sa.String),
    sa.column("explanation", sa.String),
)
REMARKS = ("injected faults", "retransmitted frames", "discarded damaged frames")


def upgrade() -> None:
    database = op.get_bind()
    cells = sa.select(CELL).where(CELL.c.explanation.contains("; "))
    for number, causes, explanation in database.execute(cells).all():
        lines = split_reasons(explanation, [*causes.split(", "), *REMARKS])
        database.execute(sa.update(CELL).where(CELL.c.id == number).values(explanation="\n".join(lines)))


def downgrade() -> None:
    op.execute(sa.update(CELL).values(explanation=sa.func.replace(CELL.c.explanation, "\n", "; ")))


def split_reasons(explanation: str, names: list[str]) -> list[str]:
    """Return the reasons in the order of the explanation; each but the first begins with one of the names."""
    first, *parts = explanation.split("; ")
    reasons = [first]
    for part in parts:
        if any(part.startswith(f"{name}: ") for name in names if name):
            reasons.append(part)
        else:
            reasons[-1] += f"; {part}"
    return reasons
