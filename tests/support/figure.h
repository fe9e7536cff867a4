// SPDX-License-Identifier: AGPL-3.0-or-later
// A figure of blocks with arms, legs, named bones, organs and skin, and a rig that fits it; built in code, checkable by
// hand.
#pragma once

#include <filesystem>
#include <string>

#include "core/rig/armature.h"
#include "core/tissue/tissue_table.h"
#include "core/volume/label_volume.h"

namespace limber::test {

enum FigureLabel : Label {
  kFigureSkin = 1,
  kFigureMuscle,
  kLeftFemur,
  kRightFemur,
  kLeftTibia,
  kRightTibia,
  kLeftHumerus,
  kRightHumerus,
  kLeftUlna,
  kRightUlna,
  kLeftHip,
  kRightHip,
  kVertebrae,
  kBladder,
  kLiver,
};

struct Figure {
  LabelVolume volume;  // 4 mm
  TissueTable tissues;
  Armature armature;
};
Figure block_figure();

// Of its left arm and nothing else.
Figure block_arm();

// A box of voxels, low <= v < high, where the volume has `only` (0: air), gets the label.
void fill_where(LabelVolume& volume, const glm::ivec3& low, const glm::ivec3& high, Label only, Label label);

// As volume.nrrd, tissues.json and rig.json in the folder.
void write_figure(const Figure& figure, const std::filesystem::path& folder);

}  // namespace limber::test
