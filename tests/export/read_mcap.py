#!/usr/bin/env python3
"""Compares an MCAP file with the labels and the recording it was made of. usage: read_mcap.py MCAP LABELS RECORDING"""

import sys

import h5py
import numpy as np
from mcap.reader import make_reader
from mcap_ros2.decoder import DecoderFactory


def read_topics(path):
    """Messages by topic as (log_time, message); also checks all CRCs."""
    topics = {}
    with open(path, "rb") as file:
        reader = make_reader(file, validate_crcs=True, decoder_factories=[DecoderFactory()])
        assert reader.get_header().profile == "ros2"
        summary = reader.get_summary()
        for _, channel, message, decoded in reader.iter_decoded_messages():
            topics.setdefault(channel.topic, []).append((message.log_time, decoded))
        for number, count in summary.statistics.channel_message_counts.items():
            assert len(topics[summary.channels[number].topic]) == count
    return topics


def stamp_s(header):
    return header.stamp.sec + 1e-9 * header.stamp.nanosec


def check_body(topics, labels, epoch_s, name):
    rows = np.flatnonzero(labels[f"{name}/quality"][:] == 0)
    messages = [message for _, message in topics[f"/{name}/odometry"]]
    assert len(messages) == len(rows)
    times = np.array([stamp_s(m.header) for m in messages])
    assert np.abs(times - epoch_s - labels["label/time_s"][:][rows]).max() < 1e-6
    get = lambda part, names: np.array([[getattr(part(m), n) for n in names] for m in messages])
    position = get(lambda m: m.pose.pose.position, "xyz")
    velocity = get(lambda m: m.twist.twist.linear, "xyz")
    assert (position == labels[f"{name}/position_m"][:][rows]).all()
    assert (velocity == labels[f"{name}/velocity_m_per_s"][:][rows]).all()
    points = [message.point for _, message in topics[f"/{name}/position"]]
    assert (np.array([[p.x, p.y, p.z] for p in points]) == position).all()
    covariance = labels[f"{name}/covariance"][:][rows]
    for block, part in ((slice(0, 3), "pose"), (slice(3, 6), "twist")):
        stored = np.array([getattr(m, part).covariance for m in messages]).reshape(-1, 6, 6)
        assert (stored[:, :3, :3] == covariance[:, block, block]).all()
        assert (stored[:, 3:, 3:] == 1e6 * np.eye(3)).all()


def check_touch(topics, glove):
    counts, baseline = glove["counts"][:].astype(float), glove["baseline"][:].astype(float)
    pressure = glove.attrs["polarity"] * (counts - baseline) / (2 ** glove.attrs["bits"] - 1)
    pressure = np.clip(pressure, 0, 1) * glove["mask"][:]
    images = [message for _, message in topics["/glove0/tactile"]]
    stored = np.array([np.frombuffer(bytes(m.data), "<f4").reshape(m.height, m.width) for m in images])
    assert images[0].encoding == "32FC1" and images[0].step == 4 * images[0].width
    assert np.abs(stored - pressure).max() < 2**-23  # one rounding of a number up to 1


def check_images(topics, recording):
    color, depth = topics["/camera/color/image_raw"], topics["/camera/depth/image_raw"]
    assert len(color) == len(recording["color/image"])
    for i, (_, message) in enumerate(color):
        assert message.encoding == "rgb8"
        assert bytes(message.data) == recording["color/image"][i].tobytes()
    for i, (_, message) in enumerate(depth):
        assert message.encoding == "16UC1"
        assert bytes(message.data) == recording["depth/image"][i].tobytes()
    info = topics["/camera/color/camera_info"][0][1]
    assert list(info.k) == [7.5, 0, 4, 0, 7.25, 3, 0, 0, 1] and info.width == 8


def main(mcap, labels, recording):
    topics = read_topics(mcap)
    with h5py.File(labels) as l, h5py.File(recording) as r:
        for name in "hand", "object":
            check_body(topics, l, r.attrs["epoch_unix_s"], name)
        check_touch(topics, r["glove0"])
        check_images(topics, r)
    for messages in topics.values():
        times = [time for time, _ in messages]
        assert times == sorted(times)


if __name__ == "__main__":
    main(*sys.argv[1:])
