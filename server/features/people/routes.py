"""Operations on people and devices: pairing, roles, tokens, revocation."""

import time
from dataclasses import asdict

from fastapi import Request, Response

from server.features.people.schemas import (
    CallerDetails,
    Confirmation,
    DeviceChanges,
    DeviceDetails,
    MadeCode,
    MadeToken,
    NewCode,
    NewToken,
    Paired,
    Pairing,
)
from server.http.audit import address_of
from server.http.dependencies import Provided
from server.http.operations import Identifier, Operations
from server.http.sign_in.access import Access
from server.http.sign_in.devices import Device, UnknownDeviceError
from server.http.sign_in.identity import IDENTITY, SIGN_IN_ENDED, Caller, Identity
from server.http.sign_in.pairing_codes import (
    CODE_SECONDS,
    TooManyTriesError,
    WrongCodeError,
    WrongConfirmationError,
)
from server.http.sign_in.pairing_links import pairing_link, qr_svg
from server.http.sign_in.policy import Need, list_refused
from server.platform.settings import Settings

COOKIE_SECONDS = 400 * 86400
"""The longest time for which browsers keep a cookie."""

TOO_MANY = {409: "Too many devices are paired"}
NO_TOKEN = {409: "Too many devices are paired, or another has the name"}
NO_CHANGE = {409: "No operator would be left, or another has the name"}

router = Operations(prefix="/api/access", tags=["access"])


@router.operation("GET /me", Need.NOTHING)
async def get_me(request: Request, settings: Provided[Settings], access: Provided[Access]) -> CallerDetails:
    """Return the caller: signed in or not, and in which role."""
    return describe_caller(request, settings, access, request.scope[IDENTITY])


@router.operation("POST /pair", Need.NOTHING, WrongCodeError, TooManyTriesError, TOO_MANY)
async def pair_browser(
    request: Request,
    settings: Provided[Settings],
    access: Provided[Access],
    response: Response,
    body: Pairing,
) -> Paired:
    """Sign this browser in with a code.

    Sets a cookie, and answers the page's own secret: the page sends it as the header `X-Mucat`, and its live
    socket as the second subprotocol, after `mucat`. A browser that is signed in already keeps both, and gets
    the code's role if that is higher. A new one gets a number after its name if another has it.
    """
    address = address_of(request.scope)
    identity, secrets = await access.pair(body.code, body.name, request.scope[IDENTITY], address)
    request.scope[IDENTITY] = identity
    if secrets is not None:
        set_cookie(request, access, response, secrets.cookie, COOKIE_SECONDS)
    caller = describe_caller(request, settings, access, identity)
    return Paired(page_secret=None if secrets is None else secrets.page, **dict(caller))


@router.operation("POST /confirm", Need.OPERATOR, WrongConfirmationError, TooManyTriesError)
async def confirm_browser(
    request: Request, access: Provided[Access], caller: Caller, body: Confirmation
) -> None:
    """Confirm the user of this browser, with a new operator's code.

    Dangerous acts of a browser (`administer`) need it where the browser has neither signed in nor confirmed
    in the last ten minutes. The code is used up. A code made by this browser does not confirm.
    Programs and the shell need no confirmation.
    """
    access.confirm(body.code, caller, address_of(request.scope))


@router.operation("POST /sign-out", Need.VIEWER, {409: "The shell is not signed in"})
async def sign_out(access: Provided[Access], caller: Caller, response: Response) -> None:
    """Sign this browser out.

    It must be paired again afterwards. A program's token becomes invalid.
    """
    await access.sign_out(caller)
    response.delete_cookie(access.cookie, httponly=True, samesite="strict")


@router.operation("POST /codes", Need.ADMINISTER, status_code=201)
async def make_code(
    request: Request, settings: Provided[Settings], access: Provided[Access], caller: Caller, body: NewCode
) -> MadeCode:
    """Make a pairing code for one browser, valid for ten minutes."""
    code = access.codes.make(body.role, caller.device)
    # A shell's own address is no browser's: at another name than the start's a sign-in would not be found.
    base = settings.base_url("" if caller.kind == "shell" else _called(request))
    link = pairing_link(base, code)
    return MadeCode(
        code=code,
        link=link,
        other_links=[pairing_link(other, code) for other in settings.base_urls() if other != base],
        only_here=settings.only_here,
        role=body.role,
        expires=time.time() + CODE_SECONDS,
        qr_svg=qr_svg(link),
    )


@router.operation("GET /devices", Need.OPERATOR)
async def list_devices(access: Provided[Access], caller: Caller) -> list[DeviceDetails]:
    """List the paired browsers and programs, oldest first."""
    return [_describe(access, caller, device) for device in access.devices.all()]


@router.operation("PATCH /devices/{device}", Need.ADMINISTER, UnknownDeviceError, NO_CHANGE)
async def change_device(
    access: Provided[Access], caller: Caller, device: Identifier, body: DeviceChanges
) -> DeviceDetails:
    """Rename, promote or demote a device.

    A new role closes its live sockets; they open again in the new role.
    """
    # A name that is refused leaves the role as it was.
    if body.name is not None:
        await access.devices.rename(device, body.name)
    if body.role is not None:
        await access.set_role(device, body.role, caller)
    return _describe(access, caller, access.devices.get(device))


@router.operation(
    "DELETE /devices/{device}", Need.ADMINISTER, UnknownDeviceError, {409: "No operator would be left"}
)
async def revoke_device(access: Provided[Access], caller: Caller, device: Identifier) -> None:
    """Revoke a device's access.

    Its live sockets are closed at once.
    """
    await access.revoke(device, caller)


@router.operation("POST /tokens", Need.ADMINISTER, NO_TOKEN, status_code=201)
async def make_token(access: Provided[Access], caller: Caller, body: NewToken) -> MadeToken:
    """Make a token for a program.

    The token is shown only this once. The program sends it as `Authorization: Bearer`. Its scope: `read` as a
    viewer, `operate` as an operator who does not administer, `administer` as an operator.
    """
    device, token = await access.make_program(body.name, body.scope, body.days, caller)
    return MadeToken(token=token, device=_describe(access, caller, device))


def set_cookie(request: Request, access: Access, response: Response, secret: str, seconds: int) -> None:
    """Give the browser its cookie, for so many seconds."""
    response.set_cookie(
        access.cookie,
        secret,
        max_age=seconds,
        httponly=True,
        samesite="strict",
        secure=request.url.scheme == "https",
    )


def _called(request: Request) -> str:
    return request.headers["host"].rsplit(":", 1)[0].lower()


def describe_caller(
    request: Request, settings: Settings, access: Access, identity: Identity | None
) -> CallerDetails:
    """Return the caller as the page is told of it."""
    return CallerDetails(
        signed_in=identity is not None,
        robot=settings.robot.name,
        lab=settings.lab,
        identity=identity,
        ended=request.scope.get(SIGN_IN_ENDED, "") if identity is None else "",
        pairing_open=access.codes.any_valid,
        operators_only=[] if identity is None else list_refused(request.app.routes, identity),
        ends=None if identity is None else access.devices.end_of(identity.device),
    )


def _describe(access: Access, caller: Identity, device: Device) -> DeviceDetails:
    ended = access.devices.explain_end(device) or ""
    return DeviceDetails(**asdict(device), ended=ended, you=caller.device == device.id)
