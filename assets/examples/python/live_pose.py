"""Bends the elbow thirty times a second, and reads the labels of a sagittal slice of the posed arm each time."""
import math
import time

import numpy as np

import limber

volume, rig, _ = limber.make_phantom("arm", spacing=3)
preview = limber.Preview(limber.Body(volume, rig).weights())
elbow = rig.heads[rig.index("Forearm")]
across, along = np.meshgrid(np.arange(-150, 150, 3.0), np.arange(-300, 300, 3.0))
slice_points = np.stack([np.full(across.size, elbow[0]), elbow[1] + across.ravel(), elbow[2] + along.ravel()], axis=1)
start = time.perf_counter()
for frame in range(60):
    pose = rig.pose(flex={"Forearm": 45 - 45 * math.cos(frame / 10)})
    labels = preview.pose(pose).labels(slice_points).reshape(across.shape)
    time.sleep(max(0, start + frame / 30 - time.perf_counter()))
print(f"{60 / (time.perf_counter() - start):.0f} poses a second, {np.count_nonzero(labels)} pixels of tissue")
