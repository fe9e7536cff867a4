// SPDX-License-Identifier: AGPL-3.0-or-later
// Transfers weights of real bodies to another spacing and back, and mirrors them in a body whose sides differ.
#include <algorithm>
#include <cmath>
#include <random>

#include <doctest/doctest.h>

#include "core/binding/heat_diffusion.h"
#include "core/bones/bone_parts.h"
#include "core/phantom/phantom.h"
#include "core/prepare/prepare.h"
#include "core/rig_io/rig_io.h"
#include "core/skin/weight_edits.h"
#include "core/volume_io/volume_io.h"
#include "tests/core/skin/painted.h"
#include "tests/support/shared_data.h"

using namespace limber;
using namespace limber::test;

namespace {

struct Skinned {
  LabelVolume volume;
  TissueTable tissues;
  Armature rig;
  TissueVoxels tissue;
  SkinWeights weights;

  Skinned(LabelVolume of, const TissueTable& table, Armature by, bool compute = true)
      : volume(std::move(of)),
        tissues(table),
        rig(std::move(by)),
        tissue(volume),
        weights(names_of(rig), tissue) {
    if (compute) weights = diffuse_heat(volume, tissue, tissues, rig, split_bones(volume, tissue, tissues, rig));
  }
  WeightedBody body() const { return {volume, tissue, tissues, rig}; }
  TransferSource source() const { return {volume, tissue, rig, weights}; }

  static std::vector<std::string> names_of(const Armature& rig) {
    std::vector<std::string> names;
    for (const Bone& bone : rig.bones) names.push_back(bone.name);
    return names;
  }
};

// Returns half the sum of the weights' differences: the share of a voxel that follows another bone.
double difference(const Influence& a, const Influence& b) {
  double sum = 0;
  for (int i = 0; i < 4; ++i) {
    if (a.weight[i]) sum += std::abs(double(a.weight[i]) / kFullWeight - b.of(a.bone[i]));
    if (b.weight[i] && a.of(b.bone[i]) == 0) sum += double(b.weight[i]) / kFullWeight;
  }
  return sum / 2;
}

struct Spread {
  double mean = 0, of_ninety_nine = 0, most = 0;
};
Spread differences(const SkinWeights& a, const SkinWeights& b) {
  std::vector<double> all;
  for (std::int64_t c = 0; c < a.chunk_count(); ++c)
    for (std::size_t i = 0; i < a.chunk(c).size(); ++i) all.push_back(difference(a.chunk(c)[i], b.chunk(c)[i]));
  std::sort(all.begin(), all.end());
  Spread spread;
  for (const double d : all) spread.mean += d / double(all.size());
  spread.of_ninety_nine = all[all.size() * 99 / 100];
  spread.most = all.back();
  return spread;
}

void check_round_trip(const char* name, const Skinned& fine, const Skinned& coarse) {
  EditScope all;
  all.rigid_bone_tissue = false;
  for (const auto& [from, by] : {std::pair{&fine, &coarse}, {&coarse, &fine}}) {
    const SkinWeights there =
        transferred(by->body(), SkinWeights(by->weights.bones(), by->tissue), from->source(), all).weights;
    const SkinWeights back = transferred(from->body(), SkinWeights(from->weights.bones(), from->tissue),
                                         {by->volume, by->tissue, by->rig, there}, all)
                                 .weights;
    const Spread round = differences(back, from->weights), computed = differences(there, by->weights);
    const double from_mm = from->volume.grid.spacing.x, by_mm = by->volume.grid.spacing.x;
    MESSAGE(std::string(name), ", ", from_mm, " mm -> ", by_mm, " mm -> ", from_mm, " mm: weights differ by ",
            round.mean, " of a voxel in the mean, ", round.of_ninety_nine, " at the 99th percentile, ", round.most,
            " at most; from those computed at ", by_mm, " mm by ", computed.mean);
    CHECK(round.mean < 0.006);
    CHECK(round.of_ninety_nine < 0.13);
  }
}

}  // namespace

TEST_CASE(
    "weights between volumes: from 2 mm to 4 mm and back, or from 4 mm to 2 mm and back, an arm's weights stay nearly "
    "what they were" *
    doctest::test_suite("slow")) {
  const Phantom two = make_arm_phantom(2), four = make_arm_phantom(4);
  check_round_trip("procedural arm", {two.volume, two.tissues, two.armature},
                   {four.volume, four.tissues, two.armature});

  NEEDS_SHARED("data/bender/man-arm-2mm.mha");
  VolumeFile file = read_volume(shared_path("data/bender/man-arm-2mm.mha"));
  const TissueTable tissues = merge_tissue_tables(file.tissues, nullptr);
  const Armature rig = read_armature(shared_path("data/bender/man-arm-2mm-armature.vtk"));
  LabelVolume coarse = regrid(file.volume, 2.0 * file.volume.grid.spacing);
  check_round_trip("Bender's arm", {std::move(file.volume), tissues, rig}, {std::move(coarse), tissues, rig});
}

