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
from typing import Any, ClassVar

from robot_runtime.contract.declarations import DeclaredTwiceError
from server.services import Maker

ENTRY_POINTS = "mucat.features"


@dataclass(frozen=True, slots=True, kw_only=True)
class Feature:
    """A feature and what it consists of; places in the code are written "module:name".

    `section` is the class of its section of robot.toml, which has its name. `is_on` tells by the section
    whether the feature has anything to do. An `optional` one can be switched off in `[features]`. `removed`
    are entries of earlier versions: empty ones are passed over, others refused in words. `routes` are places
    of `Operations`, or of functions that make them of their section. `commands` are those of the shell, by
    their names. `plug` is the place of its `Plug`.
    """

    name: str
    section: type | None = None
    is_on: Callable[[Any], bool] = lambda _: True
    optional: bool = False
    removed: Sequence[str] = ()
    routes: Sequence[str] = ()
    commands: Mapping[str, str] = field(default_factory=dict)
    plug: str = ""


class Plug:
    """The part of a feature that lives in a running server. Its constructor asks for services by their types.

    `makers` are functions that make services which cannot make themselves. A failure of `open` and `start`
    ends the server's start. All calls come from the event loop.
    """

    makers: ClassVar[Sequence[Maker]] = ()

    async def open(self) -> None:
        """Make ready; the robot is not heard yet."""

    async def start(self) -> None:
        """Begin; every feature is open. Nobody is served yet."""

    def work(self) -> Sequence[Coroutine[Any, Any, None]]:
        """The background work that lasts as long as the server; its failure is an alarm."""
        return ()

    def warm_up(self) -> None:
        """Prepare what is likely to be asked for; the server serves."""

    async def stop(self) -> None:
        """End what the feature does; the robot's processes still run, the background work has ended."""

    async def close(self) -> None:
        """Release what it holds; the robot's processes have ended."""


@cache
def list_features() -> Mapping[str, Feature]:
    """All features by name: those of the server, then those of other packages.

    Raises DeclaredTwiceError where two have the same name, or a command of the same name.
    """
    features = resolve_name("server.features")
    own = [
        resolve_name(f"server.features.{module.name}:FEATURE") for module in iter_modules(features.__path__)
    ]
    others = [point.load() for point in entry_points(group=ENTRY_POINTS)]
    named: dict[str, Feature] = {}
    commands: dict[str, str] = {}
    for feature in [*own, *others]:
        if feature.name in named:
            raise DeclaredTwiceError(f"two features are named {feature.name!r}; rename one of them")
        for command in feature.commands:
            if command in commands:
                raise DeclaredTwiceError(
                    f"the features {commands[command]} and {feature.name} both have a command {command!r}"
                )
            commands[command] = feature.name
        named[feature.name] = feature
    return named
