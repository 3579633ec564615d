"""`python -m tests.proofs.lab`: three robots, a lab on PostgreSQL and two workers, while parts of it fail.

Each has a computer of its own on one network. Prints a report and writes it to build/proofs/lab.md; status 1
where something was lost, came twice, got in, or stopped a robot. It needs root. `short FOLDER`, in a network
of its own, is the same with one robot and an archive in the lab's folder: it needs only namespaces.
"""

import os
import subprocess
import sys
from pathlib import Path
from tempfile import TemporaryDirectory

from tests.proofs.lab import failures
from tests.proofs.lab.cluster import SweepCluster
from tests.proofs.lab.network import LabNetwork
from tests.proofs.lab.programs import SwimmingRobot
from tests.proofs.lab.strangers import refuse_strangers
from tests.proofs.lab.whole_lab import RADIO, ServedArchive, WholeLab
from tests.server.postgres import PostgresServer

ROBOTS = 3
SECONDS = 90.0
"""Of the session that is pulled while everything fails."""
SHORT_SECONDS = 5.0
DISK = "200m"
SHORT_CUT_SECONDS = 3.0


def main() -> int:
    """Exit status."""
    match sys.argv[1:]:
        case ["short", folder]:
            return prove_short(Path(folder))
        case ["here", folder]:
            return prove(Path(folder))
    if os.geteuid() != 0:
        sys.exit("it needs root: PostgreSQL runs as another user, on a disk of its own")
    with TemporaryDirectory(prefix="mucat-lab-", ignore_cleanup_errors=True) as name:
        # PostgreSQL's user comes through.
        Path(name).chmod(0o711)
        command = ["unshare", "--net", "--mount", sys.executable, "-m", "tests.proofs.lab", "here", name]
        with subprocess.Popen(command) as inside:
            try:
                return inside.wait()
            except KeyboardInterrupt:
                # It was interrupted as well, and ends its robots.
                return inside.wait()


def prove(folder: Path) -> int:
    """Prove all of it, in a network and with mounts of its own; return the exit status."""
    disk = folder / "disk"
    disk.mkdir()
    subprocess.run(["mount", "-t", "tmpfs", "-o", f"size={DISK},mode=711", "tmpfs", str(disk)], check=True)
    database = PostgresServer(disk)
    try:
        with LabNetwork() as network:
            lab = ServedArchive(network, disk / "lab", database.create("lab"))
            robots = [
                SwimmingRobot(network.add(f"turtle-{number}", 10 + number), folder / f"turtle-{number}")
                for number in range(1, ROBOTS + 1)
            ]
            whole = WholeLab(network, lab, robots)
            cluster = SweepCluster(network, lab.computer, folder / "sweeps")
            try:
                with whole.running(), cluster.running():
                    play(whole, cluster, database, folder)
            except AssertionError as problem:
                whole.report.check(False, str(problem))
    finally:
        if database.runs:
            database.stop()
    whole.report.write()
    return 1 if whole.report.problems else 0


def play(whole: WholeLab, cluster: SweepCluster, database: PostgresServer, folder: Path) -> None:
    """Play all failures in turn."""
    whole.swim()
    whole.record(SECONDS)
    whole.first.computer.slow(RADIO)
    whole.join()
    failures.cut_robot(whole)
    failures.kill_lab(whole)
    failures.stop_database(whole, database)
    failures.fill_disk(whole, database)
    failures.cut_lab(whole)
    stranger = whole.network.add("stranger", 66)
    refuse_strangers(whole, stranger, folder / "stranger")
    cluster.refuse(whole, stranger)
    cluster.prove(whole)
    whole.stop_within_reach()
    whole.stop_all()
    whole.wait_for_all()
    whole.compare()
    whole.remove_first()


def prove_short(folder: Path) -> int:
    """Prove that one robot joins, is pulled from through a cut, and stops; return the exit status."""
    with LabNetwork() as network:
        lab = ServedArchive(network, folder / "lab")
        whole = WholeLab(network, lab, [SwimmingRobot(network.add("turtle-1", 11), folder / "turtle-1")])
        with whole.running():
            whole.record(SHORT_SECONDS)
            whole.first.computer.slow(RADIO)
            whole.join()
            failures.cut_robot(whole, SHORT_CUT_SECONDS)
            whole.wait_for_all()
            whole.compare()
            whole.first.arm()
            whole.stop_all()
    print(whole.report.text(), flush=True)
    return 1 if whole.report.problems else 0


if __name__ == "__main__":
    sys.exit(main())
