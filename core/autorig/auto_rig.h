// SPDX-License-Identifier: AGPL-3.0-or-later
// Fits a rig to a label volume automatically. A jointed body of known shape (core/autorig/body_atlas.h) is fitted to
// the volume from coarse to fine:
//   1  the ends of the tissue and the paths to them give the limbs (core/autorig/limb_paths.h), whatever their pose and
//      the orientation of the body;
//   2  the skin gives pose and proportions (core/autorig/articulated_fit.h);
//   3  if labels name bones, joints are placed where two bones meet (core/autorig/named_joints.h), and the body's limbs
//      are moved onto them;
//   4  if the tissue table says which labels are bone, the bones' surfaces give the joints. If the volume has rods
//      instead of anatomical bones, the rods' axes are used. Without a table, the label along the long bones is used as
//      bone (core/bones/guess_bone_labels.h);
//   5  where the skin differs from that of the known body, landmarks of the volume's own shape correct the joints
//      (core/autorig/joint_landmarks.h).
// If the body is cut off (core/autorig/cut_planes.h), only the part in the volume is fitted. The joints beyond the cut
// are placed by proportion, and a warning lists them.
//
// The joints of the given rig are then moved to the body's joints, matched by the meaning of their names
// (core/rig/joint_names.h); joints between and below matched joints move with them. For a rig whose names have no known
// meaning, such as an animal's, a body is built from the rig itself: a round limb about each bone
// (core/autorig/capsule_atlas.h), fitted to the skin. A rig without a trunk is scaled to the tissue's extents.
//
// The result is the same, bit for bit, for any number of threads.
#pragma once

#include <string>
#include <vector>

#include "core/autorig/rig_check.h"
#include "core/base/progress.h"
#include "core/rig/armature.h"
#include "core/tissue/tissue_table.h"
#include "core/volume/label_volume.h"

namespace limber {

struct JointFit {
  enum class How {
    Skin,
    BoneSurface,
    BoneAxis,
    Girth,
    Ball,
    NamedBones,
    Carried,
    Extents,
    Unseen
  };  // Unseen: the joint is beyond a cut
  How how = How::Carried;
  double confidence = 0;  // confidence in the joint, [0, 1]
  double error = 0;       // estimated error, mm: on bodies with known joints, 9 of 10 joints had a smaller error
};
std::string_view to_string(JointFit::How how);  // returns text such as "bone surface"

struct AutoFit {
  Armature armature;
  std::vector<JointFit> joints;  // how the joint at the head of each bone was found
  RigCheck check;                // where the fitted rig leaves the tissue
  double misfit_mm = 0;  // root mean square distance of the fitted body from the volume; 0 if no body was fitted
  std::vector<std::string> warnings;  // sentences about what failed or is uncertain
};

// Returns the rig moved, rotated and scaled to the tissue. The axes of joint limits rotate with their bones, and limit
// angles are adapted to the fitted rest pose (core/autorig/fitted_limits.h). Throws Error for a volume without tissue.
AutoFit auto_fit(const LabelVolume& volume, const TissueTable& tissues, const Armature& rig,
                 Progress& progress = no_progress());

// Returns the rig, without rotation, scaled to the size of the tissue and centred on it.
Armature scaled_to_tissue(const LabelVolume& volume, const Armature& rig);

// Returns the estimated error, mm, of the joints of a rig that was only scaled to the tissue (scaled_to_tissue()).
double error_by_extents(const LabelVolume& volume);

// Returns the name of the rig template that fits the volume best; the templates are those of
// core/rig_io/rig_templates.h.
std::string suggest_template(const LabelVolume& volume, Progress& progress = no_progress());

}  // namespace limber
