# SPDX-License-Identifier: AGPL-3.0-or-later
"""Blender add-on: imports a body that `limber export-gltf` wrote, and carries poses between Blender and Limber.

The axes of an imported armature are Limber's (x to the left, y to the back, z up), in metres instead of millimetres.
Blender's importer invents the rest axes of the bones, so poses are computed with motions in the armature's axes:
  motion(bone) = posed matrix * inverse(rest matrix)
  motion(bone) = motion(parent) * rotation of the pose file about the bone's head
A pose does not contain the position of the armature object in the scene.
"""
import contextlib
import json
import math
import pathlib

import bpy
import numpy
from bpy_extras.io_utils import ExportHelper, ImportHelper
from mathutils import Matrix, Quaternion, Vector

bl_info = {"name": "Limber bodies and poses", "version": (1, 0, 0), "blender": (3, 4, 0), "category": "Import-Export",
           "location": "File > Import, Export", "description": "Import bodies of Limber; import and export poses"}

RIG = "limber_rig"  # property of an armature: JSON text {bone: [parent or null, head at rest]}, parents first
LONGEST_NAME = 63  # bytes of a bone's name that Blender keeps
MM = 0.001  # in metres
MAX_OFFSET = 0.05 * MM  # Blender's rounding errors move joints by less than this
MAX_STRETCH = 1e-4  # relative
MIN_HALF_ANGLE = 1e-6  # radians; rotations by less are rounding errors


class LimberError(Exception):
    """Says what is wrong, where, and what the user can do."""


def check_body(path):
    """Checks that the file is a posable body of Limber, with bone names that Blender keeps whole."""
    try:
        with open(path, "rb") as file:
            gltf = json.loads(file.read(int.from_bytes(file.read(20)[12:16], "little")))
        names = [gltf["nodes"][joint]["name"] for joint in gltf["skins"][0]["joints"]]
        if gltf["asset"]["generator"] != "Limber":
            raise ValueError("another program wrote it")
    except (OSError, ValueError, LookupError, TypeError) as error:
        raise LimberError(f"{path} is not a body that 'limber export-gltf' wrote ({error!r})") from error
    for name in names:
        if len(name.encode()) > LONGEST_NAME:
            raise LimberError(f"Blender cuts names after {LONGEST_NAME} bytes: shorten '{name}' in the rig")


def armature_of(context):
    """Returns the armature that the user means: the active one, that of the active surface, or the only one."""
    active = context.active_object
    armature = active.find_armature() if active and active.type == "MESH" else active
    if not armature or armature.type != "ARMATURE":
        found = [thing for thing in context.scene.objects if thing.type == "ARMATURE"]
        if len(found) != 1:
            raise LimberError(f"The scene has {len(found) or 'no'} armatures: select one, or import a Limber body")
        armature = found[0]
    if armature.mode == "EDIT" or armature.data.pose_position == "REST":
        raise LimberError(f"'{armature.name}' shows its rest position: leave Edit Mode and select Pose Position")
    return armature


def rig_of(armature):
    """Returns {bone: (parent or None, head at rest)} as it was imported. The armature's rest must still be the same."""
    if RIG not in armature.data:
        raise LimberError(f"'{armature.name}' is not from Limber: use File > Import > Limber body (.glb)")
    rig = {name: (parent, Vector(head)) for name, (parent, head) in json.loads(armature.data[RIG]).items()}
    for name, (_, head) in rig.items():
        bone = armature.data.bones.get(name)
        if not bone or (bone.head_local - head).length > MAX_OFFSET:
            change = "moved at rest" if bone else "renamed or deleted"
            raise LimberError(f"Bone '{name}' was {change}: undo that, or import the body again and pose that one")
    return rig


def pose_of(armature, context):
    """Returns the pose as a pose file has it."""
    posed = armature.evaluated_get(context.evaluated_depsgraph_get()).pose.bones
    motion, turns, travel = {}, {}, None
    for name, (parent, head) in rig_of(armature).items():
        motion[name] = posed[name].matrix @ armature.data.bones[name].matrix_local.inverted()
        axes = numpy.array(motion[name].to_3x3())
        if numpy.abs(axes @ axes.T - numpy.eye(3)).max() > MAX_STRETCH or numpy.linalg.det(axes) < 0:
            raise LimberError(f"Bone '{name}' is scaled, and Limber has no scaling: clear it (Alt S)")
        own = motion[parent].inverted() @ motion[name] if parent else motion[name]
        rotation, offset = own.to_quaternion(), own @ head - head
        if Vector(rotation[1:]).length > MIN_HALF_ANGLE:
            turns[name] = {"rotation_wxyz": list(rotation)}
        travel = offset if travel is None else travel  # the first bone is a root
        gap = (offset if parent else offset - travel).length
        if gap > MAX_OFFSET:
            raise LimberError(f"Bone '{name}' is {gap / MM:.2f} mm off its joint: clear its location (Alt G)")
    return {"bones": turns, "root_translation": [round(value / MM, 3) for value in travel]}


