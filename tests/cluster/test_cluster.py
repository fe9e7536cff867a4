# SPDX-License-Identifier: AGPL-3.0-or-later
"""Runs batches by Slurm, Snakemake and GNU parallel, and kills them again and again. The result must be that of one
process, and no finished cell may be computed again.

LIMBER_PROGRAM names the command line's program. LIMBER_CLUSTER_CELLS and LIMBER_CLUSTER_KILLS make the runs longer.
What is not installed is skipped: apt-get install --no-install-recommends slurm-wlm snakemake parallel
"""
import hashlib
import json
import os
import random
import shutil
import signal
import socket
import subprocess
import tempfile
import time
import unittest
from pathlib import Path

PROGRAM = os.environ.get("LIMBER_PROGRAM", "limber")
SCRIPTS = Path(__file__).resolve().parents[2] / "assets/cluster"
CELLS = int(os.environ.get("LIMBER_CLUSTER_CELLS", 24))
KILLS = int(os.environ.get("LIMBER_CLUSTER_KILLS", 3))
PATIENCE = 900  # seconds until a run counts as hanging


def skip_without(*programs):
    for program in programs:
        if not shutil.which(program, path=os.environ["PATH"] + ":/usr/sbin"):
            print(f"SKIPPED: {program} is not installed", flush=True)
            raise unittest.SkipTest(f"{program} is not installed")


def limber(*words):
    return subprocess.run([PROGRAM, *map(str, words)], check=True, capture_output=True, text=True).stdout


def write_batch(folder):
    """Writes a batch of two bodies, CELLS / 4 frames and two methods, with an export."""
    limber("phantom", "arm", "--spacing", 4, "-o", folder / "arm")
    frames = CELLS // 4
    batch = {"bodies": [{"name": "arm 5 mm", "phantom": "arm", "spacing_mm": 5},
                        {"name": "arm 4 mm", "volume": "arm/volume.nrrd", "rig": "arm/rig.json",
                         "tissues": "arm/tissues.json"}],
             "poses": [{"name": "bend", "motion": "arm/motion.bvh", "frames": f"0:{frames - 1}"}],
             "methods": ["dqs", "lbs"], "exports": [".vti"]}
    (folder / "batch.json").write_text(json.dumps(batch))
    return folder / "batch.json"


def contents(out):
    """Returns the hash of each file of a result that does not contain times."""
    files = {}
    for path in sorted(out.rglob("*")):
        if path.is_file() and path.name not in ("report.json", "cell.json", "body.json", "times.csv"):
            if ".snakemake" not in path.parts and "finished" not in path.parts:
                files[str(path.relative_to(out))] = hashlib.sha256(path.read_bytes()).hexdigest()
    return files


def finished(out):
    """Returns the finished cells and exports, each with its identity on the disk."""
    return {path.parent: (path.stat().st_ino, path.stat().st_mtime_ns)
            for kind in ("cells", "exports") for path in out.glob(f"{kind}/[!.]*/cell.json")}


def running(folder):
    """Returns the ids of the processes that run the batch of a folder, and of no other test."""
    found = []
    for entry in Path("/proc").iterdir():
        if entry.name.isdigit():
            try:
                words = (entry / "cmdline").read_bytes().split(b"\0")
            except OSError:
                continue
            is_batch = len(words) > 2 and words[0].endswith(b"limber") and words[1] == b"batch"
            if is_batch and words[2] == os.fsencode(folder / "batch.json"):
                found.append(int(entry.name))
    return found


def kill(process):
    try:
        os.kill(process, signal.SIGKILL)
    except ProcessLookupError:
        pass  # the process had ended by itself


def free_port():
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return probe.getsockname()[1]


