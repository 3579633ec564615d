"""Profiles: parameters kept under names, restored, and carried about as files."""

from typing import Annotated

from fastapi import APIRouter, HTTPException, Path, Request
from fastapi.concurrency import run_in_threadpool
from starlette.responses import Response

from server.container import Assembly
from server.features.operate.routes import COMMAND, SILENT
from server.features.parameters.profiles import ProfileError, file_name, read_file, write_file
from server.features.parameters.routes import ask_parameters
from server.features.parameters.schemas import Imported, NewProfile, Profile, ProfileText, Restored
from server.http.problems import answers
from server.http.sign_in.identity import Identity
from server.platform.models import IDENTIFIER_MAX

UNKNOWN = answers(_404="There is no such profile")
STORED = answers(_503="The database does not work")

router = APIRouter(prefix="/api/profiles", tags=["parameters"])

Identifier = Annotated[int, Path(ge=1, le=IDENTIFIER_MAX)]


@router.get("", summary="Profiles", operation_id="listProfiles", responses=STORED)
async def get_profiles(request: Request) -> list[Profile]:
    """In alphabetical order, with their values."""
    return await run_in_threadpool(Assembly.of(request).profiles.list)


@router.post(
    "",
    status_code=201,
    summary="Keep what is in force",
    operation_id="saveProfile",
    responses={**answers(_409="The name is taken"), **SILENT},
)
async def save_profile(request: Request, wanted: NewProfile) -> Profile:
    """Every parameter as it is now, under a name."""
    listed = await ask_parameters(request)
    values = {one["name"]: one["value"] for one in listed["parameters"]}
    return await Assembly.of(request).profiles.save(wanted.name, wanted.note, values)


@router.post(
    "/file",
    status_code=201,
    summary="Take a profile from a file",
    operation_id="importProfile",
    responses={**answers(_409="The name is taken", _422="The file is no profile of this version"), **SILENT},
)
async def import_profile(request: Request, wanted: ProfileText) -> Imported:
    """Keep it as a profile, which changes nothing of the robot. Parameters that are unknown now are told."""
    try:
        found = read_file(wanted.text)
    except ProfileError as problem:
        raise HTTPException(422, str(problem)) from problem
    listed = await ask_parameters(request)
    profile = await Assembly.of(request).profiles.save(found.name, found.note, found.parameters)
    known = {one["name"] for one in listed["parameters"]}
    return Imported(profile=profile, unknown=[name for name in found.parameters if name not in known])


@router.get(
    "/{profile}/file",
    summary="A profile as a file",
    operation_id="downloadProfile",
    response_class=Response,
    responses={200: {"content": {"application/json": {}}}, **UNKNOWN, **STORED},
)
async def get_file(request: Request, profile: Identifier) -> Response:
    """JSON, which another robot takes too."""
    found = await run_in_threadpool(Assembly.of(request).profiles.find, profile)
    headers = {"Content-Disposition": f'attachment; filename="{file_name(found)}"'}
    return Response(write_file(found), media_type="application/json", headers=headers)


@router.post(
    "/{profile}/restore",
    summary="Bring a profile into force",
    operation_id="restoreProfile",
    responses={**UNKNOWN, **COMMAND},
)
async def restore_profile(request: Request, profile: Identifier) -> Restored:
    """All of its parameters that can be set now; what is unknown or out of range is left out, and said."""
    assembly = Assembly.of(request)
    found = await run_in_threadpool(assembly.profiles.find, profile)
    wanted = {"values": found.values, "partly": True}
    return await assembly.changes.command(
        Identity.of(request).name, "parameters", wanted, why=f"Profile “{found.name}”"
    )


@router.delete(
    "/{profile}",
    status_code=204,
    summary="Delete a profile",
    operation_id="deleteProfile",
    responses={**UNKNOWN, **STORED},
)
async def delete_profile(request: Request, profile: Identifier) -> None:
    """For good."""
    await Assembly.of(request).profiles.delete(profile)
