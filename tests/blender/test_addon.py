# SPDX-License-Identifier: AGPL-3.0-or-later
"""Tests the add-on for Blender. Run by Python, this file starts Blender, which runs the same file again, and so the
tests.

Joints are compared with `limber fk` and vertices with `limber skin-points`; the numbers of the .glb file are read here
a second time, without Blender. LIMBER_PROGRAM names the command line's program.
"""
import json
import math
import os
import shutil
import subprocess
import sys
import tempfile
import unittest
import unittest.mock
from pathlib import Path

try:
    import bpy
except ImportError:
    bpy = None
if bpy:
    import numpy as np
    from mathutils import Matrix, Vector
    NUMPY_BOOL = vars(np).get("bool", "missing")  # numpy.bool before the add-on runs

PROGRAM = os.environ.get("LIMBER_PROGRAM", "limber")
ADD_ON = Path(__file__).resolve().parents[2] / "assets/blender/limber_blender.py"
CLOSE = 0.01  # mm
PASSED = 10  # exit code of Blender if the tests ran and passed; it is 0 also if Blender ran nothing


def limber(*words):
    run = subprocess.run([PROGRAM, *map(str, words)], capture_output=True, text=True, check=False)
    if run.returncode:
        raise AssertionError(f"limber {' '.join(map(str, words))}: {run.stderr}")
    return run.stdout


def write_body(folder, hand="Hand", parent_of_hand='"Forearm"'):
    """Writes the procedural arm and its motion as arm.glb, with another name or parent of the hand's bone."""
    limber("phantom", "arm", "--spacing", 5, "-o", folder, "--threads", 1)
    rig, motion = folder / "rig.json", folder / "motion.bvh"
    edited = rig.read_text().replace('"Hand","parent":"Forearm"', f'"Hand","parent":{parent_of_hand}')
    rig.write_text(edited.replace('"Hand"', f'"{hand}"'), encoding="utf-8")
    motion.write_text(motion.read_text().replace("JOINT Hand\n", f"JOINT {hand}\n"), encoding="utf-8")
    body = [folder / "volume.nrrd", "--rig", folder / "rig.json", "--tissues", folder / "tissues.json"]
    limber("weights", *body, "-o", folder / "weights.nrrd", "--threads", 1)
    limber("export-gltf", *body, "--weights", folder / "weights.nrrd", "--motion", folder / "motion.bvh", "-o",
           folder / "arm.glb")


def joints(*words, rig="rig.json"):
    """Returns {bone: (head in mm, world rotation from rest)} as Limber poses the arm."""
    posed = json.loads(limber("fk", Arm.folder / rig, "--json", *words))["joints"]
    return {joint["name"]: (np.array(joint["position"]), np.array(joint["rotation_wxyz"])) for joint in posed}


def matrix_of(head, rotation):
    """Returns the 4x4 matrix of a rotation (w, x, y, z) and a position, row by row."""
    w, x, y, z = rotation
    return [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y), head[0],
            2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x), head[1],
            2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y), head[2], 0, 0, 0, 1]


def read_glb(path):
    """Returns the bones' names, and of each vertex the position (LPS, mm), four bones and four weights."""
    data = path.read_bytes()
    length = int.from_bytes(data[12:16], "little")
    gltf, binary = json.loads(data[20:20 + length]), data[28 + length:]

    def array(index, kind, columns):
        accessor = gltf["accessors"][index]
        start = gltf["bufferViews"][accessor["bufferView"]]["byteOffset"] + accessor.get("byteOffset", 0)
        return np.frombuffer(binary, kind, accessor["count"] * columns, start).reshape(-1, columns)

    attributes = gltf["meshes"][0]["primitives"][0]["attributes"]
    x, y, z = array(attributes["POSITION"], "<f4", 3).astype(float).T * 1000
    names = [gltf["nodes"][joint]["name"] for joint in gltf["skins"][0]["joints"]]
    return (names, np.stack([x, -z, y], 1), array(attributes["JOINTS_0"], "<u2", 4),
            array(attributes["WEIGHTS_0"], "<u2", 4) / 65535)


def skinned(posed, rest):
    """Returns where Limber's linear blend brings the vertices of the .glb file."""
    names, points, bones, weights = read_glb(Arm.folder / "arm.glb")
    still = [1, 0, 0, 0]
    case = {"schema": "skin-ref/1", "rest": points.ravel().tolist(),
            "bones": [{"rest": matrix_of(rest[name][0], still), "pose": matrix_of(*posed[name])} for name in names],
            "influence_offsets": list(range(0, bones.size + 1, 4)), "influence_bones": bones.ravel().tolist(),
            "influence_weights": weights.ravel().tolist()}
    file = Arm.folder / "case.json"
    file.write_text(json.dumps(case))
    return np.array(json.loads(limber("skin-points", file, "--method", "lbs", "--json"))["points"]).reshape(-1, 3)


