// SPDX-License-Identifier: AGPL-3.0-or-later
// Compares, pixel by pixel, the labels that a posed body shows at rest of the view with the labels that the resampled
// body shows from the same side.
#include <array>

#include "core/body/bind_body.h"
#include "core/deform/preview_map.h"
#include "core/pose/body_poses.h"
#include "core/resample/resample.h"
#include "core/rig_io/rig_io.h"
#include "core/volume_io/volume_io.h"
#include "tests/render/studio.h"
#include "tests/support/shared_data.h"

using namespace limber;
using namespace limber::render;
using namespace limber::test;

namespace {

constexpr glm::ivec2 kSize{900, 900};

// A body with its weights and seams.
struct RealBody {
  Body body;
  BoundBody bound;
  std::shared_ptr<const LabelVolume> volume;

  RealBody(const char* volume_file, const char* rig_file)
      : body(make_body(read_volume(shared_path(volume_file)), nullptr, read_armature(shared_path(rig_file)), {}, {},
                       volume_file)),
        bound(bind_body(body, Binding::Heat, {}, no_progress())),
        volume(std::make_shared<const LabelVolume>(body.file.volume)) {}

  Scene scene() const { return scene_of(volume, std::make_shared<const LabelLooks>(looks_of(body.tissues))); }
  std::shared_ptr<const PreviewMap> map(const Pose& pose, Blend blend, int step) const {
    std::vector<RigidTransform> motions;
    const std::vector<RigidTransform> of_rig = posed_from_rest(body.rig, pose);
    for (const std::string& bone : bound.weights.bones()) motions.push_back(of_rig[require_bone(body.rig, bone)]);
    return LivePreview(volume, body.tissues, bound.tissue, bound.weights, step).update(motions, blend);
  }
  std::shared_ptr<const LabelVolume> resampled(const Pose& pose, Blend blend) const {
    return std::make_shared<const LabelVolume>(
        resample(*volume, body.tissues, body.rig, bound.weights, pose, blend, {.seams = bound.tissue.shared_seams()})
            .volume);
  }
};

std::vector<Label> labels_at_rest(Renderer& renderer, const Scene& scene, const Camera& camera) {
  View3D view(renderer);
  for (double now = 0; now == 0 || !view.complete(); now += 1) view.draw(scene, camera, kSize, now);
  REQUIRE(view.scale() == 1);
  return view.pixel_labels();
}

struct Agreement {
  std::int64_t body = 0, same = 0, outline = 0;  // pixels of either body; with the same label; that only one covers
  double share() const { return double(same) / double(body); }
  double only_one() const { return double(outline) / double(body); }
};
Agreement agreement(const std::vector<Label>& a, const std::vector<Label>& b) {
  REQUIRE(a.size() == b.size());
  Agreement found;
  for (std::size_t i = 0; i < a.size(); ++i) {
    if (a[i] == 0 && b[i] == 0) continue;
    ++found.body;
    found.same += a[i] == b[i];
    found.outline += (a[i] == 0) != (b[i] == 0);
  }
  return found;
}

struct View {
  StandardView side;
  double least;  // least share of the body's pixels that show the same label
};

// Checks the labels by the blend, with the node spacing that the editor uses while nothing moves. What differs even by
// an exact map: resampling moves outlines by a part of a voxel, and of skin one voxel thick it shows and hides other
// voxels than the ray through the rest volume.
void check_labels(const RealBody& body, const Pose& pose, Blend blend, const std::array<View, 2>& views) {
  Studio studio;
  studio.renderer.average_at_rest(1);
  Scene posed = body.scene(), dense = body.scene();
  posed.pose = body.map(pose, blend, preview_step(body.bound.tissue) / 2);
  dense.volume = body.resampled(pose, blend);
  for (const auto& [side, least] : views) {
    const Camera camera = camera_of(dense.volume->grid, Projection::Perspective, side);
    const Agreement found =
        agreement(labels_at_rest(studio.renderer, posed, camera), labels_at_rest(studio.renderer, dense, camera));
    MESSAGE("blend ", int(blend), ", side ", int(side), ": of ", found.body, " pixels ", found.share(),
            " have the same label, ", found.only_one(), " are covered by one body only");
    CHECK(found.body > 20'000);
    CHECK(found.share() >= least);
  }
}

}  // namespace

TEST_CASE("posed labels: at rest of pose and view, the labels of the volume itself are shown") {
  NEEDS_SHARED("data/bender/man-arm-2mm.mha");
  const RealBody arm("data/bender/man-arm-2mm.mha", "data/bender/man-arm-2mm-armature.vtk");
  check_labels(arm, rest_pose(arm.body.rig), Blend::Linear,
               {View{StandardView::Front, 0.999}, View{StandardView::Left, 0.999}});
}

// The default blend differs more: resampling then also restores the volume of flesh, which the live preview does not.
TEST_CASE("posed labels: at rest of the view, a real arm shows the labels of the resampled arm") {
  NEEDS_SHARED("data/bender/man-arm-2mm.mha");
  const RealBody arm("data/bender/man-arm-2mm.mha", "data/bender/man-arm-2mm-armature.vtk");
  for (const double degrees : {45.0, 90.0}) {
    CAPTURE(degrees);
    Pose pose = rest_pose(arm.body.rig);
    flex(pose, arm.body.rig, require_bone(arm.body.rig, "Forearm"), degrees);
    check_labels(arm, pose, Blend::Linear, {View{StandardView::Front, 0.968}, View{StandardView::Left, 0.994}});
    check_labels(arm, pose, Blend::Mixed, {View{StandardView::Front, 0.93}, View{StandardView::Left, 0.98}});
  }
}

TEST_CASE("posed labels: so does a sitting body") {
  NEEDS_SHARED("data/bp3d/body_3mm_tissue.nrrd");
  const RealBody body("data/bp3d/body_3mm_tissue.nrrd", "data/bp3d/body.armature.json");
  std::vector<std::string> warnings;
  const Pose pose = with_request(body.body.rig, rest_pose(body.body.rig), {.name = "sit"}, warnings);
  check_labels(body, pose, Blend::Linear, {View{StandardView::Front, 0.99}, View{StandardView::Left, 0.99}});
  check_labels(body, pose, Blend::Mixed, {View{StandardView::Front, 0.983}, View{StandardView::Left, 0.987}});
}
