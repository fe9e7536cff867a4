// SPDX-License-Identifier: AGPL-3.0-or-later
// The methods by which a pose moves tissue, as one table: every blend (deform/blend_rule.h), then finite elements.
// Commands, job files, studies, the guide and the editor's lists of methods read it.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace limber {

enum class Blend;  // of deform/skinning.h

struct DeformationMethod {
  std::string word;            // on the command line and in files: "dqs"
  std::string label;           // in lists and columns: "DQ"
  std::string name;            // in a study: "Dual quaternions"
  std::string summary;         // explanation that follows the word in --help
  std::string description;     // a full sentence, for a tooltip
  std::optional<Blend> blend;  // none: finite elements
};

inline constexpr std::string_view kFiniteElements = "fem";

// Returns all methods. The first one is the default.
std::span<const DeformationMethod> deformation_methods();
// Returns the method with this word; null where there is none.
const DeformationMethod* find_method(std::string_view word);

// The methods that a command accepts: all of them, or only the blends (skinning), since previews cannot draw finite
// elements.
enum class Methods { All, Blends };
std::vector<std::string> method_words(Methods which);
// Returns a list of words with their summaries, such as "lbs (linear) or dqs (dual quaternions)".
std::string method_summaries(Methods which);

}  // namespace limber
