"""Poses the arm by every tenth frame of a motion, one file for each."""
import limber

volume, rig, motion = limber.make_phantom("arm", spacing=4)
weights = limber.Body(volume, rig).weights()
rigged = motion.retarget(rig)
frames = range(0, len(rigged), 10)
for frame, posed in zip(frames, weights.resample([rigged[frame] for frame in frames], "dqs", glide="voxel")):
    posed.save(f"frame_{frame:04}.nrrd")
    print(f"frame {frame}: {(posed.labels > 0).sum()} voxels of tissue")
