"""Sign-in under any sequence of codes, roles, tokens, revocations and restarts, against a small model."""

import asyncio
import tempfile
from collections.abc import Coroutine
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, TypeVar

import pytest
from hypothesis import settings as hypothesis_settings
from hypothesis import strategies as st
from hypothesis.stateful import Bundle, RuleBasedStateMachine, invariant, precondition, rule
from starlette.requests import HTTPConnection

from robot_runtime.clock import SimulatedClock
from robot_runtime.errors import RefusedError
from server.http.sign_in.access import Access
from server.http.sign_in.devices import SignInEndedError
from server.http.sign_in.identity import SHELL, Identity, Kind, Role, Scope
from server.http.sign_in.pairing_codes import CODE_SECONDS, CODES_MAX, TooManyTriesError, WrongCodeError
from server.http.sign_in.tokens import TOKEN_PREFIX, make_token
from server.platform.schema import prepare
from server.platform.settings import DataFolder, Settings, make_folders
from server.platform.store import Store

T = TypeVar("T")
ROLES = st.sampled_from(["viewer", "operator"])


@dataclass
class Code:
    """A code of the model; `void` once it was used or dropped."""

    text: str
    role: Role
    until: float
    void: bool = False


@dataclass
class Member:
    """A paired device of the model, whose secret is valid unless it is `out`."""

    identity: Identity
    secret: str
    page_secret: str = ""
    out: bool = False


