#!/bin/sh
# Chromium's engine without the windows around it. It gives way to the robot, as chromium.sh does, and so does its session:
# Playwright gives it one of its own, in which niceness alone would not count for others (tests/beside.py).
program=/usr/lib/chromium/chromium-headless-shell
niceness=$(nice)
{ echo $((niceness < 14 ? niceness + 5 : 19)) > /proc/self/autogroup; } 2> /dev/null
[ "$(id -u)" -ne 0 ] || exec setpriv --bounding-set=-sys_nice nice -n 5 "$program" "$@"
exec nice -n 5 "$program" "$@"
