#!/usr/bin/env python3
"""Reads a rosbag2 folder with rosbags and compares it with labels. usage: read_rosbag2.py FOLDER LABELS"""

import sys

import h5py
from rosbags.rosbag2 import Reader
from rosbags.typesys import Stores, get_typestore


def main(folder, labels):
    store, counts = get_typestore(Stores.ROS2_HUMBLE), {}
    with Reader(folder) as reader, h5py.File(labels) as file:
        first = None
        for connection, time, data in reader.messages():
            counts[connection.topic] = counts.get(connection.topic, 0) + 1
            message = store.deserialize_cdr(data, connection.msgtype)
            assert message.header.stamp.sec * 10**9 + message.header.stamp.nanosec == time
            if connection.topic == "/object/odometry" and first is None:
                first = message
        for connection in reader.connections:
            assert connection.msgcount == counts[connection.topic], connection
        assert reader.message_count == sum(counts.values())
        position = first.pose.pose.position
        assert [position.x, position.y, position.z] == list(file["object/position_m"][0])
        assert first.child_frame_id == "object"


if __name__ == "__main__":
    main(*sys.argv[1:])
