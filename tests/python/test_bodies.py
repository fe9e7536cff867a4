# SPDX-License-Identifier: AGPL-3.0-or-later
import json
import unittest

import limber
import numpy as np
from support import InFolder, arm, run_limber


def without_times(report):
    """Returns a report without values that differ from run to run or that only the command line writes."""
    kept = dict(report)
    for key in ("seconds", "inputs", "peak_memory_mb", "memory_mb"):
        kept.pop(key, None)
    kept["settings"] = {key: value for key, value in kept["settings"].items() if key not in ("flex", "threads")}
    return kept


class AsTheCommandLine(InFolder):
    def setUp(self):
        super().setUp()
        run_limber("phantom", "arm", "--spacing", 4, "-o", "arm")
        tissues = limber.read_tissues("arm/tissues.json")
        self.rig = limber.read_rig("arm/rig.json")
        self.body = limber.Body(limber.read_volume("arm/volume.nrrd"), self.rig, tissues=tissues)
        self.files = ("arm/volume.nrrd", "--rig", "arm/rig.json", "--tissues", "arm/tissues.json")

    def same_bytes(self, one, other):
        self.assertEqual((self.folder / one).read_bytes(), (self.folder / other).read_bytes(), one)

    def test_weights_are_the_same_bytes(self):
        for method in ("heat", "geodesic", "rigid"):
            run_limber("weights", *self.files, "--method", method, "-o", "command.nrrd")
            self.body.weights(method).save("python.nrrd")
            self.same_bytes("python.nrrd", "command.nrrd")

    def test_posed_bodies_and_reports_are_the_same(self):
        weights = self.body.weights()
        for method in ("lbs", "dqs", "mix"):
            run_limber("resample", *self.files, "--flex", "Forearm=75", "--method", method, "-o", "command.nrrd",
                       "--report", "command.json")
            posed = weights.resample(self.rig.pose(flex={"Forearm": 75}), method, report=True)
            posed.save("python.nrrd")
            self.same_bytes("python.nrrd", "command.nrrd")
            with open("command.json", encoding="utf-8") as file:
                self.assertEqual(without_times(posed.report), without_times(json.load(file)))

    def test_clinical_angles_are_those_asked_for_and_pose_again(self):
        pose = self.rig.pose(joints={"elbow flexion": 75, "forearm pronation": 40, "index knuckle flexion": 30})
        angles = self.rig.angles(pose)
        out = run_limber("fk", "arm/rig.json", "--joint", "elbow flexion=75", "--joint", "forearm pronation=40",
                         "--joint", "index knuckle flexion=30", "--angles", "--json")
        told = {f"{joint} {motion}": degrees for joint, motions in json.loads(out)["angles"].items()
                for motion, degrees in motions.items()}
        self.assertEqual(angles, told)
        elbow = next(degrees for name, degrees in angles.items() if name.endswith("elbow flexion"))
        self.assertAlmostEqual(elbow, 75, places=6)
        again = self.rig.pose(joints=angles)
        self.assertLess(np.abs(self.rig.transforms(again) - self.rig.transforms(pose)).max(), 1e-6)

    def test_finite_elements_are_the_same(self):
        run_limber("resample", *self.files, "--flex", "Forearm=30", "--method", "fem", "--quality", "draft", "-o",
                   "command.nrrd")
        posed = self.body.weights().resample(self.rig.pose(flex={"Forearm": 30}), "fem", quality="draft")
        posed.save("python.nrrd")
        self.same_bytes("python.nrrd", "command.nrrd")
        self.assertEqual(posed.reached, 1)

    def test_weights_from_a_file_and_fields_are_the_same(self):
        run_limber("weights", *self.files, "-o", "w.nrrd")
        run_limber("resample", *self.files, "--weights", "w.nrrd", "--flex", "Forearm=60", "-o", "command.nrrd",
                   "--field", "field.nrrd", "--glide", "off")
        posed = self.body.read_weights("w.nrrd").resample(self.rig.pose(flex={"Forearm": 60}), glide="off",
                                                          displacement=True, jacobian=True, overlap=True)
        posed.save("python.nrrd")
        self.same_bytes("python.nrrd", "command.nrrd")
        header, _, raw = (self.folder / "field.nrrd").read_bytes().partition(b"\n\n")
        if b"encoding: raw" in header:
            field = np.frombuffer(raw, "<f4").reshape(posed.displacement.shape[::-1]).T
            np.testing.assert_array_equal(np.moveaxis(posed.displacement, 3, 0), field)
        self.assertEqual(posed.jacobian.shape, posed.labels.shape)
        self.assertEqual(posed.overlap.dtype, np.uint16)

    def test_a_motion_is_the_same(self):
        run_limber("resample", *self.files, "--motion", "arm/motion.bvh", "--frames", "0:20:10", "--method", "dqs", "-o",
                   "command_{frame}.nrrd")
        rigged = limber.read_motion("arm/motion.bvh").retarget(self.rig)
        frames = [0, 10, 20]
        for frame, posed in zip(frames, self.body.weights().resample([rigged[f] for f in frames], "dqs", glide="voxel")):
            posed.save("python.nrrd")
            self.same_bytes("python.nrrd", f"command_{frame:04}.nrrd")

    def test_the_number_of_threads_changes_nothing(self):
        pose = self.rig.pose(flex={"Forearm": 60})
        many = self.body.weights().resample(pose).labels
        limber.set_thread_count(1)
        self.addCleanup(limber.set_thread_count, 0)
        self.assertTrue((self.body.weights().resample(pose).labels == many).all())


