"""Poses a NIfTI volume that nibabel read; its voxels are shared, and spacing and direction are kept."""
import sys

import nibabel
import numpy as np

import limber

image = nibabel.load(sys.argv[1])
labels = np.asarray(image.dataobj, dtype=np.uint16, order="F")
volume = limber.Volume(labels, affine=image.affine, tissues=limber.read_tissues(sys.argv[2]))
assert np.shares_memory(volume.labels, labels)
rig = limber.read_rig(sys.argv[3])
posed = limber.Body(volume, rig).weights().resample(rig.pose(flex={"Forearm": 60}))
nibabel.save(nibabel.Nifti1Image(posed.labels, posed.volume.affine), "posed.nii.gz")
