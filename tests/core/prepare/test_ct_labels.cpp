// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/prepare/ct_labels.h"

#include <map>
#include <random>

#include <doctest/doctest.h>

#include "core/base/error.h"
#include "core/base/parallel.h"

using namespace limber;

namespace {

enum class Truth { Air, Table, Fat, Soft, Lung, Gas, Bone };

constexpr std::array<double, 7> kDensity = {-1000, -150, -100, 50, -750, -1000, 700};

// A CT of a trunk with two arms on a thin table: fat around flesh, two lungs whose windpipe is open to the outside at
// the neck, gas in the bowel, a spine, and arm bones whose marrow is as dense as flesh.
struct Scan {
  Grid grid{{110, 80, 90}, {4, 4, 4}, {-218, -158, -178}, glm::dmat3(1)};
  std::vector<Truth> truth;
  std::vector<float> values;

  explicit Scan(double noise = 15) {
    std::mt19937 random(5);
    std::normal_distribution<double> normal(0, noise);
    const AffineTransform world = world_from_voxel(grid);
    for (int z = 0; z < grid.size.z; ++z)
      for (int y = 0; y < grid.size.y; ++y)
        for (int x = 0; x < grid.size.x; ++x) {
          truth.push_back(at(world * glm::dvec3(x, y, z)));
          values.push_back(static_cast<float>(kDensity[static_cast<std::size_t>(truth.back())] + normal(random)));
        }
  }
  static Truth at(const glm::dvec3& p) {
    const auto ellipse = [](double x, double y, double a, double b) { return x * x / (a * a) + y * y / (b * b); };
    if (std::abs(p.y - 118) <= 3 && std::abs(p.x) < 190) return Truth::Table;
    if (std::abs(p.z) > 150) return Truth::Air;
    for (const double side : {-1.0, 1.0}) {
      const double r = glm::length(glm::dvec2(p.x - side * 182, p.y));
      const bool in_bone = r < 13 && std::abs(p.z) < 132, in_marrow = r < 7 && std::abs(p.z) < 124;
      if (r < 28) return in_bone && !in_marrow ? Truth::Bone : r < 22 ? Truth::Soft : Truth::Fat;
    }
    const double trunk = ellipse(p.x, p.y, 130, 95);
    if (glm::length(glm::dvec2(p.x, p.y + 40)) < 10 && p.z > 60) return Truth::Air;  // windpipe
    if (trunk > 1) return Truth::Air;
    if (ellipse(p.x, p.y, 115, 80) > 1) return Truth::Fat;
    if (glm::length(glm::dvec2(p.x, p.y - 50)) < 20) return Truth::Bone;
    for (const double side : {-1.0, 1.0})
      if (ellipse(p.x - side * 55, p.y + 10, 42, 45) + (p.z - 60) * (p.z - 60) / (70.0 * 70) < 1) return Truth::Lung;
    // This air connects the windpipe to the lungs.
    if (std::abs(p.x) < 20 && std::abs(p.y + 40) < 8 && p.z > 55 && p.z < 64) return Truth::Air;
    if (glm::length(p - glm::dvec3(30, 0, -80)) < 22) return Truth::Gas;
    return Truth::Soft;
  }
  GreyLevels image() const { return grey_levels(grid, values); }
};

// Returns two shares: of the voxels with this truth, those that have the named label (recall), and of the voxels with
// this label, those that have the truth (precision).
std::pair<double, double> found(const Scan& scan, const CtLabels& labels, Truth truth, const std::string& name) {
  double both = 0, true_ones = 0, named = 0;
  for (std::size_t i = 0; i < scan.truth.size(); ++i) {
    const Tissue* tissue = labels.tissues.find(labels.volume.voxels[i]);
    const bool is_named = tissue && tissue->name == name, is_true = scan.truth[i] == truth;
    both += is_named && is_true;
    true_ones += is_true;
    named += is_named;
  }
  return {both / std::max(true_ones, 1.0), both / std::max(named, 1.0)};
}

}  // namespace

TEST_CASE("labels of a CT: bone, lung, gas and fat are found, and the table is not") {
  const Scan scan;
  const CtLabels labels = labels_of_ct(scan.image());
  CHECK(labels.volume.grid == scan.grid);
  for (const auto& [truth, name, least] :
       {std::tuple{Truth::Bone, "Bone", 0.9}, {Truth::Lung, "Lung", 0.9}, {Truth::Gas, "Gas", 0.9}}) {
    const auto [recall, precision] = found(scan, labels, truth, name);
    INFO(std::string(name) << " " << recall << " " << precision);
    CHECK(recall > least);
    CHECK(precision > 0.8);
  }
  // Fat lies under the skin, which takes the outermost voxels.
  CHECK(found(scan, labels, Truth::Fat, "Fat").first + found(scan, labels, Truth::Fat, "Skin").first > 0.9);
  double table = 0, wrong = 0, bare = 0, surface = 0;
  for (std::size_t i = 0; i < scan.truth.size(); ++i) {
    table += scan.truth[i] == Truth::Table;
    wrong += scan.truth[i] == Truth::Table && labels.volume.voxels[i];
  }
  CHECK(wrong == 0);
  CHECK(table > 1000);
  // The marrow of the arm is labelled as bone, although it is as dense as flesh.
  CHECK(labels.tissues.find(labels.volume.at({9, 39, 45}))->name == "Bone");
  // Skin closes the body below the windpipe: only skin has a face towards air.
  const glm::ivec3 size = scan.grid.size;
  for (int z = 20; z < 56; ++z)
    for (int y = 1; y + 1 < size.y; ++y)
      for (int x = 1; x + 1 < size.x; ++x) {
        const Label label = labels.volume.at({x, y, z});
        if (!label) continue;
        const bool at_air = !labels.volume.at({x - 1, y, z}) || !labels.volume.at({x + 1, y, z}) ||
                            !labels.volume.at({x, y - 1, z}) || !labels.volume.at({x, y + 1, z});
        const Tissue& tissue = *labels.tissues.find(label);
        surface += at_air;
        bare += at_air && tissue.name != "Skin";
      }
  CHECK(surface > 1000);
  CHECK(bare == 0);
}

