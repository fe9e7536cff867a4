// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/resample/deformation_method.h"

#include <set>

#include <doctest/doctest.h>

#include "core/deform/blend_rule.h"

using namespace limber;

TEST_CASE("methods: every blend and finite elements are in the table once, and the first blends") {
  const auto methods = deformation_methods();
  REQUIRE(methods.size() == blend_rules().size() + 1);
  REQUIRE(methods.front().blend.has_value());
  CHECK(methods.front().word == "mix");
  std::set<std::string> words, labels;
  for (const DeformationMethod& method : methods) {
    CAPTURE(method.word);
    CHECK(words.insert(method.word).second);
    CHECK(labels.insert(method.label).second);
    CHECK(find_method(method.word) == &method);
    CHECK(method.blend == find_blend(method.word));
  }
  CHECK(find_method("fem") == &methods.back());
  CHECK(find_method("FEM") == nullptr);
}

TEST_CASE("methods: commands that draw previews offer blends only") {
  const std::vector<std::string> all = method_words(Methods::All), blends = method_words(Methods::Blends);
  CHECK(all.size() == blends.size() + 1);
  CHECK(all.back() == kFiniteElements);
  CHECK(method_summaries(Methods::All).ends_with(" or fem (finite elements)"));
  CHECK(method_summaries(Methods::Blends).find("fem") == std::string::npos);
  for (const std::string& word : blends)
    CHECK(method_summaries(Methods::Blends).find(word + " (") != std::string::npos);
}
