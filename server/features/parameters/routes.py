"""Parameters of runtime and firmware: values, history, undo, and profiles kept under names."""

from typing import Annotated, Any

from fastapi import APIRouter, Path
from fastapi.concurrency import run_in_threadpool
from starlette.responses import Response

from robot_runtime.contract.commands import ParametersCommand
from robot_runtime.contract.documents import Parameters
from robot_runtime.errors import RefusedError
from server.features.parameters.changes import Changes
from server.features.parameters.profiles import (
    ProfileError,
    Profiles,
    UnknownProfileError,
    file_name,
    read_file,
    write_file,
)
from server.features.parameters.schemas import (
    Change,
    Imported,
    NewProfile,
    Profile,
    ProfileText,
    Restored,
    Undo,
)
from server.http.dependencies import Provided
from server.http.problems import COMMAND, SILENT, answers
from server.http.sign_in.identity import Caller
from server.http.sign_in.policy import Need, needs
from server.platform.models import IDENTIFIER_MAX
from server.platform.store import StoreError
from server.stream.bridge import Bridge

UNKNOWN = answers(UnknownProfileError)
STORED = answers(StoreError)

router = APIRouter(prefix="/api", tags=["parameters"])

Identifier = Annotated[int, Path(ge=1, le=IDENTIFIER_MAX)]


async def ask_parameters(bridge: Bridge) -> dict[str, Any]:
    """As the runtime knows them now. Raises RuntimeSilentError, RefusedError."""
    answer = await bridge.query("parameters")
    return {name: answer[name] for name in ("time", "parameters")}


@router.get(
    "/parameters",
    summary="Everything that may be tuned",
    operation_id="getParameters",
    openapi_extra=needs(Need.VIEWER),
    responses={**answers(_409="A communication test uses the robot's board"), **SILENT},
    response_model=Parameters,
)
async def get_parameters(bridge: Provided[Bridge]) -> object:
    """Each with its type, its range, its unit, its meaning and its value, as it is now."""
    return await ask_parameters(bridge)


@router.get(
    "/parameters/changes",
    summary="Who changed what",
    operation_id="listParameterChanges",
    openapi_extra=needs(Need.VIEWER),
    responses=answers(StoreError),
)
async def get_changes(changes: Provided[Changes]) -> list[Change]:
    """The newest hundred, the newest first."""
    return await run_in_threadpool(changes.newest)


@router.post(
    "/parameters/undo",
    summary="Undo a change",
    operation_id="undoParameters",
    openapi_extra=needs(Need.CONTROL),
    responses=COMMAND,
)
async def undo(changes: Provided[Changes], caller: Caller, body: Undo) -> Restored:
    """Set back what the newest change has changed; then the one before it is the newest."""
    return await changes.undo(caller.name, body.change)


@router.get(
    "/profiles",
    summary="Profiles",
    operation_id="listProfiles",
    openapi_extra=needs(Need.VIEWER),
    responses=STORED,
)
async def get_profiles(profiles: Provided[Profiles]) -> list[Profile]:
    """In alphabetical order, with their values."""
    return await run_in_threadpool(profiles.list)


@router.post(
    "/profiles",
    status_code=201,
    summary="Keep what is in force",
    operation_id="saveProfile",
    openapi_extra=needs(Need.OPERATOR),
    responses={**answers(_409="The name is taken"), **SILENT},
)
async def save_profile(bridge: Provided[Bridge], profiles: Provided[Profiles], body: NewProfile) -> Profile:
    """Every parameter as it is now, under a name."""
    listed = await ask_parameters(bridge)
    values = {one["name"]: one["value"] for one in listed["parameters"]}
    return await profiles.save(body.name, body.note, values)


@router.post(
    "/profiles/file",
    status_code=201,
    summary="Take a profile from a file",
    operation_id="importProfile",
    openapi_extra=needs(Need.OPERATOR),
    responses={**answers(ProfileError, _409="The name is taken"), **SILENT},
)
async def import_profile(
    bridge: Provided[Bridge], profiles: Provided[Profiles], body: ProfileText
) -> Imported:
    """Keep it as a profile, which changes nothing of the robot. Parameters that are unknown now are told."""
    found = read_file(body.text)
    listed = await ask_parameters(bridge)
    profile = await profiles.save(found.name, found.note, found.parameters)
    known = {one["name"] for one in listed["parameters"]}
    return Imported(profile=profile, unknown=[name for name in found.parameters if name not in known])


@router.get(
    "/profiles/{profile}/file",
    summary="A profile as a file",
    operation_id="downloadProfile",
    openapi_extra=needs(Need.VIEWER),
    response_class=Response,
    responses={200: {"content": {"application/json": {}}}, **UNKNOWN, **STORED},
)
async def get_file(profiles: Provided[Profiles], profile: Identifier) -> Response:
    """JSON, which another robot takes too."""
    found = await run_in_threadpool(profiles.find, profile)
    headers = {"Content-Disposition": f'attachment; filename="{file_name(found)}"'}
    return Response(write_file(found), media_type="application/json", headers=headers)


@router.post(
    "/profiles/{profile}/restore",
    summary="Bring a profile into force",
    operation_id="restoreProfile",
    openapi_extra=needs(Need.CONTROL),
    responses={**UNKNOWN, **COMMAND},
)
async def restore_profile(
    profiles: Provided[Profiles], changes: Provided[Changes], caller: Caller, profile: Identifier
) -> Restored:
    """All of its parameters that can be set now; what is unknown or out of range is left out, and said."""
    found = await run_in_threadpool(profiles.find, profile)
    if not found.values:
        raise RefusedError(f"The profile “{found.name}” holds no parameters.")
    body = ParametersCommand(values=found.values, partly=True)
    return await changes.command(caller.name, body, why=f"Profile “{found.name}”")


@router.delete(
    "/profiles/{profile}",
    status_code=204,
    summary="Delete a profile",
    operation_id="deleteProfile",
    openapi_extra=needs(Need.OPERATOR),
    responses={**UNKNOWN, **STORED},
)
async def delete_profile(profiles: Provided[Profiles], profile: Identifier) -> None:
    """For good."""
    await profiles.delete(profile)
