// SPDX-License-Identifier: AGPL-3.0-or-later
// The table of deformation methods: the skinning blends (deform/blend_rule.h), such as linear blending and dual
// quaternions, and finite elements. Commands, job files, studies, the guide and the editor read this table.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace limber {

enum class Blend;  // defined in deform/skinning.h

struct DeformationMethod {
  std::string word;            // id on the command line and in files: "dqs"
  std::string label;           // short name in lists and table columns: "DQ"
  std::string name;            // full name in a study: "Dual quaternions"
  std::string summary;         // short explanation of the method, shown after its word in --help
  std::string description;     // description of the method for a tooltip, a full sentence
  std::optional<Blend> blend;  // skinning blend of the method; none: the method is finite elements
};

inline constexpr std::string_view kFiniteElements = "fem";

// Returns all methods. The first one is the default.
std::span<const DeformationMethod> deformation_methods();
// Returns the method whose `word` (its name on the command line) equals the argument; null: there is no such method.
const DeformationMethod* find_method(std::string_view word);

// The methods that a command accepts: all, or only the skinning blends, for previews, which cannot compute finite
// elements.
enum class Methods { All, Blends };
std::vector<std::string> method_words(Methods which);
// Returns the methods' words with their summaries, such as "lbs (linear) or dqs (dual quaternions)".
std::string method_summaries(Methods which);

}  // namespace limber
