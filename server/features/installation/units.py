"""The services of an installed robot, and the command `mucat` of its shell."""

from server.features.installation.places import USER, InstallPlaces

WATCHDOG_SECONDS = 5
"""The control loop feeds the watchdog once a second, and was a second late at most on a slow computer."""

HARDENING = """NoNewPrivileges=yes
ProtectSystem=strict
ProtectHome=yes
PrivateTmp=yes
ProtectKernelTunables=yes
ProtectKernelModules=yes
ProtectKernelLogs=yes
ProtectControlGroups=yes
ProtectHostname=yes
RestrictSUIDSGID=yes
RestrictRealtime=yes
RestrictNamespaces=yes
LockPersonality=yes
SystemCallArchitectures=native
SystemCallFilter=@system-service adjtimex clock_adjtime
SystemCallErrorNumber=EPERM
CapabilityBoundingSet=
RestrictAddressFamilies=AF_UNIX AF_INET AF_INET6 AF_NETLINK
LimitCORE=0
UMask=0077"""
"""Without MemoryDenyWriteExecute, with which OpenCV cannot be loaded. The clock may be read, not set."""


def _service(places: InstallPlaces) -> str:
    return f"""User={USER}
Group={USER}
Environment=MUCAT_DATA={places.data} MUCAT_CONFIG={places.config} PYTHONUNBUFFERED=1
WorkingDirectory={places.data}
ReadWritePaths={places.data}
{HARDENING}"""


JOURNAL = """# By mucat install: what all services say stays within 100 MB of the card.
[Journal]
SystemMaxUse=100M
"""


def write_units(places: InstallPlaces) -> dict[str, str]:
    """The text of each unit, by its name."""
    program = places.current / "bin/mucat"
    common = _service(places)
    return {
        "mucat-runtime.service": f"""[Unit]
Description=Runtime of the robot turtle: link, vision and control
After=local-fs.target
StartLimitIntervalSec=0

[Service]
Type=notify
NotifyAccess=main
ExecStart={program} runtime
Restart=always
RestartSec=0.5
TimeoutStartSec=120
WatchdogSec={WATCHDOG_SECONDS}
WatchdogSignal=SIGKILL
OOMScoreAdjust=-900
OOMPolicy=continue
CPUWeight=1000
Nice=-5
{common}

[Install]
WantedBy=multi-user.target
""",
        "mucat.service": f"""[Unit]
Description=Server of the robot turtle: page, recording, export
After=mucat-runtime.service network.target
Wants=mucat-runtime.service
StartLimitIntervalSec=0

[Service]
Type=notify
NotifyAccess=all
ExitType=cgroup
ExecStart={program} run --external-runtime
Restart=always
RestartSec=1
TimeoutStartSec=300
OOMScoreAdjust=500
OOMPolicy=continue
CPUWeight=50
MemoryMax=50%
{common}

[Install]
WantedBy=multi-user.target
""",
        "mucat-update.path": f"""[Unit]
Description=Update of the robot turtle that the page has asked for

[Path]
PathExists={places.request}

[Install]
WantedBy=multi-user.target
""",
        "mucat-update.service": f"""[Unit]
Description=Update of the robot turtle
StartLimitIntervalSec=0

[Service]
Type=oneshot
ExecStart={program} update --asked-by-page
Environment=MUCAT_DATA={places.data} MUCAT_CONFIG={places.config}
TimeoutStartSec=infinity
ProtectHome=yes
PrivateTmp=yes
""",
        "mucat-recover.service": f"""[Unit]
Description=Way back from an update of the robot turtle that was cut off
ConditionPathExists={places.journal}
After=local-fs.target
Before=mucat-runtime.service mucat.service mucat-update.service

[Service]
Type=oneshot
ExecStart={places.previous}/bin/mucat rollback --cut-off
Environment=MUCAT_DATA={places.data} MUCAT_CONFIG={places.config}
TimeoutStartSec=infinity

[Install]
WantedBy=multi-user.target
""",
    }


def write_command(places: InstallPlaces) -> str:
    """The command `mucat` of the shell: with the robot's data and configuration, as the service's user."""
    program = places.current / "bin/mucat"
    return f"""#!/bin/sh
# µ-CAT as installed on this computer. Its data belong to the user {USER}, so that root becomes that user for
# everything but what changes the installation itself.
MUCAT_DATA={places.data} MUCAT_CONFIG={places.config}
export MUCAT_DATA MUCAT_CONFIG
case "${{1-}}" in
    install | uninstall | update | rollback) exec {program} "$@" ;;
esac
test "$(id -u)" -ne 0 || exec runuser -u {USER} -- {program} "$@"
exec {program} "$@"
"""
