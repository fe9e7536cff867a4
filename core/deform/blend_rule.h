// SPDX-License-Identifier: AGPL-3.0-or-later
// A table of the methods that blend the motions of bones. Resampling, previews, commands, studies and the editor's
// lists of methods read this table. To add a blend, add one source file in core/deform/blends and one line to kBlends
// in blend_rule.cpp.
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

  const char* word;         // id on the command line and in files: "dqs"
  const char* label;        // short name in lists and table columns: "DQ"
  const char* name;         // full name in a study: "Dual quaternions"
  const char* summary;      // short explanation after the word in --help: "dual quaternions"
  const char* description;  // tooltip, one sentence

  Point point;            // returns the posed point if no bone stretches
  Point stretched_point;  // returns the posed point if bones may stretch
  // Replace four rest points by their posed points, equal to those of `point` bit for bit. four_points_wide needs AVX2.
  Four four_points, four_points_wide;

  bool sums_displacements;     // true: the blend needs the weighted sum of SkinTransform::displacement
  bool sums_dual_quaternions;  // true: the blend needs the weighted sum of SkinTransform::dual_quaternion
  bool settles_flesh;          // true: the volume of flesh is corrected after blending (settled_flesh.h)
};

// Returns the rows of the table. The first row is the default method. Row i is the rule of the i-th value of Blend.
std::span<const BlendRule* const> blend_rules();

const BlendRule& rule_of(Blend blend);

}  // namespace limber
