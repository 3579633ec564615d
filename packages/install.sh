#!/bin/sh
# Installs the release in this folder as services of this computer: sudo sh install.sh [--dry-run] [--yes]
# The wheels that an installation needs are plain Python, which Python runs without unpacking them.
folder=$(cd "$(dirname "$0")" && pwd) || exit 1
command -v python3 >/dev/null || { echo "There is no python3: sudo apt install python3-venv" >&2; exit 1; }
exec python3 -c '
import glob, sys
folder = sys.argv.pop(1)
if sys.version_info < (3, 11):
    sys.exit("Python 3.11 or newer is needed: install Raspberry Pi OS 12 or newer.")
sys.path[:0] = sorted(glob.glob(folder + "/*.whl"))
try:
    from server.cli import main
except Exception as problem:
    sys.exit(f"{folder} is not a whole release ({problem}): copy it again.")
sys.exit(main())
' "$folder" install "$folder" "$@"
