#!/bin/sh
# Says what this machine lacks to build and run the robot, and installs Debian's part of it where it may.
# usage: ./setup.sh run|test|packages [PYTHON]
set -eu

fail() { printf '%s\n' "$1" >&2; exit 1; }

python=${2:-python3}
"$python" -c 'import sys; sys.exit(sys.version_info < (3, 11))' 2>/dev/null ||
    fail "Python 3.11 or newer is needed, and $python is not. On Debian: apt install python3 python3-venv; for another one: make SYSTEM_PYTHON=python3.12"
command -v node >/dev/null && command -v npm >/dev/null ||
    fail "Node 20.19 or newer, with npm, is needed to build the page. See https://nodejs.org"
[ "$(node -p 'const [a, b] = process.versions.node.split("."); a * 100 + +b')" -ge 2019 ] ||
    fail "Node 20.19 or newer is needed to build the page; this machine has $(node --version). See https://nodejs.org"

missing=""
need() { # package, then a file or command that shows it to be there
    case $2 in
        /*) [ -e "$2" ] || missing="$missing $1" ;;
        *) command -v "$2" >/dev/null || missing="$missing $1" ;;
    esac
}
"$python" -c 'import ensurepip' 2>/dev/null || missing="$missing python3-venv"
need gcc gcc
need gcc-avr avr-gcc
need avr-libc /usr/lib/avr/include/avr/io.h
need binutils-avr avr-objcopy
need arduino-core-avr /usr/share/arduino/hardware/arduino/avr/cores/arduino/Arduino.h
need avrdude avrdude
need libsimavr-dev /usr/include/simavr/sim_avr.h
need libelf-dev /usr/include/libelf.h
# What renders the scene on a CPU. Without it the robot swims as well, and its camera shows a drawn card.
wished=""
wish() { # package, then a file that shows it to be there, * and ? as in the shell
    # shellcheck disable=SC2086 - a pattern
    ls $2 >/dev/null 2>&1 || wished="$wished $1"
}
wish libegl1 "/usr/lib/*/libEGL.so.1"
wish libegl-mesa0 "/usr/lib/*/libEGL_mesa.so.0"
wish libgl1-mesa-dri "/usr/lib/*/dri/*_dri.so"
if [ "${1:-run}" = test ]; then
    need g++ g++
    need chromium chromium
    need chromium-headless-shell chromium-headless-shell
    need firefox-esr firefox-esr
    need nginx-light /usr/sbin/nginx
    need mosquitto /usr/sbin/mosquitto
    ls /usr/lib/postgresql/*/bin/postgres >/dev/null 2>&1 || missing="$missing postgresql"
    need arduino-builder arduino-builder
    need clang-format clang-format
    need cppcheck cppcheck
    need iproute2 ip
    need clang clang
    ls /usr/lib/llvm-*/lib/clang/*/lib/linux/libclang_rt.fuzzer-*.a >/dev/null 2>&1 || missing="$missing libclang-rt-dev"
    # Firefox plays H.264 with it; its number is the system's, and apt takes an expression.
    ls /usr/lib/*/libavcodec.so.* >/dev/null 2>&1 || missing="$missing ^libavcodec[0-9].$"
fi
# What makes systems of other computers; then what builds the emulated board for them, and runs the packages there.
case ${1:-run} in
    test | packages) need mmdebstrap mmdebstrap; need arch-test arch-test ;;
esac
if [ "${1:-run}" = packages ]; then
    need systemd-container systemd-nspawn
    need gcc-aarch64-linux-gnu aarch64-linux-gnu-gcc
    need g++-aarch64-linux-gnu aarch64-linux-gnu-g++
    need gcc-i686-linux-gnu i686-linux-gnu-gcc
    need g++-i686-linux-gnu i686-linux-gnu-g++
    need qemu-user-static qemu-aarch64-static
    need binfmt-support update-binfmts
    need buildah buildah
fi
[ -n "$missing$wished" ] || exit 0

give_up() { # nothing fails for want of what was only wished for
    [ -n "$missing" ] || { printf 'The scene is not rendered. %s\n' "$1"; exit 0; }
    fail "$1"
}
all="$missing$wished"
if ! command -v apt-get >/dev/null; then
    give_up "Missing on this machine, by the names of Debian's packages:$all. Install them and try again."
fi
if [ "$(id -u)" = 0 ]; then as_root=""
elif sudo -n true 2>/dev/null; then as_root="sudo"
else give_up "Missing Debian packages. Install them with: sudo apt install$all"
fi
printf 'Installing Debian packages:%s\n' "$all"
$as_root apt-get update -q
# shellcheck disable=SC2086 - a list of names
DEBIAN_FRONTEND=noninteractive $as_root apt-get install -y -q --no-install-recommends $all ||
    give_up "apt could not install them. Try: sudo apt install$all"
