// SPDX-License-Identifier: AGPL-3.0-or-later
// The material of hyperelastic tissue, per tet (kPa, mm). Its energy density is
//    W = mu/2 (|F|^2 - 3) - mu ln J + lambda/2 (J - 1)^2,   J = det F > 0
// [the compressible neo-Hookean energy of Bonet & Wood 2008, with the volume term in J]. The energy is zero at rest and
// for rotations, and infinite for inverted tets. With a large lambda, linear tets lock (become far too stiff). So
// lambda is split: the value for a Poisson ratio of at most 0.4 acts on each tet; the remainder acts on the mean of J
// over a patch of tets (patch_form.h).
#pragma once

#include <algorithm>

namespace limber {

struct TetMaterial {
  double shear_modulus = 1;    // shear modulus mu, kPa, above 0
  double poisson_ratio = 0.4;  // Poisson ratio, [0, 0.5)
  double filled = 1;           // share of the tet that is tissue, above 0; weight of the tet in its patch's mean of J
};

inline double lame_lambda(double shear_modulus, double poisson_ratio) {
  return 2 * shear_modulus * poisson_ratio / (1 - 2 * poisson_ratio);
}

// Return the part of lambda that acts on each tet and the part that acts on the patch, kPa.
inline double tet_bulk(const TetMaterial& m) { return lame_lambda(m.shear_modulus, std::min(m.poisson_ratio, 0.4)); }
inline double patch_bulk(const TetMaterial& m) { return lame_lambda(m.shear_modulus, m.poisson_ratio) - tet_bulk(m); }

}  // namespace limber
