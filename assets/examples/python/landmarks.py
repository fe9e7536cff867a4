"""Moves points of the body with a pose, and measures the elbow's angle from them."""
import numpy as np

import limber

volume, rig, _ = limber.make_phantom("arm", spacing=3)
weights = limber.Body(volume, rig).weights()
shoulder, elbow = rig.heads[rig.index("UpperArm")], rig.heads[rig.index("Forearm")]
wrist = rig.tails[rig.index("Forearm")]
points = np.stack([shoulder, elbow, wrist])
for degrees in (0, 45, 90):
    a, b, c = weights.move_points(points, rig.pose(flex={"Forearm": degrees}))
    cosine = np.dot(a - b, c - b) / np.linalg.norm(a - b) / np.linalg.norm(c - b)
    print(f"flexed by {degrees:2} degrees: {np.degrees(np.arccos(cosine)):5.1f} degrees between the bones")