class Slurm:
    """A cluster of one node on this machine."""

    def __init__(self, folder):
        self.folder, self.host, self.processes = folder, socket.gethostname().split(".")[0], {}
        (folder / "key").write_bytes(os.urandom(1024))
        (folder / "key").chmod(0o400)
        folder.chmod(0o755)
        for name in ("state", "spool"):
            (folder / name).mkdir()
        me = subprocess.run(["id", "-un"], check=True, capture_output=True, text=True).stdout.strip()
        (folder / "slurm.conf").write_text(f"""
ClusterName=test
SlurmctldHost={self.host}(127.0.0.1)
SlurmctldPort={free_port()}
SlurmdPort={free_port()}
SlurmUser={me}
SlurmdUser={me}
AuthType=auth/munge
AuthInfo=socket={folder}/munge.socket,cred_expire=5
StateSaveLocation={folder}/state
SlurmdSpoolDir={folder}/spool
SlurmctldPidFile={folder}/slurmctld.pid
SlurmdPidFile={folder}/slurmd.pid
SlurmctldLogFile={folder}/slurmctld.log
SlurmdLogFile={folder}/slurmd.log
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
MpiDefault=none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
ReturnToService=2
KillWait=1
SlurmdTimeout=5
BatchStartTimeout=5
MailProg=/bin/true
SchedulerParameters=sched_interval=1,batch_sched_delay=0,bf_interval=1
NodeName={self.host} NodeAddr=127.0.0.1 CPUs=2 State=UNKNOWN
PartitionName=all Nodes={self.host} Default=YES MaxTime=INFINITE State=UP
""")
        self.environment = os.environ | {"SLURM_CONF": str(folder / "slurm.conf"), "LIMBER": PROGRAM,
                                         "PATH": os.environ["PATH"] + ":/usr/sbin"}
        self.start("munged", "--foreground", "--force", f"--socket={folder}/munge.socket", f"--key-file={folder}/key",
                   f"--pid-file={folder}/munge.pid", f"--seed-file={folder}/seed", f"--log-file={folder}/munge.log")
        self.start("slurmctld", "-D", "-c")
        self.start_node()
        self.wait_until(lambda: "idle" in self.ask("sinfo", "-h", "-o", "%T"), "the cluster is up")

    def start(self, program, *words):
        with open(self.folder / f"{program}.out", "ab") as log:
            self.processes[program] = subprocess.Popen([program, *words], env=self.environment, stdout=log, stderr=log)

    def start_node(self):
        self.start("slurmd", "-D", "-N", self.host)

    def end_node(self):
        """Kills the node's daemon and all that it runs, as a power failure does, and waits until the cluster has
        noticed."""
        self.processes["slurmd"].kill()
        self.processes["slurmd"].wait()
        subprocess.run(["pkill", "-KILL", "slurmstepd"], check=False)
        for process in running(self.folder.parent):
            kill(process)
        self.wait_until(lambda: "down" in self.ask("sinfo", "-h", "-o", "%T"), "the node counts as down")

    def ask(self, *words):
        return subprocess.run(words, env=self.environment, capture_output=True, text=True, check=False).stdout

    def submit(self, *words):
        run = subprocess.run(["sbatch", "--parsable", "--mem=0", "--cpus-per-task=1", "-o", self.folder / "job-%j.out",
                              *words], env=self.environment, capture_output=True, text=True, check=False, cwd=self.folder)
        if run.returncode:
            raise AssertionError(run.stderr)
        return run.stdout.strip()

    def wait_until(self, is_so, what):
        end = time.monotonic() + PATIENCE
        while not is_so():
            if time.monotonic() > end:
                raise AssertionError(f"waited in vain until {what}: {self.log()}")
            time.sleep(0.05)

    def log(self):
        return "\n".join((self.folder / name).read_text(errors="replace")[-2000:]
                         for name in ("slurmctld.log", "slurmd.log", "munged.out") if (self.folder / name).exists())

    def stop(self):
        self.ask("scancel", "--user", str(os.getuid()))
        for name in ("slurmd", "slurmctld", "munged"):
            self.processes[name].terminate()
        for name in ("slurmd", "slurmctld", "munged"):
            try:
                self.processes[name].wait(20)
            except subprocess.TimeoutExpired:
                self.processes[name].kill()


