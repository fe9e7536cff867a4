#!/usr/bin/env python3
# SPDX-License-Identifier: AGPL-3.0-or-later
"""Poses many bodies by finite elements with contact, and writes one table of the results.

    run_grid.py --program build/limber --data DATA [--hard HARD] --out DIR [--cpu 250] [--quality draft] [CASE ...]

A CASE is BODY/POSE, BODY or /POSE; without one, all poses of all bodies run, the quickest bodies first. Each case gives
a line in DIR/results.jsonl, and DIR/table.md is written anew after each. A second call skips the cases that have a line;
--again runs the named cases once more. A pose that moves no joint of a body is "not applicable".

A case holds if the solve reached the whole pose, no tet is inverted, no triangles of the mesh's surface cross, at most
0.1 % of the surface shows tissue that lay deep inside, and volumes by mesh keep within the limits below.
"""
import argparse
import json
import os
import pathlib
import resource
import subprocess
import time

POSES = {
    "walk": ["--pose-name", "walk"],
    "arms-up": ["--pose-name", "arms-up"],
    "phone": ["--pose-name", "phone"],
    "fist": ["--pose-name", "fists"],
    "sit": ["--pose-name", "sit"],
    "knee120": ["--joint", "knees flexion=120"],
    "squat": ["--pose-name", "squat"],
}
# A pose counts for a rig only if it turns a bone whose name contains one of these words.
NEEDS = {
    "walk": ("thigh", "shank", "leg"),
    "arms-up": ("arm", "humerus"),
    "phone": ("forearm",),
    "fist": ("proximal", "middle", "finger", "phalan"),
    "sit": ("thigh", "shank", "leg"),
    "knee120": ("shank", "leg"),
    "squat": ("thigh", "shank", "leg"),
}
EXPOSED_PERCENT = 0.1
# Limits on the change of a label's volume by mesh, in percent, for labels of at least this many voxels.
LARGE_SOFT = (5000, 0.3)
OTHER_SOFT = (500, 3.0)
CORDS = 5.0  # limit for cartilage and tendon of at least 500 voxels, percent
# Limit for cavities, percent. They hold gas and fluid; their Poisson ratio of 0.45 lets them change more than flesh.
CAVITIES = 5.0


def bodies(data, hard):
    """Returns {body: arguments}, the quickest bodies first."""
    found = {}

    def add(name, volume, rig, tissues=None):
        if not (volume and pathlib.Path(volume).exists()):
            return
        found[name] = [str(volume), "--rig", str(rig)] + (["--tissues", str(tissues)] if tissues else [])

    for name in ("coarse_knee", "fused_hand"):
        if hard:
            add(name, hard / name / "volume.nrrd", hard / name / "rig.json", hard / name / "tissues.json")
    add("arm", data / "bender/man-arm-2mm.mha", data / "bender/man-arm-2mm-armature.vtk")
    add("makehuman", data / "makehuman/body_4mm.nrrd", data / "makehuman/body.armature.json")
    for name in ("control", "icrp_like", "glued", "icrp_glued"):
        if hard:
            add(name, hard / name / "volume.nrrd", hard / name / "rig.json", hard / name / "tissues.json")
    rig = data / "bp3d/body.armature.json"
    add("tissue_2mm", data / "bp3d/body_2mm_tissue.mha", rig, data / "bp3d/tissue.labels.json")
    add("structures_3mm", data / "bp3d/body_3mm_structures.nii.gz", rig, data / "bp3d/body_structures.labels.json")
    return found


def run(command, cpu_limit, stdout, stderr):
    """Runs a command; returns its exit status, CPU seconds and peak memory in MB."""
    with open(stdout, "wb") as out, open(stderr, "wb") as err:
        process = subprocess.Popen(
            command, stdout=out, stderr=err,
            preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_CPU, (cpu_limit, cpu_limit + 5)))
        _, status, used = os.wait4(process.pid, 0)
        process.returncode = os.waitstatus_to_exitcode(status)
    return process.returncode, used.ru_utime + used.ru_stime, used.ru_maxrss / 1024


