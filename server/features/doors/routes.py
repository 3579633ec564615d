"""The doors' sockets, and the list of their clients."""

from fastapi import WebSocket

from server.driving.arbiter import ControlArbiter
from server.features.doors.config import DoorsConfig
from server.features.doors.foxglove import choose_subprotocol
from server.features.doors.house import Door, Doors
from server.features.doors.schemas import DoorClientDetails, DoorDetails
from server.features.doors.visit import DoorVisit
from server.http.dependencies import Provided
from server.http.operations import Operations
from server.http.sign_in.policy import Need

router = Operations(prefix="/api")
ROSBRIDGE = Operations(admits_itself=True)
FOXGLOVE = Operations(admits_itself=True)


@router.operation("GET /doors", Need.VIEWER, tags=["doors"])
async def list_doors(doors: Provided[Doors], arbiter: Provided[ControlArbiter]) -> list[DoorDetails]:
    """Return the doors for other programs, and their clients."""
    return [_describe(door, arbiter) for door in doors.doors.values()]


@ROSBRIDGE.socket("/rosbridge")
async def open_rosbridge(socket: WebSocket) -> None:
    """Serve a program that speaks rosbridge v2 until it leaves."""
    await DoorVisit(socket, "rosbridge").serve(None)


@FOXGLOVE.socket("/foxglove")
async def open_foxglove(socket: WebSocket) -> None:
    """Serve a program that speaks Foxglove's protocol until it leaves."""
    await DoorVisit(socket, "foxglove").serve(choose_subprotocol(socket.scope["subprotocols"]))


def open_routes(doors: DoorsConfig) -> list[Operations]:
    """Return the sockets of the doors that are open."""
    given = {ROSBRIDGE: doors.rosbridge, FOXGLOVE: doors.foxglove}
    return [door for door, is_open in given.items() if is_open]


def _describe(door: Door, arbiter: ControlArbiter) -> DoorDetails:
    holder = arbiter.lease.holder
    return DoorDetails(
        name=door.name,
        path=door.path,
        open=door.open,
        clients=[
            DoorClientDetails(
                name=client.identity.name,
                role=client.identity.role,
                address=client.address,
                since=client.since,
                topics=sorted(
                    {
                        subscription.channel.name
                        for subscription in client.subscriptions.values()
                        if not subscription.channel.hidden
                    }
                ),
                sent=client.sent,
                refused=client.refused,
                in_control=holder is not None and holder == client.owner,
            )
            for client in door.clients
        ],
    )
