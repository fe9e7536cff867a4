// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/deform/blend_rule.h"

namespace limber {

// Each rule is defined in a source file of core/deform/blends.
extern const BlendRule kMixedBlend;
extern const BlendRule kLinearBlend;
extern const BlendRule kDualQuaternionBlend;

namespace {

// The rules, in the order of enum Blend.
constexpr const BlendRule* kBlends[] = {
    &kMixedBlend,
    &kLinearBlend,
    &kDualQuaternionBlend,
};

}  // namespace

std::span<const BlendRule* const> blend_rules() { return kBlends; }

const BlendRule& rule_of(Blend blend) { return *kBlends[static_cast<std::size_t>(blend)]; }

std::optional<Blend> find_blend(std::string_view word) {
  for (std::size_t i = 0; i < std::size(kBlends); ++i)
    if (kBlends[i]->word == word) return static_cast<Blend>(i);
  return std::nullopt;
}

}  // namespace limber
