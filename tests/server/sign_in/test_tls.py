"""TLS: a server with its own certificate, and its clients."""

import asyncio
import hashlib
import os
import ssl
import struct
import subprocess
import sys
import time
from dataclasses import replace
from pathlib import Path

import httpx
import pytest

from server.platform.certificate import AUTHORITY, prepare_certificate
from server.platform.openssl import CERTIFICATE, KEY, LEAF, make_certificate, read_validity
from server.platform.running_server import announce, ask
from server.platform.settings import Settings, SetupError
from tests.server.serving import Served, next_text, serve
from tests.waiting import SECONDS

ROOT = Path(__file__).parents[3]


@pytest.fixture
def encrypted(settings: Settings) -> Settings:
    return settings.with_section(replace(settings.server, tls=True))


async def test_pages_shell_and_sockets_use_tls_only(encrypted: Settings) -> None:
    async def scenario(served: Served) -> None:
        port = served.settings.server.port
        me = (await served.api.get("/access/me")).json()
        assert me["identity"]["name"] == "the shell of this computer"
        async with served.connect() as socket:
            assert (await next_text(socket, "hello"))["robot"] == "tested"
        code = (await served.api.post("/access/codes", json={})).json()
        assert code["link"].startswith(f"https://localhost:{port}/#pair=")
        paired = await served.api.post("/access/pair", json={"code": code["code"], "name": "tablet"})
        assert "secure" in paired.headers["set-cookie"].lower()
        announce(served.settings)
        assert (await asyncio.to_thread(ask, encrypted.data, "GET", "/access/me"))["signed_in"]
        async with httpx.AsyncClient(timeout=SECONDS) as client:
            with pytest.raises(httpx.RemoteProtocolError):
                await client.get(f"http://127.0.0.1:{port}/api/access/me")
            with pytest.raises(httpx.ConnectError, match=r"self.signed certificate"):
                await client.get(f"https://127.0.0.1:{port}/api/access/me")
        foreign = await served.api.get("/access/me", headers={"origin": f"http://127.0.0.1:{port}"})
        assert foreign.status_code == 403

    async with serve(encrypted) as served:
        await scenario(served)


IN_1970 = """
import ssl, sys, time
from pathlib import Path
from server.platform.certificate import trust_only
from server.platform.settings import DataFolder

folder = DataFolder(Path(sys.argv[1]))
there = ssl.SSLContext(ssl.PROTOCOL_TLS_SERVER)
there.load_cert_chain(folder.tls / "certificate.pem", folder.tls / "key.pem")
up, down = ssl.MemoryBIO(), ssl.MemoryBIO()
ends = there.wrap_bio(up, down, server_side=True), trust_only(folder).wrap_bio(down, up)
for _ in range(3):
    for end in ends:
        try:
            end.do_handshake()
        except ssl.SSLWantReadError:
            pass
print(time.gmtime().tm_year, ends[1].version())
"""


