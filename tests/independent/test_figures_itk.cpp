// SPDX-License-Identifier: AGPL-3.0-or-later
// Compares figures of reports (voxels, pieces, enclosed air, label overlap) with those that ITK computes.
#include <algorithm>
#include <cmath>
#include <random>

#include <doctest/doctest.h>
#include <itkConnectedComponentImageFilter.h>
#include <itkImage.h>
#include <itkLabelOverlapMeasuresImageFilter.h>
#include <itkRelabelComponentImageFilter.h>

#include "core/report/dice.h"
#include "core/report/metrics.h"
#include "core/volume_io/volume_io.h"
#include "tests/support/program.h"
#include "tests/support/random_blobs.h"
#include "tests/support/shared_data.h"

using namespace limber;
using namespace limber::test;

namespace {

using Image = itk::Image<Label, 3>;
using Pieces = itk::Image<std::uint32_t, 3>;
constexpr std::int64_t kSmallest = 50;  // voxels of the smallest piece that take_census counts

template <class Of>
Image::Pointer image_of(const LabelVolume& volume, const Of& value, int margin = 0) {
  auto image = Image::New();
  Image::SizeType size;
  for (int a = 0; a < 3; ++a) size[a] = static_cast<itk::SizeValueType>(volume.grid.size[a] + 2 * margin);
  image->SetRegions(size);
  image->Allocate();
  image->FillBuffer(value(0));
  glm::ivec3 v;
  for (v.z = 0; v.z < volume.grid.size.z; ++v.z)
    for (v.y = 0; v.y < volume.grid.size.y; ++v.y)
      for (v.x = 0; v.x < volume.grid.size.x; ++v.x)
        image->SetPixel({v.x + margin, v.y + margin, v.z + margin}, value(volume.at(v)));
  return image;
}

// Returns the number of voxels of each connected piece of nonzero voxels, in descending order.
std::vector<std::int64_t> pieces_of(Image::Pointer mask, bool across_corners) {
  auto connect = itk::ConnectedComponentImageFilter<Image, Pieces>::New();
  connect->SetInput(mask);
  connect->SetFullyConnected(across_corners);
  auto sort = itk::RelabelComponentImageFilter<Pieces, Pieces>::New();
  sort->SetInput(connect->GetOutput());
  sort->Update();
  const auto sizes = sort->GetSizeOfObjectsInPixels();
  return {sizes.begin(), sizes.end()};
}

std::int64_t enclosed_air(const LabelVolume& volume) {
  // A margin of 8 voxels of air is added around the volume, so that all outside air is connected. In these volumes it
  // is the largest piece of air.
  const auto pieces = pieces_of(image_of(
                                    volume, [](Label label) -> Label { return label == 0; }, 8),
                                false);
  std::int64_t enclosed = 0;
  for (std::size_t i = 1; i < pieces.size(); ++i) enclosed += pieces[i];
  return enclosed;
}

void check(const LabelVolume& before, const LabelVolume& after, const TissueTable& tissues) {
  const VolumeMetrics ours = compare(before, after, tissues);
  for (const TissueChange& tissue : ours.tissues)
    for (const bool is_after : {false, true}) {
      INFO(tissue.name, is_after ? " after" : " before");
      const auto pieces = pieces_of(
          image_of(is_after ? after : before, [&](Label label) -> Label { return label == tissue.label; }), true);
      std::int64_t voxels = 0;
      for (const std::int64_t piece : pieces) voxels += piece;
      CHECK(voxels == (is_after ? tissue.voxels_after : tissue.voxels_before));
      CHECK(std::count_if(pieces.begin(), pieces.end(), [](std::int64_t piece) { return piece >= kSmallest; }) ==
            (is_after ? tissue.components_after : tissue.components_before));
    }
  CHECK(enclosed_air(before) == ours.enclosed_air_before);
  CHECK(enclosed_air(after) == ours.enclosed_air_after);
  if (before.grid.size != after.grid.size) return;

  auto overlap = itk::LabelOverlapMeasuresImageFilter<Image>::New();
  const auto same = [](Label label) { return label; };
  overlap->SetSourceImage(image_of(before, same));
  overlap->SetTargetImage(image_of(after, same));
  overlap->Update();
  const std::vector<double> dice = dice_by_label(before, after);
  for (const TissueChange& tissue : ours.tissues) {
    INFO(tissue.name);
    CHECK(overlap->GetDiceCoefficient(tissue.label) == doctest::Approx(dice[tissue.label]));
    // ITK's similarity is 2 (source - target) / (source + target).
    const double change = double(tissue.voxels_after - tissue.voxels_before),
                 sum = double(tissue.voxels_before + tissue.voxels_after);
    CHECK(std::abs(overlap->GetVolumeSimilarity(tissue.label)) == doctest::Approx(std::abs(2 * change / sum)));
  }
}

}  // namespace

TEST_CASE("known figures: ITK finds the same voxels, pieces, enclosed air and Dice in random blobs") {
  std::mt19937 random(11);
  TissueTable table;
  for (Label label = 1; label < 6; ++label)
    table.tissues.push_back({.label = label, .file_value = double(label), .name = std::to_string(label)});
  const LabelVolume a = random_blobs(random, {30, 26, 22}, 300, 5), b = random_blobs(random, {30, 26, 22}, 300, 5);
  check(a, b, table);
}

TEST_CASE("known figures: ITK finds the same in an arm that was posed") {
  NEEDS_SHARED("data/bender/man-arm-2mm.mha");
  const TemporaryFolder folder;
  const std::string rest = folder / "rest.nrrd", posed = folder / "posed.nrrd",
                    rig = shared_path("data/bender/man-arm-2mm-armature.vtk").string();
  for (const std::vector<std::string>& words : std::vector<std::vector<std::string>>{
           {"prepare", shared_path("data/bender/man-arm-2mm.mha").string(), "-o", rest, "--spacing", "4"},
           {"weights", rest, "--rig", rig, "--method", "geodesic", "-o", folder / "w.nrrd"},
           {"resample", rest, "--rig", rig, "--weights", folder / "w.nrrd", "--flex", "Forearm=45", "--method", "dqs",
            "-o", posed}}) {
    const auto run = run_limber(words);
    REQUIRE_MESSAGE(run.exit_code == 0, run.err);
  }
  const VolumeFile before = read_volume(rest), after = read_volume(posed);
  REQUIRE(before.tissues.tissues.size() == after.tissues.tissues.size());
  check(before.volume, after.volume, before.tissues);
}
