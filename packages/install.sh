#!/bin/sh
# Installs the release in this folder as services of this computer: sudo sh install.sh [--dry-run] [--yes]
# The wheels that an installation needs are plain Python, which Python runs without unpacking them.
folder=$(cd "$(dirname "$0")" && pwd) || exit 1
exec python3 -c '
import glob, sys
sys.path[:0] = sorted(glob.glob(sys.argv.pop(1) + "/*.whl"))
from server.cli import main
sys.exit(main())
' "$folder" install "$folder" "$@"
