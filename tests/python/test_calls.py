# SPDX-License-Identifier: AGPL-3.0-or-later
"""Tests calls of the Python module: progress, cancelling, threads, previews and memory."""
import os
import signal
import subprocess
import sys
import threading
import time
import unittest

import limber
import numpy as np
from support import InFolder, arm

INTERRUPTED = """
import os, signal, sys, threading, time
import limber
volume, rig, _ = limber.make_phantom("body", spacing=3)
body = limber.Body(volume, rig)
def interrupt():
    global sent
    time.sleep(1.0)
    sent = time.perf_counter()
    os.kill(os.getpid(), signal.SIGINT)
threading.Thread(target=interrupt, daemon=True).start()
try:
    while True: body.weights()
except KeyboardInterrupt:
    print(time.perf_counter() - sent)
"""


def resident_bytes():
    with open("/proc/self/statm", encoding="ascii") as file:
        return int(file.read().split()[1]) * os.sysconf("SC_PAGESIZE")


class Calls(InFolder):
    def test_progress_is_a_function(self):
        volume, rig = arm(2)
        seen = []
        limber.Body(volume, rig).weights(progress=lambda stage, fraction: seen.append((stage, fraction)))
        self.assertTrue(seen)
        self.assertTrue(all(isinstance(stage, str) and 0 <= fraction <= 1 for stage, fraction in seen))

    def test_progress_is_a_tqdm_bar(self):
        class Bar:  # the parts of a tqdm bar that are used
            total = None
            n = 0
            shown = 0

            def set_description_str(self, text, refresh):
                self.text = text

            def refresh(self):
                self.shown += 1

        volume, rig = arm(2)
        bar = Bar()
        limber.Body(volume, rig).weights(progress=bar)
        self.assertGreater(bar.shown, 0)
        self.assertEqual(bar.total, 1)

    def test_an_exception_of_a_callback_ends_the_work(self):
        def stop(stage, fraction):
            raise LookupError("enough")

        volume, rig = arm(2)
        with self.assertRaisesRegex(LookupError, "enough"):
            limber.Body(volume, rig).weights(progress=stop)

    def test_ctrl_c_ends_the_work(self):
        run = subprocess.run([sys.executable, "-c", INTERRUPTED], capture_output=True, text=True, timeout=120, check=False)
        self.assertEqual(run.returncode, 0, run.stderr)
        seconds = float(run.stdout)
        self.assertLess(seconds, 3)  # 0.1 s on an idle machine
        print(f"Ctrl-C took {seconds:.2f} s", file=sys.stderr)

    def test_other_threads_run_meanwhile(self):
        volume, rig = arm(2)
        body = limber.Body(volume, rig)
        worker = threading.Thread(target=body.weights)
        worker.start()
        turns = 0
        while worker.is_alive():
            turns += 1
            time.sleep(0.001)
        self.assertGreater(turns, 10)

    def test_threads_share_a_body(self):
        volume, rig = arm(6)
        weights = limber.Body(volume, rig).weights()
        alone = [weights.resample(rig.pose(flex={"Forearm": d})).labels for d in (20, 40, 60, 80)]
        together = [None] * 4

        def pose(i):
            together[i] = weights.resample(rig.pose(flex={"Forearm": 20 * (i + 1)})).labels

        threads = [threading.Thread(target=pose, args=(i,)) for i in range(4)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        for one, other in zip(alone, together):
            self.assertTrue((one == other).all())


class Previews(InFolder):
    def test_a_preview_is_near_the_resampled_body(self):
        volume, rig = arm(4)
        weights = limber.Body(volume, rig).weights()
        pose = rig.pose(flex={"Forearm": 60})
        posed = weights.resample(pose, "dqs", glide="off")
        grid = posed.volume
        indices = np.argwhere(posed.labels > 0)[::17]
        places = (indices * grid.spacing) @ grid.direction.T + grid.origin
        labels = limber.Preview(weights).pose(pose, "dqs").labels(places)
        self.assertGreater((labels == posed.labels[tuple(indices.T)]).mean(), 0.85)

    def test_points_come_back_to_rest(self):
        volume, rig = arm(4)
        weights = limber.Body(volume, rig).weights()
        pose = rig.pose(flex={"Forearm": 45})
        voxels = weights.voxels[::101]
        rest = (voxels * volume.spacing) @ volume.direction.T + volume.origin
        posed = weights.move_points(rest, pose, "dqs")
        back = limber.Preview(weights).pose(pose, "dqs").rest_points(posed)
        known = np.isfinite(back).all(axis=1)
        self.assertGreater(known.mean(), 0.95)
        self.assertLess(np.median(np.linalg.norm(back[known] - rest[known], axis=1)), 4)
        far = limber.Preview(weights).pose(pose).rest_points([[9000, 0, 0]])
        self.assertTrue(np.isnan(far).all())

    def test_threads_share_a_preview(self):
        volume, rig = arm(6)
        weights = limber.Body(volume, rig).weights()
        preview = limber.Preview(weights)
        points = (weights.voxels[::29] * volume.spacing) @ volume.direction.T + volume.origin
        alone = [limber.Preview(weights).pose(rig.pose(flex={"Forearm": 20 * i})).labels(points) for i in range(4)]
        wrong = []

        def turn(i):
            for _ in range(25):
                if (preview.pose(rig.pose(flex={"Forearm": 20 * i})).labels(points) != alone[i]).any():
                    wrong.append(i)

        threads = [threading.Thread(target=turn, args=(i,)) for i in range(4)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        self.assertEqual(wrong, [])

    def test_many_poses_leave_no_memory_behind(self):
        count = int(os.environ.get("LIMBER_PREVIEW_POSES", 400))
        volume, rig = arm(4)
        preview = limber.Preview(limber.Body(volume, rig).weights())
        points = np.zeros((100, 3))
        for turn in range(count):
            preview.pose(rig.pose(flex={"Forearm": turn % 90})).labels(points)
            if turn == count // 4:
                early = resident_bytes()
        self.assertLess(resident_bytes() - early, 8e6)


if __name__ == "__main__":
    unittest.main()
