# SPDX-License-Identifier: AGPL-3.0-or-later
# blender -b --factory-startup --python-exit-code 1 --python blender_surfaces.py -- FOLDER
# Writes a scaled and rotated object in every surface format that the program reads, and the corners of its triangles to
# triangles.txt: one corner per line, in mm along Blender's own axes.
import sys

import bpy

folder, = sys.argv[sys.argv.index("--") + 1:]
bpy.ops.wm.read_factory_settings(use_empty=True)
bpy.ops.mesh.primitive_ico_sphere_add(subdivisions=2, radius=0.1, location=(0.3, -0.5, 1.2), rotation=(0.3, 0.2, 1.0))
ball = bpy.context.object
ball.scale = (1, 2, 0.5)
bpy.context.view_layer.update()

mm = {"global_scale": 1000, "axis_forward": "Y", "axis_up": "Z"}
bpy.ops.export_mesh.stl(filepath=folder + "/binary.stl", **mm)
bpy.ops.export_mesh.stl(filepath=folder + "/ascii.stl", ascii=True, **mm)
bpy.ops.export_mesh.ply(filepath=folder + "/binary.ply", use_ascii=False, **mm)
bpy.ops.export_mesh.ply(filepath=folder + "/ascii.ply", use_ascii=True, **mm)
bpy.ops.export_scene.obj(filepath=folder + "/a.obj", **mm)
for kind, name in ("GLB", "a.glb"), ("GLTF_EMBEDDED", "inside.gltf"), ("GLTF_SEPARATE", "beside.gltf"):
    bpy.ops.export_scene.gltf(filepath=folder + "/" + name, export_format=kind)

with open(folder + "/triangles.txt", "w") as out:
    for face in ball.data.polygons:
        assert len(face.vertices) == 3
        for v in face.vertices:
            print(*(ball.matrix_world @ ball.data.vertices[v].co * 1000), file=out)
