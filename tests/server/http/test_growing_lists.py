"""Every list of the interface that grows with data has a limit, also that of the next route."""

from collections.abc import Iterator
from dataclasses import replace
from typing import Any

from robot_runtime.contract.missions import NODES_MAX
from robot_runtime.contract.vision_settings import COLOURS_MAX, MARKERS_MAX
from robot_runtime.experiments.comm_test.document import CELLS_MAX
from robot_runtime.experiments.scenario.document import EVENTS_MAX as SCENARIO_EVENTS_MAX
from robot_runtime.experiments.sweep.document import PARAMETERS_MAX as SWEPT_MAX
from robot_runtime.experiments.sweep.parameter import COUNT_MAX as VALUES_MAX
from server.analysis.flags import FLAGS_MAX
from server.analysis.schemas import SESSIONS_MAX
from server.analysis.segment import SEGMENTS_MAX
from server.analysis.story import COLUMNS
from server.analysis.story_schemas import SPECTRA_MAX
from server.analysis.study import FREQUENCIES_MAX, PAIRS_MAX
from server.analysis.summary import NAMES_MAX
from server.analysis.track import POINTS_MAX, TRACKS_MAX
from server.app import create_app
from server.driving.changes import SHOWN
from server.driving.profiles import PARAMETERS_MAX, PROFILES_MAX
from server.features.comm_tests.runs import LISTED_MOST as TESTS_LISTED
from server.features.comparison.figure_query import BEST_SHOWN, BINS, PERIODS_MAX
from server.features.comparison.figure_query import GROUPS_MAX as GROUPS_TOLD_APART
from server.features.doors.house import CLIENTS_MAX
from server.features.doors.subscriptions import SUBSCRIPTIONS_MAX
from server.features.exports.archive_models import COLUMNS_MAX, TAGS_MAX, TOPICS_MAX
from server.features.exports.jobs import JOBS_MAX
from server.features.lab.pull import PROBLEMS_SHOWN
from server.features.layouts.library import LAYOUTS_MOST
from server.features.missions.library import MISSIONS_MAX, VERSIONS_MAX
from server.features.missions.past_runs import RUNS_MAX
from server.features.missions.schemas import SEEDS_MAX
from server.features.panels.scripts import PANELS_SHOWN
from server.features.people.audit import LISTED_MOST as ENTRIES_LISTED
from server.features.roster.roster import DEPTHS
from server.features.scenarios.library import SCENARIOS_MAX
from server.features.scenarios.runs import QUEUE_MAX
from server.features.sweeps.library import RUNS_LISTED_MAX
from server.features.sweeps.results import REASONS_MAX, VARIANTS_SHOWN
from server.features.sweeps.store import LISTED_MAX as SWEEPS_LISTED
from server.features.tuning.runs import LISTED_MOST as RUNS_LISTED
from server.http.sign_in.devices import DEVICES_MAX, LINKS_MAX
from server.library.crafts import CRAFTS_MAX
from server.library.film import SPANS_SHOWN
from server.library.listing import COLUMNS_SHOWN, GROUPS_MAX, PAGE_MAX, TAGS_SHOWN
from server.library.missions import MISSIONS_SHOWN
from server.library.schemas import ARCHIVED_MAX, SHOWN_MAX
from server.library.snapshots import SNAPSHOTS_SHOWN
from server.platform.paired_robots import ROBOTS_MAX
from server.platform.settings import Settings
from server.recording.schemas import CURVE_POINTS

