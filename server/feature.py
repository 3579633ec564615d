"""A feature: a plug of the server, declared in one place.

    # server/features/lamp/__init__.py
    FEATURE = Feature(name="lamp", plug="server.features.lamp.plug:LampPlug", ...)

The declaration is read at every start and imports nothing heavy; what it names is imported where the feature
is on. A pip package offers a feature of its own by an entry point of the group `mucat.features`.
"""

from collections.abc import Callable, Coroutine, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cache
from importlib.metadata import entry_points
from pkgutil import iter_modules, resolve_name
from typing import Any, ClassVar, Literal

from robot_runtime.contract.declarations import Declarations
from server.services import Maker

ENTRY_POINTS = "mucat.features"

Place = Literal["robot", "lab", "both"]
"""The servers that have a feature: a robot's, a lab's, which has no robot, or both."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Feature:
    """A feature and its parts; locations in the code are written "module:name".

    `section` is the place of the class of its section of robot.toml, which has its name. `is_on` tells by
    the section whether the feature has anything to do. `place` names the servers that have it. An `optional`
    one can be switched off in `[features]`. `removed` are entries of earlier versions: empty ones are passed
    over, the others refused in words. `routes` are places of `Operations`, or of functions that make them of
    their section. `prepare` is the place of a function of the settings, called before the server is loaded; a
    SetupError ends the start. `commands` are those of the shell, by their names; two words are a command of a
    group. `plug` is the place of its `Plug`.
    """

    name: str
    section: str = ""
    is_on: Callable[[Any], bool] = lambda _: True
    optional: bool = False
    place: Place = "robot"
    removed: Sequence[str] = ()
    routes: Sequence[str] = ()
    commands: Mapping[str, str] = field(default_factory=dict)
    plug: str = ""
    prepare: str = ""

    @property
    def section_class(self) -> type | None:
        """The class of its section of robot.toml; None without one."""
        return resolve_name(self.section) if self.section else None


class Plug:
    """The part of a feature that lives in a running server. Its constructor names services by their types.

    `makers` are functions that make services whose constructors do not suffice. A failure of `open` and
    `start` ends the server's start. All calls come from the event loop.
    """

    makers: ClassVar[Sequence[Maker]] = ()

    async def open(self) -> None:
        """Prepare; no data of the robot arrives yet."""

    async def start(self) -> None:
        """Begin; every feature is open, and no request is served yet."""

    def work(self) -> Sequence[Coroutine[Any, Any, None]]:
        """Return the background work that lasts as long as the server; its failure is an alarm."""
        return ()

    def warm_up(self) -> None:
        """Prepare data that is likely to be needed; the server serves already."""

    async def stop(self) -> None:
        """End the feature's work; the robot's processes still run, the background work has ended."""

    async def close(self) -> None:
        """Release its resources; the robot's processes have ended."""


@cache
def list_features() -> Mapping[str, Feature]:
    """Return all features by name: those of the server, then those of other packages.

    Raise DeclaredTwiceError where two have the same name, or a command of the same name.
    """
    folders = iter_modules(resolve_name("server.features").__path__)
    modules = [f"server.features.{folder.name}" for folder in folders]
    features = [(module, resolve_name(f"{module}:FEATURE")) for module in modules]
    features += [(point.value, point.load()) for point in entry_points(group=ENTRY_POINTS)]
    named: Declarations[str, Feature] = Declarations("the name of a feature")
    commands: Declarations[str, Feature] = Declarations("the name of a shell command")
    for location, feature in features:
        named.add_from(location, feature.name, feature)
        for command in feature.commands:
            commands.add_from(location, command, feature)
    return named
