// SPDX-License-Identifier: AGPL-3.0-or-later
// A limb that can be checked by hand: a bar of muscle along z. Inside it lie two bones with a gap between them, and a
// rig of two bones meets in the middle of the gap.
#pragma once

#include "core/rig/armature.h"
#include "core/tissue/tissue_table.h"
#include "core/volume/label_volume.h"

namespace limber::test {

constexpr Label kMuscle = 1, kBone = 2;

struct SmallBody {
  LabelVolume volume;
  TissueTable tissues;
  Armature armature;
};

inline TissueTable muscle_and_bone() {
  TissueTable table;
  for (Label label : {kMuscle, kBone}) {
    Tissue tissue;
    tissue.label = label;
    tissue.file_value = label;
    tissue.kind = label == kBone ? TissueKind::Bone : TissueKind::Muscle;
    table.tissues.push_back(tissue);
  }
  return table;
}

inline Bone bone_between(const char* name, int parent, const glm::dvec3& head, const glm::dvec3& tail) {
  Bone bone;
  bone.name = name;
  bone.parent = parent;
  bone.head = head;
  bone.tail = tail;
  return bone;
}

// Makes the limb, with two voxels of air on every side.
//   width   voxels across the bar; the bones are a third of it
//   length  voxels along it
//   gap     voxels between the bones
inline SmallBody two_bone_bar(int width = 12, int length = 40, int gap = 6, const glm::dvec3& spacing = glm::dvec3(2)) {
  SmallBody body;
  body.volume.grid.size = {width + 4, width + 4, length + 4};
  body.volume.grid.spacing = spacing;
  body.volume.voxels.assign(body.volume.grid.voxel_count(), 0);
  const int third = width / 3;
  for (int z = 0; z < length; ++z)
    for (int y = 0; y < width; ++y)
      for (int x = 0; x < width; ++x) {
        const bool inner = x >= third && x < width - third && y >= third && y < width - third;
        const bool gapped = z >= (length - gap) / 2 && z < (length + gap) / 2;
        body.volume.at({x + 2, y + 2, z + 2}) = inner && !gapped ? kBone : kMuscle;
      }
  body.tissues = muscle_and_bone();
  const glm::dvec3 middle = glm::dvec3(width + 3, width + 3, 0) / 2.0 * spacing;
  auto at = [&](double z) { return middle + glm::dvec3(0, 0, (z + 1.5) * spacing.z); };
  body.armature.bones = {bone_between("Upper", -1, at(0), at(length / 2.0)),
                         bone_between("Lower", 0, at(length / 2.0), at(length))};
  return body;
}

}  // namespace limber::test
