# SPDX-License-Identifier: AGPL-3.0-or-later
"""Functions shared by the tests of the Python module. The environment variable LIMBER_PROGRAM names the command line's
program."""
import os
import subprocess
import tempfile
import unittest
import warnings
from pathlib import Path

import limber

PROGRAM = os.environ.get("LIMBER_PROGRAM", "limber")
SHARED = Path(os.environ.get("LIMBER_SHARED", Path(__file__).resolve().parents[2] / ".." / "shared"))
warnings.simplefilter("ignore", limber.LimberWarning)


def run_limber(*words):
    """Runs the command line, which must succeed (0) or report that a quality gate failed (5)."""
    run = subprocess.run([PROGRAM, *map(str, words)], capture_output=True, text=True, check=False)
    if run.returncode not in (0, 5):
        raise AssertionError(f"limber {' '.join(map(str, words))}: {run.stderr}")
    return run.stdout


class InFolder(unittest.TestCase):
    """A test case whose working folder is a new temporary folder."""

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.addCleanup(os.chdir, os.getcwd())
        os.chdir(folder.name)
        self.folder = Path(folder.name)


def arm(spacing=4):
    """Returns the volume and the rig of the procedural arm."""
    volume, rig, _ = limber.make_phantom("arm", spacing=spacing)
    return volume, rig
