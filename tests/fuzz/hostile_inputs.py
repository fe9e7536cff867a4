#!/usr/bin/env python3
# SPDX-License-Identifier: AGPL-3.0-or-later
"""Runs the program on damaged and malicious files of every format that it reads, and reports where it misbehaves.

    hostile_inputs.py --program build/limber [--count 1000] [--seed 1] [--first 0] [--malformed FOLDER] [--keep FOLDER]

Small valid samples are made by the program itself, or by this script for formats that the program only reads. Each
input is a sample with one to four mutations (bits, bytes, slices cut, doubled or exchanged, numbers made huge, nested
JSON), which depend on the seed only; with --malformed, every fifth input is an unchanged file of FOLDER. The parts of a
project beside its chunks (the editor's state, its picture) are mutated inside the project. The program runs on each
input in a new folder, which contains HOME, TMPDIR and the working folder, with 5 s of processor time (the editor:
20 s). The editor opens files, key maps and scripts without a display. It reads preferences only with a window, and
themes only from its installation; fuzz_editor_files.cpp tests these.

A fault is a crash (an end by a signal), a time-out, more than 1 GB of memory, an exit code that the program does not
define, an error that is not one line, or a file that is made, changed or deleted although it is not named as an output.
The exit code is 0 if there is no fault. With --keep, the inputs with faults are copied to that folder, each with its
command.
"""
import argparse
import base64
import collections
import hashlib
import json
import os
import pathlib
import random
import re
import resource
import shutil
import signal
import sqlite3
import struct
import subprocess
import sys
import tempfile
import time

CPU_SECONDS = 5
EDITOR_SECONDS = 20
WALL_SECONDS = 60
MEMORY_KB = 1_000_000
ADDRESS_BYTES = 4 << 30  # limit of the address space: a huge allocation fails instead of exhausting the machine's memory
ASSETS = pathlib.Path(__file__).resolve().parents[2] / "assets"
NUMBERS = [b"-1", b"0", b"65536", b"4294967295", b"2147483648", b"9223372036854775807", b"1e308", b"-1e308", b"nan", b"inf", b"1e999"]


def dicom(z=0):
    def element(group, number, kind, value):
        if len(value) % 2:
            value += b"\0" if kind == b"UI" else b" "
        if kind == b"OW":
            return struct.pack("<HH2sHI", group, number, kind, 0, len(value)) + value
        return struct.pack("<HH2sH", group, number, kind, len(value)) + value

    def word(value):
        return struct.pack("<H", value)

    syntax = element(2, 0x10, b"UI", b"1.2.840.10008.1.2.1")
    head = b"\0" * 128 + b"DICM" + element(2, 0, b"UL", struct.pack("<I", len(syntax))) + syntax
    for group, number, kind, value in [
            (8, 0x16, b"UI", b"1.2.840.10008.5.1.4.1.1.2"), (0x18, 0x50, b"DS", b"2"), (0x20, 0xe, b"UI", b"1.2.3"), (0x20, 0x32, b"DS", b"0\\0\\%d" % z),
            (0x20, 0x37, b"DS", b"1\\0\\0\\0\\1\\0"), (0x28, 2, b"US", word(1)), (0x28, 4, b"CS", b"MONOCHROME2"), (0x28, 0x10, b"US", word(4)),
            (0x28, 0x11, b"US", word(4)), (0x28, 0x30, b"DS", b"1\\1"), (0x28, 0x100, b"US", word(16)), (0x28, 0x101, b"US", word(16)),
            (0x28, 0x102, b"US", word(15)), (0x28, 0x103, b"US", word(0)), (0x28, 0x1052, b"DS", b"0"), (0x28, 0x1053, b"DS", b"1")]:
        head += element(group, number, kind, value)
    return head + element(0x7fe0, 0x10, b"OW", bytes(range(32)))