TEST_CASE("labels of a CT: two threads and one give the same labels") {
  const Scan scan;
  const CtLabels all = labels_of_ct(scan.image());
  const ThreadCount one(1);
  CHECK(labels_of_ct(scan.image()).volume.voxels == all.volume.voxels);
}

TEST_CASE("labels of a CT: what is no CT, no body or no order of thresholds is refused in a sentence") {
  const Grid grid{{20, 20, 20}, glm::dvec3(2), glm::dvec3(0), glm::dmat3(1)};
  const std::vector<float> air(8000, -1000);
  CHECK_THROWS_WITH_AS(labels_of_ct(grey_levels(grid, air)), doctest::Contains("no body was found"), Error);
  std::vector<float> sheet = air;  // 4 mm thick, like a blanket
  for (std::size_t i = 0; i < 800; ++i) sheet[3200 + i] = 40;
  CHECK_THROWS_WITH_AS(labels_of_ct(grey_levels(grid, sheet)), doctest::Contains("no body was found"), Error);
  CHECK_THROWS_WITH_AS(labels_of_ct(grey_levels(grid, air), {.soft = 300}), doctest::Contains("must ascend"), Error);
}

TEST_CASE("labels of a CT: a body that reaches the borders of the image is labelled up to them") {
  const Grid grid{{30, 30, 30}, glm::dvec3(2), glm::dvec3(0), glm::dmat3(1)};
  std::vector<float> values(27000, 40);
  values[0] = -1000;
  const CtLabels labels = labels_of_ct(grey_levels(grid, values));
  for (std::size_t i = 6000; i < labels.volume.voxels.size(); ++i) CHECK_MESSAGE(labels.volume.voxels[i] != 0, i);
  CHECK_THROWS_WITH_AS(labels_of_ct(grey_levels(grid, std::vector<float>(27000, 40))),
                       doctest::Contains("it has no air"), Error);
}

namespace {

// A magnitude MR image of a leg along z: bright fat around muscle with a quarter of its signal, cortical bone without
// signal around bright marrow, and Rician noise everywhere.
struct LegMr {
  Grid grid{{64, 64, 40}, glm::dvec3(2), glm::dvec3(0), glm::dmat3(1)};
  std::vector<float> values;
  std::vector<bool> is_body;
  std::mt19937 random{7};

  LegMr() {
    std::normal_distribution<double> noise(0, 12);
    for (int z = 0; z < grid.size.z; ++z)
      for (int y = 0; y < grid.size.y; ++y)
        for (int x = 0; x < grid.size.x; ++x) {
          const double r = std::hypot(2 * x - 63.0, 2 * y - 61.0);
          const double signal = r < 8 ? 500 : r < 14 ? 0 : r < 40 ? 150 : r < 46 ? 620 : 0;
          const double real = signal + noise(random), imaginary = noise(random);
          values.push_back(static_cast<float>(std::hypot(real, imaginary)));
          is_body.push_back(r < 46);
        }
  }
};

}  // namespace

TEST_CASE("labels of a body: the histogram of an MR gives a threshold that parts noise from dark muscle") {
  const LegMr leg;
  const GreyLevels image = grey_levels(leg.grid, leg.values);
  const double threshold = body_threshold(image);
  CHECK(threshold > 40);   // the noise has a mean of 15
  CHECK(threshold < 130);  // muscle has a value of 150
  const CtLabels labels = labels_of_body(image, threshold);
  double wrong = 0;
  for (std::size_t i = 0; i < leg.is_body.size(); ++i) wrong += leg.is_body[i] != (labels.volume.voxels[i] != 0);
  CHECK(wrong < 0.01 * double(leg.is_body.size()));
  REQUIRE(labels.tissues.tissues.size() == 2);  // skin and soft tissue; dark bone must not become air
  CHECK(labels.tissues.find(labels.volume.at({32, 31, 20}))->name == "Soft tissue");
  CHECK(labels.tissues.find(labels.volume.at({37, 31, 20}))->name == "Soft tissue");  // this voxel is cortical bone
  CHECK(labels.tissues.find(labels.volume.at({54, 31, 20}))->name == "Skin");
  const ThreadCount one(1);
  CHECK(labels_of_body(image, threshold).volume.voxels == labels.volume.voxels);
}

TEST_CASE("labels of a body: a threshold that parts nothing is refused in a sentence, and a constant image has one") {
  const LegMr leg;
  const GreyLevels image = grey_levels(leg.grid, leg.values);
  CHECK_THROWS_WITH_AS(labels_of_body(image, -1), doctest::Contains("no value is below"), Error);
  CHECK_THROWS_WITH_AS(labels_of_body(image, 1e6), doctest::Contains("no body was found"), Error);
  const Grid grid{{4, 4, 4}, glm::dvec3(2), glm::dvec3(0), glm::dmat3(1)};
  CHECK(body_threshold(grey_levels(grid, std::vector<float>(64, 5))) == 5);
}