def evaluated(thing):
    return thing.evaluated_get(bpy.context.evaluated_depsgraph_get())


def heads(armature):
    """Returns {bone: head in mm} as Blender draws the armature."""
    return {bone.name: np.array(armature.matrix_world @ bone.head) * 1000 for bone in evaluated(armature).pose.bones}


def vertices():
    """Returns the vertices of the surface in mm as Blender draws them."""
    surface = evaluated(bpy.data.objects["Surface"])
    return np.array([surface.matrix_world @ vertex.co for vertex in surface.data.vertices]) * 1000


def turn(bone, axis, degrees):
    """Turns a bone of Blender and those below it about an axis of the world through the bone's head."""
    head = Matrix.Translation(bone.head)
    bone.matrix = head @ Matrix.Rotation(math.radians(degrees), 4, Vector(axis)) @ head.inverted() @ bone.matrix
    bpy.context.view_layer.update()


def quaternion(axis, degrees):
    half, axis = math.radians(degrees) / 2, np.array(axis, float)
    return np.array([math.cos(half), *math.sin(half) * axis / np.linalg.norm(axis)])


def empty_scene():
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.ops.preferences.addon_enable(module="limber_blender")
    bpy.context.scene.render.fps = 30  # the motion's frame rate


def setUpModule():
    if bpy:
        Arm.folder = Path(tempfile.mkdtemp())
        unittest.addModuleCleanup(shutil.rmtree, Arm.folder)
        write_body(Arm.folder, hand="Händ 手")
        Arm.rest = joints()


class Arm(unittest.TestCase):
    """The procedural arm, imported into a scene without anything else, at rest."""

    def setUp(self):
        self.file = self.folder / "pose.json"
        self.file.unlink(missing_ok=True)
        empty_scene()
        self.bring(self.folder / "arm.glb")
        self.armature.animation_data_clear()
        for bone in self.bones:
            bone.matrix_basis = Matrix.Identity(4)
        bpy.context.view_layer.update()

    def bring(self, path):
        bpy.ops.import_scene.limber_body(filepath=str(path))
        self.armature = bpy.context.active_object
        self.bones = self.armature.pose.bones

    def exported(self):
        bpy.ops.export_anim.limber_pose(filepath=str(self.file))
        return json.loads(self.file.read_text(encoding="utf-8"))

    def read(self, pose):
        self.file.write_text(pose if isinstance(pose, str) else json.dumps(pose), encoding="utf-8")
        bpy.ops.import_anim.limber_pose(filepath=str(self.file))

    def expect_error(self, words, operator, **arguments):
        """Checks that the operator fails with an error of one line that contains these words."""
        with self.assertRaises(RuntimeError) as caught:
            operator(**arguments)
        self.assertIn(words, str(caught.exception))
        self.assertNotIn("Traceback", str(caught.exception))
        self.assertEqual(len(str(caught.exception).strip().splitlines()), 1, caught.exception)

    def expect_joints(self, posed, what):
        shown = heads(self.armature)
        self.assertEqual(set(shown), set(posed))
        distance = max(np.linalg.norm(shown[name] - head) for name, (head, _) in posed.items())
        print(f"{what}: joints of Blender and Limber differ by up to {distance:.6f} mm")
        self.assertLess(distance, CLOSE)

    def expect_same(self, pose, other):
        bones, others = pose["bones"], other["bones"]
        self.assertEqual(set(bones), set(others))
        for name in bones:
            turns = np.array(bones[name]["rotation_wxyz"]), np.array(others[name]["rotation_wxyz"])
            np.testing.assert_allclose(turns[0] * np.sign(np.dot(*turns)), turns[1], atol=1e-6)  # q and -q are one.
        np.testing.assert_allclose(pose["root_translation"], other["root_translation"], atol=0.001)


