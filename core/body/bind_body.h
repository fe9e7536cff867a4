// SPDX-License-Identifier: AGPL-3.0-or-later
// Binds a body to its rig: finds its seams and the weights by which its tissue follows the bones.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/base/file.h"
#include "core/base/progress.h"
#include "core/binding/heat_diffusion.h"
#include "core/body/body.h"
#include "core/bones/bone_parts.h"
#include "core/skin/skin_weights.h"
#include "core/volume/tissue_voxels.h"

namespace limber {

enum class Binding { Heat, Geodesic, Rigid };
std::vector<std::string> binding_words();  // returns the names of the methods: "heat", "geodesic", "rigid"
Binding require_binding(const std::string& word, const std::string& where);  // throws Error for an unknown word

// The seams of a body: voxel faces at which tissue touches without being connected. Empty: they are found
// automatically; null: there are none.
using SeamChoice = std::optional<std::shared_ptr<const Seams>>;

struct BoundBody {
  TissueVoxels tissue;  // the tissue voxels, with the seams
  SkinWeights weights;
  std::optional<BoneParts> parts;  // the parts of the body's bone tissue; empty until parts_of() is called
  WeightsReport solve;             // report on the solve of Binding::Heat
  bool is_from_file = false;       // true: the weights come from a file, so they may be of another rig or program
  std::vector<std::string> warnings;
};

// Computes the weights of a body. Throws Error if the body has no bones to follow, or if a solve fails.
BoundBody bind_body(const Body& body, Binding binding, const SeamChoice& seams, Progress& progress);
// Reads the weights of a body from a file or a folder. If `seams` is empty, uses the seams that the file names, else
// finds them.
BoundBody read_bound_body(const Body& body, const Path& weights, const SeamChoice& seams, Progress& progress);

// Returns the parts into which the body's bone tissue is split. They are computed at the first call, since splitting
// bones is slow.
const BoneParts& parts_of(const Body& body, BoundBody& bound, Progress& progress);

}  // namespace limber
