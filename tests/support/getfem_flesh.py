# SPDX-License-Identifier: AGPL-3.0-or-later
"""Computes the energy of flesh, its forces and a Newton step by GetFEM, from the text of the formula. MUMPS solves for
the step.

  getfem_flesh.py FOLDER [newton]

FOLDER contains the files that tests/support/getfem.h writes: tets at rest and moved, their materials and patches, and
springs. Writes the forces without those of the springs to forces.f64 and, with `newton`, the step with the springs to
step.f64. Prints lines of a name and a number; seconds are CPU seconds of one thread.
"""
import sys
import time
from pathlib import Path

import getfem as gf
import numpy as np

# The energy in GetFEM's language. The pressure p of a patch is an additional unknown: for p = K (mean of J - 1) the
# last two terms are the patch's energy of compression.
F = '(Id(3)+Grad_u)'
J = f'Det{F}'
TET = f'mu/2*(Norm_sqr{F} - 3) - mu*log({J}) + k/2*sqr({J} - 1) - 2*weak*half_sqr_pos_part(1 - {J}/below)*log({J}/below)'
PATCH = f' + filled*(p*({J} - 1) - softness/2*sqr(p))'


class Flesh:
    def __init__(self, folder):
        def read(name, kind=np.float64):
            return np.fromfile(folder / name, kind)
        self.rest, moved = read('rest.f64').reshape(-1, 3), read('moved.f64').reshape(-1, 3)
        T, patch = read('tets.i32', np.int32).reshape(-1, 4), read('patch.i32', np.int32)
        self.weak, self.below = read('weak.f64')

        mesh = gf.Mesh('empty', 3)
        mesh.add_convex(gf.GeoTrans('GT_PK(3,1)'), np.asfortranarray(self.rest[T].transpose(2, 1, 0)))
        self.mim = gf.MeshIm(mesh, gf.Integ('IM_TETRAHEDRON(1)'))
        self.field = gf.MeshFem(mesh, 3)
        self.field.set_fem(gf.Fem('FEM_PK(3,1)'))
        node_at = {self.rest[v].tobytes(): v for v in np.unique(T)}
        places = np.ascontiguousarray(self.field.basic_dof_nodes().T)
        assert all(np.array_equal(places[0::3], places[c::3]) for c in (1, 2)) and len(places) == 3 * len(node_at)
        self.node = np.array([node_at[p.tobytes()] for p in places[::3]])  # node of every three unknowns
        self.u = (moved - self.rest)[self.node].ravel()
        pins = read('pins.f64').reshape(-1, 4)[self.node]
        self.stiffness, self.target = np.repeat(pins[:, 0], 3), (pins[:, 1:] - self.rest[self.node]).ravel()

        self.of_tet = gf.MeshFem(mesh, 1)
        self.of_tet.set_fem(gf.Fem('FEM_PK_DISCONTINUOUS(3,0)'))
        tet_of = np.empty(len(T), int)
        tet_of[[int(self.of_tet.basic_dof_from_cvid(t)[0][0]) for t in range(len(T))]] = np.arange(len(T))
        self.mu, self.k, patch_k, self.filled = (read(name)[tet_of] for name in ('shear.f64', 'bulk.f64', 'patch_bulk.f64', 'filled.f64'))
        self.gather_patches(patch[tet_of], patch_k)

    def gather_patches(self, patch, bulk):
        """Makes a field that is constant over each patch: reduces a field of tets to one unknown for each patch with a
        bulk modulus."""
        tissue = self.filled * self.integral(1, 'Test_q', ('q', 1, self.of_tet, np.zeros(len(patch))))
        stiff = np.bincount(patch, tissue * bulk)
        number = np.where(stiff > 0, np.cumsum(stiff > 0) - 1, -1)[patch]
        tets, patches = np.flatnonzero(number >= 0), int((stiff > 0).sum())
        share = 1 / np.bincount(number[tets], minlength=patches)
        spread, gather = gf.Spmat('empty', len(patch), patches), gf.Spmat('empty', patches, len(patch))
        for tet in tets:
            spread.add(int(tet), int(number[tet]), 1.0)
            gather.add(int(number[tet]), int(tet), float(share[number[tet]]))
        self.of_patch = gf.MeshFem(self.of_tet.linked_mesh(), 1)
        self.of_patch.set_fem(gf.Fem('FEM_PK_DISCONTINUOUS(3,0)'))
        self.of_patch.reduction_matrices(gather, spread)
        self.bulk = (stiff / np.bincount(patch, tissue))[stiff > 0]

        of = ('q', 1, self.of_patch, np.zeros(patches)), ('filled', 0, self.of_tet, self.filled), ('u', 0, self.field, self.u)
        mean = self.integral(1, 'filled*' + J + '*Test_q', *of) / self.integral(1, 'filled*Test_q', *of[:2])
        self.pressure = self.bulk * (mean - 1)

    def integral(self, order, what, *fields):
        return gf.asm_generic(self.mim, order, what, -1, *[word for field in fields for word in field])

    def constants(self):
        return (('mu', 0, self.of_tet, self.mu), ('k', 0, self.of_tet, self.k), ('softness', 0, self.of_patch, 1 / self.bulk), ('filled', 0, self.of_tet, self.filled),
                ('weak', 0, self.weak), ('below', 0, self.below))

    def energy(self, order):
        u, p = ('u', order, self.field, self.u), ('p', 0, self.of_patch, self.pressure)
        return self.integral(order, TET + PATCH, u, p, *self.constants())

    def model(self, with_patches):
        md = gf.Model('real')
        md.add_fem_variable('u', self.field)
        md.set_variable('u', self.u)
        if with_patches:
            md.add_fem_variable('p', self.of_patch)
            md.set_variable('p', self.pressure)
        for name, _, *value in self.constants():
            md.add_initialized_fem_data(name, *value) if len(value) == 2 else md.add_initialized_data(name, [value[0]])
        md.add_nonlinear_term(self.mim, TET + (PATCH if with_patches else ''), -1, 1, 0)
        md.add_explicit_matrix('u', 'u', gf.Spmat('diag', self.stiffness), 1, 0)
        md.add_explicit_rhs('u', self.stiffness * self.target)
        return md


