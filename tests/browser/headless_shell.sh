#!/bin/sh
# Chromium's engine without the windows around it. It gives way to the robot, as chromium.sh does.
program=/usr/lib/chromium/chromium-headless-shell
[ "$(id -u)" -ne 0 ] || exec setpriv --bounding-set=-sys_nice nice -n 5 "$program" "$@"
exec nice -n 5 "$program" "$@"
