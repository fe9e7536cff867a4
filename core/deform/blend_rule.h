// SPDX-License-Identifier: AGPL-3.0-or-later
// The ways to blend the motions of bones, as one table: resampling, previews, commands, studies and the editor's lists
// of methods read it. A new blend is one source in core/deform/blends and its line of kBlends in blend_rule.cpp.
#pragma once

#include <span>
#include <string_view>

#include "core/deform/skinning.h"

namespace limber {

struct BlendRule {
  using Point = glm::dvec3 (*)(std::span<const SkinTransform> bones, std::span<const BoneWeight> influences,
                               const glm::dvec3& rest_point);

  const char* word;         // on the command line and in files: "dqs"
  const char* label;        // in lists and columns: "DQ"
  const char* name;         // in a study: "Dual quaternions"
  const char* summary;      // behind the word in --help: "dual quaternions"
  const char* description;  // for a tooltip, a sentence

  Point point;            // returns the posed point where no bone stretches
  Point stretched_point;  // returns it where bones may stretch

  bool sums_displacements;     // a SkinTransform of several bones needs the sum of their displacements
  bool sums_dual_quaternions;  // it needs the sum of their dual quaternions
  bool settles_flesh;          // flesh gets its volume back after blending (settled_flesh.h)
};

// The table's rows; the first is taken where no method is named. Row i is the rule of Blend i.
std::span<const BlendRule* const> blend_rules();

const BlendRule& rule_of(Blend blend);

}  // namespace limber
