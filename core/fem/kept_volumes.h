// SPDX-License-Identifier: AGPL-3.0-or-later
// Keeps the volumes of whole tissues. The material of flesh keeps the volume of each patch of tets (patch_form.h), but
// a patch may contain several tissues, and compressible joints lie beside flesh: a thin muscle could grow by percents
// while its neighbours shrink. So after the solve each tissue gets a pressure of its own, the Lagrange multiplier of
// its volume, which is found in a few further solves [Uzawa's method; Nocedal & Wright, Numerical Optimization, 2006,
// chapter 17]: the pressure grows with the volume's error, by the stiffness that the last solve showed.
#pragma once

#include <vector>

#include "core/fem/material.h"
#include "core/fem/node_positions.h"
#include "core/mesh/tet_mesh.h"

namespace limber {

// A tissue whose volume a pose must keep.
struct KeptVolume {
  struct Part {
    int tet;
    double mm3;  // volume of the tissue in the tet, mm3
  };
  std::vector<Part> parts;
  double within;  // largest share by which the volume may change
};

class VolumeKeeper {
 public:
  VolumeKeeper(const TetMesh& mesh, const std::vector<KeptVolume>& kept, const std::vector<TetMaterial>& material);

  // Returns the pressures that all tissues together put on each tet, #T, kPa, for the next solve. Positive pressure
  // makes the tissue smaller. Returns an empty list if every volume is kept at x.
  std::vector<double> pressures_at(const NodePositions& x);
  // Returns the largest change of a volume at x, as a multiple of what is allowed.
  double worst_at(const NodePositions& x) const;

 private:
  double change_at(const KeptVolume& volume, const NodePositions& x) const;  // share of the volume at rest

  struct State {
    double pressure = 0, stiffness = 0;  // kPa
    double last_pressure = 0, last_change = 0;
    bool is_moved = false;  // true: the last call changed the pressure
  };
  const TetMesh& mesh_;
  const std::vector<KeptVolume>& kept_;
  std::vector<double> mm3_;    // #T: volume of each tet at rest, mm3
  std::vector<State> states_;  // one for each kept volume
};

}  // namespace limber
