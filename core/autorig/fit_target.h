// SPDX-License-Identifier: AGPL-3.0-or-later
// What automatic rigging (core/autorig/auto_rig.h) fits to, and what it fits.
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
  Occupancy body, rough_body, bone_body;  // rough enough for ways through it
  std::vector<TissueCut> cuts;
  double length = 0;  // mm, diagonal of the tissue's extent
  double cell = 0;    // mm, the largest side of a cell
  std::optional<FitSurface> skin, bone;
  std::vector<glm::dvec3> bone_cells;  // centres, some thousands
};

// Throws Error for a volume without tissue.
FitTarget make_fit_target(const LabelVolume& volume);

// The bone of these labels; nothing where they are no skeleton.
void add_bone(FitTarget& target, const LabelVolume& volume, const LabelSet& labels);

// Too few points of surface say nothing of a body.
bool has_shape(const FitTarget& target);

struct Fitted {
  std::shared_ptr<const BodyAtlas> atlas;  // the mannequin stands on it
  std::optional<Mannequin> body;
  double residual = 1e300;  // mm
  bool is_rods = false;
  bool is_capsules = false;  // of a body that only its rig tells of
};

bool ends_with_any(const std::string& name, std::initializer_list<const char*> parts);

// Fingers and jaw, by the names of the atlas's bones.
bool is_digit(const std::string& name);

// A byte per bone, 1 for `root` and what hangs from it.
std::vector<std::uint8_t> branch_of(const Armature& rig, int root);

}  // namespace limber