class SigningIn(RuleBasedStateMachine):
    """One robot, whose server is restarted now and then."""

    codes: Bundle[Code] = Bundle("codes")
    members: Bundle[Member] = Bundle("members")

    def __init__(self) -> None:
        super().__init__()
        self.runner = asyncio.Runner()
        self.folder = tempfile.TemporaryDirectory(prefix="mucat-")
        data = DataFolder(Path(self.folder.name))
        make_folders(data)
        prepare(data)
        self.settings = Settings(data=data, config=data.path / "robot.toml")
        self.clock = SimulatedClock(1000.0)
        self.made: list[Code] = []
        self.everybody: list[Member] = []
        self.wrong: list[float] = []
        self.closed: list[int] = []
        self.start()

    def start(self) -> None:
        """Start as a server does: it knows the paired devices, and no codes."""
        self.store = Store(self.settings.data.database)
        self.access = Access(
            self.settings,
            self.store,
            self.clock,
            lambda *_: None,
            lambda identity, _: self.closed.append(identity),
            make_token(TOKEN_PREFIX),
        )
        self.access.open()

    def run(self, coroutine: Coroutine[Any, Any, T]) -> T:
        """Run a coroutine; return its result."""
        return self.runner.run(coroutine)

    def end(self) -> None:
        """End the server in order."""
        self.run(self.access.devices.close())
        self.store.close()

    def teardown(self) -> None:
        self.end()
        self.runner.close()
        self.folder.cleanup()

    @rule()
    def restart(self) -> None:
        self.end()
        for code in self.made:
            code.void = True
        self.wrong.clear()
        self.start()

    @rule(seconds=st.sampled_from([0.5, 1.0, 20.0, 61.0, 599.0, 3600.0]))
    def forward(self, seconds: float) -> None:
        self.clock.forward(seconds)

    def valid(self) -> list[Code]:
        """Return the codes that are still valid."""
        return [code for code in self.made if not code.void and self.clock.now() < code.until]

    def waits(self) -> bool:
        """Return True in the second after a wrong code."""
        return bool(self.wrong) and self.clock.now() - self.wrong[-1] < 1.0

    @precondition(lambda self: len(self.valid()) < CODES_MAX)
    @rule(target=codes, role=ROLES)
    def make_code(self, role: Role) -> Code:
        code = Code(self.access.codes.make(role), role, self.clock.now() + CODE_SECONDS)
        self.made.append(code)
        return code

    @rule(target=members, code=codes)
    def pair(self, code: Code) -> Any:
        return self.try_to_pair(code, None)

    @rule(target=members, code=codes, member=members)
    def pair_again(self, code: Code, member: Member) -> Any:
        return self.try_to_pair(code, member)

    def try_to_pair(self, code: Code, known: Member | None) -> Any:
        """Return the member of a sign-in: a new one, or the one of a paired browser."""
        browser = known is not None and not known.out and known.identity.kind == "browser"
        asking = self.access.pair(
            code.text, "tablet", known.identity if known and not known.out else None, "here"
        )
        if self.waits():
            with pytest.raises(TooManyTriesError):
                self.run(asking)
            return self.nobody()
        if code not in self.valid():
            with pytest.raises(WrongCodeError):
                self.run(asking)
            self.wrong.append(self.clock.now())
            return self.nobody()
        identity, secrets = self.run(asking)
        code.void = True
        if browser:
            assert known is not None
            assert secrets is None
            role: Role = "operator" if "operator" in (known.identity.role, code.role) else "viewer"
            known.identity = replace(known.identity, role=role)
            assert identity == known.identity
            return known
        assert (identity.role, identity.kind) == (code.role, "browser")
        assert secrets is not None
        return self.let_in(identity, secrets.cookie, secrets.page)

    def nobody(self) -> Any:
        """Return a member with an invalid secret."""
        return Member(Identity(10**6, "", "viewer", "browser"), "no secret", out=True)

    def let_in(self, identity: Identity, secret: str, page_secret: str = "") -> Member:
        """Add a member; number and secrets are never reused."""
        assert identity.device not in {actor.identity.device for actor in self.everybody if not actor.out}
        assert secret not in {actor.secret for actor in self.everybody}
        member = Member(identity, secret, page_secret)
        self.everybody.append(member)
        return member

    @rule(typed=st.sampled_from(["", "wrong", "AAAAA-AAAAA", "é" * 64]))
    def guess(self, typed: str) -> None:
        if self.waits():
            with pytest.raises(TooManyTriesError):
                self.run(self.access.pair(typed, "x", None, "here"))
        else:
            with pytest.raises(WrongCodeError):
                self.run(self.access.pair(typed, "x", None, "here"))
            self.wrong.append(self.clock.now())

    @rule(target=members, role=ROLES)
    def make_program(self, role: Role) -> Member:
        scope: Scope = "administer" if role == "operator" else "read"
        device, token = self.run(
            self.access.make_program(f"script {len(self.everybody)}", scope, None, SHELL)
        )
        assert (device.role, device.kind) == (role, "program")
        return self.let_in(device.identity, token)

    def operators(self) -> list[Member]:
        """Browsers of operators."""
        return [
            actor
            for actor in self.everybody
            if not actor.out and (actor.identity.kind, actor.identity.role) == ("browser", "operator")
        ]

    @rule(member=members, by=members, role=ROLES, shell=st.booleans())
    def change_role(self, member: Member, by: Member, role: Role, shell: bool) -> None:
        if member.out or by.out:
            return
        last = self.operators() == [member] and role == "viewer" and not shell
        asking = self.access.set_role(member.identity.device, role, SHELL if shell else by.identity)
        if last:
            with pytest.raises(RefusedError):
                self.run(asking)
            return
        before, self.closed = member.identity.role, []
        self.run(asking)
        old = member.identity
        member.identity = replace(old, role=role)
        assert self.closed == ([old.device] if before != role else [])

    @rule(member=members, by=members, shell=st.booleans())
    def revoke(self, member: Member, by: Member, shell: bool) -> None:
        if member.out or by.out:
            return
        asking = self.access.revoke(member.identity.device, SHELL if shell else by.identity)
        if self.operators() == [member] and not shell:
            with pytest.raises(RefusedError):
                self.run(asking)
            return
        self.closed = []
        self.run(asking)
        member.out = True
        assert self.closed == [member.identity.device]

    @rule(member=members)
    def sign_out(self, member: Member) -> None:
        if not member.out:
            self.closed = []
            self.run(self.access.sign_out(member.identity))
            member.out = True
            assert self.closed == [member.identity.device]

    async def seen(self, kind: Kind, secret: str, page_secret: str) -> Identity | None:
        """Return the identity that the server finds for a request with these secrets."""
        header = (b"authorization", f"Bearer {secret}".encode())
        if kind == "browser":
            header = (b"cookie", f"{self.access.cookie}={secret}".encode())
        headers = [header, (b"x-mucat", page_secret.encode())]
        return self.access.identify(HTTPConnection({"type": "http", "headers": headers}))

    @invariant()
    def everybody_is_who_they_are(self) -> None:
        for actor in self.everybody:
            other: Kind = "program" if actor.identity.kind == "browser" else "browser"
            identity = self.run(self.seen(actor.identity.kind, actor.secret, actor.page_secret))
            assert identity == (None if actor.out else actor.identity)
            assert self.run(self.seen(other, actor.secret, actor.page_secret)) is None
            if actor.page_secret and not actor.out:
                with pytest.raises(SignInEndedError):
                    self.run(self.seen("browser", actor.secret, actor.secret))
            assert (self.access.refresh(actor.identity) == actor.identity) is not actor.out
        there = {actor.identity for actor in self.everybody if not actor.out}
        assert {device.identity for device in self.access.devices.all()} == there
        assert self.access.codes.any_valid is bool(self.valid())


SigningIn.TestCase.settings = hypothesis_settings(
    max_examples=15, stateful_step_count=25, deadline=None, derandomize=True
)
TestSigningIn = SigningIn.TestCase
