// SPDX-License-Identifier: AGPL-3.0-or-later
// Computes the energy of flesh by an independent program, GetFEM (Debian's python3-getfem). GetFEM integrates the
// energy from the text of its formula, and takes Newton steps by the solver MUMPS (tests/support/getfem_flesh.py).
#pragma once

#include <fstream>
#include <map>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "core/fem/fem_energy.h"
#include "core/fem/patch_form.h"
#include "tests/support/program.h"

namespace limber::test {

struct Flesh {
  NodePositions rest, moved;
  Eigen::MatrixX4i T;
  std::vector<TetMaterial> material;  // material of each tet
  double weak_barrier_kpa = 0;
  PinForm pins = {};
};

struct GetfemAnswer {
  double energy = 0;           // energy of the flesh, without that of the pins' springs
  NodePositions forces, step;  // for each node: gradient of the energy; Newton step with the springs, if asked for
  std::map<std::string, double> number;  // every number that GetFEM printed, by name
};

inline bool has_getfem() { return run_program("/usr/bin/python3", {"-c", "import getfem"}).exit_code == 0; }

namespace detail {
template <class Number>
void write_numbers(const std::filesystem::path& path, const Number* first, std::size_t count) {
  std::ofstream(path, std::ios::binary)
      .write(reinterpret_cast<const char*>(first), std::streamsize(count * sizeof(Number)));
}

inline NodePositions read_places(const std::filesystem::path& path, Eigen::Index rows) {
  NodePositions places(rows, 3);
  std::ifstream file(path, std::ios::binary);
  file.read(reinterpret_cast<char*>(places.data()), std::streamsize(places.size() * sizeof(double)));
  if (!file) throw std::runtime_error(path.string() + " cannot be read");
  return places;
}
}  // namespace detail

// Runs GetFEM on the flesh. Throws std::runtime_error with GetFEM's output when it fails.
//   newton  true: also computes a Newton step
inline GetfemAnswer ask_getfem(const Flesh& flesh, bool newton = false) {
  const TemporaryFolder folder;
  const std::size_t tets = flesh.material.size();
  std::vector<double> shear, bulk, patch, filled, pins(4 * flesh.rest.rows(), 0.0);
  for (const TetMaterial& m : flesh.material)
    shear.push_back(m.shear_modulus), bulk.push_back(tet_bulk(m)), patch.push_back(patch_bulk(m)),
        filled.push_back(m.filled);
  const PatchOrder order = grow_patches(flesh.rest, flesh.T, patch, shear);
  std::vector<std::int32_t> patch_of(tets);
  for (std::size_t p = 0; p + 1 < order.first.size(); ++p)
    for (auto k = order.first[p]; k < order.first[p + 1]; ++k) patch_of[order.tet[k]] = std::int32_t(p);
  for (std::size_t k = 0; k < flesh.pins.node.size(); ++k) {
    double* pin = &pins[4 * flesh.pins.node[k]];
    pin[0] = flesh.pins.stiffness(k, 0);
    for (int c = 0; c < 3; ++c) pin[1 + c] = flesh.pins.target(k, c);
  }
  const Eigen::Matrix<std::int32_t, Eigen::Dynamic, 4, Eigen::RowMajor> corners = flesh.T;
  const double weak[2] = {flesh.weak_barrier_kpa, 0.4};
  detail::write_numbers(folder / "rest.f64", flesh.rest.data(), flesh.rest.size());
  detail::write_numbers(folder / "moved.f64", flesh.moved.data(), flesh.moved.size());
  detail::write_numbers(folder / "tets.i32", corners.data(), corners.size());
  detail::write_numbers(folder / "shear.f64", shear.data(), tets);
  detail::write_numbers(folder / "bulk.f64", bulk.data(), tets);
  detail::write_numbers(folder / "patch_bulk.f64", patch.data(), tets);
  detail::write_numbers(folder / "filled.f64", filled.data(), tets);
  detail::write_numbers(folder / "patch.i32", patch_of.data(), tets);
  detail::write_numbers(folder / "weak.f64", weak, 2);
  detail::write_numbers(folder / "pins.f64", pins.data(), pins.size());

  std::vector<std::string> words{"OMP_NUM_THREADS=1", "/usr/bin/python3",
                                 LIMBER_SOURCE_DIR "/tests/support/getfem_flesh.py", folder.path().string()};
  if (newton) words.push_back("newton");
  const ProgramRun run = run_program("/usr/bin/env", words);
  if (run.exit_code != 0) throw std::runtime_error("GetFEM failed: " + run.out + run.err);

  GetfemAnswer answer;
  std::istringstream lines(run.out);
  std::string name;
  for (double number; lines >> name >> number;) answer.number[name] = number;
  answer.energy = answer.number.at("energy");
  answer.forces = detail::read_places(folder / "forces.f64", flesh.rest.rows());
  if (newton) answer.step = detail::read_places(folder / "step.f64", flesh.rest.rows());
  return answer;
}

}  // namespace limber::test
