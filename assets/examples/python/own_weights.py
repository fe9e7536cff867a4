"""Changes weights with NumPy: every voxel follows its strongest bone alone, and the joint gets a sharp crease."""
import numpy as np

import limber

volume, rig, _ = limber.make_phantom("arm", spacing=3)
smooth = limber.Body(volume, rig).weights()
bones, parts = smooth.influences()
rigid = smooth.with_influences(bones, np.where(np.arange(4) == 0, parts[:, :1], 0))
pose = rig.pose(flex={"Forearm": 90})
for name, weights in (("smooth", smooth), ("rigid", rigid)):
    posed = weights.resample(pose)
    print(f"{name}: {np.count_nonzero(posed.labels) - np.count_nonzero(volume.labels):+} voxels")
