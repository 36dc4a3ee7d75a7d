#!/usr/bin/env python3
"""Prints the messages of ros2_messages_test.cpp as rosbags serializes them: name and bytes in hexadecimal.

usage: make_cdr_messages.py > cdr_messages.txt    needs rosbags (PyPI); the file was made with version 0.11.9
"""

import numpy as np
from rosbags.typesys import Stores, get_typestore

STORE = get_typestore(Stores.ROS2_HUMBLE)
TYPES = STORE.types


def header(frame):
    stamp = TYPES["builtin_interfaces/msg/Time"](sec=1700000000, nanosec=250000001)
    return TYPES["std_msgs/msg/Header"](stamp=stamp, frame_id=frame)


def make(name, **members):
    return TYPES[name](**members)


def show(name, **members):
    print(name, bytes(STORE.serialize_cdr(make(name, **members), name)).hex())


def covariance(first):
    """Block of the 6 x 6 matrix 0, 1, ... 35 from row and column `first` on; unknown rotations."""
    result = np.diag([0, 0, 0, 1e6, 1e6, 1e6])
    result[:3, :3] = np.arange(36.0).reshape(6, 6)[first:first + 3, first:first + 3]
    return result.ravel()


point = make("geometry_msgs/msg/Point", x=0.5, y=-0.25, z=2.0)
pose = make("geometry_msgs/msg/Pose", position=point,
            orientation=make("geometry_msgs/msg/Quaternion", x=0.0, y=0.0, z=0.0, w=1.0))
twist = make("geometry_msgs/msg/Twist", linear=make("geometry_msgs/msg/Vector3", x=1.0, y=2.0, z=-3.0),
             angular=make("geometry_msgs/msg/Vector3", x=0.0, y=0.0, z=0.0))
show("geometry_msgs/msg/PointStamped", header=header("camera"), point=point)
show("nav_msgs/msg/Odometry", header=header("camera"), child_frame_id="hand",
     pose=make("geometry_msgs/msg/PoseWithCovariance", pose=pose, covariance=covariance(0)),
     twist=make("geometry_msgs/msg/TwistWithCovariance", twist=twist, covariance=covariance(3)))
show("sensor_msgs/msg/Image", header=header("glove0"), height=2, width=3, encoding="16UC1", is_bigendian=0, step=6,
     data=np.arange(12, dtype=np.uint8))
show("sensor_msgs/msg/CameraInfo", header=header("c"), height=6, width=8, distortion_model="plumb_bob",
     d=np.array([0.5, 0.25, 0, 0, 0]), k=np.array([7.5, 0, 4, 0, 7.25, 3, 0, 0, 1]), r=np.eye(3).ravel(),
     p=np.array([7.5, 0, 4, 0, 0, 7.25, 3, 0, 0, 0, 1, 0]), binning_x=0, binning_y=0,
     roi=make("sensor_msgs/msg/RegionOfInterest", x_offset=0, y_offset=0, height=0, width=0, do_rectify=False))
