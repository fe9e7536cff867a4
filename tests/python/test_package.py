# SPDX-License-Identifier: AGPL-3.0-or-later
"""Tests the Python package as a whole: type stubs, docstrings and examples."""
import ast
import contextlib
import inspect
import io
import runpy
import subprocess
import sys
import unittest
from pathlib import Path

import limber
from support import InFolder, run_limber

EXAMPLES = Path(__file__).resolve().parents[2] / "assets" / "examples" / "python"


def public(names):
    return {name for name in names if not name.startswith("_")}


class Package(unittest.TestCase):
    def test_stubs_name_what_is_there(self):
        tree = ast.parse(Path(limber.__file__).with_name("__init__.pyi").read_text(encoding="utf-8"))
        stubs = {}
        for node in tree.body:
            if isinstance(node, ast.ClassDef):
                stubs[node.name] = public(part.name for part in node.body if isinstance(part, ast.FunctionDef))
            elif isinstance(node, ast.FunctionDef):
                stubs[node.name] = set()
            elif isinstance(node, ast.AnnAssign):
                stubs[node.target.id] = set()
        stubs.pop("__version__")
        there = {}
        for name in public(vars(limber._limber)):
            value = getattr(limber, name)
            inherited = set(dir(RuntimeError)) | set(dir(UserWarning))
            there[name] = public(vars(value)) - inherited if inspect.isclass(value) else set()
        self.assertEqual(stubs, there)

    def test_everything_says_what_it_does(self):
        for name in public(vars(limber._limber)):
            value = getattr(limber, name)
            if callable(value) and not (inspect.isclass(value) and issubclass(value, Exception)):
                self.assertTrue(inspect.getdoc(value), name)

    def test_the_version_is_the_programs(self):
        self.assertIn(limber.__version__, run_limber("--version"))


class Examples(InFolder):
    def run_example(self, name, *words):
        lines = (EXAMPLES / name).read_text(encoding="utf-8").splitlines()
        self.assertLessEqual(len(lines), 20, name)
        said = io.StringIO()
        arguments, sys.argv = sys.argv, [name, *map(str, words)]
        try:
            with contextlib.redirect_stdout(said):
                runpy.run_path(str(EXAMPLES / name), run_name="__main__")
        finally:
            sys.argv = arguments
        return said.getvalue()

    def test_first_pose(self):
        self.assertIn("%", self.run_example("first_pose.py"))
        self.assertTrue((self.folder / "bent.nrrd").exists())

    def test_study(self):
        self.run_example("study.py")
        self.assertEqual(len((self.folder / "study.csv").read_text(encoding="utf-8").splitlines()), 10)

    def test_totalsegmentator(self):
        volume, _, _ = limber.make_phantom("body", spacing=6)
        volume.save("body.nii.gz")
        volume.tissues.save("names.json")
        self.assertIn("bones", self.run_example("totalsegmentator.py", "body.nii.gz", "names.json"))
        seated = limber.read_volume("seated.nii.gz")
        self.assertNotEqual(seated.shape, volume.shape)

    def test_live_pose(self):
        self.assertIn("poses a second", self.run_example("live_pose.py"))

    def test_nibabel_in_out(self):
        try:
            import nibabel
        except ImportError:
            self.skipTest("nibabel is not installed")
        volume, rig, _ = limber.make_phantom("arm", spacing=4)
        volume.save("arm.nii.gz")
        volume.tissues.save("names.json")
        rig.save("rig.json")
        self.run_example("nibabel_in_out.py", "arm.nii.gz", "names.json", "rig.json")
        before, after = nibabel.load("arm.nii.gz"), nibabel.load("posed.nii.gz")
        self.assertEqual(before.header.get_zooms(), after.header.get_zooms())
        self.assertTrue((before.affine[:3, :3] == after.affine[:3, :3]).all())

    def test_motion_frames(self):
        self.assertIn("frame 10", self.run_example("motion_frames.py"))

    def test_own_weights(self):
        self.assertIn("rigid", self.run_example("own_weights.py"))

    def test_finite_elements(self):
        self.assertIn("reached 100%", self.run_example("finite_elements.py"))

    def test_ct_follows(self):
        self.assertIn("HU", self.run_example("ct_follows.py"))

    def test_landmarks(self):
        self.assertIn("90 degrees", self.run_example("landmarks.py"))

    def test_every_example_is_run_here(self):
        tested = {name[5:] + ".py" for name in dir(self) if name.startswith("test_")}
        self.assertEqual({path.name for path in EXAMPLES.glob("*.py")} - tested, set())


if __name__ == "__main__":
    unittest.main()