def test_the_shell_reaches_the_server_also_while_the_clock_is_not_set(
    encrypted: Settings, tmp_path: Path
) -> None:
    # The certificate was made when the date was known, and is not valid in 1970.
    prepare_certificate(encrypted)
    library, shift = tmp_path / "wall_clock.so", tmp_path / "shift"
    command = ["gcc", "-O2", "-shared", "-fPIC", "-o", str(library), str(ROOT / "tests/proofs/wall_clock.c")]
    subprocess.run([*command, "-ldl"], check=True)
    shift.write_bytes(struct.pack("<q", int(300 - time.time())))
    done = subprocess.run(
        [sys.executable, "-c", IN_1970, str(encrypted.data.path)],
        env=os.environ | {"LD_PRELOAD": str(library), "MUCAT_WALL_CLOCK": str(shift)},
        cwd=ROOT,
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.stdout == "1970 TLSv1.3\n", done.stderr


def test_the_certificate_is_created_once_and_is_private(encrypted: Settings) -> None:
    made = prepare_certificate(encrypted)
    assert made == prepare_certificate(encrypted)
    own = made.file.read_text().partition(ssl.PEM_FOOTER)
    der = ssl.PEM_cert_to_DER_cert(own[0] + own[1])
    assert made.fingerprint.replace(":", "").lower() == hashlib.sha256(der).hexdigest()
    assert made.key.stat().st_mode & 0o777 == 0o600
    assert made.key.parent.stat().st_mode & 0o777 == 0o700
    other = replace(encrypted, data=type(encrypted.data)(encrypted.data.path / "other"))
    other.data.path.mkdir()
    assert prepare_certificate(other).fingerprint != made.fingerprint


def test_a_certificate_that_cannot_be_made_or_read_is_reported(
    encrypted: Settings, monkeypatch: pytest.MonkeyPatch
) -> None:
    with monkeypatch.context() as patch:
        patch.setenv("PATH", "/nowhere")
        with pytest.raises(SetupError, match="apt install openssl"):
            prepare_certificate(encrypted)
    broken = encrypted.with_section(replace(encrypted.server, allowed_hosts=["a,nonsense"]))
    with pytest.raises(SetupError, match="openssl refused"):
        prepare_certificate(broken)
    assert not encrypted.data.tls.exists()
    made = prepare_certificate(encrypted)
    made.file.write_text("no certificate")
    with pytest.raises(SetupError, match="cannot be had"):
        prepare_certificate(encrypted)


def text_of(certificate: Path) -> str:
    command = ["openssl", "x509", "-in", str(certificate), "-noout", "-text"]
    return subprocess.run(command, capture_output=True, text=True, check=True).stdout


def age(settings: Settings, days: int, *extensions: str) -> None:
    """Replace the certificate by one of the same key that is valid for so many days."""
    folder = settings.data.tls
    make_certificate(folder / CERTIFICATE, folder / KEY, settings.robot.name, extensions, days=days)


def test_the_certificate_signs_no_other_and_lasts_no_longer_than_browsers_accept(encrypted: Settings) -> None:
    made = prepare_certificate(encrypted)
    valid = read_validity(made.file)
    assert (valid.ends - valid.begins) / 86_400 <= 825
    text = text_of(made.file)
    assert "CA:FALSE" in text
    assert "Key Usage: critical\n                Digital Signature\n" in text
    assert "TLS Web Server Authentication" in text
    assert "DNS:localhost, IP Address:127.0.0.1" in text
    assert not made.renewed
    # Who trusts its authority trusts it, by its name, and nothing else: the authority's key is nowhere.
    authority = made.file.with_name(AUTHORITY)
    assert "CA:TRUE, pathlen:0" in text_of(authority)
    valid = read_validity(authority)
    assert (valid.ends - valid.begins) / 86_400 <= 825
    check = ["openssl", "verify", "-x509_strict", "-CAfile", str(authority), "-verify_hostname", "localhost"]
    subprocess.run([*check, str(made.file)], check=True, capture_output=True)
    assert [file.name for file in authority.parent.iterdir() if "PRIVATE" in file.read_text()] == [KEY]


@pytest.mark.parametrize(
    ("days", "extensions", "renewed"),
    [
        (36_500, ("basicConstraints=critical,CA:TRUE",), True),
        (820, ("basicConstraints=critical,CA:TRUE",), True),
        (900, LEAF, True),
        (89, LEAF, True),
        (91, LEAF, False),
    ],
)
def test_a_certificate_is_renewed_with_its_key(
    encrypted: Settings, days: int, extensions: tuple[str, ...], renewed: bool
) -> None:
    made = prepare_certificate(encrypted)
    key = made.key.read_bytes()
    age(encrypted, days, *extensions)
    again = prepare_certificate(encrypted)
    assert again.renewed is renewed
    assert again.key.read_bytes() == key
    assert {file.name for file in again.file.parent.iterdir()} == {AUTHORITY, CERTIFICATE, KEY}
    assert read_validity(again.file).is_leaf
    once_more = prepare_certificate(encrypted)
    assert (once_more.renewed, once_more.fingerprint) == (False, again.fingerprint)
    ssl.SSLContext(ssl.PROTOCOL_TLS_SERVER).load_cert_chain(again.file, again.key)


def test_a_clock_that_is_not_set_renews_nothing(encrypted: Settings, monkeypatch: pytest.MonkeyPatch) -> None:
    made = prepare_certificate(encrypted)
    monkeypatch.setattr(time, "time", lambda: 300.0)
    assert prepare_certificate(encrypted) == made
