#!/usr/bin/env python3
# SPDX-License-Identifier: AGPL-3.0-or-later
"""Feeds the program with damaged and malicious files of every format that its commands read, and watches it.

    hostile_inputs.py --program build/limber [--count 1000] [--seed 1] [--malformed FOLDER] [--keep FOLDER]

Small sound samples are made with the program itself, and by hand where it only reads a format. Each input is a sample with one to
four mutations (bits, bytes, slices cut, doubled or exchanged, numbers made huge, nested JSON), chosen by the seed alone, or, one in
five, a file of --malformed as it is. The program runs on each in a folder of its own, with 5 s of processor and HOME, TMPDIR and
the working folder inside. Counted: crashes (an end by a signal), time-outs, more than 1 GB of memory, exit codes that are none of
the program's, errors that are no single line, and every file that was made, changed or deleted without being named as an output.
The exit code is 0 when nothing was counted. With --keep the inputs that were counted are kept there, with the command.
"""
import argparse
import collections
import hashlib
import os
import pathlib
import random
import re
import resource
import shutil
import signal
import struct
import subprocess
import sys
import tempfile
import time

CPU_SECONDS = 5
WALL_SECONDS = 60
MEMORY_KB = 1_000_000
ADDRESS_BYTES = 4 << 30  # so that a claim of everything is refused by the system and not by the machine's end
NUMBERS = [b"-1", b"0", b"65536", b"4294967295", b"2147483648", b"9223372036854775807", b"1e308", b"-1e308", b"nan", b"inf", b"1e999"]


def dicom():
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
            (8, 0x16, b"UI", b"1.2.840.10008.5.1.4.1.1.2"), (0x18, 0x50, b"DS", b"2"), (0x20, 0xe, b"UI", b"1.2.3"), (0x20, 0x32, b"DS", b"0\\0\\0"),
            (0x20, 0x37, b"DS", b"1\\0\\0\\0\\1\\0"), (0x28, 2, b"US", word(1)), (0x28, 4, b"CS", b"MONOCHROME2"), (0x28, 0x10, b"US", word(4)),
            (0x28, 0x11, b"US", word(4)), (0x28, 0x30, b"DS", b"1\\1"), (0x28, 0x100, b"US", word(16)), (0x28, 0x101, b"US", word(16)),
            (0x28, 0x102, b"US", word(15)), (0x28, 0x103, b"US", word(0)), (0x28, 0x1052, b"DS", b"0"), (0x28, 0x1053, b"DS", b"1")]:
        head += element(group, number, kind, value)
    return head + element(0x7fe0, 0x10, b"OW", bytes(range(32)))


class Samples:
    """Sound files, and for each the commands that read it."""

    def __init__(self, program, folder):
        self.folder = folder
        self.cases = []  # (file to be damaged, words with {name} for files and {out} for the output's folder)
        self.program = program
        self.make()

    def limber(self, *words):
        subprocess.run([self.program, *words], cwd=self.folder, check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)

    def write(self, name, text):
        (self.folder / name).write_bytes(text if isinstance(text, bytes) else text.encode())

    def make(self):
        self.limber("phantom", "arm", "--spacing", "10", "-o", ".")
        for name in ["v.mha", "v.mhd", "v.nii", "v.nii.gz", "v.hdr", "v.nhdr", "v.txt", "v.seg.nrrd"]:
            self.limber("convert", "volume.nrrd", name)
        self.limber("weights", "volume.nrrd", "--rig", "rig.json", "-o", "weights.nrrd")
        self.limber("export-gltf", "volume.nrrd", "--rig", "rig.json", "--weights", "weights.nrrd", "-o", "body.glb")
        self.limber("surfaces", "volume.nrrd", "-o", "body.obj")
        self.limber("resample", "volume.nrrd", "--rig", "rig.json", "--flex", "Forearm=20", "--method", "lbs", "-o", "posed.nrrd", "--field", "field.nrrd")
        self.limber("project", "body.limber", "create", "volume.nrrd", "--rig", "rig.json", "--weights", "weights.nrrd", "--motion", "motion.bvh")
        self.write("image.dcm", dicom())
        self.write("pose.json", '{"bones": {"Forearm": {"axis": [0, 0, 1], "degrees": 20}}, "root_translation": [0, 0, 1]}')
        self.write("map.json", '{"Forearm": "Forearm", "@rests": {"motion": "T", "rig": "anatomical"}}')
        self.write("bone_map.json", '{"1@left": "Forearm"}')
        self.write("points.csv", "name,x,y,z\nelbow,1,2,3\n")
        self.write("case.json", '{"schema": "skin-ref/1", "bones": [{"rest": [1,0,0,0,0,1,0,0,0,0,1,0,0,0,0,1], "pose": [1,0,0,5,0,1,0,0,0,0,1,0,0,0,0,1]}], '
                                '"rest": [1, 2, 3], "influence_offsets": [0, 1], "influence_bones": [0], "influence_weights": [1]}')
        self.write("job.json", '{"command": "prepare", "volume": "volume.nrrd", "output": "out/job.nrrd", "pad": 1}')
        self.write("study.json", '{"volume": "volume.nrrd", "rig": "rig.json", "poses": [{"name": "bent", "flex": ["Forearm=20"]}], "methods": ["lbs"]}')
        self.write("rig.vtk", self.bender_rig())
        for name in ["volume.nrrd", "v.mha", "v.mhd", "v.nii", "v.nii.gz", "v.hdr", "v.nhdr", "v.txt", "v.seg.nrrd", "image.dcm"]:
            self.add(name, ["info", "{}"], ["info", "{}", "--json"], ["convert", "{}", "{out}/a.nrrd"], ["prepare", "{}", "-o", "{out}/a.mha", "--crop"])
        for name, header in [("v.raw", "v.txt"), ("v.zraw", "v.mhd"), ("v.raw.gz", "v.nhdr"), ("v.img", "v.hdr")]:
            if (self.folder / name).exists():
                self.add(name, ["info", header])
        for name in ["rig.json", "rig.vtk", "motion.bvh", "body.glb", "body.obj"]:
            self.add(name, ["info", "{}"], ["fk", "{}"], ["fk", "{}", "--json"], ["convert", "{}", "{out}/r.json"])
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
        self.add("study.json", ["experiment", "{}", "-o", "{out}/study", "--shard", "1/9"])

    def bender_rig(self):
        return ("# vtk DataFile Version 3.0\nArmature\nASCII\nDATASET POLYDATA\nPOINTS 2 double\n0 0 0 0 0 100\nLINES 1 3\n2 0 1\n"
                "CELL_DATA 1\nFIELD FieldData 2\nNames 1 1 string\nForearm\nParenthood 1 1 int\n-1\n")

    def add(self, name, *commands):
        self.cases += [(name, list(words)) for words in commands]


