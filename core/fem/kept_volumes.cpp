// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/fem/kept_volumes.h"

#include <algorithm>
#include <cmath>

#include "core/fem/step_bound.h"

namespace limber {

namespace {
// Pressures aim at this share of the allowed change, so that the next solve ends within it.
constexpr double kAim = 0.5;
// First guess of a tissue's stiffness against a change of its volume, as a multiple of its shear modulus.
constexpr double kFirst = 32;
// Largest factor by which the guess changes from one solve to the next: neighbours change the volume too.
constexpr double kFactor = 4;
}  // namespace

VolumeKeeper::VolumeKeeper(const TetMesh& mesh, const std::vector<KeptVolume>& kept,
                           const std::vector<TetMaterial>& material)
    : mesh_(mesh),
      kept_(kept),
      states_(kept.size()) {
  for (Eigen::Index t = 0; t < mesh.T.rows(); ++t) mm3_.push_back(signed_volume(mesh.V, mesh.T.row(t)));
  for (std::size_t k = 0; k < kept.size(); ++k) {
    double shear = 0, all = 0;
    for (const auto& [tet, mm3] : kept[k].parts) shear += mm3 * material[tet].shear_modulus, all += mm3;
    states_[k].stiffness = kFirst * shear / std::max(all, 1e-300);
  }
}

double VolumeKeeper::change_at(const KeptVolume& volume, const NodePositions& x) const {
  double before = 0, after = 0;
  for (const auto& [tet, mm3] : volume.parts) {
    const auto& T = mesh_.T;
    before += mm3;
    after += mm3 * determinant(x, T(tet, 0), T(tet, 1), T(tet, 2), T(tet, 3)) / (6 * mm3_[tet]);
  }
  return before > 0 ? after / before - 1 : 0;
}

double VolumeKeeper::worst_at(const NodePositions& x) const {
  double worst = 0;
  for (const KeptVolume& volume : kept_) worst = std::max(worst, std::abs(change_at(volume, x)) / volume.within);
  return worst;
}

std::vector<double> VolumeKeeper::pressures_at(const NodePositions& x) {
  bool all_kept = true;
  std::vector<double> pressures(mesh_.T.rows(), 0);
  for (std::size_t k = 0; k < kept_.size(); ++k) {
    const KeptVolume& volume = kept_[k];
    State& state = states_[k];
    const double change = change_at(volume, x);
    if (std::abs(change) > volume.within) all_kept = false;
    if (state.is_moved && state.last_change != change) {
      const double shown = (state.pressure - state.last_pressure) / (state.last_change - change);
      state.stiffness = std::clamp(shown > 0 ? shown : kFactor * state.stiffness, state.stiffness / kFactor,
                                   state.stiffness * kFactor);
    }
    state.last_pressure = state.pressure;
    state.last_change = change;
    if (std::abs(change) > kAim * volume.within) {
      state.pressure += state.stiffness * change;
      state.is_moved = true;
    } else {
      state.is_moved = false;  // the next change comes from the neighbours' pressures
    }
    for (const auto& [tet, mm3] : volume.parts) pressures[tet] += state.pressure * mm3 / mm3_[tet];
  }
  if (all_kept) pressures.clear();
  return pressures;
}

}  // namespace limber
