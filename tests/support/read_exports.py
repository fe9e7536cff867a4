# SPDX-License-Identifier: AGPL-3.0-or-later
"""Reads exports back with other programs' readers and compares them with a volume that was written as plain numbers.

  read_exports.py KIND FILE VOLUME.nii.gz [TISSUES.csv]

KIND is volume (nibabel), disc or gprmax (h5py), icrp (numpy), openems (FILE is openEMS's dump of its materials; VTK),
surface (VTK: manifold, watertight), surfaces (a glTF file with all surfaces; VTK) or tets (numpy). VOLUME is the same
body as NIfTI, read by nibabel. TISSUES.csv is written by `limber tissues`. Exits with 0 and a line of figures if
everything agrees, else with 1 and the difference; with 77 if a reader is not installed.
"""
import csv
import json
import sys

try:
    import numpy as np
    import nibabel
    if sys.argv[1] in ('disc', 'gprmax'):
        import h5py
    if sys.argv[1] in ('openems', 'surface', 'surfaces'):
        import vtk
        from vtk.util.numpy_support import vtk_to_numpy
except ImportError as missing:
    print(missing)
    sys.exit(77)

kind, name = sys.argv[1:3]


def check(holds, what):
    if not holds:
        print('WRONG:', what)
        sys.exit(1)


image = nibabel.load(sys.argv[3])
labels = np.asarray(image.dataobj).astype(int)  # [x, y, z], RAS world
# Voxel axes of the arm's phantom are L, P, S: world RAS is minus x, minus y.
lps = np.diag([-1, -1, 1, 1]) @ image.affine
spacing = np.abs(np.diag(lps)[:3])
origin = lps[:3, 3]
check(np.allclose(lps[:3, :3], np.diag(spacing)), 'the axes are not L, P, S')
tissues = {}
if len(sys.argv) > 4:
    for row in csv.DictReader(open(sys.argv[4])):
        tissues[int(row['label'])] = row


def of_label(column):
    table = np.zeros(labels.max() + 1)
    for label, row in tissues.items():
        if label < len(table):
            table[label] = float(row[column])
    return table[labels]


if kind == 'volume':
    other = nibabel.load(name)
    check((np.asarray(other.dataobj).astype(int) == labels).all(), 'labels')
    check(np.allclose(other.affine, image.affine), 'affine')
elif kind == 'disc':
    with h5py.File(name) as f:
        check(float(f.attrs['Version']) == 2.0, 'version')
        data, db = f['DiscData'][:], f['DiscData'].attrs
        check(data.shape == labels.shape[::-1] and data.dtype == np.uint8, f'shape {data.shape}')
        check(int(db['DB_Size']) == len(db['epsR']) == len(db['kappa']) == len(db['density']), 'size of the database')
        check(db['epsR'][0] == 1 and db['kappa'][0] == 0, 'background')
        index = data.transpose(2, 1, 0)
        for column, key in (('relative_permittivity', 'epsR'), ('conductivity_S_m', 'kappa'), ('density_kg_m3', 'density')):
            expected = of_label(column)
            if key == 'epsR':
                expected[labels == 0] = 1
            check(np.allclose(db[key][index], expected, rtol=1e-6), key)
        for axis in range(3):
            mesh = f['mesh/' + 'xyz'[axis]][:]
            check(len(mesh) == labels.shape[axis] + 1, 'mesh')
            check(np.allclose(mesh, (origin[axis] + (np.arange(len(mesh)) - 0.5) * spacing[axis]) / 1000, atol=1e-6), 'mesh lines')
elif kind == 'gprmax':
    materials = []
    for line in open(name.replace('.gprmax.h5', '_materials.txt')):
        if line.startswith('##'):
            continue
        words = line.split()
        check(words[0] == '#material:' and len(words) == 6, line)
        materials.append((float(words[1]), float(words[2])))
    with h5py.File(name) as f:
        check(np.allclose(f.attrs['dx_dy_dz'], spacing / 1000), 'dx_dy_dz')
        data = f['data'][:]
    check(data.shape == labels.shape and data.dtype == np.int16, f'shape {data.shape}')
    check(((data == -1) == (labels == 0)).all(), 'air')
    body = labels > 0
    check(np.allclose(np.array(materials)[data[body], 0], of_label('relative_permittivity')[body]), 'permittivity')
    check(np.allclose(np.array(materials)[data[body], 1], of_label('conductivity_S_m')[body]), 'conductivity')
elif kind == 'icrp':
    numbers = np.array(open(name).read().split(), dtype=int)
    check((numbers.reshape(labels.shape[::-1]).transpose(2, 1, 0) == labels).all(), 'organ numbers')
    organs = [line.split('\t') for line in open(name.replace('.dat', '_organs.dat')).read().split('\n') if line and line[0].isdigit()]
    media = {line.split('\t')[0]: [float(x) for x in line.split('\t')[1:-1]] for line in open(name.replace('.dat', '_media.dat')) if line[0].isdigit()}
    check({int(organ[0]) for organ in organs} == set(np.unique(labels)) - {0}, 'organs')
    for organ in organs:
        check(0.1 < float(organ[2]) < 3, 'density')
        check(abs(sum(media[organ[1]]) - 100) < 0.02, 'elements')
