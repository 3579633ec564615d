"""Routes of signing in: pairing, roles, tokens, revocation."""

import time
from typing import Annotated

from fastapi import APIRouter, Path, Request, Response

from server.features.people.pairing_links import pairing_link, qr_svg
from server.features.people.schemas import (
    DeviceChanges,
    DeviceDetails,
    MadeCode,
    MadeToken,
    Me,
    NewCode,
    NewToken,
    Pairing,
)
from server.http.dependencies import Provided
from server.http.problems import answers
from server.http.sign_in.access import Access
from server.http.sign_in.devices import Device, UnknownDeviceError
from server.http.sign_in.identity import IDENTITY, Caller, Identity
from server.http.sign_in.pairing_codes import CODE_SECONDS, TooManyTriesError, WrongCodeError
from server.http.sign_in.policy import Need, list_needs, needs
from server.platform.errors import ConflictError
from server.platform.models import IDENTIFIER_MAX
from server.platform.settings import Settings
from server.platform.store import StoreError

COOKIE_SECONDS = 400 * 86400
"""As long as browsers keep any. Access ends by signing out and by revocation; a Raspberry Pi without a
battery has no clock that could tell when it is too old."""

STORING = answers(ConflictError, StoreError)
UNKNOWN = answers(UnknownDeviceError)

router = APIRouter(prefix="/api/access", tags=["access"])

Number = Annotated[int, Path(ge=1, le=IDENTIFIER_MAX)]


@router.get("/me", summary="Who asks", operation_id="getMe", openapi_extra=needs(Need.NOTHING))
async def get_me(request: Request, settings: Provided[Settings], access: Provided[Access]) -> Me:
    """Answered to everybody."""
    return _me(request, settings, access, request.scope[IDENTITY])


@router.post(
    "/pair",
    summary="Sign this browser in with a code",
    operation_id="pairBrowser",
    openapi_extra=needs(Need.NOTHING),
    responses=answers(WrongCodeError, TooManyTriesError) | STORING,
)
async def pair(
    request: Request,
    settings: Provided[Settings],
    access: Provided[Access],
    response: Response,
    body: Pairing,
) -> Me:
    """Sets a cookie. A browser that has one keeps it, and gets the code's role where that is more."""
    identity, secret = await access.pair(body.code, body.name, request.scope[IDENTITY])
    if secret is not None:
        response.set_cookie(
            access.cookie,
            secret,
            max_age=COOKIE_SECONDS,
            httponly=True,
            samesite="strict",
            secure=request.url.scheme == "https",
        )
    return _me(request, settings, access, identity)


@router.post(
    "/sign-out",
    status_code=204,
    summary="Sign this browser out",
    operation_id="signOut",
    openapi_extra=needs(Need.VIEWER),
    responses=STORING,
)
async def sign_out(access: Provided[Access], caller: Caller, response: Response) -> None:
    """It has to be paired anew afterwards. For a program: its token is void."""
    await access.sign_out(caller)
    response.delete_cookie(access.cookie, httponly=True, samesite="strict")


@router.post(
    "/codes",
    status_code=201,
    summary="Make a pairing code",
    operation_id="makeCode",
    openapi_extra=needs(Need.OPERATOR),
)
async def make_code(
    request: Request, settings: Provided[Settings], access: Provided[Access], body: NewCode
) -> MadeCode:
    """For one browser, within ten minutes."""
    code = access.codes.make(body.role)
    link = pairing_link(settings.base_url(_called(request)), code)
    expires = time.time() + CODE_SECONDS
    return MadeCode(code=code, link=link, role=body.role, expires=expires, qr_svg=qr_svg(link))


@router.get(
    "/devices", summary="Who may come in", operation_id="listDevices", openapi_extra=needs(Need.OPERATOR)
)
async def get_devices(access: Provided[Access], caller: Caller) -> list[DeviceDetails]:
    """Browsers and programs, in the order in which they came."""
    return [_describe(caller, device) for device in access.devices.all()]


@router.patch(
    "/devices/{device}",
    summary="Rename, promote or demote",
    operation_id="changeDevice",
    openapi_extra=needs(Need.OPERATOR),
    responses=UNKNOWN | STORING,
)
async def change(
    access: Provided[Access], caller: Caller, device: Number, body: DeviceChanges
) -> DeviceDetails:
    """A new role closes its live sockets, which come back in that role."""
    if body.role is not None:
        await access.set_role(device, body.role, caller)
    if body.name is not None:
        await access.rename(device, body.name)
    return _describe(caller, access.devices.get(device))


@router.delete(
    "/devices/{device}",
    status_code=204,
    summary="Revoke access",
    operation_id="revokeDevice",
    openapi_extra=needs(Need.OPERATOR),
    responses=UNKNOWN | STORING,
)
async def revoke(access: Provided[Access], caller: Caller, device: Number) -> None:
    """At once, also on live sockets, which are closed."""
    await access.revoke(device, caller)


@router.post(
    "/tokens",
    status_code=201,
    summary="Let a program in",
    operation_id="makeToken",
    openapi_extra=needs(Need.OPERATOR),
    responses=STORING,
)
async def make_token(access: Provided[Access], caller: Caller, body: NewToken) -> MadeToken:
    """The token is shown this once; the program sends it as `Authorization: Bearer`."""
    device, token = await access.make_program(body.name, body.role, caller)
    return MadeToken(token=token, device=_describe(caller, device))


def _called(request: Request) -> str:
    return request.headers["host"].rsplit(":", 1)[0].lower()


def _me(request: Request, settings: Settings, access: Access, identity: Identity | None) -> Me:
    return Me(
        signed_in=identity is not None,
        robot=settings.robot,
        identity=identity,
        pairing_open=access.codes.any_valid,
        operators_only=[
            name
            for name, need in list_needs(request.app.routes).items()
            if identity and need is not None and need >= Need.OPERATOR
        ],
    )


def _describe(caller: Identity, device: Device) -> DeviceDetails:
    return DeviceDetails(
        id=device.id,
        name=device.name,
        role=device.role,
        kind=device.kind,
        paired=device.paired,
        seen=device.seen,
        you=caller.device == device.id,
    )