class Poses(Arm):
    def test_a_pose_of_blender_moves_limbers_joints_and_surface_as_blender_does(self):
        turn(self.bones["Forearm"], (1, 0, 0), -60)
        turn(self.bones["Händ 手"], (0, 1, 0), 25)
        turn(self.bones["UpperArm"], (1, 2, 3), 40)
        self.bones["UpperArm"].matrix = Matrix.Translation((0.1, -0.02, 0.3)) @ self.bones["UpperArm"].matrix
        bpy.context.view_layer.update()
        pose = self.exported()
        self.assertEqual(set(pose["bones"]), {"UpperArm", "Forearm", "Händ 手"})
        for name, axis, degrees in (("Forearm", (1, 0, 0), -60), ("UpperArm", (1, 2, 3), 40)):
            np.testing.assert_allclose(pose["bones"][name]["rotation_wxyz"], quaternion(axis, degrees), atol=1e-6)
        np.testing.assert_allclose(pose["root_translation"], (100, -20, 300), atol=0.001)
        posed = joints("--pose", self.file)
        self.expect_joints(posed, "pose of Blender")

        shown, expected = vertices(), skinned(posed, self.rest)
        travel = np.linalg.norm(expected - read_glb(self.folder / "arm.glb")[1], axis=1)
        self.assertGreater(travel.min(), 100)
        distance = np.linalg.norm(shown - expected, axis=1).max()
        print(f"pose of Blender: {len(shown)} vertices of Blender and Limber differ by up to {distance:.6f} mm")
        self.assertLess(distance, CLOSE)

    def test_a_pose_of_limber_comes_back_the_same(self):
        bones = {name: {"rotation_wxyz": list(quaternion((i % 3 - 1, 1, i % 5), 170 - 60 * i if i % 2 else 0.01 * i))}
                 for i, name in enumerate(self.rest) if i % 4}
        pose = {"bones": bones, "root_translation": [12.5, -300, 40.25]}
        turn(self.bones["UpperArm"], (0, 0, 1), 50)  # The pose file does not list this bone, so it returns to rest.
        self.read(pose)
        self.expect_joints(joints("--pose", self.file), "pose of Limber")
        self.expect_same(self.exported(), pose)
        self.expect_joints(joints("--pose", self.file), "pose of Limber, there and back")

    def test_axes_and_degrees_are_read_and_euler_angles_are_exported(self):
        self.bones["Forearm"].rotation_mode = "ZXY"
        self.read({"bones": {"Forearm": {"axis": [-2, 0, 0], "degrees": 75}}})
        self.expect_joints(joints("--pose", self.file), "axis and degrees")
        pose = {"bones": {"Forearm": {"rotation_wxyz": quaternion((-1, 0, 0), 75)}}, "root_translation": [0, 0, 0]}
        self.expect_same(self.exported(), pose)

    def test_rest_is_exactly_rest(self):
        self.assertEqual(self.exported(), {"bones": {}, "root_translation": [0, 0, 0]})

    def test_a_frame_of_a_motion_is_the_pose_that_limber_takes_from_the_motion(self):
        empty_scene()
        self.bring(self.folder / "arm.glb")
        bpy.context.scene.frame_set(25)
        pose = self.exported()
        posed = joints("--motion", self.folder / "motion.bvh", "--frame", 25)
        self.assertGreater(np.linalg.norm(posed["Händ 手"][0] - self.rest["Händ 手"][0]), 100)
        self.expect_joints(posed, "frame 25 of the motion")
        self.expect_joints(joints("--pose", self.file), "frame 25 as a pose")
        bpy.context.scene.frame_set(0)
        self.read(pose)
        self.expect_joints(posed, "frame 25, read over frame 0")

    def test_the_roots_of_a_rig_move_together(self):
        folder = self.folder / "roots"
        write_body(folder, parent_of_hand="null")
        empty_scene()
        self.bring(folder / "arm.glb")
        self.armature.animation_data_clear()
        pose = {"bones": {"Hand": {"axis": [1, 2, 3], "degrees": 80}}, "root_translation": [50, 60, 70]}
        self.read(pose)
        self.expect_joints(joints("--pose", self.file, rig="roots/rig.json"), "two roots")
        np.testing.assert_allclose(self.exported()["root_translation"], [50, 60, 70], atol=0.001)
        self.bones["Hand"].location.x += 0.01
        self.expect_error("Bone 'Hand' is 10.00 mm off its joint", self.exported)

    def test_a_constraint_is_part_of_the_pose_and_bones_of_the_users_own_are_not(self):
        bpy.ops.object.mode_set(mode="EDIT")
        target = self.armature.data.edit_bones.new("Target")
        target.head, target.tail = (0, -0.3, -0.3), (0, -0.4, -0.3)
        bpy.ops.object.mode_set(mode="POSE")
        chain = self.armature.pose.bones["Händ 手"].constraints.new("IK")
        chain.target, chain.subtarget, chain.chain_count = self.armature, "Target", 3
        bpy.context.view_layer.update()
        self.assertNotIn("Target", self.exported()["bones"])
        shown, posed = heads(self.armature), joints("--pose", self.file)
        self.assertGreater(np.linalg.norm(posed["Händ 手"][0] - self.rest["Händ 手"][0]), 100)
        for name, (head, _) in posed.items():
            np.testing.assert_allclose(shown[name], head, atol=CLOSE)

    def test_the_place_of_the_armature_in_the_scene_is_not_part_of_the_pose(self):
        turn(self.bones["Forearm"], (1, 0, 0), -60)
        pose = self.exported()
        self.armature.matrix_world = Matrix.Translation((1, 2, 3)) @ Matrix.Rotation(1, 4, "Z")
        bpy.context.view_layer.update()
        self.assertEqual(self.exported(), pose)

    def test_the_surface_or_nothing_may_be_selected(self):
        for active in (bpy.data.objects["Surface"], None):
            bpy.context.view_layer.objects.active = active
            self.exported()


