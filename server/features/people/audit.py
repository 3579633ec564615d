"""Operations on the audit log, the list of all acts. Nobody can change it."""

import asyncio
from collections.abc import Iterator, Sequence
from datetime import UTC, datetime
from itertools import islice
from typing import Annotated

from fastapi import Depends, Query, Response
from pydantic import ConfigDict

from server.http.audit import AuditLog
from server.http.dependencies import Provided
from server.http.operations import Operations
from server.http.sign_in.policy import Need
from server.platform.audit_file import AuditEntry, read_entries
from server.platform.csv_cells import STYLES, CsvStyle, Spreadsheet, escape_formula
from server.platform.schema_base import Schema
from server.platform.searching import fold

LISTED_MOST = 200
WORDS_MAX = 100
COLUMNS = ("utc", "who", "device", "role", "address", "action", "about", "outcome", "count")

router = Operations(prefix="/api/audit", tags=["access"])
Words = Annotated[str, Query(max_length=WORDS_MAX)]
Moment = Annotated[float | None, Query(allow_inf_nan=False, description="s since 1970")]


class AuditFilter(Schema):
    """Conditions on entries of the audit log."""

    model_config = ConfigDict(frozen=True)
    who: str
    what: str
    since: float | None
    until: float | None

    def fits(self, entry: AuditEntry) -> bool:
        """Return True where the entry meets the conditions, without regard to case and accents."""
        if self.since is not None and entry.time < self.since:
            return False
        if self.until is not None and entry.time > self.until:
            return False
        named = f"{entry.who} {entry.role} {entry.address}"
        did = f"{entry.action} {entry.about} {entry.outcome}"
        return fold(self.who) in fold(named) and fold(self.what) in fold(did)


class AuditList(Schema):
    """Entries, newest first; `more`: older matching entries exist."""

    entries: list[AuditEntry]
    more: bool


async def _choose(
    who: Words = "", what: Words = "", since: Moment = None, until: Moment = None
) -> AuditFilter:
    return AuditFilter(who=who, what=what, since=since, until=until)


Chosen = Annotated[AuditFilter, Depends(_choose)]


@router.operation("GET", Need.OPERATOR)
async def list_audit(audit: Provided[AuditLog], chosen: Chosen) -> AuditList:
    """List the audit log, newest first, at most 200 entries.

    `who` is searched in name, role and address, `what` in action, details and outcome.
    """
    entries = await asyncio.to_thread(lambda: list(islice(_find(audit, chosen), LISTED_MOST + 1)))
    return AuditList(entries=entries[:LISTED_MOST], more=len(entries) > LISTED_MOST)


@router.operation("GET /csv", Need.OPERATOR, media_type="text/csv")
async def export_audit(
    audit: Provided[AuditLog], chosen: Chosen, spreadsheet: Spreadsheet = "none"
) -> Response:
    """Download the matching entries as CSV, newest first.

    `spreadsheet` is the decimal sign of the spreadsheet that reads it.
    """
    text = await asyncio.to_thread(lambda: _write_csv(_find(audit, chosen), STYLES[spreadsheet]))
    headers = {"Content-Disposition": 'attachment; filename="mucat-audit.csv"'}
    return Response(text, media_type="text/csv", headers=headers)


def _find(audit: AuditLog, chosen: AuditFilter) -> Iterator[AuditEntry]:
    return (entry for entry in read_entries(audit.folder) if chosen.fits(entry))


def _write_csv(entries: Iterator[AuditEntry], style: CsvStyle) -> str:
    lines: list[Sequence[object]] = [COLUMNS]
    for entry in entries:
        moment = style.moment(datetime.fromtimestamp(entry.time, UTC).isoformat(timespec="milliseconds"))
        device = "" if entry.device is None else entry.device
        texts = (entry.who, entry.role, entry.address, entry.action, entry.about)
        who, role, address, action, about = map(escape_formula, texts)
        lines.append((moment, who, device, role, address, action, about, entry.outcome, entry.count))
    return style.mark + style.write(lines)
