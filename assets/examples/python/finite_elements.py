"""Bends the elbow by finite elements with contact, shows the progress, and colours the skin's strain."""
import numpy as np

import limber

volume, rig, _ = limber.make_phantom("arm", spacing=4)
weights = limber.Body(volume, rig).weights()
posed = weights.resample(rig.pose(flex={"Forearm": 45}), "fem", contact=True, quality="draft", jacobian=True,
                         report=True, progress=lambda stage, fraction: print(f"\r{stage} {fraction:4.0%} ", end=""))
mesh = posed.report["mesh"]
print(f"\nreached {posed.reached:.0%} with {mesh['tets']} tets, {mesh['inverted']} of them inverted")
soft = posed.jacobian[posed.labels > 0]
print("change of volume, 1st and 99th percentile:", np.percentile(soft, [1, 99]).round(2))
