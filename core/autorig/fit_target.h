// SPDX-License-Identifier: AGPL-3.0-or-later
// The data that automatic rigging (core/autorig/auto_rig.h) fits to, and the body that it fits. Lengths in mm.
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

// The tissue and its bone, reduced to cells and surfaces.
struct FitTarget {
  Occupancy body, rough_body, bone_body;  // cells of tissue, coarser ones for paths through it, and cells of bone
  std::vector<TissueCut> cuts;
  double length = 0;  // diagonal of the tissue's extent, mm
  double cell = 0;    // largest side of a cell, mm
  std::optional<FitSurface> skin, bone;
  std::vector<glm::dvec3> bone_cells;  // centres of some thousand bone cells
};

// Reduces the volume to cells and surfaces. Throws Error for a volume without tissue.
FitTarget make_fit_target(const LabelVolume& volume);

// Adds the bone of these labels to the target; adds nothing where there is too little of it for a skeleton.
void add_bone(FitTarget& target, const LabelVolume& volume, const LabelSet& labels);

// Returns whether the skin has enough points to show the shape of a body.
bool has_shape(const FitTarget& target);

struct Fitted {
  std::shared_ptr<const BodyAtlas> atlas;  // the atlas that `body` refers to
  std::optional<Mannequin> body;
  double residual = 1e300;   // root mean square distance of `body` from the skin, mm; single distances are limited
  bool is_rods = false;      // true: the volume's bones are rods along a rig
  bool is_capsules = false;  // true: the atlas is made from the rig alone (capsule_atlas.h)
};

bool ends_with_any(const std::string& name, std::initializer_list<const char*> parts);

// Returns whether a name of the atlas's bones means a finger or the jaw.
bool is_digit(const std::string& name);

// Returns a byte per bone, 1 for `root` and its descendants.
std::vector<std::uint8_t> branch_of(const Armature& rig, int root);

}  // namespace limber
