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
  std::string summary;         // behind the word in --help
  std::string description;     // for a tooltip, a sentence
  std::optional<Blend> blend;  // nothing: finite elements
};

inline constexpr std::string_view kFiniteElements = "fem";

// The first is taken where none is named.
std::span<const DeformationMethod> deformation_methods();
// Null where no method has this word.
const DeformationMethod* find_method(std::string_view word);

// What a command may take: all methods, or only the blends, which previews can draw.
enum class Methods { All, Blends };
std::vector<std::string> method_words(Methods which);
// "mix (between the two, ...), lbs (linear) or dqs (dual quaternions)"
std::string method_summaries(Methods which);

}  // namespace limber
