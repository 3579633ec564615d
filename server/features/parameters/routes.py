"""Operations on parameters of runtime and firmware: values, history, undo, profiles."""

from typing import Any

from fastapi.concurrency import run_in_threadpool
from starlette.responses import Response

from robot_runtime.contract.commands import ParametersCommand
from robot_runtime.contract.documents import Parameters
from robot_runtime.errors import RefusedError
from server.driving.changes import COMMAND_ERRORS, Changes
from server.driving.profiles import (
    Profile,
    ProfileError,
    Profiles,
    UnknownProfileError,
    file_name,
    read_file,
    write_file,
)
from server.driving.schemas import Change, Restored
from server.features.parameters.schemas import Imported, NewProfile, ProfileText, Undo
from server.http.dependencies import Provided
from server.http.operations import Identifier, Operations
from server.http.sign_in.identity import Caller
from server.http.sign_in.policy import Need
from server.stream.bridge import Bridge, RuntimeSilentError

NAME_TAKEN = {409: "The name is taken"}

router = Operations(prefix="/api", tags=["parameters"])


async def ask_parameters(bridge: Bridge) -> dict[str, Any]:
    """Return the present parameters of the runtime. Raise RuntimeSilentError, RefusedError."""
    answer = await bridge.query("parameters")
    return {name: answer[name] for name in ("time", "parameters")}


@router.operation("GET /parameters", Need.VIEWER, *COMMAND_ERRORS, response_model=Parameters)
async def get_parameters(bridge: Provided[Bridge]) -> object:
    """List all parameters.

    Each with type, range, unit, meaning and present value.
    """
    return await ask_parameters(bridge)


@router.operation("GET /parameters/changes", Need.VIEWER)
async def list_parameter_changes(changes: Provided[Changes]) -> list[Change]:
    """List the newest hundred changes of parameters, newest first."""
    return await run_in_threadpool(changes.newest)


@router.operation("POST /parameters/undo", Need.CONTROL, *COMMAND_ERRORS)
async def undo_parameters(changes: Provided[Changes], caller: Caller, body: Undo) -> Restored:
    """Undo the newest change of parameters."""
    return await changes.undo(caller.name, body.change)


@router.operation("GET /profiles", Need.VIEWER)
async def list_profiles(profiles: Provided[Profiles]) -> list[Profile]:
    """List the profiles with their values, in alphabetical order."""
    return await run_in_threadpool(profiles.list)


@router.operation("POST /profiles", Need.OPERATOR, RuntimeSilentError, NAME_TAKEN, status_code=201)
async def save_profile(
    bridge: Provided[Bridge], profiles: Provided[Profiles], caller: Caller, body: NewProfile
) -> Profile:
    """Save all present parameter values as a profile."""
    listed = await ask_parameters(bridge)
    values = {parameter["name"]: parameter["value"] for parameter in listed["parameters"]}
    return await profiles.save(body.name, body.note, values, caller.name)


@router.operation(
    "POST /profiles/file", Need.OPERATOR, ProfileError, RuntimeSilentError, NAME_TAKEN, status_code=201
)
async def import_profile(
    bridge: Provided[Bridge], profiles: Provided[Profiles], caller: Caller, body: ProfileText
) -> Imported:
    """Import a profile from a file.

    The robot's parameters stay unchanged. The answer lists parameters that this robot does not know.
    """
    content = read_file(body.text)
    listed = await ask_parameters(bridge)
    profile = await profiles.save(content.name, content.note, content.parameters, caller.name)
    known = {parameter["name"] for parameter in listed["parameters"]}
    return Imported(profile=profile, unknown=[name for name in content.parameters if name not in known])


@router.operation(
    "GET /profiles/{profile}/file",
    Need.VIEWER,
    UnknownProfileError,
    media_type="application/json",
    linked=True,
)
async def download_profile(profiles: Provided[Profiles], profile: Identifier) -> Response:
    """Download a profile as a JSON file."""
    saved = await run_in_threadpool(profiles.find, profile)
    headers = {"Content-Disposition": f'attachment; filename="{file_name(saved)}"'}
    return Response(write_file(saved), media_type="application/json", headers=headers)


@router.operation("POST /profiles/{profile}/restore", Need.CONTROL, UnknownProfileError, *COMMAND_ERRORS)
async def restore_profile(
    profiles: Provided[Profiles], changes: Provided[Changes], caller: Caller, profile: Identifier
) -> Restored:
    """Restore a profile.

    Sets all of its parameters that can be set now. The answer lists those that are unknown or out of range.
    """
    saved = await run_in_threadpool(profiles.find, profile)
    if not saved.values:
        raise RefusedError(f"The profile “{saved.name}” holds no parameters.")
    body = ParametersCommand(values=saved.values, partly=True)
    return await changes.command(caller.name, body, why=f"Profile “{saved.name}”")


@router.operation("DELETE /profiles/{profile}", Need.OPERATOR, UnknownProfileError)
async def delete_profile(profiles: Provided[Profiles], profile: Identifier) -> None:
    """Delete a profile."""
    await profiles.delete(profile)
