"""Bends the elbow of the procedural arm by 90 degrees and prints what changed, as the README's first pose does."""
import limber

volume, rig, _ = limber.make_phantom("arm", spacing=2)
weights = limber.Body(volume, rig).weights()
bent = weights.resample(rig.pose(flex={"Forearm": 90}), "dqs", report=True)
bent.save("bent.nrrd")
for tissue in bent.report["tissues"]:
    print(f"{tissue['name']:20} {tissue['volume_change_percent']:+6.2f} %")