def progress_of(stderr):
    """Returns the share of the path, the iterations and the lines of text in a log of --progress json."""
    share, iterations, text = 0.0, 0, []
    for line in stderr.read_text(errors="replace").splitlines():
        if not line.startswith("{"):
            text.append(line)
            continue
        step = json.loads(line)
        if step.get("stage") == "solving":
            share, iterations = step.get("fraction", share), step.get("iteration", iterations)
    return share, iterations, text


def volume_limits(report):
    """Returns (label, name, change, limit) of the soft labels that have a limit."""
    changes = report["mesh"]["volume_change_percent_by_label"]
    rows = []
    for tissue in report["tissues"]:
        change, kind, voxels = changes.get(str(tissue["label"])), tissue["kind"], tissue["voxels_before"]
        if change is None or "bone" in kind or "marrow" in kind or voxels < OTHER_SOFT[0]:
            continue
        is_cord = kind in ("cartilage", "tendon", "ligament")
        limit = CORDS if is_cord else CAVITIES if kind == "cavity" else \
            LARGE_SOFT[1] if voxels >= LARGE_SOFT[0] else OTHER_SOFT[1]
        rows.append((tissue["label"], tissue["name"], change, limit))
    return sorted(rows, key=lambda row: -abs(row[2]) / row[3])


def judge(report):
    """Returns the figures of one report, with the list of the conditions that it violates."""
    mesh, solve, exposed = report["mesh"], report["solve"], report["exposure"]["percent"]
    rows, fails = volume_limits(report), []
    if solve["reached"] < 1:
        fails.append("reached %.1f %%: %s" % (100 * solve["reached"], solve.get("blocked_by", "")))
    if mesh["inverted"]:
        fails.append("%d inverted" % mesh["inverted"])
    if mesh["self_intersections"]:
        fails.append("%d crossings" % mesh["self_intersections"])
    if exposed > EXPOSED_PERCENT:
        fails.append("exposed %.3f %%" % exposed)
    fails += ["volume of %s %+.2f %% (%g)" % (name, change, limit)
              for _, name, change, limit in rows if abs(change) > limit]
    return {
        "reached": solve["reached"], "converged": solve["converged"], "iterations": solve["iterations"],
        "tets": mesh["tets"], "inverted": mesh["inverted"], "least_det_f": mesh["min_det_f"],
        "crossings": mesh["self_intersections"], "exposed_percent": exposed,
        "total_percent": report["total"]["volume_change_percent"],
        "worst_volumes": [[name, round(change, 3), limit] for _, name, change, limit in rows[:3]],
        "fails": fails,
        "failing_gates": [gate["id"] for gate in report["gates"] if gate["state"] == "failed"],
        "warnings": report.get("warnings", [])[:3],
    }


def turned(bones, pose):
    return any(word in bone.lower() for bone in bones for word in NEEDS[pose])


