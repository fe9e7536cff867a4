// SPDX-License-Identifier: AGPL-3.0-or-later
// Checks the displacement field of a known pose, a body that turns rigidly. In one direction the field is posed minus
// rest. In the other it is what warping programs take: posed(x) = rest(x + field(x)).
#include <cmath>
#include <numbers>

#include <doctest/doctest.h>

#include "core/base/file.h"
#include "core/phantom/phantom.h"
#include "core/rig_io/rig_io.h"
#include "core/volume_io/vector_volume_io.h"
#include "core/volume_io/volume_io.h"
#include "tests/support/program.h"

using namespace limber;
using namespace limber::test;

namespace {

struct TurnedArm {
  static constexpr double kDegrees = 35;
  TemporaryFolder folder;
  Phantom phantom = make_arm_phantom(6);
  glm::dvec3 centre;
  TurnedArm() {
    write_volume(phantom.volume, folder / "volume.nrrd", phantom.tissues);
    write_armature(phantom.armature, folder / "rig.json");
    const Bone& root = phantom.armature.bones.front();
    centre = root.head;
    write_file_atomically(folder / "pose.json",
                          R"({"bones": {")" + root.name + R"(": {"axis": [0, 0, 1], "degrees": 35}}})");
  }
  ProgramRun resample(const std::vector<std::string>& more) const {
    std::vector<std::string> words{"resample",
                                   folder / "volume.nrrd",
                                   "--rig",
                                   folder / "rig.json",
                                   "--pose",
                                   folder / "pose.json",
                                   "--method",
                                   "lbs",
                                   "--nearest",
                                   "-o",
                                   folder / "posed.nrrd"};
    words.insert(words.end(), more.begin(), more.end());
    return run_limber(words);
  }
  // Returns the rest position of a point of the posed body.
  glm::dvec3 rest_of(const glm::dvec3& posed) const {
    const double turn = -kDegrees * std::numbers::pi / 180, c = std::cos(turn), s = std::sin(turn);
    const glm::dvec3 from = posed - centre;
    return centre + glm::dvec3(c * from.x - s * from.y, s * from.x + c * from.y, from.z);
  }
};

Label nearest(const LabelVolume& volume, const glm::dvec3& place) {
  const glm::dvec3 v = glm::round(voxel_from_world(volume.grid) * place);
  for (int axis = 0; axis < 3; ++axis)
    if (v[axis] < 0 || v[axis] >= volume.grid.size[axis]) return 0;
  return volume.at(glm::ivec3(v));
}

}  // namespace

TEST_CASE(
    "field direction: a body that turns as one has the field of the formula, in the direction that the header says") {
  const TurnedArm arm;
  for (const bool to_rest : {false, true}) {
    const std::string word = to_rest ? "to-rest" : "to-posed";
    CAPTURE(word);
    const Path file = arm.folder / (word + ".nrrd");
    const ProgramRun run = arm.resample({"--field", file, "--field-direction", word});
    REQUIRE_MESSAGE(run.exit_code == 0, run.err);
    const std::string bytes = read_file(file);
    CHECK(bytes.find("limber_field_direction:=" + word + "\n") != std::string::npos);
    CHECK(bytes.find(to_rest ? "LPS: rest minus posed" : "LPS: posed minus rest") != std::string::npos);

    const VectorVolume field = read_vector_volume(file);  // the reader returns posed minus rest for both directions
    const LabelVolume posed = read_volume(arm.folder / "posed.nrrd").volume;
    REQUIRE(field.grid.size == posed.grid.size);
    double worst = 0;
    std::int64_t tissue = 0;
    for (int z = 0, i = 0; z < posed.grid.size.z; ++z)
      for (int y = 0; y < posed.grid.size.y; ++y)
        for (int x = 0; x < posed.grid.size.x; ++x, ++i) {
          if (posed.voxels[static_cast<std::size_t>(i)] == 0) continue;
          const glm::dvec3 place = world_from_voxel(posed.grid) * glm::dvec3(x, y, z);
          worst = std::max(
              worst, glm::length(glm::dvec3(field.voxels[static_cast<std::size_t>(i)]) - (place - arm.rest_of(place))));
          ++tissue;
        }
    CHECK(tissue > 1000);
    CHECK(worst < 1e-2);
  }
}

TEST_CASE(
    "field direction: what warping programs do with a field to rest makes the posed volume from the rest volume") {
  const TurnedArm arm;
  const Path file = arm.folder / "to-rest.mha", plain = arm.folder / "plain.nrrd";
  REQUIRE(arm.resample({"--field", file, "--field-direction", "to-rest"}).exit_code == 0);
  CHECK(read_file(file).find("Comment = displacement, mm, LPS: rest minus posed") != std::string::npos);
  REQUIRE(arm.resample({"--field", plain, "--field-direction", "to-rest"}).exit_code == 0);
  const LabelVolume posed = read_volume(arm.folder / "posed.nrrd").volume;
  const VectorVolume to_posed = read_vector_volume(plain);
  std::int64_t tissue = 0, same = 0;
  for (int z = 0, i = 0; z < posed.grid.size.z; ++z)
    for (int y = 0; y < posed.grid.size.y; ++y)
      for (int x = 0; x < posed.grid.size.x; ++x, ++i) {
        const Label label = posed.voxels[static_cast<std::size_t>(i)];
        if (label == 0) continue;
        const glm::dvec3 place = world_from_voxel(posed.grid) * glm::dvec3(x, y, z);
        ++tissue;
        same += nearest(arm.phantom.volume, place - glm::dvec3(to_posed.voxels[static_cast<std::size_t>(i)])) == label;
      }
  CAPTURE(tissue);
  CAPTURE(same);
  CHECK(double(same) >= 0.999 * double(tissue));
}

TEST_CASE(
    "field direction: the two directions are each other's negative in the file, and a direction that is none is "
    "refused") {
  const TemporaryFolder folder;
  const Grid grid{glm::ivec3(2, 1, 1), glm::dvec3(1), glm::dvec3(0), glm::dmat3(1)};
  const std::vector<glm::vec3> field{{1, -2, 3}, {0, 0, 0}};
  write_displacement_field(grid, field, FieldDirection::ToPosed, folder / "posed.nhdr");
  write_displacement_field(grid, field, FieldDirection::ToRest, folder / "rest.nhdr");
  for (const char* name : {"posed.nhdr", "rest.nhdr"}) {
    const VectorVolume read = read_vector_volume(folder / name);
    CHECK(read.voxels[0] == field[0]);
    CHECK(read.voxels[1] == field[1]);
  }
  CHECK(read_file(folder / "posed.raw.gz") != read_file(folder / "rest.raw.gz"));
  std::string header = read_file(folder / "rest.nhdr");
  header.replace(header.find(":=to-rest"), 9, ":=sidewise");
  write_file_atomically(folder / "rest.nhdr", header);
  CHECK_THROWS_WITH(read_vector_volume(folder / "rest.nhdr"), doctest::Contains("direction of the field is sidewise"));
  // A NIfTI header has room for a short description only.
  write_displacement_field(grid, field, FieldDirection::ToRest, folder / "rest.nii");
  CHECK(read_file(folder / "rest.nii").substr(148, 79).starts_with("displacement, mm, LPS: rest minus posed"));
}
