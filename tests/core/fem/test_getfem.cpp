// SPDX-License-Identifier: AGPL-3.0-or-later
// The energy of flesh against an independent program's: GetFEM, which integrates the same formula from its text.
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <random>

#include <doctest/doctest.h>

#include "core/fem/fem_energy.h"
#include "tests/support/fem_models.h"

using namespace limber;
namespace fs = std::filesystem;

namespace {
constexpr const char* kScript = R"(
import sys
import getfem as gf
mesh = gf.Mesh('empty', 3)
with open(sys.argv[1]) as file:
    nodes, tets = map(int, file.readline().split())
    rest = [list(map(float, file.readline().split())) for _ in range(nodes)]
    moved = [list(map(float, file.readline().split())) for _ in range(nodes)]
    corners = [file.readline().split() for _ in range(tets)]
mesh.add_point([[p[c] for p in rest] for c in range(3)])
trans = gf.GeoTrans('GT_PK(3,1)')
field = gf.MeshFem(mesh, 3)
shear, bulk = [], []
for row in corners:
    mesh.add_convex(trans, [[rest[int(v)][c] for v in row[:4]] for c in range(3)])
    shear.append(float(row[4]))
    bulk.append(float(row[5]))
field.set_fem(gf.Fem('FEM_PK(3,1)'))
of_tet = gf.MeshFem(mesh, 1)
of_tet.set_fem(gf.Fem('FEM_PK_DISCONTINUOUS(3,0)'))
place = {tuple(p): m for p, m in zip(rest, moved)}
dofs = field.basic_dof_nodes()
u = []
for k in range(field.nbdof()):
    p = tuple(dofs[c][k] for c in range(3))
    u.append(place[p][k % 3] - p[k % 3])
cells = [int(of_tet.basic_dof_from_cvid(c)[0][0]) for c in range(len(corners))]
mu, k = [0.0] * len(corners), [0.0] * len(corners)
for c, dof in enumerate(cells):
    mu[dof], k[dof] = shear[c], bulk[c]
value = gf.asm_generic(gf.MeshIm(mesh, gf.Integ('IM_TETRAHEDRON(1)')), 0,
    'mu/2*(Norm_sqr(Id(3)+Grad_u)-3) - mu*log(Det(Id(3)+Grad_u)) + k/2*sqr(Det(Id(3)+Grad_u)-1)', -1,
    'u', 0, field, u, 'mu', 0, of_tet, mu, 'k', 0, of_tet, k)
print('%.17g' % float(value))
)";

std::string output_of(const std::string& command) {
  std::string text;
  FILE* pipe = popen(command.c_str(), "r");
  for (char buffer[256]; pipe && std::fgets(buffer, sizeof buffer, pipe);) text += buffer;
  return pipe && pclose(pipe) == 0 ? text : "";
}
}  // namespace

TEST_CASE("elastic form: GetFEM finds the same energy to ten digits, where it is installed") {
  if (std::system("/usr/bin/python3 -c 'import getfem' >/dev/null 2>&1") != 0) {
    MESSAGE("SKIPPED: /usr/bin/python3 has no getfem (Debian's python3-getfem)");
    return;
  }
  const BarModel bar;
  const TetMesh& mesh = bar.fem.mesh;
  std::vector<TetMaterial> material;
  for (Eigen::Index t = 0; t < mesh.T.rows(); ++t) material.push_back({1.0 + t % 7, 0.05 * (t % 8)});
  const Places rest = mesh.V;
  std::mt19937 random(11);
  std::uniform_real_distribution<double> uniform(-1.2, 1.2);
  const Places x = rest + Places::NullaryExpr(rest.rows(), 3, [&] { return uniform(random); });
  REQUIRE(count_inverted(mesh.T, x) == 0);
  FemEnergy energy(rest, mesh.T, material, 0);

  const fs::path folder = fs::temp_directory_path() / ("limber-getfem-" + std::to_string(std::random_device{}()));
  fs::create_directories(folder);
  std::ofstream(folder / "energy.py") << kScript;
  {
    std::ofstream out(folder / "mesh.txt");
    out.precision(17);
    out << rest.rows() << ' ' << mesh.T.rows() << '\n';
    const Eigen::IOFormat plain(17, Eigen::DontAlignCols, " ", "\n");
    out << rest.format(plain) << '\n' << x.format(plain) << '\n';
    for (Eigen::Index t = 0; t < mesh.T.rows(); ++t)
      out << mesh.T.row(t).format(plain) << ' ' << material[t].shear_modulus << ' ' << tet_bulk(material[t]) << '\n';
  }
  const std::string text = output_of("/usr/bin/python3 " + (folder / "energy.py").string() + " " + (folder / "mesh.txt").string() + " 2>&1");
  fs::remove_all(folder);
  INFO(text);
  REQUIRE(!text.empty());
  const double theirs = std::strtod(text.c_str(), nullptr), ours = energy.value(x);
  MESSAGE("energy of ", mesh.T.rows(), " tets: ", ours, ", GetFEM differs by ", std::abs(ours - theirs) / ours);
  CHECK(theirs > 0);
  CHECK(std::abs(ours - theirs) < 1e-10 * ours);
}
