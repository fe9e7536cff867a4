// SPDX-License-Identifier: AGPL-3.0-or-later
#include "tests/support/figure.h"

#include "core/rig_io/rig_io.h"
#include "core/tissue/tissue_table.h"
#include "core/volume_io/volume_io.h"

namespace limber::test {

namespace {
constexpr glm::ivec3 kSize{64, 24, 100};
constexpr double kSpacing = 4;
constexpr glm::dvec3 kOrigin{-126, -46, 0};  // first voxel's position, mm; the figure's middle plane is x = 0

void fill(LabelVolume& volume, const glm::ivec3& low, const glm::ivec3& high, Label label) {
  for (int z = low.z; z < high.z; ++z)
    for (int y = low.y; y < high.y; ++y)
      for (int x = low.x; x < high.x; ++x) volume.at({x, y, z}) = label;
}

// Fills a box on the figure's left side, which has larger x, and the mirrored box on its right side.
void fill_both(LabelVolume& volume, const glm::ivec3& low, const glm::ivec3& high, Label left, Label right) {
  fill(volume, low, high, left);
  fill(volume, {kSize.x - high.x, low.y, low.z}, {kSize.x - low.x, high.y, high.z}, right);
}

// Turns the muscle voxels that touch air into skin.
void cover_with_skin(LabelVolume& volume) {
  const LabelVolume bare = volume;
  for (int z = 0; z < kSize.z; ++z)
    for (int y = 0; y < kSize.y; ++y)
      for (int x = 0; x < kSize.x; ++x) {
        bool open = false;
        for (int k = 0; k < 27; ++k)
          open |= bare.at_or_air(glm::ivec3(x, y, z) + glm::ivec3(k % 3 - 1, k / 3 % 3 - 1, k / 9 - 1)) == 0;
        if (open && bare.at({x, y, z}) == kFigureMuscle) volume.at({x, y, z}) = kFigureSkin;
      }
}

Tissue tissue(Label label, const char* name, TissueKind kind) {
  Tissue made;
  made.label = label;
  made.file_value = label;
  made.name = name;
  made.kind = kind;
  apply_kind_defaults(made);
  return made;
}

Bone bone(const char* name, int parent, const glm::dvec3& head, const glm::dvec3& tail) {
  Bone made;
  made.name = name, made.parent = parent;
  made.head = kOrigin + kSpacing * (head - 0.5);
  made.tail = kOrigin + kSpacing * (tail - 0.5);
  return made;
}

void add_arms(LabelVolume& volume) {
  fill_both(volume, {48, 7, 46}, {58, 17, 92}, kFigureMuscle, kFigureMuscle);
  fill_both(volume, {44, 7, 82}, {48, 17, 92}, kFigureMuscle, kFigureMuscle);  // muscles of the shoulders
}

void add_arm_bones(LabelVolume& volume) {
  fill_both(volume, {51, 10, 69}, {55, 14, 88}, kLeftHumerus, kRightHumerus);
  fill_both(volume, {51, 10, 48}, {55, 14, 67}, kLeftUlna, kRightUlna);
}

void hinge(Bone& bone) {
  bone.limits.type = JointLimits::Type::Hinge;
  bone.limits.axis = {1, 0, 0};
  bone.limits.minimum = glm::radians(-120.0);
  bone.limits.maximum = glm::radians(120.0);
}
}  // namespace

void fill_where(LabelVolume& volume, const glm::ivec3& low, const glm::ivec3& high, Label only, Label label) {
  for (int z = low.z; z < high.z; ++z)
    for (int y = low.y; y < high.y; ++y)
      for (int x = low.x; x < high.x; ++x)
        if (volume.at({x, y, z}) == only) volume.at({x, y, z}) = label;
}

Figure block_figure() {
  Figure figure;
  figure.volume.grid = {.size = kSize, .spacing = glm::dvec3(kSpacing), .origin = kOrigin};
  figure.volume.voxels.assign(static_cast<std::size_t>(figure.volume.grid.voxel_count()), 0);
  LabelVolume& volume = figure.volume;
  fill(volume, {20, 4, 44}, {44, 20, 94}, kFigureMuscle);
  fill_both(volume, {33, 6, 3}, {43, 18, 44}, kFigureMuscle, kFigureMuscle);
  add_arms(volume);
  cover_with_skin(volume);
  fill_both(volume, {36, 10, 24}, {40, 14, 45}, kLeftFemur, kRightFemur);
  fill_both(volume, {36, 10, 5}, {40, 14, 22}, kLeftTibia, kRightTibia);
  fill_both(volume, {34, 10, 47}, {41, 14, 51}, kLeftHip, kRightHip);
  add_arm_bones(volume);
  fill(volume, {30, 14, 54}, {34, 18, 90}, kVertebrae);
  fill(volume, {28, 6, 54}, {36, 12, 62}, kBladder);
  fill(volume, {24, 6, 68}, {36, 12, 78}, kLiver);

  figure.tissues.tissues = {tissue(kFigureSkin, "Skin", TissueKind::Skin),
                            tissue(kFigureMuscle, "Muscle", TissueKind::Muscle),
                            tissue(kLeftFemur, "Left femur", TissueKind::Bone),
                            tissue(kRightFemur, "Right femur", TissueKind::Bone),
                            tissue(kLeftTibia, "Left tibia", TissueKind::Bone),
                            tissue(kRightTibia, "Right tibia", TissueKind::Bone),
                            tissue(kLeftHumerus, "Left humerus", TissueKind::Bone),
                            tissue(kRightHumerus, "Right humerus", TissueKind::Bone),
                            tissue(kLeftUlna, "Left ulna", TissueKind::Bone),
                            tissue(kRightUlna, "Right ulna", TissueKind::Bone),
                            tissue(kLeftHip, "Left hip bone", TissueKind::Bone),
                            tissue(kRightHip, "Right hip bone", TissueKind::Bone),
                            tissue(kVertebrae, "Thoracic vertebrae", TissueKind::Bone),
                            tissue(kBladder, "Bladder", TissueKind::Organ),
                            tissue(kLiver, "Liver", TissueKind::Organ)};
  figure.armature.bones = {
      bone("Pelvis", -1, {32, 12, 48}, {32, 14, 56}),       bone("Spine", 0, {32, 14, 56}, {32, 14, 90}),
      bone("LeftUpperArm", 1, {53, 12, 88}, {53, 12, 68}),  bone("LeftForearm", 2, {53, 12, 68}, {53, 12, 48}),
      bone("RightUpperArm", 1, {11, 12, 88}, {11, 12, 68}), bone("RightForearm", 4, {11, 12, 68}, {11, 12, 48}),
      bone("LeftThigh", 0, {38, 12, 45}, {38, 12, 23}),     bone("LeftShank", 6, {38, 12, 23}, {38, 12, 5}),
      bone("RightThigh", 0, {26, 12, 45}, {26, 12, 23}),    bone("RightShank", 8, {26, 12, 23}, {26, 12, 5})};
  for (const int b : {2, 3, 4, 5, 6, 7, 8, 9}) hinge(figure.armature.bones[b]);
  return figure;
}

Figure block_arm() {
  Figure arm = block_figure();
  for (std::int64_t at = 0; at < std::ssize(arm.volume.voxels); ++at)
    if (at % kSize.x < 48) arm.volume.voxels[at] = 0;
  std::erase_if(arm.tissues.tissues, [](const Tissue& one) {
    return is_bone(one.kind) && one.label != kLeftHumerus && one.label != kLeftUlna;
  });
  std::erase_if(arm.tissues.tissues, [](const Tissue& one) { return one.kind == TissueKind::Organ; });
  arm.armature.bones = {arm.armature.bones[2], arm.armature.bones[3]};
  arm.armature.bones[0].parent = -1;
  arm.armature.bones[1].parent = 0;
  return arm;
}

void write_figure(const Figure& figure, const std::filesystem::path& folder) {
  write_volume(figure.volume, folder / "volume.nrrd", figure.tissues);
  write_tissue_table(figure.tissues, folder / "tissues.json");
  write_armature(figure.armature, folder / "rig.json");
}

}  // namespace limber::test