class Errors(Arm):
    def expect_no_export(self, words):
        self.file.write_text("before")
        self.expect_error(words, bpy.ops.export_anim.limber_pose, filepath=str(self.file))
        self.assertEqual(self.file.read_text(), "before")

    def test_a_scene_needs_one_armature(self):
        bpy.context.view_layer.objects.active = None
        bpy.context.collection.objects.link(self.armature.copy())
        self.expect_no_export("The scene has 2 armatures: select one")
        empty_scene()
        self.expect_no_export("The scene has no armatures: select one, or import a Limber body")

    def test_an_armature_must_be_from_limber(self):
        bpy.ops.object.armature_add()
        self.expect_no_export("'Armature.001' is not from Limber: use File > Import > Limber body (.glb)")

    def test_limber_has_no_scaling(self):
        for scale in ((1.1, 1.1, 1.1), (1, 1.01, 1), (-1, 1, 1)):
            self.bones["Forearm"].scale = scale
            self.expect_no_export("Bone 'Forearm' is scaled, and Limber has no scaling: clear it (Alt S)")

    def test_only_the_root_moves(self):
        self.bones["Händ 手"].location = (0, 0.003, 0.004)
        self.expect_no_export("Bone 'Händ 手' is 5.00 mm off its joint: clear its location (Alt G)")

    def test_the_rig_must_be_as_it_was_imported(self):
        self.armature.data.pose_position = "REST"
        self.expect_no_export("'Armature' shows its rest position")
        self.armature.data.pose_position = "POSE"
        self.bones["Forearm"].name = "Elbow"
        self.expect_no_export("Bone 'Forearm' was renamed or deleted")
        self.bones["Elbow"].name = "Forearm"
        bpy.ops.object.mode_set(mode="EDIT")
        self.expect_no_export("'Armature' shows its rest position")
        self.armature.data.edit_bones["Forearm"].head.x += 0.01
        bpy.ops.object.mode_set(mode="OBJECT")
        self.expect_no_export("Bone 'Forearm' was moved at rest")

    def test_a_place_that_cannot_be_written_is_named(self):
        for path in (self.folder / "none" / "pose.json", self.folder):
            self.expect_error(f"{path} cannot be written", bpy.ops.export_anim.limber_pose, filepath=str(path))
        self.assertEqual(list(self.folder.glob("*.part")) + list(self.folder.parent.glob("*.part")), [])

    def test_a_pose_must_fit_the_rig(self):
        self.file.write_text(json.dumps({"bones": {"Tail": {"axis": [1, 0, 0], "degrees": 9}}}))
        self.expect_error("'Armature' has no bone 'Tail': the pose belongs to another rig",
                          bpy.ops.import_anim.limber_pose, filepath=str(self.file))

    def test_what_is_no_pose_is_refused(self):
        turns = ('{"axis": [0, 0, 0], "degrees": 1}', '{"axis": [1, 0], "degrees": 1}', '{"axis": [1, 0, 0]}', "3",
                 '{"rotation_wxyz": [0, 0, 0, 0]}', '{"rotation_wxyz": ["a", 0, 0, 0]}',
                 '{"rotation_wxyz": [1e999, 0, 0, 0]}')
        texts = [f'{{"bones": {{"Forearm": {one}}}}}' for one in turns]
        for text in [*texts, "", "[]", "{", '{"bones": []}', '{"bones": {}, "root_translation": [1, 2, NaN]}']:
            with self.subTest(text):
                self.expect_error(f"{self.file} is not a pose file of Limber", self.read, pose=text)
        self.expect_error("is not a pose file", bpy.ops.import_anim.limber_pose, filepath=str(self.folder / "none"))

    def test_what_is_no_body_is_refused(self):
        glb = (self.folder / "arm.glb").read_bytes()
        other = self.folder / "other.glb"
        without_skin, of_others = glb.replace(b'"skins"', b'"skinz"'), glb.replace(b'"Limber"', b'"Others"')
        for data in (b"", b"glTF", glb[:1000], without_skin, of_others):
            other.write_bytes(data)
            self.expect_error(f"{other} is not a body that 'limber export-gltf' wrote",
                              bpy.ops.import_scene.limber_body, filepath=str(other))

    def test_names_that_blender_cuts_are_refused(self):
        folder = self.folder / "long"
        for name, fits in (("é" * 31 + "x", True), ("é" * 32, False)):
            write_body(folder, hand=name)
            if fits:
                self.bring(folder / "arm.glb")
                self.assertIn(name, self.bones)
            else:
                self.expect_error(f"Blender cuts names after 63 bytes: shorten '{name}' in the rig", self.bring,
                                  path=folder / "arm.glb")


