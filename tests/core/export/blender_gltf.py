# SPDX-License-Identifier: AGPL-3.0-or-later
# blender -b --factory-startup --python-exit-code 1 --python blender_gltf.py -- IN.glb OUT.txt  ANIMATION SECONDS ...
# Opens a glTF file in Blender and writes the positions of its mesh's vertices at the given times of its animations: x y
# z in Blender's own axes, a line per vertex, all vertices at the first time, then at the next.
import sys

import numpy

numpy.bool = bool  # Blender 3.4's glTF reader uses this name, which numpy 1.24 has removed

import bpy

file, out, *asked = sys.argv[sys.argv.index("--") + 1:]
bpy.ops.wm.read_factory_settings(use_empty=True)
bpy.ops.import_scene.gltf(filepath=file)

scene = bpy.context.scene
armature, = [o for o in bpy.data.objects if o.type == "ARMATURE"]
mesh, = [o for o in bpy.data.objects if o.type == "MESH" and o.find_armature() == armature]
armature.animation_data.use_nla = False

with open(out, "w") as places:
    for name, seconds in zip(asked[::2], asked[1::2]):
        armature.animation_data.action, = [a for a in bpy.data.actions if a.name.startswith(name)]
        frame = float(seconds) * scene.render.fps / scene.render.fps_base
        scene.frame_set(int(frame), subframe=frame - int(frame))
        posed = mesh.evaluated_get(bpy.context.evaluated_depsgraph_get())
        for vertex in posed.data.vertices:
            places.write("%.9g %.9g %.9g\n" % tuple(posed.matrix_world @ vertex.co))