class Cluster(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.scratch = tempfile.TemporaryDirectory(prefix="limber-cluster-")
        cls.folder = Path(cls.scratch.name)
        cls.batch = write_batch(cls.folder)
        limber("batch", cls.batch, "-o", cls.folder / "one")
        cls.expected = contents(cls.folder / "one")
        cls.random = random.Random(7)

    @classmethod
    def tearDownClass(cls):
        cls.scratch.cleanup()

    def check(self, out, seen, logs):
        """Checks a finished run. `seen` has the cells and exports that were finished at the time of each kill."""
        self.assertEqual(len(finished(out)), 2 * CELLS)
        self.assertEqual(contents(out), self.expected)
        at_end = finished(out)
        for moment in seen:
            for cell, identity in moment.items():
                self.assertEqual(at_end[cell], identity, f"{cell} was computed again")
        done = [line.split("  ", 1)[1] for log in logs for line in log.splitlines() if line.endswith(": done")]
        self.assertEqual(len(done), len(set(done)), "a cell was computed twice")

    def wait_for_progress(self, out, wait):
        """Waits until another one or two cells are finished, so that a kill meets a run that has work to lose."""
        goal = len(finished(out)) + self.random.randint(1, 3)
        wait(lambda: len(finished(out)) >= min(goal, 2 * CELLS) or (out / "cells.csv").exists())
        time.sleep(self.random.uniform(0, 0.3))

    def test_slurm(self):
        skip_without("sbatch", "slurmctld", "slurmd", "munged")
        (self.folder / "slurm").mkdir()
        slurm = Slurm(self.folder / "slurm")
        self.addCleanup(slurm.stop)
        out, script = self.folder / "out-slurm", SCRIPTS / "limber.sbatch"
        job = ""

        def submit():
            nonlocal job
            job = slurm.submit("--array=1-4", script, "batch", self.batch, out)

        def wait(is_so):
            slurm.wait_until(lambda: is_so() or not slurm.ask("squeue", "-h"), "another cell is finished")

        submit()
        seen, ways = [], ["process", "scancel"]
        for number in range(KILLS):
            self.wait_for_progress(out, wait)
            seen.append(finished(out))
            way = "node" if number == KILLS // 2 else ways[number % 2]
            if way == "node":
                slurm.end_node()
                slurm.start_node()
            elif way == "process" and running(self.folder):
                kill(self.random.choice(running(self.folder)))
            else:
                slurm.ask("scancel", job)
            if not slurm.ask("squeue", "-h"):
                submit()
        collector = slurm.submit(f"--dependency=afterany:{job}", script, "batch", self.batch, out)
        slurm.wait_until(lambda: (out / "cells.csv").exists() and not slurm.ask("squeue", "-h", "-j", collector),
                         "the tables are written")
        self.check(out, seen, [path.read_text() for path in slurm.folder.glob("job-*.out")])

    def snakemake(self, *settings):
        words = ["snakemake", "-s", SCRIPTS / "Snakefile", "--cores", "2", "--rerun-incomplete", "--nolock"]
        log = open(self.folder / "snakemake.log", "ab")
        self.addCleanup(log.close)
        return subprocess.Popen([*words, "--config", f"limber={PROGRAM}", *settings], cwd=self.folder, stdout=log,
                                stderr=log, start_new_session=True)

    def test_snakemake(self):
        skip_without("snakemake")
        out = self.folder / "out-snakemake"
        settings = f"batch={self.batch}", f"out={out}"
        seen, run = [], self.snakemake(*settings)
        for _ in range(KILLS):
            end = time.monotonic() + PATIENCE

            def wait(is_so):
                while not is_so() and run.poll() is None and time.monotonic() < end:
                    time.sleep(0.05)

            self.wait_for_progress(out, wait)
            seen.append(finished(out))
            os.killpg(run.pid, signal.SIGKILL)
            run.wait()
            for process in running(self.folder):
                kill(process)
            run = self.snakemake(*settings)
        self.assertEqual(run.wait(PATIENCE), 0, (self.folder / "snakemake.log").read_text()[-2000:])
        self.check(out, seen, [(self.folder / "snakemake.log").read_text()])

    def test_snakemake_study(self):
        skip_without("snakemake")
        study = {"phantom": "arm", "spacings_mm": [6], "methods": ["dqs", "lbs"],
                 "poses": [{"name": "bend", "motion": "arm/motion.bvh", "frames": "0:10:5"}]}
        (self.folder / "study.json").write_text(json.dumps(study))
        run = self.snakemake(f"study={self.folder / 'study.json'}", "shards=2", f"out={self.folder / 'study'}")
        self.assertEqual(run.wait(PATIENCE), 0, (self.folder / "snakemake.log").read_text()[-2000:])
        self.assertEqual(len(list(self.folder.glob("study/cells/*/cell.json"))), 6)
        self.assertTrue((self.folder / "study/report.html").exists())

    def test_parallel(self):
        skip_without("parallel")
        out = self.folder / "out parallel"
        subprocess.run([SCRIPTS / "parallel.sh", self.batch, out, "--jobs", "2"], check=True, capture_output=True,
                       env=os.environ | {"LIMBER": PROGRAM}, cwd=self.folder)
        self.check(out, [], [])

    def test_many_processes(self):
        """Processes without --shard compute the cells that no other process computes, also when some processes are
        killed."""
        out, log = self.folder / "out-processes", open(self.folder / "processes.log", "ab")
        self.addCleanup(log.close)

        def start():
            return subprocess.Popen([PROGRAM, "batch", self.batch, "-o", out, "--threads", "1"], stdout=log, stderr=log)

        runs, seen = [start() for _ in range(3)], []
        for _ in range(KILLS):
            self.wait_for_progress(out, lambda is_so: [time.sleep(0.02) for _ in range(5000) if not is_so()])
            seen.append(finished(out))
            victim = self.random.randrange(3)
            runs[victim].kill()
            runs[victim].wait()
            runs[victim] = start()
        for run in runs:
            self.assertEqual(run.wait(PATIENCE), 0)
        self.check(out, seen, [(self.folder / "processes.log").read_text()])


if __name__ == "__main__":
    unittest.main()
