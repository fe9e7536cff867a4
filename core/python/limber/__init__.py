# SPDX-License-Identifier: AGPL-3.0-or-later
"""Poses labelled voxel anatomy: volumes, rigs, weights, poses, motion capture, resampling by LBS, DQ or finite elements.

    import limber
    volume, rig, motion = limber.make_phantom("arm")
    weights = limber.Body(volume, rig).weights()
    posed = weights.resample(rig.pose(flex={"Forearm": 60}))
    posed.save("posed.nrrd")

Lengths are mm and positions LPS (x to the patient's left, y to the back, z to the head). Arrays of voxels are indexed
[x, y, z] with x fastest in memory, as nibabel's are; the array of a SimpleITK image is transposed.
"""
from ._limber import *  # noqa: F401,F403
from ._limber import __version__  # noqa: F401