def mutated(data, name, chance):
    """The file with one to four mutations."""
    for _ in range(chance.randint(1, 4)):
        kind = chance.choice(["bit", "byte", "cut", "double", "remove", "exchange", "number", "length", "nest", "insert"])
        if not data:
            return data
        at = chance.randrange(len(data))
        # Half of all damage goes to the start, where headers are.
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


def state_of(folder):
    """Every file below the folder: what it is and what it holds."""
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


def limit():
    resource.setrlimit(resource.RLIMIT_CPU, (CPU_SECONDS, CPU_SECONDS))
    resource.setrlimit(resource.RLIMIT_AS, (ADDRESS_BYTES, ADDRESS_BYTES))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    resource.setrlimit(resource.RLIMIT_FSIZE, (1 << 30, 1 << 30))


def run(program, words, folder):
    """Exit code (negative: signal), what it printed, peak memory in kB."""
    environment = {"PATH": os.environ.get("PATH", "/usr/bin:/bin"), "HOME": str(folder / "home"), "TMPDIR": str(folder / "tmp"),
                   "XDG_CONFIG_HOME": str(folder / "home"), "XDG_CACHE_HOME": str(folder / "home"), "XDG_DATA_HOME": str(folder / "home")}
    with open(folder / "printed", "wb") as out, open(folder / "told", "wb") as err:
        process = subprocess.Popen([program, *words], cwd=folder / "work", env=environment, stdin=subprocess.DEVNULL, stdout=out, stderr=err, preexec_fn=limit)
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
    if b"mistake of the program" in err:
        problems.append("mistake of the program")
    if code == 1 and sum(not line.startswith(b"limber: warning:") for line in err.splitlines()) != 1:
        problems.append("error that is no single line")
    if re.search(rb"[\x00-\x08\x0b-\x1f\x7f]|\xc2[\x80-\x9f]", out + err):
        problems.append("control character printed")
    named = str(folder / "work" / "out") + os.sep
    # The folders in which the program notes what it has not finished; no note may stay.
    notes = [str(folder / "home" / part) for part in (".local", ".local/state", ".local/state/limber", ".local/state/limber/unfinished")]
    for path in sorted(set(before) | set(after)):
        if after.get(path) == "folder" and path in notes:
            continue
        if before.get(path) != after.get(path) and not path.startswith(named):
            problems.append("file made, changed or deleted: " + os.path.relpath(path, folder))
    if code == 1 and any(path.startswith(named) and after[path] != "folder" for path in after):
        problems.append("output left behind after an error")
    return problems


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", required=True)
    parser.add_argument("--count", type=int, default=60)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--malformed", type=pathlib.Path)
    parser.add_argument("--keep", type=pathlib.Path)
    options = parser.parse_args()
    program = os.path.abspath(options.program)
    malformed = sorted(path for path in options.malformed.rglob("*") if path.is_file()) if options.malformed else []
    counts, worst = collections.Counter(), 0
    with tempfile.TemporaryDirectory(prefix="limber-hostile-") as top:
        (pathlib.Path(top) / "samples").mkdir()
        samples = Samples(program, pathlib.Path(top) / "samples")
        for number in range(options.count):
            chance = random.Random(options.seed * 1_000_003 + number)
            folder = pathlib.Path(top) / "run"
            shutil.rmtree(folder, ignore_errors=True)
            for name in ["home", "tmp"]:
                (folder / name).mkdir(parents=True)
            shutil.copytree(samples.folder, folder / "work")
            (folder / "work" / "out").mkdir()
            if malformed and number % 5 == 0:
                source = chance.choice(malformed)
                name = source.name
                shutil.copyfile(source, folder / "work" / name)
                words = ["info", name]
            else:
                name, words = samples.cases[number % len(samples.cases)] if number < len(samples.cases) else chance.choice(samples.cases)
                path = folder / "work" / name
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
