#!/usr/bin/python3
# SPDX-License-Identifier: AGPL-3.0-or-later
"""Computes figures of two label volumes by numpy and scipy: volume_figures.py BEFORE.nrrd AFTER.nrrd [FIELD.nrrd]

Prints a line for each figure: NAME LABEL BEFORE AFTER, or NAME LABEL VALUE. With a displacement field, also prints how
far each label of AFTER is from the best rigid motion of its voxels (found by singular values).
"""
import gzip
import sys

import numpy as np
from scipy import ndimage
from scipy.spatial.transform import Rotation

TYPES = {"uint8": "u1", "unsigned char": "u1", "uchar": "u1", "unsigned short": "<u2", "ushort": "<u2", "uint16": "<u2", "float": "<f4"}


def read(path):
    with open(path, "rb") as file:
        head, data = file.read().split(b"\n\n", 1)
    fields = dict(line.split(": ", 1) for line in head.decode().splitlines()[1:] if ": " in line)
    if "gz" in fields["encoding"]:
        data = gzip.decompress(data)
    sizes = [int(size) for size in fields["sizes"].split()]
    vectors = [[float(x) for x in word.strip("()").split(",")] for word in fields["space directions"].split() if word != "none"]
    origin = [float(x) for x in fields["space origin"].strip("()").split(",")]
    # In the array, z is the first index.
    return np.frombuffer(data, TYPES[fields["type"]]).reshape(sizes[::-1]), np.array(vectors), np.array(origin)


def figures(labels):
    result = {}
    faces = ndimage.generate_binary_structure(3, 1)
    all_26 = np.ones((3, 3, 3))
    air = np.pad(labels == 0, 1, constant_values=True)
    pieces, _ = ndimage.label(air, faces)
    result["enclosed", 0] = int(np.count_nonzero(air & (pieces != pieces[0, 0, 0])))
    beside_air = ndimage.binary_dilation(air, faces)[1:-1, 1:-1, 1:-1]
    for label in np.unique(labels[labels > 0]):
        mask = labels == label
        pieces, count = ndimage.label(mask, all_26)
        result["voxels", label] = int(np.count_nonzero(mask))
        result["components", label] = int(np.count_nonzero(np.bincount(pieces.ravel())[1:] >= 50))
        result["surface", label] = int(np.count_nonzero(mask & beside_air))
    return result


def residual(labels, field, directions, origin, label):
    z, y, x = np.nonzero(labels == label)
    posed = np.stack([x, y, z], 1) @ directions + origin
    rest = posed - field[z, y, x]
    turn, _ = Rotation.align_vectors(posed - posed.mean(0), rest - rest.mean(0))
    return np.linalg.norm(turn.apply(rest - rest.mean(0)) - (posed - posed.mean(0)), axis=1).max()


before, _, _ = read(sys.argv[1])
after, directions, origin = read(sys.argv[2])
ours, theirs = figures(before), figures(after)
for name, label in sorted({*ours, *theirs}):
    print(name, label, ours.get((name, label), 0), theirs.get((name, label), 0))
if before.shape == after.shape:
    for label in np.unique(np.concatenate([before[before > 0], after[after > 0]])):
        a, b = before == label, after == label
        print("dice", label, 2 * np.count_nonzero(a & b) / (np.count_nonzero(a) + np.count_nonzero(b)))
if len(sys.argv) > 3:
    field, _, _ = read(sys.argv[3])
    for label in np.unique(after[after > 0]):
        print("residual", label, residual(after, field, directions, origin, label))
