// SPDX-License-Identifier: AGPL-3.0-or-later
#include <algorithm>

#include <doctest/doctest.h>

#include "core/base/error.h"
#include "core/body/glide_poses.h"
#include "core/body/pose_body.h"
#include "core/phantom/phantom.h"

using namespace limber;

namespace {
Body arm_body(double spacing, bool has_table = true) {
  Phantom arm = make_arm_phantom(spacing);
  VolumeFile file{std::move(arm.volume), arm.tissues, {"NRRD", "uint8", false}, {}};
  if (!has_table) {
    for (Tissue& tissue : file.tissues.tissues) {
      tissue.name = "";
      tissue.kind = TissueKind::Unknown;
    }
  }
  return make_body(std::move(file), has_table ? &arm.tissues : nullptr, arm.armature, {}, {}, "arm.nrrd");
}

}  // namespace

TEST_CASE("body: labels of bone and skin come from the table") {
  const Body body = arm_body(4);
  CHECK(body.warnings.empty());
  CHECK(std::any_of(body.tissues.tissues.begin(), body.tissues.tissues.end(),
                    [](const Tissue& tissue) { return is_bone(tissue.kind); }));
}

TEST_CASE("body: bone is found where no table names it, and a warning says which label was taken") {
  const Body body = arm_body(4, false);
  CHECK(std::any_of(body.tissues.tissues.begin(), body.tissues.tissues.end(),
                    [](const Tissue& tissue) { return is_bone(tissue.kind); }));
  REQUIRE(!body.warnings.empty());
  CHECK(body.warnings.front().find("arm.nrrd") != std::string::npos);
  CHECK(body.warnings.front().find("--bones") != std::string::npos);
}

TEST_CASE("body: a posed sequence gives each pose its own report, and the rest pose gives back the body") {
  const Body body = arm_body(4);
  BoundBody bound = bind_body(body, require_binding("heat", "here"), {}, no_progress());
  CHECK(!bound.is_from_file);
  Pose bent = rest_pose(body.rig);
  flex(bent, body.rig, require_bone(body.rig, "Forearm"), 60);
  PosingSettings settings;
  settings.resample.displacement = true;
  std::vector<std::size_t> seen;
  pose_body(
      body, bound, {rest_pose(body.rig), bent}, settings, {}, {},
      [&](BodyInPose& posed) {
        seen.push_back(posed.index);
        const bool is_rest = posed.index == 0;
        CHECK((posed.posed.volume.voxels == body.file.volume.voxels) == is_rest);
        measure_posed_body(body, settings, posed);
        CHECK(posed.report.joints.empty() == is_rest);
        REQUIRE(posed.report.metrics);
        CHECK(posed.report.metrics->voxels_before == bound.tissue.size());
        CHECK(!posed.report.gates.empty());
        CHECK(posed.report.method == settings.method);
      },
      no_progress());
  CHECK(seen == std::vector<std::size_t>{0, 1});
}

TEST_CASE("body: bad words are refused") {
  CHECK_THROWS_AS(require_binding("magic", "method"), Error);
  CHECK_THROWS_AS(glide_settings("far", 2, "glide far"), Error);
  CHECK(!glide_settings("off", 2, "glide off"));
  CHECK(glide_settings("voxel", 2, "glide voxel")->whole_mm.value() < 2);
  CHECK(glide_settings("7.5", 2, "glide 7.5")->most_mm == 7.5);
  const Body body = arm_body(6);
  BoundBody bound = bind_body(body, Binding::Rigid, std::shared_ptr<const Seams>(), no_progress());
  PosingSettings settings;
  settings.method = "magic";
  CHECK_THROWS_AS(pose_body(
                      body, bound, {rest_pose(body.rig)}, settings, {}, {}, [](BodyInPose&) {}, no_progress()),
                  Error);
}
