// SPDX-License-Identifier: AGPL-3.0-or-later
// Contact without collision detection: the air around the skin is tetrahedra too, without nodes of its own, and may not
// invert [Mueller, Chentanez, Kim & Macklin 2015, Air Meshes for Robust Collision Handling; Jiang, Schaefer & Panozzo 2017,
// Simplicial Complex Augmentation Framework]. As long as no tet of flesh or air inverts, no surface can have passed another.
// Made anew at every step, from the shape there. Air costs next to nothing until it gets thin: then a barrier of a thickness
// in mm, not in shares of a tet, keeps skins apart; one that only knows shares would let the gap shrink tenfold a step.
#pragma once

#include <cstdint>

#include "core/fem/elastic_form.h"
#include "core/fem/places.h"

namespace limber {

struct AirSettings {
  double margin_mm = 60;      // of the box around the skin
  double shear_kpa = 1e-3;    // of air
  double barrier_kpa = 5;     // of the barrier,
  double thickness_mm = 2;    // which begins where a tet is thinner than this,
  double share = 0.5;         // or has less than this of its volume
  double thinnest_mm = 0.05;  // a tet that is thinner at the start counts as this thin: its barrier is of its own volume
};

// Air tets that change their shape from x (the shape now) to `next` (the shape as it may become): not those that only move as a
// rigid body, nor those without volume.
Eigen::MatrixX4i moving_air(const Eigen::MatrixX4i& air, const Places& x, const Places& next);

// Their energy, at rest at x.
ElasticForm air_form(const Eigen::MatrixX4i& T, const Places& x, const AirSettings& settings = {});

}  // namespace limber
