#!/bin/sh
# Chromium's engine without the windows around it. It gives way to the robot, as chromium.sh does. Where its test gives way
# to tests in real time, its session does so, too: it has one of its own (tests/beside.py).
program=/usr/lib/chromium/chromium-headless-shell
niceness=$(nice)
[ "$niceness" -le 0 ] || { echo $((niceness < 14 ? niceness + 5 : 19)) > /proc/self/autogroup; } 2> /dev/null
[ "$(id -u)" -ne 0 ] || exec setpriv --bounding-set=-sys_nice nice -n 5 "$program" "$@"
exec nice -n 5 "$program" "$@"
