// SPDX-License-Identifier: AGPL-3.0-or-later
// Tests poses by joint names, measured by the voxels of the posed bones only, not by the rig.
#include <algorithm>
#include <cmath>
#include <map>
#include <string>
#include <vector>

#include <doctest/doctest.h>
#include <Eigen/Dense>

#include "core/volume_io/tissue_table_io.h"
#include "core/volume_io/volume_io.h"
#include "tests/support/program.h"
#include "tests/support/shared_data.h"

using namespace limber;
using namespace limber::test;

namespace {

struct LongBone {
  glm::dvec3 middle{0}, along{0};  // middle of the bone, mm; unit vector along it, downwards or forwards
};

// Returns the line through each bone's voxels, along the direction of their largest spread.
std::map<Label, LongBone> lines_of(const LabelVolume& volume, const std::vector<Label>& labels) {
  const AffineTransform to_world = world_from_voxel(volume.grid);
  std::map<Label, std::vector<glm::dvec3>> places;
  std::size_t i = 0;
  for (int z = 0; z < volume.grid.size.z; ++z)
    for (int y = 0; y < volume.grid.size.y; ++y)
      for (int x = 0; x < volume.grid.size.x; ++x, ++i)
        if (std::find(labels.begin(), labels.end(), volume.voxels[i]) != labels.end())
          places[volume.voxels[i]].push_back(to_world * glm::dvec3(x, y, z));
  std::map<Label, LongBone> lines;
  for (const auto& [label, all] : places) {
    LongBone& line = lines[label];
    for (const glm::dvec3& place : all) line.middle += place / double(all.size());
    Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
    for (const glm::dvec3& place : all) {
      const Eigen::Vector3d off(place.x - line.middle.x, place.y - line.middle.y, place.z - line.middle.z);
      spread += off * off.transpose();
    }
    const Eigen::Vector3d axis = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(spread).eigenvectors().col(2);
    line.along = glm::dvec3(axis.x(), axis.y(), axis.z());
    if (line.along.z - line.along.y > 0 && std::abs(line.along.z) > 0.5) line.along = -line.along;
    if (line.along.y > 0 && std::abs(line.along.z) <= 0.5) line.along = -line.along;
  }
  return lines;
}

// Returns the angle in degrees between a bone and straight down, positive forwards, in the view from the left.
double forward_of(const LongBone& bone) { return glm::degrees(std::atan2(-bone.along.y, -bone.along.z)); }

}  // namespace

TEST_CASE(
    "pose names: a seated CT body has thighs 90 degrees forward of where they were in standing, and shanks as they "
    "were" *
    doctest::test_suite("slow")) {
  NEEDS_SHARED("data/bp3d/body_3mm_structures.nii.gz");
  const TemporaryFolder folder;
  const auto shared = [](const char* name) { return shared_path(std::string("data/bp3d/") + name).string(); };
  const TissueTable table = read_tissue_table(shared("body_structures.labels.json"));
  std::map<std::string, double> file_value;
  for (const Tissue& tissue : table.tissues) file_value[tissue.name] = tissue.file_value;
  const std::vector<std::string> names = {"Left femur",  "Right femur",  "Left tibia",
                                          "Right tibia", "Left humerus", "Left ulna"};
  std::map<std::string, std::map<std::string, LongBone>> bones;
  const auto coarser =
      run_limber({"prepare", shared("body_3mm_structures.nii.gz"), "--tissues", shared("body_structures.labels.json"),
                  "--spacing", "5", "-o", folder / "coarse.nii.gz"});
  REQUIRE(coarser.exit_code == 0);
  for (const std::string pose : {"supine", "sit"}) {
    const auto run = run_limber({"resample", folder / "coarse.nii.gz", "--tissues",
                                 shared("body_structures.labels.json"), "--rig", shared("body.armature.json"),
                                 "--pose-name", pose, "--method", "lbs", "-o", folder / (pose + ".nrrd")});
    INFO(run.err);
    REQUIRE(run.exit_code == 0);
    const VolumeFile file = read_volume(folder / (pose + ".nrrd"));
    std::vector<Label> labels;
    for (const std::string& name : names) labels.push_back(file.tissues.find_file_value(file_value.at(name))->label);
    const auto lines = lines_of(file.volume, labels);
    for (std::size_t i = 0; i < names.size(); ++i) bones[pose][names[i]] = lines.at(labels[i]);
  }
  for (const std::string side : {"Left", "Right"}) {
    CHECK(forward_of(bones["sit"][side + " femur"]) - forward_of(bones["supine"][side + " femur"]) ==
          doctest::Approx(90).epsilon(0.01));
    CHECK(std::abs(forward_of(bones["sit"][side + " tibia"]) - forward_of(bones["supine"][side + " tibia"])) < 1);
    CHECK(bones["sit"][side + " tibia"].middle.y < bones["supine"][side + " tibia"].middle.y - 300);
  }
  CHECK(forward_of(bones["sit"]["Left humerus"]) - forward_of(bones["supine"]["Left humerus"]) ==
        doctest::Approx(10).epsilon(0.1));
  // The forearm is also turned so that the palm faces inwards, and the ulna is not parallel to the forearm's axis. So
  // its angle may differ from 90 by some degrees.
  CHECK(std::abs(forward_of(bones["sit"]["Left ulna"]) - forward_of(bones["supine"]["Left ulna"]) - 90) < 8);
}