def cpu_seconds(work):
    start = time.process_time()
    result = work()
    return time.process_time() - start, result


def newton(flesh, folder, name, with_patches):
    md = flesh.model(with_patches)
    md.assembly('build_all')  # compiles the formula
    assembly, _ = cpu_seconds(lambda: md.assembly('build_all'))
    unsymmetric, solution = cpu_seconds(lambda: gf.linsolve_mumps(md.tangent_matrix(), md.rhs()))
    whole, _ = cpu_seconds(lambda: md.solve('max_iter', 1, 'lsearch', 'simplest', 'max_res', 1e-30))
    print(name + '_assembly_seconds', assembly)
    print(name + '_lu_seconds', unsymmetric)
    print(name + '_iteration_seconds', whole)
    print(name + '_unknowns', md.nbdof())
    step = np.zeros_like(flesh.rest)
    first, count = md.interval_of_variable('u')
    step[flesh.node] = np.asarray(solution).ravel()[first:first + count].reshape(-1, 3)
    return step


gf.util_trace_level(0)
folder = Path(sys.argv[1])
flesh = Flesh(folder)
print('energy %.17g' % float(flesh.energy(0)))
forces = np.zeros_like(flesh.rest)
forces[flesh.node] = np.asarray(flesh.energy(1)).reshape(-1, 3)
forces.tofile(folder / 'forces.f64')
if 'newton' in sys.argv:
    newton(flesh, folder, 'tets', False)
    newton(flesh, folder, 'patches', True).tofile(folder / 'step.f64')
