// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/skin/smooth_weights.h"

#include <cmath>
#include <numeric>

#include <doctest/doctest.h>

#include "core/base/parallel.h"
#include "core/binding/heat_diffusion.h"
#include "core/resample/resample.h"
#include "core/rig_io/rig_io.h"
#include "core/volume_io/volume_io.h"
#include "tests/core/skin/painted.h"
#include "tests/support/shared_data.h"

using namespace limber;
using namespace limber::test;

namespace {

constexpr double kLength = 240, kRadius = 36;

// Makes a cylinder of muscle along z whose second bone begins in its middle.
Painted cylinder(double spacing) {
  SmallBody body;
  const int across = static_cast<int>(std::ceil(2 * kRadius / spacing)) + 4;
  const int along = static_cast<int>(kLength / spacing);
  body.volume.grid.size = {across, across, along};
  body.volume.grid.spacing = glm::dvec3(spacing);
  body.volume.voxels.assign(body.volume.grid.voxel_count(), 0);
  const double middle = 0.5 * (across - 1) * spacing;
  for (int z = 0; z < along; ++z)
    for (int y = 0; y < across; ++y)
      for (int x = 0; x < across; ++x)
        if (std::hypot(x * spacing - middle, y * spacing - middle) < kRadius) body.volume.at({x, y, z}) = kMuscle;
  body.tissues = muscle_and_bone();
  body.armature.bones = {bone_between("Upper", -1, {middle, middle, 0}, {middle, middle, kLength / 2}),
                         bone_between("Fore", 0, {middle, middle, kLength / 2}, {middle, middle, kLength})};
  return Painted(std::move(body));
}

// Sets weights of Fore that rise along z like the integral of a Gaussian of this width, mm; 0: a step.
void blend(Painted& body, double width) {
  const double spacing = body.body.volume.grid.spacing.z;
  body.set([&](const glm::ivec3& v) {
    const double off = (v.z + 0.5) * spacing - kLength / 2;
    const double share = width > 0 ? 0.5 + 0.5 * std::erf(off / width / std::sqrt(2.0)) : off > 0 ? 1 : 0;
    return quantize({{0, 1 - share}, {1, share}});
  });
}

// Returns over what distance along z the weight of Fore rises from 0.25 to 0.75, mm, at a depth below the skin.
double band(const Painted& body, const SkinWeights& weights, double depth) {
  const Grid& grid = body.body.volume.grid;
  const double spacing = grid.spacing.x;
  const int middle = grid.size.x / 2, y = static_cast<int>(std::lround((middle * spacing - kRadius + depth) / spacing));
  std::array<double, 2> reached{};
  double before = 0;
  for (int z = 0; z < grid.size.z; ++z) {
    const double now = at(body.tissue, weights, {middle, y, z}).of(1);
    for (int i = 0; i < 2; ++i)
      if (const double level = i ? 0.75 : 0.25; before < level && now >= level)
        reached[i] = (z - (now - level) / (now - before)) * spacing;
    before = now;
  }
  return reached[1] - reached[0];
}

}  // namespace

TEST_CASE("smooth weights: a step becomes a Gauss curve's integral of the width asked for, at any spacing") {
  for (const double spacing : {1.0, 2.0, 4.0})
    for (const double width : {8.0, 16.0}) {
      Painted body = cylinder(spacing);
      blend(body, 0);
      std::vector<int> bricks(body.tissue.bricks().size());
      std::iota(bricks.begin(), bricks.end(), 0);
      SmoothWeights smooth(body.tissue, body.body.volume.grid.spacing);
      smooth.spread(bricks, width, [&](int brick) -> InfluenceView { return body.weights->chunk(brick); });
      double largest = 0;
      for (const int brick : bricks)
        body.tissue.for_each(brick, brick + 1, [&](std::int64_t, const glm::ivec3& v) {
          const double off = (v.z + 0.5) * spacing - kLength / 2;
          // Voxels near the ends are skipped: the exact solution is that of an infinitely long cylinder.
          if (std::abs(off) > kLength / 2 - 3 * width) return;
          const glm::ivec3 in = v & 7;
          WeightSum sum;
          smooth.at(brick, in.x + 8 * in.y + 64 * in.z, sum);
          double all = 0, fore = 0;
          for (const auto& [bone, weight] : sum) all += weight, fore += bone == 1 ? weight : 0;
          largest = std::max(largest, std::abs(fore / all - (0.5 + 0.5 * std::erf(off / width / std::sqrt(2.0)))));
        });
      CAPTURE(spacing);
      CAPTURE(width);
      CHECK(largest < 0.025);
    }
}

