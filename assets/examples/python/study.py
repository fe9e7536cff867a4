"""Compares methods over a range of elbow angles, and writes one row for each pose to study.csv."""
import csv

import limber

volume, rig, _ = limber.make_phantom("arm", spacing=3)
weights = limber.Body(volume, rig).weights()
with open("study.csv", "w", newline="") as file:
    table = csv.writer(file)
    table.writerow(["method", "degrees", "volume_change_percent", "failed_gates"])
    for method in ("lbs", "dqs", "mix"):
        for degrees in (30, 60, 90):
            posed = weights.resample(rig.pose(flex={"Forearm": degrees}), method, report=True)
            failed = [gate["id"] for gate in posed.report["gates"] if gate["state"] == "failed"]
            table.writerow([method, degrees, posed.report["total"]["volume_change_percent"], " ".join(failed)])
