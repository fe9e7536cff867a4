"""Poses a grey volume (here a made-up CT) together with the labels."""
import numpy as np

import limber

volume, rig, _ = limber.make_phantom("arm", spacing=3)
weights = limber.Body(volume, rig).weights()
density = np.zeros(65536, np.float32)
for tissue in weights.body.tissues:
    density[tissue.label] = 1000 * (tissue.density - 1)
ct = np.where(volume.labels > 0, density[volume.labels], -1000)
posed = weights.resample(rig.pose(flex={"Forearm": 60}), grey=ct)
np.save("posed_ct.npy", posed.grey)
print("HU of the posed arm:", int(posed.grey[posed.labels > 0].min()), "to", int(posed.grey.max()))