class AddOn(Arm):
    def test_numpy_is_left_as_it_was(self):
        self.bring(self.folder / "arm.glb")
        self.assertEqual(vars(np).get("bool", "missing"), NUMPY_BOOL)
        broken = self.folder / "broken.glb"
        broken.write_bytes((self.folder / "arm.glb").read_bytes()[:-10000])
        self.expect_error(f"cannot import {broken}", self.bring, path=broken)
        self.assertEqual(vars(np).get("bool", "missing"), NUMPY_BOOL)

    def test_a_numpy_with_bool_keeps_its_own(self):
        with unittest.mock.patch.object(np, "bool", np.bool_, create=True):
            self.bring(self.folder / "arm.glb")
            self.assertIs(vars(np)["bool"], np.bool_)

    def test_it_comes_and_goes_without_a_trace(self):
        def entries():
            menus = (bpy.types.TOPBAR_MT_file_import, bpy.types.TOPBAR_MT_file_export)
            return [draw for menu in menus for draw in menu.draw._draw_funcs if draw.__module__ == "limber_blender"]

        operators = ("IMPORT_SCENE_OT_limber_body", "IMPORT_ANIM_OT_limber_pose", "EXPORT_ANIM_OT_limber_pose")
        for _ in range(2):
            self.assertEqual(len(entries()), 2)
            self.assertTrue(all(hasattr(bpy.types, name) for name in operators))
            bpy.ops.preferences.addon_disable(module="limber_blender")
            self.assertEqual(entries(), [])
            self.assertFalse(any(hasattr(bpy.types, name) for name in operators))
            bpy.ops.preferences.addon_enable(module="limber_blender")

    def test_it_is_short(self):
        lines = ADD_ON.read_text(encoding="utf-8").splitlines()
        self.assertLessEqual(len(lines), 200)
        self.assertLessEqual(max(map(len, lines)), 120)


class InBlender(unittest.TestCase):
    def test_the_add_on(self):
        blender = shutil.which("blender")
        if not blender:
            print("SKIPPED: the add-on for Blender (blender is not installed)", flush=True)
            self.skipTest("blender is not installed")
        with tempfile.TemporaryDirectory() as folder:  # for Blender's add-ons and settings
            # Debian's Blender takes its modules from the first python3 of the PATH, which must be Debian's.
            places = {"BLENDER_USER_SCRIPTS": folder, "BLENDER_USER_CONFIG": folder,
                      "PATH": f"{Path(blender).parent}{os.pathsep}{os.environ['PATH']}"}
            run = subprocess.run([blender, "--background", "--factory-startup", "--threads", "1", "--python-exit-code",
                                  "1", "--python", __file__], env={**os.environ, **places}, check=False)
        self.assertEqual(run.returncode, PASSED)


def load_tests(loader, _, __):
    cases = (Poses, Errors, AddOn) if bpy else (InBlender,)
    return unittest.TestSuite(loader.loadTestsFromTestCase(case) for case in cases)


if bpy and __name__ == "__main__":
    sys.dont_write_bytecode = True
    bpy.ops.preferences.addon_install(filepath=str(ADD_ON))
    tests = unittest.main(argv=["test_addon", "-v"], exit=False)
    sys.exit(PASSED if tests.result.wasSuccessful() else 1)