EDITOR_STATE = json.dumps({
    "schema": "limber-editor/1", "workspace": 2, "display": 1, "slices": 1, "cross_hair": [1, 2, 3], "bones": True, "method": "fem", "tissue": 3,
    "camera": {"centre": [0, 0, 0], "distance": 500, "world_from_view": [1, 0, 0, 0], "projection": 1}, "weights": {"display": 2, "contours": True},
    "finite_elements": {"quality": "fine", "contact": True}, "slice_cameras": [{"centre": [0, 0, 0], "millimetres_per_pixel": 0.5}],
    "arrangements": [{"views": 1, "sidebar": True}]}).encode()


def gltf_of(glb):
    """Returns the text form of a .glb file, with its buffer inside."""
    length, = struct.unpack_from("<I", glb, 12)
    description = json.loads(glb[20:20 + length])
    description["buffers"][0]["uri"] = "data:application/octet-stream;base64," + base64.b64encode(glb[28 + length:]).decode()
    return json.dumps(description)


class Samples:
    """Valid files, and for each file the commands that read it."""

    def __init__(self, program, folder):
        self.folder = folder
        # Pairs: the file to damage (or FILE#STATE for a state inside a project), and the command line, in which {} is
        # the file and {out} the folder of the output.
        self.cases = []
        self.program = program
        self.has_editor = subprocess.run([program, "editor", "--help"], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL).returncode == 0
        self.make()
        self.make_editor_files()

    def limber(self, *words):
        subprocess.run([self.program, *words], cwd=self.folder, check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)

    def write(self, name, text):
        (self.folder / name).write_bytes(text if isinstance(text, bytes) else text.encode())

    def make(self):
        self.limber("phantom", "arm", "--spacing", "10", "-o", ".")
        for name in ["v.mha", "v.mhd", "v.nii", "v.nii.gz", "v.hdr", "v.nhdr", "v.txt", "v.seg.nrrd"]:
            self.limber("convert", "volume.nrrd", name)
        self.limber("weights", "volume.nrrd", "--rig", "rig.json", "-o", "weights.nrrd")
        for name in ["body.obj", "body.stl", "body.ply"]:
            self.limber("surfaces", "volume.nrrd", "-o", name)
        self.limber("resample", "volume.nrrd", "--rig", "rig.json", "--flex", "Forearm=20", "--method", "lbs", "-o", "posed.nrrd", "--field", "field.nrrd")
        self.limber("project", "body.limber", "create", "volume.nrrd", "--rig", "rig.json", "--weights", "weights.nrrd", "--motion", "motion.bvh")
        self.write("image.dcm", dicom())
        self.write("pose.json", '{"bones": {"Forearm": {"axis": [0, 0, 1], "degrees": 20}}, "root_translation": [0, 0, 1], "angles": {"elbow": {"flexion": 30}}}')
        self.write("map.json", '{"Forearm": "Forearm", "@rests": {"motion": "T", "rig": "anatomical"}}')
        self.write("bone_map.json", '{"cortical bone": "Forearm"}')
        self.write("points.csv", "name,x,y,z\nelbow,1,2,3\n")
        self.write("case.json", '{"schema": "skin-ref/1", "bones": [{"rest": [1,0,0,0,0,1,0,0,0,0,1,0,0,0,0,1], "pose": [1,0,0,5,0,1,0,0,0,0,1,0,0,0,0,1]}], '
                                '"rest": [1, 2, 3], "influence_offsets": [0, 1], "influence_bones": [0], "influence_weights": [1]}')
        self.write("job.json", '{"command": "prepare", "volume": "volume.nrrd", "output": "out/job.nrrd", "pad": 1}')
        self.write("study.json", '{"volume": "volume.nrrd", "rig": "rig.json", "poses": [{"name": "bent", "flex": ["Forearm=20"]}], "methods": ["lbs"]}')
        self.limber("experiment", "study.json", "-o", "out/study", "--rating-form", "--bundle", "bundle")
        code = (self.folder / "out/study/rating_key.csv").read_text().splitlines()[1].split(",")[0]
        self.write("scores.csv", f'study,rater,order,picture,score,remark\r\n"study","R 1",1,{code},4,"a fold, ""flat"""\r\n')
        self.write("batch.json", '{"bodies": [{"volume": "volume.nrrd", "rig": "rig.json", "weights": "weights.nrrd"}], "methods": ["lbs"], "exports": [".stl"], '
                                 '"poses": [{"name": "walk", "motion": "motion.bvh", "frames": "0:1"}, {"name": "bent", "flex": ["Forearm=20"]}]}')
        self.limber("batch", "batch.json", "-o", "out/batch")
        self.limber("prepare", "volume.nrrd", "--rig", "rig.json", "--seams", "seams.nrrd", "-o", "prepared.nrrd")
        self.limber("export-gltf", "volume.nrrd", "--rig", "rig.json", "--weights", "weights.nrrd", "-o", "body.glb")
        self.write("body.gltf", gltf_of((self.folder / "body.glb").read_bytes()))
        self.write("rig.vtk", self.bender_rig())
        self.write("rig.arm", '<armature name="a" orientation="0 0 0 1"><bone name="Forearm" head="0 0 0" tail="0 0 9" orientation="0 0 0 1"/></armature>')
        self.write("job2.json", '{"command": "resample", "volume": "volume.nrrd", "rig": "rig.json", "flex": ["Forearm=20"], "joints": ["elbow flexion=9"], '
                                '"method": "lbs", "output": "out/job.nrrd", "report": "out/report.json"}')
        self.write("table.ctbl", "# Color table\n1 skin 177 122 101 255\n2 fat 240 210 60 255\n")
        self.write("table.label", '    1  177 122 101  1  1  1  "skin"\n    2  240 210 60  1  1  1  "fat"\n')
        self.write("properties.csv", "\n".join((ASSETS / "tissues/dielectric.csv").read_text().splitlines()[:3]) + "\n")
        (self.folder / "images").mkdir()
        self.write("images/1.dcm", dicom())
        self.write("images/2.dcm", dicom(2))
        for name in ["volume.nrrd", "v.mha", "v.mhd", "v.nii", "v.nii.gz", "v.hdr", "v.nhdr", "v.txt", "v.seg.nrrd", "image.dcm"]:
            self.add(name, ["info", "{}"], ["info", "{}", "--json"], ["convert", "{}", "{out}/a.nrrd"], ["prepare", "{}", "-o", "{out}/a.mha", "--crop"])
        for name, header in [("v.raw", "v.txt"), ("v.zraw", "v.mhd"), ("v.raw.gz", "v.nhdr"), ("v.img", "v.hdr")]:
            if (self.folder / name).exists():
                self.add(name, ["info", header])
        for name in ["rig.json", "rig.vtk", "rig.arm", "motion.bvh", "body.glb", "body.gltf"]:
            self.add(name, ["info", "{}"], ["fk", "{}"], ["fk", "{}", "--json"], ["convert", "{}", "{out}/r.json"])
        self.add("body.obj", ["info", "{}"])
        for name in ["body.obj", "body-nerve.stl", "body-nerve.ply", "body.glb", "body.gltf"]:
            self.add(name, ["resample", "volume.nrrd", "--rig", "rig.json", "--weights", "weights.nrrd", "--method", "fem", "--quality", "draft", "-o", "{out}/p.nrrd",
                            "--obstacle", "{}@2000,0,0@from=1,0,0"])
        self.add("rig.json", ["weights", "volume.nrrd", "--rig", "{}", "--method", "rigid", "-o", "{out}/w.nrrd"])
        self.add("weights.nrrd", ["info", "{}"], ["resample", "volume.nrrd", "--rig", "rig.json", "--weights", "{}", "--flex", "Forearm=20", "--method", "lbs", "-o", "{out}/p.nrrd"])
        self.add("body.limber", ["info", "{}"], ["project", "{}", "verify"], ["project", "{}", "recover", "-o", "{out}/r.limber"], ["project", "{}", "export", "rig", "-o", "{out}/r.json"])
        self.add("pose.json", ["fk", "rig.json", "--pose", "{}"], ["info", "{}"])
        self.add("motion.bvh", ["fk", "rig.json", "--motion", "{}", "--frame", "1"])
        self.add("map.json", ["fk", "rig.json", "--motion", "motion.bvh", "--map", "{}"])
        self.add("tissues.json", ["info", "{}"], ["tissues", "volume.nrrd", "--frequency", "1e9", "--tissues", "{}"])
        self.add("bone_map.json", ["weights", "volume.nrrd", "--rig", "rig.json", "--bone-map", "{}", "--method", "rigid", "-o", "{out}/w.nrrd"])
        self.add("points.csv", ["resample", "volume.nrrd", "--rig", "rig.json", "--flex", "Forearm=20", "--method", "lbs", "-o", "{out}/p.nrrd", "--landmarks", "{}={out}/l.csv"])
        self.add("field.nrrd", ["report", "volume.nrrd", "posed.nrrd", "--field", "{}"])
        self.add("case.json", ["skin-points", "{}", "--method", "dqs"])
        self.add("job.json", ["job", "{}"])
        self.add("job2.json", ["job", "{}"])
        self.add("study.json", ["experiment", "{}", "-o", "{out}/new", "--shard", "1/9"])
        self.add("scores.csv", ["experiment", "study.json", "-o", "{out}/study", "--scores", "{}"])
        self.add("bundle/expected.json", ["experiment", "study.json", "-o", "{out}/study", "--expect", "{}"])
        for cell in sorted((self.folder / "out/study/cells").rglob("*.json")):
            self.add(str(cell.relative_to(self.folder)), ["experiment", "study.json", "-o", "{out}/study"])
        self.add("batch.json", ["batch", "{}", "-o", "{out}/new", "--plan"], ["batch", "{}", "-o", "{out}/new", "--cells", "1"])
        for cell in sorted((self.folder / "out/batch").rglob("*.json")):
            self.add(str(cell.relative_to(self.folder)), ["batch", "batch.json", "-o", "{out}/batch"])
        self.add("images/2.dcm", ["info", "images"], ["convert", "images", "{out}/a.nrrd"])
        for name in ["table.ctbl", "table.label"]:
            self.add(name, ["info", "{}"], ["convert", "{}", "{out}/t.json"], ["tissues", "volume.nrrd", "--frequency", "1e9", "--tissues", "{}"])
        self.add("properties.csv", ["tissues", "volume.nrrd", "--frequency", "1e9", "--properties", "{}"])
        self.add("seams.nrrd", ["info", "{}"], ["resample", "volume.nrrd", "--rig", "rig.json", "--seams", "{}", "--flex", "Forearm=20", "--method", "lbs", "-o", "{out}/p.nrrd"])
        self.add("body.limber#editor", ["info", "{}"])
        self.add("body.limber#thumbnail", ["info", "{}"])

    def make_editor_files(self):
        if not self.has_editor:
            return
        self.write("look.txt", "key Ctrl+Alt+Q\nwait 0.1\n")
        self.write("keys.txt", 'key F3\ntype "import keymap"\nkey Return\ntype keys.json\nkey Return\nwait-job\nexpect widget:dialog/Keymap\n')
        self.write("keys.json", (ASSETS / "keymap.json").read_bytes())
        self.write("script.txt", 'move 300 200\nwheel "3D view/view" 2\nkey-down Shift\nkey-up Shift\ndrop rig.json\nwait-job\nresize 700 500\n'
                                 'type "a\u00e9"\nwait 0.1\nexpect workspace rig\n')
        (self.folder / "config/limber").mkdir(parents=True)
        self.write("config/limber/remembered.json", json.dumps({
            "schema": "limber-remembered/1", "recent": [{"path": str(self.folder / "volume.nrrd"), "time": 1}], "folders": {"keymap": str(self.folder.parent / "run/work")},
            "recent_folders": ["/"], "show_start": True, "hidden_files": False, "tour_step": 1}))
        self.leave_journal()
        editor = ["editor", "--size", "640x480"]
        for name in ["volume.nrrd", "v.mha", "v.nii", "v.txt", "body.limber", "body.limber#editor", "body.limber#thumbnail"]:
            self.add(name, [*editor, "{}", "--play", "look.txt"])
        for name in ["rig.json", "rig.vtk", "rig.arm", "body.gltf", "body.glb", "motion.bvh", "tissues.json", "table.label"]:
            self.add(name, [*editor, "volume.nrrd", "{}", "--play", "look.txt"])
        for name in ["weights.nrrd", "pose.json"]:
            self.add(name, [*editor, "volume.nrrd", "rig.json", "{}", "--play", "look.txt"])
        self.add("keys.json", [*editor, "--play", "keys.txt"])
        self.add("script.txt", [*editor, "volume.nrrd", "--play", "{}"])
        self.add("config/limber/remembered.json", [*editor, "--play", "look.txt"])
        self.add("edited.limber-edits", [*editor, "edited.limber", "--play", "look.txt"], ["info", "edited.limber"],
                 ["project", "edited.limber", "verify"], ["project", "edited.limber", "recover", "-o", "{out}/r.limber"])

    def leave_journal(self):
        """Kills an editor with unsaved edits, which leaves the journal of its project behind."""
        shutil.copyfile(self.folder / "body.limber", self.folder / "edited.limber")
        self.write("edit.txt", "drop pose.json\nwait-job\nwait 1000\n")
        process = subprocess.Popen([self.program, "editor", "--size", "640x480", "edited.limber", "--play", "edit.txt"], cwd=self.folder,
                                   env=environment_of(self.folder.parent, self.folder), stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        journal, latest = self.folder / "edited.limber-edits", time.monotonic() + WALL_SECONDS
        while not (journal.exists() and journal.stat().st_size > 0) and time.monotonic() < latest and process.poll() is None:
            time.sleep(0.02)
        time.sleep(0.5)
        process.kill()
        process.wait()

    def bender_rig(self):
        return ("# vtk DataFile Version 3.0\nArmature\nASCII\nDATASET POLYDATA\nPOINTS 2 double\n0 0 0 0 0 100\nLINES 1 3\n2 0 1\n"
                "CELL_DATA 1\nFIELD FieldData 2\nNames 1 1 string\nForearm\nParenthood 1 1 int\n-1\n")

    def add(self, name, *commands):
        self.cases += [(name, list(words)) for words in commands]


def mutated(data, name, chance):
    """Returns the bytes of a file with one to four mutations."""
    for _ in range(chance.randint(1, 4)):
        kind = chance.choice(["bit", "byte", "cut", "double", "remove", "exchange", "number", "length", "nest", "insert"])
        if not data:
            return data
        at = chance.randrange(len(data))
        # Half of all mutations are near the start, where headers are.
        if chance.random() < 0.5:
            at = chance.randrange(min(len(data), 400))
        length = chance.choice([1, 2, 4, 16, 200])
        if kind == "bit":
            data = data[:at] + bytes([data[at] ^ 1 << chance.randrange(8)]) + data[at + 1:]
        elif kind == "byte":
            data = data[:at] + bytes([chance.choice([0, 1, 10, 27, 32, 127, 128, 155, 255])]) + data[at + 1:]
        elif kind == "cut":
            data = data[:at]
        elif kind == "double":
            data = data[:at] + data[at:at + length] * chance.choice([2, 3, 1000]) + data[at + length:]
        elif kind == "remove":
            data = data[:at] + data[at + length:]
        elif kind == "exchange":
            other = chance.randrange(len(data))
            piece = data[other:other + length]
            data = data[:at] + piece + data[at + len(piece):]
        elif kind == "length":
            data = data[:at] + struct.pack(chance.choice("<>") + "I", chance.choice([0, 1, 0x7fffffff, 0x80000000, 0xfffffff0, 0xffffffff])) + data[at + 4:]
        elif kind == "number":
            numbers = list(re.finditer(rb"-?\d+(\.\d+)?", data[:4000]))
            if numbers:
                one = chance.choice(numbers)
                data = data[:one.start()] + chance.choice(NUMBERS) + data[one.end():]
        elif kind == "nest" and name.endswith(".json"):
            depth = chance.choice([100, 100_000])
            places = [m.end() for m in re.finditer(rb":", data)]
            if places:
                at = chance.choice(places)
                data = data[:at] + b"[" * depth + b"]" * depth + b"," + data[at:]
        elif kind == "insert":
            data = data[:at] + chance.choice([b"\x1b[2J\xc2\x9b31m", b"\0", b"../../", b"/etc/passwd", b"\xff\xfe", b"%s%n", b"\n\n"]) + data[at:]
    return data


def mutate_state(project, state, chance):
    """Mutates a state, which a project stores beside its chunks, inside the project's database."""
    with sqlite3.connect(project) as database:
        name = state.encode()
        held = database.execute("SELECT value FROM state WHERE name = ?", (name,)).fetchone()
        database.execute("REPLACE INTO state VALUES (?, ?)", (name, mutated(held[0] if held and held[0] else EDITOR_STATE, state + ".json", chance)))
    database.close()


def state_of(folder):
    """Returns what each file below the folder is and contains."""
    state = {}
    for base, folders, files in os.walk(folder):
        for name in folders + files:
            path = pathlib.Path(base, name)
            if path.is_symlink():
                state[str(path)] = "link " + os.readlink(path)
            elif path.is_dir():
                state[str(path)] = "folder"
            else:
                state[str(path)] = hashlib.sha256(path.read_bytes()).hexdigest() + oct(path.stat().st_mode)
    return state


def environment_of(folder, work):
    home = str(folder / "home")
    return {"PATH": os.environ.get("PATH", "/usr/bin:/bin"), "HOME": home, "TMPDIR": str(folder / "tmp"), "XDG_CONFIG_HOME": str(work / "config"),
            "XDG_CACHE_HOME": home, "XDG_DATA_HOME": home, "MESA_SHADER_CACHE_DISABLE": "true", "LP_NUM_THREADS": "1"}


def limit(cpu_seconds):
    resource.setrlimit(resource.RLIMIT_CPU, (cpu_seconds, cpu_seconds))
    if "LIMBER_ADDRESS_SANITIZER" not in os.environ:  # the sanitizer reserves terabytes of addresses
        resource.setrlimit(resource.RLIMIT_AS, (ADDRESS_BYTES, ADDRESS_BYTES))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    resource.setrlimit(resource.RLIMIT_FSIZE, (1 << 30, 1 << 30))


def run(program, words, folder):
    """Runs the program. Returns its exit code (negative: a signal), its output and its peak memory in kB."""
    seconds = EDITOR_SECONDS if words[0] == "editor" else CPU_SECONDS
    with open(folder / "printed", "wb") as out, open(folder / "told", "wb") as err:
        process = subprocess.Popen([program, *words], cwd=folder / "work", env=environment_of(folder, folder / "work"), stdin=subprocess.DEVNULL, stdout=out,
                                   stderr=err, preexec_fn=lambda: limit(seconds))
        latest = time.monotonic() + WALL_SECONDS
        while True:
            ended, status, usage = os.wait4(process.pid, os.WNOHANG)
            if ended:
                break
            if time.monotonic() > latest:
                process.send_signal(signal.SIGXCPU)
            time.sleep(0.002)
    process.returncode = os.waitstatus_to_exitcode(status)
    return process.returncode, (folder / "printed").read_bytes(), (folder / "told").read_bytes(), usage.ru_maxrss


def problems_of(code, out, err, memory, before, after, folder):
    problems = []
    if code < 0:
        problems.append("time-out" if -code in (signal.SIGXCPU, signal.SIGKILL) else "crash by signal %d" % -code)
    elif code not in (0, 1, 2, 4, 5):
        problems.append("exit code %d" % code)
    if memory > MEMORY_KB:
        problems.append("memory %d MB" % (memory // 1000))
    if b"internal error" in err.lower():
        problems.append("internal error")
    told = [line for line in err.splitlines() if not line.startswith(b"limber: warning:") and not re.match(rb"\d+ of \d+  ", line)]
    if code == 1 and len(told) != 1:
        problems.append("error that is no single line")
    if re.search(rb"[\x00-\x08\x0b-\x1f\x7f]|\xc2[\x80-\x9f]", out + err):
        problems.append("control character printed")
    named = str(folder / "work" / "out") + os.sep
    # Files that the editor may write: its settings and the damaged ones that it renamed, thumbnails, the journal of the
    # opened project, and its note of a journal that it renamed.
    own = tuple(str(folder / part) for part in ("work/config/limber/", "home/limber", "work/edited.limber-edits", "home/.local/state/limber/edits/"))
    # Folders for the program's notes of unfinished files. No note may remain in them.
    notes = [str(folder / "home" / part) for part in (".local", ".local/state", ".local/state/limber", ".local/state/limber/unfinished", ".local/state/limber/edits")]
    for path in sorted(set(before) | set(after)):
        if after.get(path) == "folder" and path in notes:
            continue
        if before.get(path) != after.get(path) and not path.startswith(named) and not path.startswith(own):
            problems.append("file made, changed or deleted: " + os.path.relpath(path, folder))
    if code == 1 and any(path.startswith(named) and after[path] != "folder" and path not in before for path in after):
        problems.append("output left behind after an error")
    return problems


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", required=True)
    parser.add_argument("--count", type=int, default=60)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--first", type=int, default=0, help="number of the first input: to repeat one, with --count 1")
    parser.add_argument("--malformed", type=pathlib.Path)
    parser.add_argument("--keep", type=pathlib.Path)
    options = parser.parse_args()
    program = os.path.abspath(options.program)
    malformed = sorted(path for path in options.malformed.rglob("*") if path.is_file()) if options.malformed else []
    counts, worst = collections.Counter(), 0
    with tempfile.TemporaryDirectory(prefix="limber-hostile-") as top:
        (pathlib.Path(top) / "samples").mkdir()
        samples = Samples(program, pathlib.Path(top) / "samples")
        order = random.Random(options.seed).sample(samples.cases, len(samples.cases))
        for number in range(options.first, options.first + options.count):
            chance = random.Random(options.seed * 1_000_003 + number)
            folder = pathlib.Path(top) / "run"
            shutil.rmtree(folder, ignore_errors=True)
            for name in ["home", "tmp"]:
                (folder / name).mkdir(parents=True)
            shutil.copytree(samples.folder, folder / "work")
            (folder / "work" / "out").mkdir(exist_ok=True)
            if malformed and number % 5 == 0:
                source = chance.choice(malformed)
                name = source.name
                shutil.copyfile(source, folder / "work" / name)
                words = ["info", name]
            else:
                name, words = order[number] if number < len(order) else chance.choice(samples.cases)
                name, _, state = name.partition("#")
                path = folder / "work" / name
                if state:
                    mutate_state(path, state, chance)
                else:
                    path.write_bytes(mutated(path.read_bytes(), name, chance))
                words = [word.replace("{out}", "out").replace("{}", name) for word in words]
            (folder / "printed").touch()
            (folder / "told").touch()
            ignored = {str(folder / "printed"), str(folder / "told")}
            before = {path: what for path, what in state_of(folder).items() if path not in ignored}
            code, out, err, memory = run(program, words, folder)
            after = {path: what for path, what in state_of(folder).items() if path not in ignored}
            worst = max(worst, memory)
            problems = problems_of(code, out, err, memory, before, after, folder)
            counts["exit code %d" % code if code >= 0 else "signal"] += 1
            for problem in problems:
                counts["PROBLEM " + problem.split(":")[0]] += 1
                print("input %d, limber %s: %s" % (number, " ".join(words), problem), repr(err[:200]) if err else "")
            if problems and options.keep:
                kept = options.keep / str(number)
                shutil.rmtree(kept, ignore_errors=True)
                shutil.copytree(folder / "work", kept)
                (kept / "COMMAND").write_text(" ".join(words) + "\n")
    print("%d inputs, seed %d, at most %d MB:" % (options.count, options.seed, worst // 1000))
    for what, count in sorted(counts.items()):
        print("  %5d  %s" % (count, what))
    return 1 if any(what.startswith("PROBLEM") for what in counts) else 0


if __name__ == "__main__":
    sys.exit(main())
