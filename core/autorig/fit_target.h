// SPDX-License-Identifier: AGPL-3.0-or-later
// Defines the data to which automatic rigging (core/autorig/auto_rig.h) fits a body, and the fitted body. Lengths are
// in mm.
#pragma once

#include <initializer_list>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/autorig/articulated_fit.h"
#include "core/autorig/cut_planes.h"
#include "core/mesh/surface_points.h"
#include "core/volume/label_volume.h"

namespace limber {

// The tissue and the bone of a volume, reduced to grids of cells and to surface points.
struct FitTarget {
  // Cells of tissue, coarser cells of tissue for finding paths, and cells of bone.
  Occupancy body, rough_body, bone_body;
  std::vector<TissueCut> cuts;
  double length = 0;  // diagonal of the tissue's extent, mm
  double cell = 0;    // largest side of a cell, mm
  std::optional<FitSurface> skin, bone;
  std::vector<glm::dvec3> bone_cells;  // centres of at most a few thousand cells of bone, evenly spread
};

// Reduces a label volume to grids of cells and to surface points. Throws Error for a volume without tissue.
FitTarget make_fit_target(const LabelVolume& volume);

// Adds the bone tissue that has these labels to the target. Adds nothing if the amount is too small for a skeleton.
void add_bone(FitTarget& target, const LabelVolume& volume, const LabelSet& labels);

// Returns true if the skin has enough points to show the shape of a body.
bool has_shape(const FitTarget& target);

struct Fitted {
  std::shared_ptr<const BodyAtlas> atlas;  // the atlas that `body` refers to
  std::optional<Mannequin> body;
  double residual = 1e300;   // root mean square distance of `body` from the skin, mm; each distance is capped
  bool is_rods = false;      // true: the volume's bones are rods (round bars along a rig)
  bool is_capsules = false;  // true: the atlas is made from the rig alone (capsule_atlas.h)
};

bool ends_with_any(const std::string& name, std::initializer_list<const char*> parts);

// Returns true if `name`, a bone's name in the atlas, means a finger or the jaw.
bool is_digit(const std::string& name);

// Returns a byte per bone, 1 for `root` and its descendants.
std::vector<std::uint8_t> branch_of(const Armature& rig, int root);

}  // namespace limber