LIMITS = {
    "/api/access/devices": DEVICES_MAX,
    "/api/access/reading-links": LINKS_MAX,
    "/api/audit entries": ENTRIES_LISTED,
    "/api/comm-tests/runs": TESTS_LISTED,
    "/api/comm-tests/runs/{run} results": CELLS_MAX,
    "/api/doors clients": CLIENTS_MAX,
    "/api/doors clients topics": SUBSCRIPTIONS_MAX,
    "/api/exports": JOBS_MAX,
    "/api/figures course": PERIODS_MAX,
    "/api/figures edges": BINS + 1,
    "/api/figures greatest": BEST_SHOWN,
    "/api/figures groups": GROUPS_TOLD_APART + 1,
    "/api/figures groups bins": BINS,
    "/api/figures least": BEST_SHOWN,
    "/api/identification active sessions": SESSIONS_MAX,
    "/api/identification last result sessions": SESSIONS_MAX,
    "/api/identification last sessions": SESSIONS_MAX,
    "/api/lab/pulls": ROBOTS_MAX,
    "/api/lab/pulls problems": PROBLEMS_SHOWN,
    "/api/layouts": LAYOUTS_MOST,
    "/api/missions": MISSIONS_MAX,
    "/api/missions summary steps": NODES_MAX,
    "/api/missions/state steps": NODES_MAX,
    "/api/missions/trial results": SEEDS_MAX,
    "/api/missions/versions/{name}": VERSIONS_MAX,
    "/api/panels": PANELS_SHOWN,
    "/api/parameters/changes": SHOWN,
    "/api/parameters/changes values": PARAMETERS_MAX,
    "/api/profiles": PROFILES_MAX,
    "/api/profiles values": PARAMETERS_MAX,
    "/api/robots robots": ROBOTS_MAX,
    "/api/robots robots depths": DEPTHS,
    "/api/scenarios": SCENARIOS_MAX,
    "/api/scenarios summary events": SCENARIO_EVENTS_MAX,
    "/api/scenarios/state active events": SCENARIO_EVENTS_MAX,
    "/api/scenarios/state queued": QUEUE_MAX,
    "/api/sessions": PAGE_MAX,
    "/api/missions/runs/{name}": RUNS_MAX,
    "/api/missions/runs/{name} session summary cards": NAMES_MAX,
    "/api/missions/runs/{name} session summary controllers": NAMES_MAX,
    "/api/missions/runs/{name} session summary curve": CURVE_POINTS,
    "/api/missions/runs/{name} session summary modes": NAMES_MAX,
    "/api/missions/runs/{name} session tags": TAGS_MAX,
    "/api/sessions summary cards": NAMES_MAX,
    "/api/sessions summary controllers": NAMES_MAX,
    "/api/sessions summary curve": CURVE_POINTS,
    "/api/sessions summary modes": NAMES_MAX,
    "/api/sessions tags": TAGS_MAX,
    "/api/sessions/controllers": TAGS_SHOWN,
    "/api/sessions/edits": ARCHIVED_MAX,
    "/api/sessions/groups": GROUPS_MAX,
    "/api/sessions/robots": TAGS_SHOWN,
    "/api/sessions/{session} summary cards": NAMES_MAX,
    "/api/sessions/{session} summary controllers": NAMES_MAX,
    "/api/sessions/{session} summary curve": CURVE_POINTS,
    "/api/sessions/{session} summary modes": NAMES_MAX,
    "/api/sessions/{session} crafts": CRAFTS_MAX,
    "/api/sessions/{session} gaps": SHOWN_MAX,
    "/api/sessions/{session}/film spans": SPANS_SHOWN,
    "/api/sessions/{session} marks": SHOWN_MAX,
    "/api/sessions/{session} tags": TAGS_MAX,
    "/api/sessions/{session} topics": TOPICS_MAX,
    "/api/sessions/{session} topics columns": COLUMNS_SHOWN,
    "/api/sessions/{session}/missions": MISSIONS_SHOWN,
    "/api/sessions/{session}/missions mission steps": NODES_MAX,
    "/api/sessions/{session}/missions started": NODES_MAX,
    "/api/sessions/{session}/signals": COLUMNS_MAX,
    "/api/sessions/{session}/snapshots": SNAPSHOTS_SHOWN,
    **{
        f"/api/sessions/{{session}}/story {line} {column}": 2 * COLUMNS + 1
        for line in ("depth", "set_point")
        for column in ("time", "low", "high")
    },
    "/api/sessions/{session}/story flags": FLAGS_MAX,
    "/api/sessions/{session}/story segments": SEGMENTS_MAX,
    "/api/sessions/{session}/story/figures segments": SEGMENTS_MAX,
    "/api/sessions/{session}/track": TRACKS_MAX,
    **{
        f"/api/sessions/{{session}}/track {way} {column}": POINTS_MAX
        for way in ("estimate", "truth")
        for column in ("time", "x", "y", "depth")
    },
    "/api/sessions/{session}/spectrum": SPECTRA_MAX,
    **{
        f"/api/sessions/{{session}}/spectrum {column}": FREQUENCIES_MAX for column in ("frequency", "density")
    },
    **{f"/api/sessions/{{session}}/pair {column}": PAIRS_MAX for column in ("time", "x_values", "y_values")},
    "/api/sessions/{session}/timeline events": SHOWN_MAX,
    "/api/sessions/{session}/timeline holes": SHOWN_MAX,
    "/api/sessions/{session}/timeline markers": SHOWN_MAX,
    "/api/sweeps": SWEEPS_LISTED,
    "/api/sweeps best values": SWEPT_MAX,
    "/api/sweeps parameters": SWEPT_MAX,
    "/api/sweeps/{sweep} failures": REASONS_MAX,
    "/api/sweeps/{sweep} parameters": SWEPT_MAX,
    "/api/sweeps/{sweep} parameters values": VALUES_MAX,
    "/api/sweeps/{sweep} variants": VARIANTS_SHOWN,
    "/api/sweeps/{sweep} variants values": SWEPT_MAX,
    "/api/sweeps/{sweep}/runs": RUNS_LISTED_MAX,
    "/api/sweeps/{sweep}/runs values": SWEPT_MAX,
    "/api/tags": TAGS_SHOWN,
    "/api/tuning/runs runs": RUNS_LISTED,
    "/api/vision configured actions": COLOURS_MAX + MARKERS_MAX,
    "/api/vision settings actions": COLOURS_MAX + MARKERS_MAX,
    "/api/vision configured colours": COLOURS_MAX,
    "/api/vision settings colours": COLOURS_MAX,
    "/api/vision configured marker_numbers": MARKERS_MAX,
    "/api/vision settings marker_numbers": MARKERS_MAX,
}
"""The most entries of each list, by the path of its operation and its place in the answer."""