TEST_CASE(
    "weights between volumes: a body whose sides differ takes one side's weights over to the other, and says where it "
    "cannot" *
    doctest::test_suite("slow")) {
  for (const auto& [volume, rig] : {std::pair{"data/makehuman/body_4mm.nrrd", "data/makehuman/body.armature.json"},
                                    std::pair{"data/bp3d/body_3mm_tissue.nrrd", "data/bp3d/body.armature.json"}}) {
    NEEDS_SHARED(volume);
    VolumeFile file = read_volume(shared_path(volume));
    LabelVolume at_eight = regrid(file.volume, glm::dvec3(8));
    const Skinned body(std::move(at_eight), merge_tissue_tables(file.tissues, nullptr),
                       read_armature(shared_path(rig)));
    const MirrorPlane plane = mirror_plane(body.rig);
    const std::vector<int> pairs = mirror_pairs(body.rig);
    const double reach = 20;
    const MirrorEdit edit = mirrored(body.body(), body.weights, {plane, reach});

    std::vector<std::uint8_t> is_unmatched(body.tissue.size(), 0);
    for (const auto place : edit.unmatched) is_unmatched[place] = 1;
    const std::vector<TissueKind> kinds = body.tissues.kinds();
    const AffineTransform world = world_from_voxel(body.volume.grid), to_voxel = voxel_from_world(body.volume.grid);
    const auto bony = [&](const glm::ivec3& v) { return is_bone(kinds[body.volume.at(v)]); };
    const auto takes = [&](const glm::ivec3& v) {
      return glm::dot(world * glm::dvec3(v) - plane.point, plane.normal) > 0;
    };
    std::int64_t taken = 0, wrong = 0;
    double before = 0, after = 0;
    body.tissue.for_each([&](std::int64_t place, const glm::ivec3& v) {
      const Influence &is = at(body.tissue, edit.weights, v), &was = at(body.tissue, body.weights, v);
      const glm::dvec3 point = world * glm::dvec3(v);
      if (!takes(v) || bony(v)) {
        wrong += is != was;
        return;
      }
      // Finds all voxels nearest to the mirrored position that may be the source, by brute force.
      const glm::dvec3 centre = to_voxel * plane.place(point);
      double nearest = 1e9;
      std::vector<glm::ivec3> sources;
      const int far = static_cast<int>(std::ceil(reach / 8)) + 1;
      for (int z = -far; z <= far; ++z)
        for (int y = -far; y <= far; ++y)
          for (int x = -far; x <= far; ++x) {
            const glm::ivec3 other = glm::ivec3(glm::round(centre)) + glm::ivec3(x, y, z);
            if (body.volume.at_or_air(other) == 0 || bony(other) || takes(other)) continue;
            const double way = 8 * glm::distance(glm::dvec3(other), centre);
            if (way < nearest - 1e-9) sources.clear();
            if (way < nearest + 1e-9) sources.push_back(other), nearest = std::min(nearest, way);
          }
      if (is_unmatched[place]) {
        wrong += is != was || nearest < reach - 1e-6;
        return;
      }
      ++taken;
      double least = 1, least_before = 1;
      for (const glm::ivec3& source : sources) {
        Influence other = at(body.tissue, body.weights, source);
        for (int i = 0; i < 4; ++i) other.bone[i] = static_cast<decltype(other.bone[0] + 0)>(pairs[other.bone[i]]);
        least = std::min(least, difference(is, other));
        least_before = std::min(least_before, difference(was, other));
      }
      wrong += nearest > reach + 1e-6 || least > 1e-4;
      before += least_before, after += least;
    });
    MESSAGE(std::string(volume), ": ", taken, " voxels took over weights, which differed by ", before / taken,
            " in the mean and now by ", after / taken, "; ", edit.unmatched.size(), " found nothing within ", reach,
            " mm");
    CHECK(wrong == 0);
    CHECK(taken > 1000);
    CHECK(before / taken > 0.001);
    CHECK(after / taken < 1e-4);
    CHECK(mirrored(body.body(), edit.weights, {plane, reach}).weights == edit.weights);
  }
}
