// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/resample/deformation_method.h"

#include "core/deform/blend_rule.h"

namespace limber {

namespace {

std::vector<DeformationMethod> all_methods() {
  std::vector<DeformationMethod> methods;
  for (std::size_t i = 0; i < blend_rules().size(); ++i) {
    const BlendRule& rule = *blend_rules()[i];
    methods.push_back({rule.word, rule.label, rule.name, rule.summary, rule.description, static_cast<Blend>(i)});
  }
  methods.push_back(
      {std::string(kFiniteElements), "FEM", "FEM", "finite elements",
       "Finite elements: tissue keeps its volume, and skin presses against skin. Runs in the background for minutes.",
       std::nullopt});
  return methods;
}

}  // namespace

std::span<const DeformationMethod> deformation_methods() {
  static const std::vector<DeformationMethod> kMethods = all_methods();
  return kMethods;
}

const DeformationMethod* find_method(std::string_view word) {
  for (const DeformationMethod& method : deformation_methods())
    if (method.word == word) return &method;
  return nullptr;
}

std::vector<std::string> method_words(Methods which) {
  std::vector<std::string> words;
  for (const DeformationMethod& method : deformation_methods())
    if (method.blend || which == Methods::All) words.push_back(method.word);
  return words;
}

std::string method_summaries(Methods which) {
  const std::vector<std::string> words = method_words(which);
  std::string text;
  for (std::size_t i = 0; i < words.size(); ++i)
    text += (i == 0                  ? ""
             : i + 1 == words.size() ? " or "
                                     : ", ") +
            words[i] + " (" + find_method(words[i])->summary + ")";
  return text;
}

}  // namespace limber
