"""Checks conventions of a recording or labels file that other tools rely on.

usage: recording_h5py.py FILE
"""

import json
import sys

import h5py


def check(name, item):
    if not isinstance(item, h5py.Dataset):
        return
    assert item.attrs["units"].decode(), f"{name} has no units"
    assert item.attrs["long_name"].decode(), f"{name} has no long_name"
    assert item.fletcher32, f"{name} has no checksum"
    assert item.chunks[1:] == item.shape[1:], f"{name} has chunks along more than its first axis"
    item[()]
    if h5py.h5ds.is_scale(item.id):
        return
    for axis, dimension in enumerate(item.dims):
        assert len(dimension) == 1, f"{name}, axis {axis}: no dimension scale"
        assert dimension[0].shape == (item.shape[axis],), f"{name}, axis {axis}: wrong length"
        assert dimension.label == dimension.keys()[0], f"{name}, axis {axis}: no label"


with h5py.File(sys.argv[1], "r") as file:
    assert file.attrs["Conventions"] == b"CF-1.10"
    assert file.attrs["schema"].startswith(b"touchtrace/")
    assert json.loads(file.attrs["provenance"])["version"]
    file.visititems(check)
    if "depth" in file:
        depth = file["depth/image"]
        assert [d.label for d in depth.dims] == ["host_time_s", "y", "x"]
        assert depth.attrs["scale_factor"] == file["depth"].attrs["depth_unit_m"]
        assert depth.chunks[0] == 1
        if "inertial" in file["glove0"]:
            unit = file["glove0/inertial"]
            assert unit["specific_force"].attrs["units"] == b"m s-2"
            assert unit["orientation_wxyz"].shape == unit["host_time_s"].shape + (4,)
            print(float(unit["specific_force"][:].sum()))
        print(int(file["glove0/counts"][:].astype("u8").sum()), int(depth[3].astype("u8").sum()))