class Bodies(InFolder):
    def test_the_rest_pose_gives_back_the_body(self):
        volume, rig = arm()
        posed = limber.Body(volume, rig).weights().resample(rig.rest_pose())
        self.assertTrue((posed.labels == volume.labels).all())
        self.assertIsNone(posed.report)
        self.assertIsNone(posed.displacement)

    def test_influences_come_and_go(self):
        volume, rig = arm(6)
        weights = limber.Body(volume, rig).weights()
        bones, parts = weights.influences()
        self.assertEqual(bones.shape, (len(weights), 4))
        self.assertTrue((parts.sum(axis=1, dtype=int) == 65535).all())
        self.assertEqual(np.count_nonzero(volume.labels), len(weights))
        self.assertTrue((volume.labels[tuple(weights.voxels.T)] > 0).all())
        again_bones, again_parts = weights.with_influences(bones, parts).influences()
        self.assertTrue((again_parts == parts).all())
        self.assertTrue((again_bones[parts > 0] == bones[parts > 0]).all())
        forearm = weights.volume_of("Forearm")
        mine = np.where(bones == weights.bones.index("Forearm"), parts, 0).sum(axis=1) / 65535
        np.testing.assert_allclose(forearm[tuple(weights.voxels.T)], mine, atol=1e-6)

    def test_bad_influences_are_refused(self):
        volume, rig = arm(6)
        weights = limber.Body(volume, rig).weights("rigid")
        bones, parts = weights.influences()
        for other_bones, other_parts in (
            (bones[:-1], parts[:-1]),
            (bones + 1000, parts),
            (bones, -parts.astype(float)),
            (bones, parts * 0),
            (bones, parts * np.nan),
        ):
            with self.assertRaises(ValueError):
                weights.with_influences(other_bones, other_parts)

    def test_grey_values_move_with_the_labels(self):
        volume, rig = arm(6)
        weights = limber.Body(volume, rig).weights()
        grey = np.where(volume.labels > 0, 100.0 + volume.labels, -1000.0)
        posed = weights.resample(rig.pose(flex={"Forearm": 60}), grey=grey)
        self.assertEqual(posed.grey.shape, posed.labels.shape)
        self.assertGreater(np.median(posed.grey[posed.labels > 0]), 100)
        with self.assertRaises(ValueError):
            weights.resample(rig.rest_pose(), grey=grey[1:])

    def test_bad_requests_are_refused_in_one_sentence(self):
        volume, rig = arm(6)
        weights = limber.Body(volume, rig).weights("rigid")
        other = limber.Rig(["A"], [None], [[0, 0, 0]], [[0, 0, 1]])
        for request, word in (
            (lambda: weights.resample(rig.rest_pose(), "magic"), "magic"),
            (lambda: weights.resample(rig.rest_pose(), "dqs", contact=True), "fem"),
            (lambda: weights.resample(rig.rest_pose(), "fem", quality="best"), "best"),
            (lambda: weights.resample(rig.rest_pose(), glide="far"), "far"),
            (lambda: weights.resample(rig.rest_pose(), nearest=True, mass_exact=True), "mass"),
            (lambda: weights.resample(other.rest_pose()), "another rig"),
            (lambda: rig.pose(flex={"Tail": 3}), "Tail"),
            (lambda: rig.pose("fly"), "fly"),
            (lambda: rig.pose(joints={"left wing flexion": 3}), "wing"),
            (lambda: rig.pose(rotations={"Hand": ((0, 0, 0), 3)}), "axis"),
            (lambda: limber.Body(volume, rig, bones=[77]), "77"),
            (lambda: limber.Body(volume, rig).weights("magic"), "magic"),
            (lambda: limber.read_volume("nothing.nrrd"), "nothing.nrrd"),
            (lambda: limber.Rig(["A", "A"], [None, "A"], np.zeros((2, 3)), np.ones((2, 3))), "A"),
            (lambda: volume.save("a.xyz"), "a.xyz"),
            (lambda: limber.export(volume, "a.xyz"), "a.xyz"),
            (lambda: limber.make_phantom("leg"), "leg"),
        ):
            with self.assertRaises((limber.Error, ValueError)) as raised:
                request()
            self.assertIn(word, str(raised.exception))
            self.assertNotIn("\n", str(raised.exception))

    def test_warnings_are_pythons(self):
        volume, rig = arm(6)
        nameless = limber.Volume(volume.labels, affine=volume.affine)
        with self.assertWarns(limber.LimberWarning):
            limber.Body(nameless, rig)

    def test_what_changed_is_told(self):
        volume, rig = arm(6)
        posed = limber.Body(volume, rig).weights().resample(rig.pose(flex={"Forearm": 90}), "lbs")
        total = limber.compare(volume, posed.volume)["total"]
        self.assertEqual(total["voxels_before"], np.count_nonzero(volume.labels))
        self.assertEqual(total["voxels_after"], np.count_nonzero(posed.labels))

    def test_an_export_without_properties_of_a_tissue_is_refused(self):
        labels = np.zeros((6, 6, 6), np.uint16, order="F")
        labels[1:3], labels[3:5] = 1, 2
        tissues = limber.Tissues([limber.Tissue(1, "muscle"), limber.Tissue(2, "unobtainium")])
        volume = limber.Volume(labels, tissues=tissues)
        with self.assertRaisesRegex(limber.Error, "unobtainium"):
            limber.export(volume, "body.xml", frequency=900e6)
        self.assertFalse((self.folder / "body.xml").exists())
        with self.assertRaisesRegex(limber.Error, "frequency"):
            limber.export(volume, "body.xml")

    def test_fitted_joints_come_with_their_rig(self):
        volume, rig = arm()
        posed = limber.Body(volume, rig).weights().resample(rig.pose(flex={"Forearm": 90}), fit_joints=True)
        self.assertEqual(posed.rig.names, rig.names)
        self.assertEqual(len(posed.rig.transforms(posed.pose)), len(rig))
        plain = limber.Body(volume, rig).weights().resample(rig.pose(flex={"Forearm": 90}))
        self.assertEqual(plain.rig, rig)

    def test_exports_are_written(self):
        volume, _ = arm(6)
        limber.export(volume, "arm.vtu")
        self.assertGreater((self.folder / "arm.vtu").stat().st_size, 1000)