FIXED = {
    "/api/robot alarms consequences",
    "/api/access/me operators_only",
    "/api/bring-up hands fins",
    "/api/bring-up raw encoders",
    "/api/bring-up steps",
    "/api/bring-up steps actions",
    "/api/bring-up steps actions inputs",
    "/api/bring-up steps actions inputs choices",
    "/api/bring-up steps results",
    "/api/comm-tests/documents",
    "/api/comm-tests/runs/{run} results causes",
    "/api/comm-tests/runs/{run} results reasons",
    "/api/comm-tests/runs/{run} tools",
    "/api/comm-tests/tables",
    "/api/comm-tests/tables cells",
    "/api/doctor",
    "/api/doors",
    "/api/health parts",
    "/api/identification last result affected",
    "/api/identification last result check channels",
    "/api/identification last result check channels after",
    "/api/identification last result check channels before",
    "/api/identification last result check channels measured",
    "/api/identification last result check times",
    "/api/identification last result missing",
    "/api/identification last result noise",
    "/api/identification last result numbers",
    "/api/identification last result sessions offsets",
    "/api/link/frames fault frames",
    "/api/link/frames fault frames kinds",
    "/api/link/frames frames",
    "/api/link/frames frames kinds",
    "/api/missions/nodes",
    "/api/missions/nodes fields",
    "/api/missions/trial results curve",
    "/api/parameters parameters",
    "/api/parameters parameters choices",
    "/api/robot alarms",
    "/api/robot cards",
    "/api/robot colours",
    "/api/robot loops",
    "/api/robot loops controllers",
    "/api/robot loops controllers gains",
    "/api/robot paces",
    "/api/robot refusals",
    "/api/scenarios/events",
    "/api/scenarios/events fields",
    "/api/scenarios/events fields choices",
    "/api/sessions/{session}/readings fins",
    "/api/sessions/{session}/story segments gains",
    "/api/sessions/{session}/story/figures meanings",
    "/api/sessions/{session}/story/figures segments",
    "/api/sessions/{session}/story/figures whole",
    "/api/sweeps/{sweep} figures",
    "/api/sweeps/{sweep} limits",
    "/api/sweeps/{sweep} variants figures",
    "/api/sweeps/{sweep}/runs figures",
    "/api/topics",
    "/api/topics fields",
    "/api/tuning/runs figures",
    "/api/tuning/runs runs cycle remarks",
    "/api/tuning/runs runs figures",
    "/api/tuning/runs runs force gains",
    "/api/tuning/runs/{run} curve outputs",
    "/api/tuning/runs/{run} curve set_points",
    "/api/tuning/runs/{run} curve times",
    "/api/tuning/runs/{run} curve values",
    "/api/tuning/runs/{run} cycle remarks",
    "/api/tuning/runs/{run} figures",
    "/api/tuning/runs/{run} force gains",
    "/api/tuning/runs/{run} proposals",
    "/api/tuning/runs/{run} proposals gains",
    "/api/tuning/state last cycle remarks",
    "/api/tuning/state last figures",
    "/api/tuning/state last force gains",
}
"""Lists whose length the program, the robot's build or a measurement of bounded length gives."""


def lists(
    schema: dict[str, Any], parts: dict[str, Any], position: str = "", ahead: str = ""
) -> Iterator[str]:
    """Yield the paths of arrays and tables in a schema without a maximum; `ahead`: parts around."""
    if "$ref" in schema:
        name = schema["$ref"].rpartition("/")[2]
        if name not in ahead.split():
            yield from lists(parts[name], parts, position, f"{ahead} {name}")
        return
    for option in (*schema.get("anyOf", ()), *schema.get("oneOf", ()), *schema.get("allOf", ())):
        yield from lists(option, parts, position, ahead)
    for name, option in schema.get("properties", {}).items():
        yield from lists(option, parts, f"{position} {name}", ahead)
    inner = schema.get("items") or schema.get("additionalProperties")
    if isinstance(inner, dict) and "maxItems" not in schema:
        yield position
        yield from lists(inner, parts, position, ahead)


def test_every_list_that_grows_with_data_has_a_limit(settings: Settings) -> None:
    document = create_app(replace(settings, every_feature=True)).openapi()
    results = {
        f"{path}{position}"
        for path, operations in document["paths"].items()
        for status, answer in operations.get("get", {}).get("responses", {}).items()
        if status.startswith("2")
        for content in answer.get("content", {}).values()
        for position in lists(content.get("schema", {}), document["components"]["schemas"])
    }
    assert results == LIMITS.keys() | FIXED
    assert all(limit <= 5000 for limit in LIMITS.values())
