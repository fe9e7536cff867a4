"""Seats a body that TotalSegmentator labelled: python totalsegmentator.py segmentation.nii.gz names.json"""
import sys

import limber

volume = limber.read_volume(sys.argv[1])
if len(sys.argv) > 2:
    volume = limber.Volume(volume.labels, affine=volume.affine, tissues=limber.read_tissues(sys.argv[2]))
rig, errors = limber.fit_rig(volume)
print(f"{len(rig)} bones; the joint of {max(errors, key=errors.get)} may be off by {max(errors.values()):.0f} mm")
seated = limber.Body(volume, rig).weights().resample(rig.pose("sit"))
seated.save("seated.nii.gz")
