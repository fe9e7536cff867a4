// SPDX-License-Identifier: AGPL-3.0-or-later
// Measures errors and costs of the picture of a posed body during camera motion, on real volumes.
#include <ctime>

#include <algorithm>

#include "core/binding/heat_diffusion.h"
#include "core/deform/preview_map.h"
#include "core/rig_io/rig_io.h"
#include "core/volume_io/volume_io.h"
#include "tests/render/studio.h"
#include "tests/support/shared_data.h"

using namespace limber;
using namespace limber::render;
using namespace limber::test;

namespace {

constexpr glm::ivec2 kSize{800, 450};
constexpr int kBand = 2;  // pixels this near to a border between labels are not compared

// A body bent at some bones, in two scenes: `moving` has the preview map that is used while the camera moves, and
// `resting` the finer map that is used at rest.
struct BentBody {
  Scene moving, resting;
  Camera camera;

  BentBody(const char* file, const char* rig_file, const std::vector<std::string>& bones, double radians) {
    VolumeFile read = read_volume(shared_path(file));
    const TissueTable tissues = merge_tissue_tables(read.tissues, nullptr);
    const Armature rig = read_armature(shared_path(rig_file));
    const TissueVoxels tissue(read.volume);
    const SkinWeights weights = diffuse_heat(read.volume, tissues, rig);
    const auto volume = std::make_shared<const LabelVolume>(std::move(read.volume));
    Pose pose = rest_pose(rig);
    const glm::dquat turn = glm::angleAxis(radians, glm::dvec3(1, 0, 0));
    for (const std::string& bone : bones) pose.rotation[require_bone(rig, bone)] = turn;
    moving = resting = scene_of(volume, std::make_shared<const LabelLooks>(looks_of(tissues)));
    const int step = preview_step(tissue);
    const auto motions = posed_from_rest(rig, pose);
    moving.pose = LivePreview(volume, tissues, tissue, weights, step).update(motions, Blend::Mixed);
    resting.pose = LivePreview(volume, tissues, tissue, weights, step / 2).update(motions, Blend::Mixed);
    camera = camera_of(volume->grid, Projection::Perspective, StandardView::Left);
  }
};

// Returns the label at each pixel, row by row; 0 outside the body.
std::vector<int> labels_of(const View3D& view, const Image& seen) {
  std::vector<int> labels(seen.rgba.size() / 4, 0);
  for (std::size_t i = 0; i < labels.size(); ++i) {
    if (seen.rgba[4 * i + 3] == 0) continue;
    const auto hit = view.pick({int(i) % seen.size.x, int(i) / seen.size.x});
    if (hit) labels[i] = hit->label;
  }
  return labels;
}

// Returns true if all pixels within the band around a pixel show the same label.
bool lies_within(const std::vector<int>& labels, int x, int y) {
  if (x < kBand || y < kBand || x + kBand >= kSize.x || y + kBand >= kSize.y) return false;
  for (int row = y - kBand; row <= y + kBand; ++row)
    for (int column = x - kBand; column <= x + kBand; ++column)
      if (labels[std::size_t(row) * kSize.x + column] != labels[std::size_t(y) * kSize.x + x]) return false;
  return true;
}

// Returns the fraction of the silhouette's pixels whose label differs from that in the picture at rest. Pixels near the
// borders between labels are not counted.
double share_of_others(const std::vector<int>& labels, const std::vector<int>& at_rest) {
  int covered = 0, others = 0;
  for (int y = 0; y < kSize.y; ++y)
    for (int x = 0; x < kSize.x; ++x) {
      const std::size_t i = std::size_t(y) * kSize.x + x;
      if (at_rest[i] == 0) continue;
      ++covered;
      others += labels[i] != at_rest[i] && lies_within(at_rest, x, y);
    }
  CHECK(covered > 10'000);
  return double(others) / covered;
}

// Returns CPU seconds of the whole process. A software driver draws on several threads, and other programs may be
// running.
double cpu_seconds() { return double(std::clock()) / CLOCKS_PER_SEC; }

double median(std::vector<double> values) {
  std::nth_element(values.begin(), values.begin() + std::ssize(values) / 2, values.end());
  return values[values.size() / 2];
}

// Checks that the moving picture of the posed body shows the same tissues as the picture at rest, at every resolution
// that a moving picture may have.
void check_tissues(Studio& studio, const BentBody& body) {
  View3D rest(studio.renderer), view(studio.renderer);
  const Image whole = draw(rest, body.resting, body.camera, kSize);
  const std::vector<int> at_rest = labels_of(rest, whole);
  for (int scale = 1; scale <= View3D::kCoarsest; ++scale) {
    view.draw(body.moving, body.camera, kSize, 0, scale);
    const double share = share_of_others(labels_of(view, whole), at_rest);
    CAPTURE(scale);
    CAPTURE(share);
    CHECK(share < 0.005);
  }
}

// Compares the cost of a moving picture of the posed body with that of a picture of the same scene by a second view, at
// the resolution of the moving picture and at the full one.
void check_cost(Studio& studio, const BentBody& body) {
  View3D view(studio.renderer), volume(studio.renderer);
  Camera camera = body.camera;
  const auto cost = [&](View3D& drawn, int scale) {
    camera.distance *= 1.0001;  // a small change, which makes the view draw again
    const double begin = cpu_seconds();
    drawn.draw(body.moving, camera, kSize, 0, scale);
    studio.renderer.finish();
    return cpu_seconds() - begin;
  };
  std::vector<double> moving, alike, whole;
  for (int i = 0; i < 12; ++i) {
    const double took = cost(view, 0);
    REQUIRE(view.scale() >= 1);
    REQUIRE(view.scale() <= View3D::kCoarsest);
    const double same = cost(volume, view.scale()), full = cost(volume, 1);
    if (i < 2) continue;  // the driver compiles its shaders in the first two frames
    moving.push_back(took);
    alike.push_back(same);
    whole.push_back(full);
  }
  const double of_alike = median(moving) / median(alike), of_whole = median(moving) / median(whole);
  CAPTURE(of_alike);
  CAPTURE(of_whole);
  CHECK(of_alike < 1.2);
  CHECK(of_whole < 1.05);
}

}  // namespace

TEST_CASE("moving body: a real arm and a whole body show the tissues that they show at rest, at no more cost") {
  NEEDS_SHARED("data/bender/man-arm-2mm.mha");
  NEEDS_SHARED("data/bp3d/body_3mm_tissue.nrrd");
  Studio studio;
  const BentBody arm("data/bender/man-arm-2mm.mha", "data/bender/man-arm-2mm-armature.vtk", {"Forearm"}, -0.8);
  const BentBody body("data/bp3d/body_3mm_tissue.nrrd", "data/bp3d/body.armature.json",
                      {"LeftForearm", "RightForearm", "LeftThigh", "RightShank"}, -1);
  for (const BentBody* bent : {&arm, &body}) {
    check_tissues(studio, *bent);
    check_cost(studio, *bent);
  }
}

TEST_CASE("moving body: a picture that is soon drawn is drawn whole while it moves") {
  Studio studio;
  const Grid grid = grid_of({20, 20, 20});
  const auto ball = [](const glm::dvec3& p) { return Label(glm::distance(p, glm::dvec3(10)) < 8); };
  const Scene scene = scene_of(painted(grid, ball));
  View3D view(studio.renderer);
  Camera camera = camera_of(grid);
  int finest = View3D::kCoarsest;
  for (int i = 0; i < 60 && finest > 1; ++i) {
    camera.distance *= 1.001;
    view.draw(scene, camera, {48, 48}, 0);
    finest = std::min(finest, view.scale());
  }
  CHECK(finest == 1);
}
