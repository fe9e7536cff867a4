// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/study/methods_text.h"

#include <doctest/doctest.h>

using namespace limber;

namespace {

bool has(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

CellResult reported(const std::string& report) { return {.report = report}; }

}  // namespace

TEST_CASE("study methods: the text has the parameters that the reports say were used, and only what was used") {
  Study study{.name = "E", .phantom = "arm", .repeats = 5, .spacings = {2.0}};
  study.techniques = techniques_of({"lbs", "fem-contact"}, "");
  const std::vector<CellResult> cells{
      reported(R"({"settings": {"glide": "joint"}, "total": {"voxels_before": 1234}})"),
      reported(R"({"settings": {"quality": "draft", "glide": "joint"}, "total": {"voxels_before": 1234},
        "mesh": {"tets": 777}, "solve": {"iterations": 50, "parameters": {"tet_mm": 8.125, "finest_tet_mm": 8.125,
        "step_degrees": 22.5, "step_tolerance_mm": 4, "tolerance_mm": 0.3, "joint_mm": 16, "contact_mm": 1.4}}})"),
      reported(R"({"solve": {"iterations": 70, "parameters": {"tet_mm": 9}}})")};
  const MethodsText text = methods_text(study, cells, false);
  for (const char* part : {"1234 voxels of tissue", "8.12 to 9\u00a0mm", "777 tetrahedra", "quality draft", "22.5°",
                           "0.3\u00a0mm", "50 to 70 iterations", "1.4\u00a0mm", "computed 5 times", "the same voxels",
                           "500 voxels or more", "Linear blend", "heat through the tissue\u00a0[1]"})
    CHECK_MESSAGE(has(text.paragraphs, part), part);
  for (const char* part : {"Baran", "Incremental potential contact", "F-bar", "Magnenat-Thalmann"})
    CHECK_MESSAGE(has(text.references, part), part);
  for (const char* part : {"Dionne", "dual quaternion", "TetGen", "Network flows"})
    CHECK_FALSE_MESSAGE(has(text.references, part), part);
  // References are numbered in the order in which the text cites them.
  std::size_t at = 0;
  for (int number = 1; has(text.paragraphs, "[" + std::to_string(number) + "]"); ++number) {
    const std::size_t first = text.paragraphs.find("[" + std::to_string(number) + "]");
    CHECK(first > at);
    at = first;
  }

  study.techniques = techniques_of({"dqs", "mix-mass-exact"}, "");
  study.weights = "geodesic";
  study.repeats = 1;
  study.phantom.clear();
  study.volume = "arm {1} & <2>.nrrd";
  const MethodsText other = methods_text(study, {}, false);
  for (const char* part : {"arm {1} &amp; &lt;2&gt;.nrrd", "shortest paths", "computed once", "cheapest paths"})
    CHECK_MESSAGE(has(other.paragraphs, part), part);
  CHECK_FALSE(has(other.paragraphs, "Finite elements"));
  CHECK_FALSE(has(methods_text(study, {}, true).paragraphs, "Weights of bones"));
}
