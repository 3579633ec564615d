"""The sweep: a TOML document that varies entries of a scenario, read strictly.

A variant is one choice of values; a run is a variant with a seed. All variants have the same seeds, so that
they can be compared in pairs. docs/use/sweeps.md has the table.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, fields
from itertools import islice, product
from math import prod
from typing import Annotated, Any

from robot_runtime.contract.craft import Craft
from robot_runtime.contract.limits import ConfigError, Range
from robot_runtime.contract.parsing import TOP, parse, read_value
from robot_runtime.contract.problems import DocumentEntry, EntryProblem
from robot_runtime.contract.toml_text import TomlError, read_toml
from robot_runtime.experiments.scenario.document import (
    DEFAULT_CRAFT,
    DURATION,
    NAME,
    SEED,
    TITLE_MAX,
    read_scenario_table,
)
from robot_runtime.experiments.sweep.parameter import (
    SweptParameter,
    Value,
    change_table,
    find_specifications,
    read_parameter,
)

FORMAT = 1
RUNS_MAX = 100_000
SEEDS_MAX = 1000
PARAMETERS_MAX = 12
CHECKED_MAX = 200
"""Variants that are checked as a whole before the sweep begins; of more, each value is checked by itself, and
a variant that cannot be run is a failed run."""
SEARCH_VARIANTS = Range(10, 10_000)
OWN = ("name", "title", "description", "seed")
"""Entries of the scenario that a sweep does not vary."""


@dataclass(frozen=True, slots=True, kw_only=True)
class SweepFigures:
    """The figures of each run: from and to (s since the scenario's start), by default while armed.

    `best` is the figure by which variants are ranked, by its mean over the seeds. A variant whose mean
    exceeds one of `limits` is not the best.
    """

    start: float | None = None
    end: float | None = None
    best: str = "rmse"
    limits: Mapping[str, float]


@dataclass(frozen=True, slots=True, kw_only=True)
class SearchSettings:
    """The search of the best variant: how many are tried, and the seed of the first ones."""

    variants: Annotated[int, SEARCH_VARIANTS] = 60
    seed: Annotated[int, SEED] = 1


@dataclass(frozen=True, slots=True, kw_only=True)
class SweepRun:
    """A run: its number from 1, its variant's number from 1, its seed, and the value of each parameter."""

    number: int
    variant: int
    seed: int
    values: tuple[Value, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class Sweep:
    """A sweep that can be run; `table` is the scenario's."""

    name: str
    title: str
    scenario: str
    table: Mapping[str, Any]
    seeds: Sequence[int]
    parameters: tuple[SweptParameter, ...]
    figures: SweepFigures
    search: SearchSettings | None = None

    @property
    def variants(self) -> int:
        """The number of variants; of a search, the most that are tried."""
        return prod(parameter.count for parameter in self.parameters) if self.search is None else self._tried

    @property
    def runs(self) -> int:
        """The number of runs."""
        return self.variants * len(self.seeds)

    @property
    def generation(self) -> int:
        """The number of variants that a search tries at once."""
        return max(5 * sum(parameter.kind == "search" for parameter in self.parameters), 5)

    @property
    def _tried(self) -> int:
        assert self.search is not None
        return max(self.search.variants // self.generation, 2) * self.generation

    def grid(self) -> Iterator[tuple[Value | None, ...]]:
        """Yield the values of each variant; None where the seed draws it. The first varies slowest."""
        return product(*(parameter.values or (None,) for parameter in self.parameters))

    def runs_of(self, variant: int, values: Sequence[Value | None]) -> Iterator[SweepRun]:
        """Yield the runs of a variant."""
        for index, seed in enumerate(self.seeds):
            yield SweepRun(
                number=(variant - 1) * len(self.seeds) + index + 1,
                variant=variant,
                seed=seed,
                values=tuple(
                    parameter.draw(seed) if value is None else value
                    for parameter, value in zip(self.parameters, values, strict=True)
                ),
            )

    def scenario_of(self, run: SweepRun) -> dict[str, Any]:
        """Return the scenario of a run as a table. Raise ConfigError where it cannot be written."""
        return {**self._changed(run.values), "seed": run.seed}

    def _changed(self, values: Sequence[Value]) -> dict[str, Any]:
        changes = zip((parameter.path for parameter in self.parameters), values, strict=True)
        return change_table(self.table, changes)


def read_sweep(text: str, scenarios: Mapping[str, str], figures: Mapping[str, bool]) -> Sweep:
    """Return the sweep in a TOML text. Raise ConfigError with all problems of the document.

    `scenarios` are the texts of the library's, by name. `figures` are those that are measured, True where a
    best one exists. `check_variants` says whether the scenario takes the values.
    """
    try:
        table = read_toml(text)
    except TomlError as problem:
        raise ConfigError(f"the sweep {problem}") from problem
    return _SweepReader(table, scenarios, figures).read()


@dataclass(frozen=True, slots=True, kw_only=True)
class _Head:
    """The entries of the document beside its tables."""

    format: int
    name: str
    title: str = ""
    scenario: str


class _SweepReader:
    """The reader of one document; it gathers its problems."""

    def __init__(
        self, table: dict[str, Any], scenarios: Mapping[str, str], figures: Mapping[str, bool]
    ) -> None:
        self._table = table
        self._scenarios = scenarios
        self._figures = figures
        self._problems: list[EntryProblem] = []

    def read(self) -> Sweep:
        """Return the sweep, of which no variant is checked yet. Raise ConfigError."""
        written = self._table.get("format", FORMAT)
        if written != FORMAT:
            # Whatever else it has, this version does not know it.
            raise ConfigError(
                TOP.field("format").problem(
                    f"is {str(written)[:20]}; this version reads {FORMAT}: use the version that wrote it"
                )
            )
        tables = ("seeds", "vary", "figures", "search")
        head: _Head | None = None
        try:
            head = parse(_Head, {name: value for name, value in self._table.items() if name not in tables})
        except ConfigError as problem:
            self._problems += [
                EntryProblem(
                    problem.path,
                    problem.text.replace(_KNOWN_HEAD, _KNOWN),
                    problem.words.replace(_KNOWN_HEAD, _KNOWN),
                )
                for problem in problem.problems
            ]
        else:
            self._check_head(head)
        search = self._search()
        parameters = self._parameters(searched=search is not None)
        seeds = self._seeds()
        figures = self._read_figures()
        runs = prod(parameter.count for parameter in parameters) * len(seeds)
        if search is None and runs > RUNS_MAX:
            self._add(_too_many(runs))
        table = {} if head is None else self._scenario(head.scenario)
        if head is None or self._problems:
            raise ConfigError(*self._problems)
        sweep = Sweep(
            name=head.name,
            title=head.title or head.name,
            scenario=head.scenario,
            table=table,
            seeds=seeds,
            parameters=parameters,
            figures=figures,
            search=search,
        )
        if sweep.runs > RUNS_MAX:
            raise ConfigError(_too_many(sweep.runs))
        return sweep

    def _add(self, *problems: EntryProblem) -> None:
        self._problems += problems

    def _check_head(self, head: _Head) -> None:
        if not NAME.fullmatch(head.name):
            self._add(
                TOP.field("name").problem(
                    f"is {head.name[:80]!r}; it is 1 to 60 small letters, digits, - and _"
                )
            )
        if len(head.title) > TITLE_MAX:
            self._add(TOP.field("title").problem(f"has more than {TITLE_MAX} characters"))

    def _scenario(self, name: str) -> dict[str, Any]:
        where = TOP.field("scenario")
        if name not in self._scenarios:
            known = ", ".join(self._scenarios)
            self._add(where.problem(f"is {name[:80]!r}; the library has {known}"))
            return {}
        try:
            return read_toml(self._scenarios[name])
        except TomlError as problem:
            self._add(where.sentence(f"{name} {problem}"))
            return {}

    def _seeds(self) -> Sequence[int]:
        where = TOP.field("seeds")
        given = self._table.get("seeds", 1)
        try:
            if not isinstance(given, list):
                return range(1, read_value(Annotated[int, Range(1, SEEDS_MAX)], given, where) + 1)
            seeds = read_value(list[Annotated[int, SEED]], given, where)
        except ConfigError as problem:
            self._add(*problem.problems)
            return (1,)
        if not 1 <= len(seeds) <= SEEDS_MAX:
            self._add(where.problem(f"has {len(seeds)} entries; there are 1 to {SEEDS_MAX}"))
        if len(set(seeds)) < len(seeds):
            self._add(where.problem("names a seed twice"))
        return tuple(seeds)

    def _search(self) -> SearchSettings | None:
        if "search" not in self._table:
            return None
        try:
            read: SearchSettings = read_value(SearchSettings, self._table["search"], TOP.field("search"))
        except ConfigError as problem:
            self._add(*problem.problems)
            return SearchSettings()
        return read

    def _parameters(self, *, searched: bool) -> tuple[SweptParameter, ...]:
        where = TOP.field("vary")
        given = self._table.get("vary", {})
        if not isinstance(given, dict):
            self._add(where.problem("must be a table, headed [vary]"))
            return ()
        parameters = []
        for name, entry, specification in find_specifications(given, where):
            if name.split(".")[0] in OWN:
                more = "; `seeds` says which" if name == "seed" else ""
                self._add(entry.problem(f"cannot vary{more}"))
                continue
            try:
                parameters.append(read_parameter(name, entry, specification, searched=searched))
            except ConfigError as problem:
                self._add(*problem.problems)
        if len(parameters) > PARAMETERS_MAX:
            self._add(where.problem(f"has {len(parameters)} entries; there are {PARAMETERS_MAX} at most"))
        if searched and not any(parameter.kind == "search" for parameter in parameters):
            self._add(
                TOP.field("search").problem("needs an entry under [vary] such as { from = 0.5, to = 4.0 }")
            )
        return tuple(parameters)

    def _read_figures(self) -> SweepFigures:
        where = TOP.field("figures")
        given = self._table.get("figures", {})
        none = SweepFigures(limits={})
        if not isinstance(given, dict):
            self._add(where.problem("must be a table, headed [figures]"))
            return none
        known = ("from", "to", "best", "limits")
        self._add(
            *(
                where.field(name, repr(name)).problem(f"is not known here; known are {', '.join(known)}")
                for name in given
                if name not in known
            )
        )
        seconds = Annotated[float, Range(0, DURATION.maximum)]
        try:
            figures = SweepFigures(
                start=read_value(seconds | None, given.get("from"), where.field("from")),
                end=read_value(seconds | None, given.get("to"), where.field("to")),
                best=read_value(str, given.get("best", "rmse"), where.field("best")),
                limits=read_value(dict[str, float], given.get("limits", {}), where.field("limits")),
            )
        except ConfigError as problem:
            self._add(*problem.problems)
            return none
        self._check_figures(figures, where)
        return figures

    def _check_figures(self, figures: SweepFigures, where: DocumentEntry) -> None:
        ranked = [name for name, has_best in self._figures.items() if has_best]
        if figures.best not in ranked:
            self._add(where.field("best").problem(f"is {figures.best[:80]!r}; there are {', '.join(ranked)}"))
        for name in figures.limits:
            if name not in self._figures:
                self._add(
                    where.field("limits")
                    .key(name)
                    .problem(f"is no figure; there are {', '.join(self._figures)}")
                )
        if figures.start is not None and figures.end is not None and figures.end <= figures.start:
            self._add(where.field("to").problem(f"is {figures.end:g} s; it must be after `from`"))


_KNOWN_HEAD = ", ".join(field.name for field in fields(_Head))
_KNOWN = f"{_KNOWN_HEAD}, seeds, vary, figures, search"


def _too_many(runs: int) -> EntryProblem:
    # More digits than Python writes at once would be an error of their own.
    shown = f"{runs:,}" if runs < 10**12 else "more than 10¹²"
    return TOP.field("vary").sentence(
        f"These are {shown} runs; there can be {RUNS_MAX:,} at most. Take fewer values or seeds, samples of "
        "a range (uniform, samples), or [search]."
    )


def check_variants(sweep: Sweep, craft: Craft = DEFAULT_CRAFT) -> None:
    """Check the scenario on this robot's craft, each value, and the variants where they are few.

    Raise ConfigError with all problems.
    """
    try:
        read_scenario_table(dict(sweep.table), craft)
    except ConfigError as problem:
        raise ConfigError(
            *(TOP.field("scenario").sentence(f"{sweep.scenario}: {text}") for text in problem.texts)
        ) from problem
    problems: dict[str, EntryProblem] = {}
    first = [parameter.checked[0][1] for parameter in sweep.parameters]
    for index, parameter in enumerate(sweep.parameters):
        for where, value in parameter.checked:
            tried = [*first[:index], value, *first[index + 1 :]]
            for entry in _find_problems(sweep, tried, where, craft):
                problems.setdefault(entry.text, entry)
    if not problems and sweep.search is None and sweep.variants <= CHECKED_MAX:
        for variant, values in enumerate(islice(sweep.grid(), CHECKED_MAX), 1):
            run = next(sweep.runs_of(variant, values))
            where = TOP.field("vary")
            for entry in _find_problems(sweep, run.values, where, craft):
                named = " and ".join(
                    f"{parameter.name} = {value}"
                    for parameter, value in zip(sweep.parameters, run.values, strict=True)
                )
                problems.setdefault(entry.text, where.sentence(f"With {named}: {entry.words}"))
    if problems:
        raise ConfigError(*problems.values())


def _find_problems(
    sweep: Sweep, values: Sequence[Value], where: DocumentEntry, craft: Craft
) -> Iterator[EntryProblem]:
    try:
        changes = zip((parameter.path for parameter in sweep.parameters), values, strict=True)
        read_scenario_table(change_table(sweep.table, changes), craft)
    except ConfigError as problem:
        for text in problem.texts:
            yield where.sentence(text)
