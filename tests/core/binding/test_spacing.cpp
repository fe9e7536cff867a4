// SPDX-License-Identifier: AGPL-3.0-or-later
// Compares the weights of one arm on a fine and on a coarse grid.
#include <algorithm>
#include <cmath>

#include <doctest/doctest.h>

#include "core/binding/heat_diffusion.h"
#include "core/prepare/prepare.h"
#include "core/rig_io/rig_io.h"
#include "core/volume_io/volume_io.h"
#include "tests/support/shared_data.h"

using namespace limber;
using namespace limber::test;

namespace {
struct Weighted {
  LabelVolume volume;
  TissueVoxels tissue;
  SkinWeights weights;
  Weighted(LabelVolume of, const TissueTable& tissues, const Armature& armature)
      : volume(std::move(of)),
        tissue(volume),
        weights(diffuse_heat(volume, tissues, armature)) {}
  Influence at(const glm::ivec3& v) const {
    const int brick = tissue.brick_at(v);
    return weights.chunk(brick)[tissue.index_of(v) - tissue.bricks()[brick].first];
  }
};

// Returns the distance along `axis`, mm, over which the mean weight of `bone` in slices of 8 mm rises from 0.1 to 0.9.
double width_across(const Weighted& body, const TissueTable& tissues, const glm::dvec3& joint, const glm::dvec3& axis,
                    int bone) {
  constexpr int kHalf = 30;  // number of slices on either side of the joint, 4 mm apart
  const AffineTransform from_voxel = world_from_voxel(body.volume.grid);
  const std::vector<TissueKind> kinds = tissues.kinds();
  std::vector<double> sum(2 * kHalf + 1), count(2 * kHalf + 1);
  body.tissue.for_each([&](std::int64_t, const glm::ivec3& v) {
    if (is_bone(kinds[body.volume.at(v)])) return;
    const glm::dvec3 from_joint = from_voxel * glm::dvec3(v) - joint;
    if (glm::length(from_joint) > 140) return;
    const double along = glm::dot(from_joint, axis) / 4 + kHalf;
    for (int slice = static_cast<int>(std::floor(along)); slice <= std::floor(along) + 1; ++slice)
      if (slice >= 0 && slice < std::ssize(sum)) sum[slice] += body.at(v).of(bone), count[slice] += 1;
  });
  std::vector<double> mean(sum.size());
  for (size_t k = 0; k < sum.size(); ++k) mean[k] = count[k] > 0 ? sum[k] / count[k] : 0;
  const auto middle =
      static_cast<int>(std::find_if(mean.begin() + 10, mean.end(), [](double m) { return m > 0.5; }) - mean.begin());
  int low = middle, high = middle;
  while (low > 0 && mean[low] > 0.1) --low;
  while (high + 1 < std::ssize(mean) && mean[high] < 0.9) ++high;
  const double from = low + (0.1 - mean[low]) / (mean[low + 1] - mean[low]),
               to = high - (mean[high] - 0.9) / (mean[high] - mean[high - 1]);
  return 4 * (to - from);
}
}  // namespace

TEST_CASE("spacing: an arm at 2, 3 and 4 mm gets the same weights, and its elbow the same width" *
          doctest::test_suite("slow")) {
  NEEDS_SHARED("data/bender/man-arm-2mm.mha");
  const VolumeFile file = read_volume(shared_path("data/bender/man-arm-2mm.mha"));
  const Armature armature = read_armature(shared_path("data/bender/man-arm-2mm-armature.vtk"));
  const TissueTable tissues = merge_tissue_tables(file.tissues, nullptr);
  const int forearm = require_bone(armature, "Forearm"), humerus = require_bone(armature, "Humerus");
  auto direction = [&](int b) { return glm::normalize(armature.bones[b].tail - armature.bones[b].head); };
  const glm::dvec3 joint = armature.bones[forearm].head, axis = glm::normalize(direction(humerus) + direction(forearm));

  const Weighted fine(file.volume, tissues, armature);
  const double fine_width = width_across(fine, tissues, joint, axis, forearm);
  const AffineTransform from_fine = world_from_voxel(fine.volume.grid);
  for (double spacing : {3.0, 4.0}) {
    const Weighted coarse(regrid(file.volume, glm::dvec3(spacing)), tissues, armature);
    const AffineTransform to_coarse = voxel_from_world(coarse.volume.grid);
    const double width = width_across(coarse, tissues, joint, axis, forearm);

    // Differences of the weights at voxels that both grids have: the mean over all bones, and over the two bones of the
    // elbow.
    double difference = 0, at_elbow = 0;
    std::int64_t voxels = 0;
    fine.tissue.for_each([&](std::int64_t, const glm::ivec3& v) {
      const glm::ivec3 w(glm::round(to_coarse * (from_fine * glm::dvec3(v))));
      if (coarse.volume.at_or_air(w) == 0) return;
      ++voxels;
      for (int b = 0; b < std::ssize(armature.bones); ++b) {
        const double d = std::abs(fine.at(v).of(b) - coarse.at(w).of(b));
        difference += d / armature.bones.size();
        if (b == humerus || b == forearm) at_elbow += d / 2;
      }
    });
    MESSAGE(spacing, " mm: mean |dw| ", difference / voxels, ", of humerus and forearm ", at_elbow / voxels, "; width ",
            width, " of ", fine_width, " mm");
    CHECK(difference / voxels < 0.005);
    CHECK(at_elbow / voxels < 0.01);
    CHECK(std::abs(width / fine_width - 1) < 0.1);
  }
}