class Rigs(InFolder):
    def test_poses_transform_bones(self):
        _, rig = arm(6)
        np.testing.assert_array_equal(rig.transforms(rig.rest_pose()), np.tile(np.eye(4), (len(rig), 1, 1)))
        bent = rig.transforms(rig.pose(flex={"Forearm": 90}))
        upper, lower = rig.index("UpperArm"), rig.index("Forearm")
        np.testing.assert_allclose(bent[upper], np.eye(4), atol=1e-12)
        elbow = np.append(rig.heads[lower], 1)
        np.testing.assert_allclose(bent[lower] @ elbow, elbow, atol=1e-9)
        angle = np.degrees(np.arccos((np.trace(bent[lower][:3, :3]) - 1) / 2))
        self.assertAlmostEqual(angle, 90, places=6)

    def test_poses_and_rigs_come_back_from_files(self):
        _, rig = arm(6)
        pose = rig.pose(flex={"Forearm": 33}, rotations={"Hand": ((1, 0, 0), 10)}, root_translation=(1, 2, 3))
        rig.save_pose(pose, "pose.json")
        self.assertEqual(rig.read_pose("pose.json"), pose)
        self.assertEqual(limber.Pose(pose.rotations, pose.root_translation), pose)
        rig.save("rig.json")
        self.assertEqual(limber.read_rig("rig.json"), rig)

    def test_a_rig_is_laid_into_a_volume(self):
        volume, rig = arm(4)
        fitted, errors = limber.fit_rig(volume, "arm")
        self.assertEqual(set(fitted.names), set(errors))
        self.assertGreater(len(fitted), 3)


if __name__ == "__main__":
    unittest.main()
