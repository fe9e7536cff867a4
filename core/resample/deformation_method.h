// SPDX-License-Identifier: AGPL-3.0-or-later
// The table of the methods by which a pose moves tissue: every blend, that is a rule of skinning
// (deform/blend_rule.h), then finite elements. Commands, job files, studies, the guide and the editor read this table.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace limber {

enum class Blend;  // of deform/skinning.h

struct DeformationMethod {
  std::string word;            // id on the command line and in files: "dqs"
  std::string label;           // short name in lists and table columns: "DQ"
  std::string name;            // full name in a study: "Dual quaternions"
  std::string summary;         // short explanation of the method, shown after its word in --help
  std::string description;     // description of the method for a tooltip, a full sentence
  std::optional<Blend> blend;  // none: finite elements
};

inline constexpr std::string_view kFiniteElements = "fem";

// Returns all methods. The first one is the default.
std::span<const DeformationMethod> deformation_methods();
// Returns the method whose `word` (its name on the command line) this is; null: there is none.
const DeformationMethod* find_method(std::string_view word);

// The methods that a command accepts: all of them, or only the blends (skinning), since previews cannot draw finite
// elements.
enum class Methods { All, Blends };
std::vector<std::string> method_words(Methods which);
// Returns a list of words with their summaries, such as "lbs (linear) or dqs (dual quaternions)".
std::string method_summaries(Methods which);

}  // namespace limber
