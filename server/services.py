"""The services of a server: each is made at its first use, from the services that its maker's types name."""

from collections.abc import Callable
from inspect import Parameter, signature
from typing import Any, TypeVar, get_type_hints

T = TypeVar("T")
Maker = Callable[..., object]


class UnknownServiceError(LookupError):
    """A service cannot be made; the text names the services that need it."""


class Services:
    """The services, each made once. A class is its own maker; a function can be offered for its return type.

    A parameter that has a default value keeps it.
    """

    def __init__(self) -> None:
        self._made: dict[type, Any] = {}
        self._makers: dict[type, Maker] = {}
        self._making: list[type] = []

    def add(self, kind: type[T], service: T) -> None:
        """Add an existing service; `kind` is the type that requests it."""
        self._made[kind] = service

    def offer(self, *makers: Maker) -> None:
        """Add functions that make a service, each by the type that it returns."""
        for maker in makers:
            self._makers[get_type_hints(maker)["return"]] = maker

    def get(self, kind: type[T]) -> T:
        """Return the service of this type. Raise UnknownServiceError where it cannot be made."""
        if kind not in self._made:
            if kind in self._making:
                raise self._error(kind, "needs itself")
            self._making.append(kind)
            try:
                self._made[kind] = self._make(kind)
            finally:
                self._making.pop()
        service: T = self._made[kind]
        return service

    def _make(self, kind: type) -> object:
        maker = self._makers.get(kind, kind)
        hints = get_type_hints(vars(kind).get("__init__", maker) if maker is kind else maker)
        asked: dict[str, Any] = {}
        for name, parameter in signature(maker).parameters.items():
            if parameter.default is not Parameter.empty:
                continue
            if not isinstance(hints.get(name), type) or hints[name].__module__ == "builtins":
                raise self._error(kind, f"asks for {name}, which is no service")
            asked[name] = self.get(hints[name])
        return maker(**asked)

    def _error(self, kind: type, what: str) -> UnknownServiceError:
        chain = " for ".join(service.__name__ for service in reversed(self._making))
        return UnknownServiceError(f"{kind.__name__} {what} (made: {chain})")