TEST_CASE("smooth weights: nothing spreads through air or across a seam") {
  Painted body = cylinder(2);
  body.set([](const glm::ivec3& v) { return quantize({{v.y < 20 ? 0 : 1, 1.0}}); });
  // Separates the halves at y = 20: by a seam for z < 60, by a layer of air above.
  auto seams = std::make_shared<Seams>(body.body.volume.grid.size);
  SmallBody parted = body.body;
  for (int z = 0; z < parted.volume.grid.size.z; ++z)
    for (int x = 0; x < parted.volume.grid.size.x; ++x)
      if (z < 60) seams->cut({x, 19, z}, 1);
      else parted.volume.at({x, 20, z}) = 0;
  Painted two(std::move(parted));
  two.tissue.set_seams(seams);
  two.set([](const glm::ivec3& v) { return quantize({{v.y < 20 ? 0 : 1, 1.0}}); });
  std::vector<int> bricks(two.tissue.bricks().size());
  std::iota(bricks.begin(), bricks.end(), 0);
  SmoothWeights smooth(two.tissue, two.body.volume.grid.spacing);
  smooth.spread(bricks, 18, [&](int brick) -> InfluenceView { return two.weights->chunk(brick); });
  int wrong = 0;
  for (const int brick : bricks)
    two.tissue.for_each(brick, brick + 1, [&](std::int64_t, const glm::ivec3& v) {
      const glm::ivec3 in = v & 7;
      WeightSum sum;
      smooth.at(brick, in.x + 8 * in.y + 64 * in.z, sum);
      wrong += sum.size() != 1 || sum[0].first != (v.y < 20 ? 0 : 1);
    });
  CHECK(wrong == 0);
}

TEST_CASE("smooth weights: a stroke widens a blend by as many mm at 1 mm as at 2 mm, and the same with more threads" *
          doctest::test_suite("slow")) {
  std::array<double, 2> wider{};
  for (const int fine : {0, 1}) {
    Painted body = cylinder(fine ? 1 : 2);
    blend(body, 15);
    StrokeSettings settings;
    settings.brush.kind = BrushKind::Smooth;
    settings.brush.radius = 40;
    settings.bones = {1};
    const double middle = body.body.volume.grid.spacing.x * (body.body.volume.grid.size.x / 2);
    const auto painted = [&](int threads) {
      const ThreadCount limit(threads);
      Stroke stroke(body.weighted_body(), body.weights, settings);
      for (int i = 0; i <= 4; ++i) stroke.to({middle, middle - kRadius + 1, 60 + i * 30.0});
      return stroke.finish();
    };
    const SkinWeights after = painted(1);
    wider[fine] = band(body, after, 6) - band(body, *body.weights, 6);
    if (!fine) CHECK(after == painted(2));
  }
  CHECK(wider[0] == doctest::Approx(10).epsilon(0.1));
  CHECK(wider[1] == doctest::Approx(wider[0]).epsilon(0.1));
}

TEST_CASE("smooth weights: ten strokes around a real elbow halve what its muscles overlap by when it bends" *
          doctest::test_suite("slow")) {
  NEEDS_SHARED("data/bender/man-arm-2mm.mha");
  VolumeFile file = read_volume(shared_path("data/bender/man-arm-2mm.mha"));
  const TissueTable tissues = merge_tissue_tables(file.tissues, nullptr);
  const Armature rig = read_armature(shared_path("data/bender/man-arm-2mm-armature.vtk"));
  const TissueVoxels tissue(file.volume);
  auto weights = std::make_shared<const SkinWeights>(diffuse_heat(file.volume, tissues, rig));
  const int fore = require_bone(rig, "Forearm");
  Pose pose = rest_pose(rig);
  flex(pose, rig, fore, 45);
  const auto overlap = [&] {
    const Posed posed = resample(file.volume, tissues, rig, *weights, pose, Blend::DualQuaternion, {});
    std::int64_t voxels = 0;
    for (const Tissue& t : tissues.tissues)
      if (t.kind == TissueKind::Muscle) voxels += posed.report.overlap_by_label[t.label];
    return voxels;
  };
  const std::int64_t before = overlap();
  const glm::dvec3 joint = rig.bones[fore].head, along = glm::normalize(rig.bones[fore].tail - joint);
  const glm::dvec3 hinge = flex_axis(rig, fore), front = glm::normalize(glm::cross(hinge, along));
  const AffineTransform from_world = voxel_from_world(file.volume.grid);
  StrokeSettings settings;
  settings.brush.kind = BrushKind::Smooth;
  settings.brush.radius = 40;
  settings.bones = {fore};
  for (int n = 0; n < 10; ++n) {
    const double angle = 0.7 * (n % 5 - 2);
    const glm::dvec3 outwards = std::cos(angle) * front + std::sin(angle) * hinge;
    Stroke stroke({file.volume, tissue, tissues, rig}, weights, settings);
    for (int i = -6; i <= 6; ++i) {
      glm::dvec3 skin = joint + 10.0 * i * along;
      for (int d = 100; d > 0; --d) {
        const glm::dvec3 at = skin + double(d) * outwards;
        if (file.volume.at_or_air(glm::ivec3(glm::round(from_world * at))) == 0) continue;
        skin = at;
        break;
      }
      stroke.to(skin);
    }
    weights = std::make_shared<const SkinWeights>(stroke.finish());
  }
  CHECK(before > 1000);
  CHECK(2 * overlap() < before);
}