def read_pose(path):
    """Returns {bone: rotation} and the root's translation of a pose file."""
    def vector(values, count, shortest=1e-9):
        if len(values) != count or not shortest <= math.hypot(*values) < 1e9:
            raise ValueError(f"{values} is not {count} finite numbers, or is zero")
        return Vector(values)

    def rotation(turn):
        if "rotation_wxyz" in turn:
            return Quaternion(vector(turn["rotation_wxyz"], 4)).normalized()
        return Quaternion(vector(turn["axis"], 3), math.radians(turn["degrees"]))

    try:
        pose = json.loads(pathlib.Path(path).read_text(encoding="utf-8"))
        turns = {name: rotation(turn) for name, turn in pose["bones"].items()}
        return turns, vector(pose.get("root_translation", [0, 0, 0]), 3, shortest=0) * MM
    except (OSError, ValueError, LookupError, TypeError, AttributeError) as error:
        raise LimberError(f"{path} is not a pose file of Limber ({error!r})") from error


class LimberOperator:
    """An operator that shows a LimberError as one line."""
    def execute(self, context):
        try:
            self.run(context)
        except LimberError as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        return {"FINISHED"}


class ImportBody(LimberOperator, bpy.types.Operator, ImportHelper):
    """Import a posable body of Limber: surface, skeleton, weights and motions"""
    bl_idname, bl_label, bl_options = "import_scene.limber_body", "Import Limber Body", {"UNDO"}
    filter_glob: bpy.props.StringProperty(default="*.glb", options={"HIDDEN"})
    def run(self, _):
        check_body(self.filepath)
        before = set(bpy.data.armatures)
        try:
            with contextlib.ExitStack() as stack:
                if "bool" not in vars(numpy):  # Blender's importer uses it, and some versions of numpy lack it.
                    numpy.bool = bool
                    stack.callback(delattr, numpy, "bool")
                bpy.ops.import_scene.gltf(filepath=self.filepath, bone_heuristic="TEMPERANCE")
        except (AttributeError, RuntimeError) as error:
            why = str(error).strip()
            raise LimberError(f"Blender's add-on 'glTF 2.0 format' cannot import {self.filepath}: {why}") from error
        for armature in set(bpy.data.armatures) - before:
            rig = {bone.name: [bone.parent and bone.parent.name, list(bone.head_local)] for bone in armature.bones}
            armature[RIG] = json.dumps(rig)


class ImportPose(LimberOperator, bpy.types.Operator, ImportHelper):
    """Pose the armature of a Limber body as a pose file says"""
    bl_idname, bl_label, bl_options = "import_anim.limber_pose", "Import Limber Pose", {"UNDO"}
    filter_glob: bpy.props.StringProperty(default="*.json", options={"HIDDEN"})
    def run(self, context):
        armature, (turns, travel) = armature_of(context), read_pose(self.filepath)
        rig = rig_of(armature)
        for name in turns.keys() - rig.keys():
            raise LimberError(f"'{armature.name}' has no bone '{name}': the pose belongs to another rig")
        for name, (parent, head) in rig.items():
            turn = turns.get(name, Quaternion()).to_matrix().to_4x4()
            own = Matrix.Translation(head if parent else head + travel) @ turn @ Matrix.Translation(-head)
            rest = armature.data.bones[name].matrix_local
            armature.pose.bones[name].matrix_basis = rest.inverted() @ own @ rest


class ExportPose(LimberOperator, bpy.types.Operator, ExportHelper):
    """Write the pose of a Limber body for 'limber resample --pose'"""
    bl_idname, bl_label, filename_ext = "export_anim.limber_pose", "Export Limber Pose", ".json"
    filter_glob: bpy.props.StringProperty(default="*.json", options={"HIDDEN"})
    def run(self, context):
        pose, part = pose_of(armature_of(context), context), pathlib.Path(f"{self.filepath}.part")
        try:
            part.write_text(json.dumps(pose, indent=1, ensure_ascii=False), encoding="utf-8")
            part.replace(self.filepath)
        except OSError as error:
            with contextlib.suppress(OSError):
                part.unlink()
            raise LimberError(f"{self.filepath} cannot be written: {error.strerror}") from error


def import_menu(self, _):
    self.layout.operator(ImportBody.bl_idname, text="Limber body (.glb)")
    self.layout.operator(ImportPose.bl_idname, text="Limber pose (.json)")


def export_menu(self, _):
    self.layout.operator(ExportPose.bl_idname, text="Limber pose (.json)")


def register():
    for operator in (ImportBody, ImportPose, ExportPose):
        bpy.utils.register_class(operator)
    bpy.types.TOPBAR_MT_file_import.append(import_menu)
    bpy.types.TOPBAR_MT_file_export.append(export_menu)


def unregister():
    bpy.types.TOPBAR_MT_file_import.remove(import_menu)
    bpy.types.TOPBAR_MT_file_export.remove(export_menu)
    for operator in (ExportPose, ImportPose, ImportBody):
        bpy.utils.unregister_class(operator)
