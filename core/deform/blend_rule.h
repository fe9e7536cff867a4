// SPDX-License-Identifier: AGPL-3.0-or-later
// A table of the methods that blend the motions of bones. Resampling, previews, commands, studies and the editor's
// lists of methods read it. To add a blend, add one source file in core/deform/blends and one line to kBlends in
// blend_rule.cpp.
#pragma once

#include <span>
#include <string_view>

#include "core/deform/four_points.h"
#include "core/deform/skinning.h"

namespace limber {

// The weights by which four points follow one bone.
struct alignas(sizeof(FourNumbers)) FourWeights {
  int bone;
  FourNumbers weight;
};

struct BlendRule {
  using Point = glm::dvec3 (*)(std::span<const SkinTransform> bones, std::span<const BoneWeight> influences,
                               const glm::dvec3& rest_point);
  using Four = void (*)(std::span<const SkinTransform> bones, std::span<const FourWeights> influences,
                        FourPoints& points);

  const char* word;         // on the command line and in files: "dqs"
  const char* label;        // in lists and columns: "DQ"
  const char* name;         // in a study: "Dual quaternions"
  const char* summary;      // behind the word in --help: "dual quaternions"
  const char* description;  // one sentence, for a tooltip

  Point point;            // returns the posed point if no bone stretches
  Point stretched_point;  // returns the posed point if bones may stretch
  // Replace four rest points by the points that `point` returns for each, bit for bit. The second needs AVX2.
  Four four_points, four_points_wide;

  bool sums_displacements;     // blending SkinTransforms needs the sum of the bones' displacements
  bool sums_dual_quaternions;  // blending SkinTransforms needs the sum of the bones' dual quaternions
  bool settles_flesh;          // corrects the volume of flesh after blending (settled_flesh.h)
};

// Returns the rows of the table; the first is the default method. Row i is the rule of Blend i.
std::span<const BlendRule* const> blend_rules();

const BlendRule& rule_of(Blend blend);

}  // namespace limber
