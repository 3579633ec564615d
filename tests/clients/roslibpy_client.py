"""Does with an unmodified roslibpy what a notebook does; prints JSON. Arguments: host, port, token, path."""

import json
import sys
import threading
from typing import Any

import roslibpy


def main(url: str) -> None:
    ros = roslibpy.Ros(url)
    ros.run(timeout=30)
    answer: dict[str, Any] = {"topics": ros.get_topics(), "type": ros.get_topic_type("/imu/data")}
    imu = roslibpy.Topic(ros, "/imu/data", "sensor_msgs/Imu", throttle_rate=50, queue_length=1)
    came = threading.Event()

    def see(message: dict[str, Any]) -> None:
        answer["imu"] = dict(message)
        came.set()

    imu.subscribe(see)
    assert came.wait(30), "no sample came"
    answer["taken"] = _call(ros, "/mucat/take_control", {"over": True})
    answer["armed"] = _call(ros, "/mucat/arm", {"mode": "manual"})
    answer["stopped"] = _call(ros, "/mucat/stop", {})
    try:
        _call(ros, "/mucat/loop", {"name": "depth", "set_point": -5})
    except roslibpy.core.ServiceException as problem:
        answer["refused"] = str(problem)
    print(json.dumps(answer))
    ros.terminate()


def _call(ros: Any, name: str, args: dict[str, Any]) -> Any:
    return dict(roslibpy.Service(ros, name, "").call(roslibpy.ServiceRequest(args), timeout=30))


main(sys.argv[1])
