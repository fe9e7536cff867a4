// SPDX-License-Identifier: AGPL-3.0-or-later
// A figure made of boxes, with arms, legs, named bones, organs and skin, and a rig that fits it. It is built in code
// and simple enough to check by hand.
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
  LabelVolume volume;  // voxels of 4 mm
  TissueTable tissues;
  Armature armature;
};
Figure block_figure();

// Returns only the left arm of the figure.
Figure block_arm();

// Gives `label` to the voxels in the box low <= v < high that have the label `only` (0: air).
void fill_where(LabelVolume& volume, const glm::ivec3& low, const glm::ivec3& high, Label only, Label label);

// Writes the figure to the files volume.nrrd, tissues.json and rig.json in the folder.
void write_figure(const Figure& figure, const std::filesystem::path& folder);

}  // namespace limber::test
