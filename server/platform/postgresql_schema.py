"""The tables of a lab's archive in PostgreSQL: created from the models, and upgraded by the migrations since.

The functions of SQLite that queries use are there by the same names.
"""

from collections.abc import Sequence

from sqlalchemy import Connection, create_engine, inspect, pool
from sqlalchemy.exc import DBAPIError
from sqlmodel import SQLModel

from migrations import HEAD, known_revisions, make_config
from server.platform import models as _models  # noqa: F401 - its tables
from server.platform.postgresql import CONNECT_SECONDS, PostgreSQL
from server.platform.settings import SetupError

FIRST = "0015"
"""The oldest revision that an archive may have: the migrations after it work on both databases."""

_LOWER = "replace(lower({} COLLATE \"und-x-icu\"), 'ß', 'ss')"
FUNCTIONS = {
    "casefold(words text) RETURNS text": f"SELECT replace({_LOWER.format('words')}, 'ς', 'σ')",
    # As server.platform.searching.fold.
    "fold(words text) RETURNS text": "SELECT regexp_replace("
    "normalize(casefold(normalize(words, NFKD)), NFKD), '[\\u0300-\\u036f]', '', 'g')",
    "instr(words text, word text) RETURNS integer": "SELECT strpos(words, word)",
    "json_extract(document text, path text) RETURNS text": "SELECT jsonb_path_query_first(document::jsonb, "
    "path::jsonpath) #>> '{}'",
    "json_each(document text, path text) RETURNS TABLE (value text)": "SELECT jsonb_array_elements_text("
    "jsonb_path_query_first(document::jsonb, path::jsonpath))",
}


def prepare_archive(url: str) -> None:
    """Create or upgrade the tables.

    Raise SetupError where the database cannot be reached, is another program's or of a newer version.
    """
    engine = create_engine(url, poolclass=pool.NullPool, connect_args={"connect_timeout": CONNECT_SECONDS})
    try:
        with engine.begin() as connection:
            _prepare(connection, url)
    except DBAPIError as problem:
        raise SetupError(
            f"The archive {url} cannot be used: {PostgreSQL(url).explain(problem)}. docs/run/lab.md says "
            "how to make it."
        ) from problem


def measure_archive(url: str) -> int:
    """Return the bytes of an archive, which this version can use or upgrade; nothing is changed.

    Raise SetupError where it cannot be reached or used.
    """
    engine = create_engine(url, poolclass=pool.NullPool, connect_args={"connect_timeout": CONNECT_SECONDS})
    try:
        with engine.connect() as connection:
            if tables := inspect(connection).get_table_names():
                _read_revision(connection, tables, url)
            return PostgreSQL(url).measure(connection).size
    except DBAPIError as problem:
        raise SetupError(f"{PostgreSQL(url).explain(problem)}.") from problem


def _prepare(connection: Connection, url: str) -> None:
    encoding = connection.exec_driver_sql("SHOW server_encoding").scalar_one()
    if encoding != "UTF8":
        raise SetupError(f"The archive {url} stores texts as {encoding}. Make one with the encoding UTF8.")
    # One lab at a time creates or upgrades.
    connection.exec_driver_sql("SELECT pg_advisory_xact_lock(1)")
    tables = inspect(connection).get_table_names()
    if not tables:
        for head, body in FUNCTIONS.items():
            connection.exec_driver_sql(f"CREATE FUNCTION {head} IMMUTABLE LANGUAGE sql AS $$ {body} $$")
        SQLModel.metadata.create_all(connection)
        connection.exec_driver_sql("CREATE TABLE alembic_version (version_num varchar(32) PRIMARY KEY)")
        connection.exec_driver_sql(f"INSERT INTO alembic_version VALUES ('{HEAD}')")
        return
    if _read_revision(connection, tables, url) != HEAD:
        from alembic import command

        config = make_config()
        config.attributes["connection"] = connection
        command.upgrade(config, "head")


def _read_revision(connection: Connection, tables: Sequence[str], url: str) -> str:
    """Return the revision of an archive. Raise SetupError where this version cannot use it."""
    if "alembic_version" not in tables:
        raise SetupError(f"The archive {url} holds tables of another program. Name another database.")
    revision = str(connection.exec_driver_sql("SELECT version_num FROM alembic_version").scalar_one())
    if revision != HEAD:
        _refuse_unknown(revision, url)
    return revision


def _refuse_unknown(revision: str, url: str) -> None:
    if not revision >= FIRST or revision not in known_revisions():
        raise SetupError(
            f"The archive {url} was written by a newer version (its revision is {revision}, this "
            f"version's is {HEAD}). Install that version, or name another database."
        )