def run_case(args, body, pose, arguments):
    out = args.out / ("%s_%s" % (body, pose))
    program = [str(args.program)]
    weights = args.out / ("weights_%s.nrrd" % body)
    if not weights.exists():
        status, *_ = run(program + ["weights", *arguments, "-o", str(weights)], 600, os.devnull, os.devnull)
        if status:
            return {"state": "no weights"}
    common = program + ["resample", *arguments, "--weights", str(weights), *POSES[pose]]
    # Blending shows within a second which joints the pose turns.
    probe = pathlib.Path(str(out) + ".probe.json")
    status, *_ = run(common + ["--method", "lbs", "-o", str(out) + ".nrrd", "--report", str(probe)], 60, os.devnull,
                     str(out) + ".txt")
    bones = json.loads(probe.read_text())["settings"]["turned_bones"] if status == 0 else []
    probe.unlink(missing_ok=True)
    if not turned(bones, pose):
        return {"state": "not applicable"}
    report = pathlib.Path(str(out) + ".json")
    report.unlink(missing_ok=True)
    stderr = pathlib.Path(str(out) + ".err")
    status, cpu, mb = run(
        common + ["--method", "fem", "--contact", "--quality", args.quality, "--progress", "json", "-o",
                  str(out) + ".nrrd", "--report", str(report), *args.option], args.cpu, str(out) + ".txt", stderr)
    share, iterations, text = progress_of(stderr)
    result = {"exit": status, "cpu_s": round(cpu, 1), "mb": round(mb)}
    if not report.exists():
        out_of_time = status < 0
        fails = ["%d %% of the pose, %d iterations after %.0f CPU s" % (100 * share, iterations, cpu)] if out_of_time \
            else [text[-1] if text else "exit status %d" % status]
        return result | {"state": "no result", "reached": share, "fails": fails}
    result |= judge(json.loads(report.read_text()))
    return result | {"state": "fails" if result["fails"] else "holds"}


def table(results):
    lines = ["| body | pose | state | CPU s | MB | reached % | inverted | crossings | exposed % | worst volume by mesh % "
             "| what fails | failing gates |", "|" + " --- |" * 12]
    for case in results.values():
        if case["state"] == "not applicable":
            continue
        worst = case.get("worst_volumes") or [["", 0, 0]]
        lines.append("| %s | %s | %s | %s | %s | %.1f | %s | %s | %s | %s | %s | %s |" % (
            case["body"], case["pose"], case["state"], case.get("cpu_s", ""), case.get("mb", ""),
            100 * case.get("reached", 0), case.get("inverted", ""), case.get("crossings", ""),
            "%.3f" % case["exposed_percent"] if "exposed_percent" in case else "",
            "%s %+.2f" % (worst[0][0], worst[0][1]) if worst[0][0] else "", "; ".join(case.get("fails", [])),
            ", ".join(case.get("failing_gates", []))))
    return "\n".join(lines) + "\n"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", type=pathlib.Path, required=True)
    parser.add_argument("--data", type=pathlib.Path, required=True, help="folder with bender, bp3d and makehuman")
    parser.add_argument("--hard", type=pathlib.Path, help="folder of the hard bodies, which make_hard.py makes")
    parser.add_argument("--out", type=pathlib.Path, required=True)
    parser.add_argument("--cpu", type=int, default=250, help="CPU seconds after which a case is given up")
    parser.add_argument("--quality", default="draft")
    parser.add_argument("--option", action="append", default=[], help="a further option of limber resample")
    parser.add_argument("--again", action="store_true", help="run the cases once more that have a result")
    parser.add_argument("case", nargs="*")
    args = parser.parse_args()
    args.out.mkdir(parents=True, exist_ok=True)
    found = bodies(args.data, args.hard)
    wanted = [tuple(case.split("/")) if "/" in case else (case, "") for case in args.case] or [("", "")]
    kept = args.out / "results.jsonl"
    results = {}
    if kept.exists():
        for line in kept.read_text().splitlines():
            case = json.loads(line)
            results[case["body"], case["pose"]] = case
    version = subprocess.run([str(args.program), "--version"], capture_output=True, text=True).stdout.strip()
    for pose in POSES:
        for body, arguments in found.items():
            if not any(b in ("", body) and p in ("", pose) for b, p in wanted):
                continue
            if (body, pose) in results and not args.again:
                continue
            case = {"body": body, "pose": pose, "program": version, "date": time.strftime("%Y-%m-%d %H:%M")}
            case |= run_case(args, body, pose, arguments)
            results[body, pose] = case
            with open(kept, "a") as file:
                file.write(json.dumps(case) + "\n")
            (args.out / "table.md").write_text(table(results))
            print(json.dumps(case), flush=True)


if __name__ == "__main__":
    main()