elif kind == 'openems':
    reader = vtk.vtkXMLRectilinearGridReader()
    reader.SetFileName(name)
    reader.Update()
    grid = reader.GetOutput()
    lines = [vtk_to_numpy(c).astype(float) for c in (grid.GetXCoordinates(), grid.GetYCoordinates(), grid.GetZCoordinates())]
    data = grid.GetPointData() if grid.GetPointData().GetNumberOfArrays() else grid.GetCellData()
    arrays = {data.GetArrayName(i).lower(): vtk_to_numpy(data.GetArray(i)) for i in range(data.GetNumberOfArrays())}
    # At each mesh node and for each axis, openEMS gives the mean of the four cells around the edge that starts at the
    # node.
    shape = tuple(len(c) for c in lines)
    check(shape == tuple(n + 1 for n in labels.shape), f'mesh {shape}')
    worst = 0
    for column, key, air in (('relative_permittivity', 'epsilon', 1), ('conductivity_S_m', 'kappa', 0)):
        found = arrays[key].reshape(shape[2], shape[1], shape[0], 3).transpose(2, 1, 0, 3)
        cell = of_label(column)
        cell[labels == 0] = air
        # At inner nodes, the edge along z is surrounded by the cells (x-1, x) by (y-1, y) at the same z.
        mean = (cell[:-1, :-1, :] + cell[1:, :-1, :] + cell[:-1, 1:, :] + cell[1:, 1:, :]) / 4
        error = np.abs(found[1:-1, 1:-1, :-1, 2] - mean).max() / cell.max()
        worst = max(worst, error)
        check(error < 1e-5, f'{key}: off by {error}')
    print('worst', worst)
elif kind == 'surfaces':
    head = open(name, 'rb').read()
    length = int.from_bytes(head[12:16], 'little')
    gltf = json.loads(head[20:20 + length])
    check([int(node['extras']['label']) for node in gltf['nodes']] == sorted(set(np.unique(labels)) - {0}), 'labels')
    reader = vtk.vtkGLTFReader()
    reader.SetFileName(name)
    reader.Update()
    blocks = reader.GetOutput().NewIterator()
    meshes = []
    while not blocks.IsDoneWithTraversal():
        meshes.append(blocks.GetCurrentDataObject())
        blocks.GoToNextItem()
    check(len(meshes) == len(gltf['nodes']), f'{len(meshes)} surfaces')
    total = 0
    for node, mesh in zip(gltf['nodes'], meshes):
        place = vtk_to_numpy(mesh.GetPoints().GetData())
        place = 1000 * np.stack([place[:, 0], -place[:, 2], place[:, 1]], 1)  # LPS, mm
        mask = np.argwhere(labels == int(node['extras']['label']))
        low, high = origin + spacing * (mask.min(0) - 0.5), origin + spacing * (mask.max(0) + 0.5)
        check((place > low - 0.5 * spacing).all() and (place < high + 0.5 * spacing).all(), f'{node["name"]}: bounds')
        check((place.min(0) < low + spacing).all() and (place.max(0) > high - spacing).all(), f'{node["name"]}: reach')
        # Checks the orientation of the triangles: the flux of the position vector through the surface is three times
        # the volume.
        corners = vtk_to_numpy(mesh.GetPolys().GetConnectivityArray()).reshape(-1, 3)
        a, b, c = (place[corners[:, i]] for i in range(3))
        volume = (np.cross(a, b) * c).sum() / 6
        check(volume > 0, f'{node["name"]}: inside out')
        total += volume
        edges = np.sort(np.concatenate([corners[:, [0, 1]], corners[:, [1, 2]], corners[:, [2, 0]]]), axis=1)
        check((np.unique(edges, axis=0, return_counts=True)[1] == 2).all(), f'{node["name"]}: an edge is not in two triangles')
        normals = vtk_to_numpy(mesh.GetPointData().GetArray('NORMAL'))
        check(np.allclose(np.linalg.norm(normals, axis=1), 1, atol=1e-4), 'normals')
    whole = np.count_nonzero(labels) * spacing.prod()
    check(abs(total / whole - 1) < 0.05, f'volume {total} of {whole}')
    print('surfaces', len(meshes), 'volume', total / whole)
elif kind == 'surface':
    reader = {'stl': vtk.vtkSTLReader, 'ply': vtk.vtkPLYReader, 'obj': vtk.vtkOBJReader}[name[-3:]]()
    if name[-3:] == 'stl':
        reader.MergingOff()
    reader.SetFileName(name)
    reader.Update()
    mesh = reader.GetOutput()
    edges = vtk.vtkFeatureEdges()
    edges.SetInputData(mesh)
    edges.FeatureEdgesOff()
    edges.ManifoldEdgesOff()
    edges.BoundaryEdgesOn()
    edges.NonManifoldEdgesOn()
    edges.Update()
    if name[-3:] == 'ply':
        check(edges.GetOutput().GetNumberOfCells() == 0, f'{edges.GetOutput().GetNumberOfCells()} edges are not in two triangles')
    mass = vtk.vtkMassProperties()
    mass.SetInputData(mesh)
    mass.Update()
    check(mesh.GetNumberOfCells() > 0 and mass.GetVolume() > 0, 'volume')
    box = np.array(mesh.GetBounds()).reshape(3, 2)
    low, high = origin - spacing, origin + spacing * labels.shape
    check((box[:, 0] >= low).all() and (box[:, 1] <= high).all(), f'bounds {box}')
    print('triangles', mesh.GetNumberOfCells(), 'volume', mass.GetVolume())
else:
    check(False, 'kind')
