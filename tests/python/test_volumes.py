# SPDX-License-Identifier: AGPL-3.0-or-later
import gc
import sys
import unittest

import limber
import numpy as np
from support import InFolder, arm, run_limber


class Arrays(InFolder):
    def test_an_array_handed_in_is_shared_not_copied(self):
        labels = np.zeros((30, 20, 10), np.uint16, order="F")
        labels[5:20, 5:15, 2:8] = 7
        before = sys.getrefcount(labels)
        volume = limber.Volume(labels, spacing=(1, 2, 3))
        self.assertEqual(volume.labels.__array_interface__["data"][0], labels.__array_interface__["data"][0])
        self.assertTrue(np.shares_memory(volume.labels, labels))
        self.assertEqual(volume.labels.strides, labels.strides)
        self.assertFalse(volume.labels.flags.writeable)
        self.assertGreater(sys.getrefcount(labels), before)
        del volume
        gc.collect()
        self.assertEqual(sys.getrefcount(labels), before)

    def test_a_body_shares_the_voxels_of_its_volume(self):
        volume, rig = arm(6)
        body = limber.Body(volume, rig)
        self.assertTrue(np.shares_memory(body.volume.labels, volume.labels))
        weights = body.weights("rigid")
        del body, volume
        gc.collect()
        self.assertGreater(np.count_nonzero(weights.body.volume.labels), 1000)

    def test_a_read_only_array_is_taken_and_stays_as_it_is(self):
        volume, rig = arm(6)
        labels = volume.labels.copy(order="F")
        labels.flags.writeable = False
        body = limber.Body(limber.Volume(labels, affine=volume.affine, tissues=volume.tissues), rig)
        body.weights().resample(rig.pose(flex={"Forearm": 60}))
        self.assertTrue((labels == volume.labels).all())

    def test_other_orders_and_types_hold_the_same_labels(self):
        volume, _ = arm(6)
        for dtype in (np.uint8, np.int16, np.int64, np.float32, ">u2"):
            for order in "CF":
                other = limber.Volume(volume.labels.astype(dtype, order=order), affine=volume.affine)
                self.assertTrue((other.labels == volume.labels).all(), (dtype, order))

    def test_values_beyond_16_bits_come_back_from_a_file(self):
        labels = np.zeros((4, 3, 2), np.int32)
        labels[0, 0, 0], labels[1, 1, 1], labels[3, 2, 1] = -5, 100000, 3
        volume = limber.Volume(labels)
        self.assertEqual(sorted(tissue.value for tissue in volume.tissues), [-5, 3, 100000])
        volume.save("big.nrrd")
        again = limber.read_volume("big.nrrd")
        self.assertEqual({t.value: int((again.labels == t.label).sum()) for t in again.tissues}, {-5: 1, 100000: 1, 3: 1})

    def test_bad_arrays_are_refused_in_a_sentence(self):
        for labels, options, word in (
            (np.zeros((3, 3), np.uint8), {}, "three axes"),
            (np.full((3, 3, 3), 0.5), {}, "not labels"),
            (np.zeros((3, 3, 3), complex), {}, "whole numbers"),
            (np.zeros((3, 3, 3), np.uint8), {"spacing": (1, 1, -1)}, "spacing"),
            (np.zeros((3, 3, 3), np.uint8), {"spacing": (1, 1)}, "three numbers"),
            (np.zeros((3, 3, 3), np.uint8), {"origin": (0, 0, np.nan)}, "finite"),
            (np.zeros((3, 3, 3), np.uint8), {"direction": np.zeros((3, 3))}, "direction"),
            (np.zeros((3, 3, 3), np.uint8), {"affine": np.eye(4), "spacing": (1, 1, 1)}, "affine"),
            (np.zeros((0, 3, 3), np.uint8), {}, ""),
        ):
            with self.assertRaises((limber.Error, ValueError, TypeError)) as raised:
                limber.Volume(labels, **options)
            self.assertIn(word, str(raised.exception))
            self.assertNotIn("\n", str(raised.exception))


class Grids(InFolder):
    def test_an_affine_is_that_of_the_file(self):
        labels = np.zeros((4, 5, 6), np.uint16, order="F")
        labels[1, 2, 3] = 1
        turn = np.array([[0.6, -0.8, 0], [0.8, 0.6, 0], [0, 0, 1]])
        affine = np.eye(4)
        affine[:3, :3] = turn * [1.5, 2, 2.5]
        affine[:3, 3] = 10, -20, 30
        volume = limber.Volume(labels, affine=affine)
        np.testing.assert_allclose(volume.affine, affine, atol=1e-12)
        np.testing.assert_allclose(volume.spacing, [1.5, 2, 2.5])
        np.testing.assert_allclose(volume.origin, [-10, 20, 30])
        volume.save("turned.nii.gz")
        again = limber.read_volume("turned.nii.gz")
        np.testing.assert_allclose(again.affine, affine, atol=1e-5)
        self.assertTrue((again.labels == labels).all())

    def test_nibabel_reads_what_is_written_and_gives_the_same_affine(self):
        try:
            import nibabel
        except ImportError:
            self.skipTest("nibabel is not installed")
        volume, _ = arm(6)
        volume.save("arm.nii.gz")
        image = nibabel.load("arm.nii.gz")
        np.testing.assert_allclose(image.affine, volume.affine, atol=1e-4)
        self.assertTrue((np.asarray(image.dataobj) == volume.labels).all())


class Tables(InFolder):
    def test_tissues_are_found_by_value_and_name(self):
        tissues = limber.Tissues([limber.Tissue(5, "left femur"), limber.Tissue(9, "lard", "fat")])
        self.assertTrue(tissues[5].is_bone)
        self.assertEqual(tissues["lard"].kind, "fat")
        with self.assertRaises(KeyError):
            tissues["liver"]
        with self.assertRaises(limber.Error):
            limber.Tissue(1, "x", "cheese")
        tissues.save("t.json")
        self.assertEqual([t.name for t in limber.read_tissues("t.json")], ["left femur", "lard"])

    def test_the_same_bytes_are_written_as_by_the_command_line(self):
        run_limber("phantom", "arm", "--spacing", 6, "-o", "arm")
        for name in ("a.mha", "a.nii", "a.vti", "a.nrrd"):
            run_limber("convert", "arm/volume.nrrd", "command_" + name)
            limber.read_volume("arm/volume.nrrd").save(name)
            self.assertEqual((self.folder / name).read_bytes(), (self.folder / ("command_" + name)).read_bytes(), name)


if __name__ == "__main__":
    unittest.main()
