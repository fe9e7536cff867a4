// SPDX-License-Identifier: AGPL-3.0-or-later
// A rig laid into a label volume by itself. A jointed body of known shape (core/autorig/body_atlas.h) is drawn onto the
// volume from coarse to fine:
//   1  the ends of the tissue and the ways to them give the limbs (core/autorig/limb_paths.h), whatever their pose and
//   however
//      the body lies in the world;
//   2  the skin gives pose and proportions (core/autorig/articulated_fit.h);
//   3  where labels name bones, joints lie where the two bones meet (core/autorig/named_joints.h), and the body is laid
//   along them; 4  where the table says what is bone, the bones' surfaces give the joints; bones drawn as mere rods are
//   followed along
//      their axes instead. Without a table bone is the label that the long bones run through
//      (core/bones/guess_bone_labels.h);
//   5  where the skin is not that of the known body, landmarks of the volume's own shape put joints right
//      (core/autorig/joint_landmarks.h).
// Of a body that was cut off (core/autorig/cut_planes.h) only what is there is fitted; what lies beyond is laid on by
// proportion, and said to be.
//
// The joints of any rig are then put where the body's joints came to lie, matched by what their names mean
// (core/rig/joint_names.h); those between and below ride along. A rig whose names mean nothing, an animal's, becomes a
// body of round limbs itself (core/autorig/capsule_atlas.h), which is drawn onto the skin; one without a trunk is laid
// into the tissue's extents.
//
// The same bytes come out for any number of threads.
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
  };  // Unseen: beyond a cut
  How how = How::Carried;
  double confidence = 0;  // 0 .. 1
  double error = 0;       // mm that it may lie off: nine joints of ten lay within it, on bodies whose joints are known
};
std::string_view to_string(JointFit::How how);  // "bone surface"

struct AutoFit {
  Armature armature;
  std::vector<JointFit> joints;  // per bone, of its head
  RigCheck check;                // where the rig leaves the tissue
  double misfit_mm = 0;          // between the body that was fitted and the volume, root mean square; 0 without one
  std::vector<std::string> warnings;  // what failed, in words
};

// The rig placed, turned and scaled to the tissue; its joint limits turn along and count from the body's own rest
// (core/autorig/fitted_limits.h).
// Throws Error for a volume without tissue.
AutoFit auto_fit(const LabelVolume& volume, const TissueTable& tissues, const Armature& rig,
                 Progress& progress = no_progress());

// The rig in the middle of the tissue, as large as it is; nothing is turned.
Armature scaled_to_tissue(const LabelVolume& volume, const Armature& rig);

// mm that a joint may lie off where the rig was only scaled to the tissue.
double error_by_extents(const LabelVolume& volume);

// The template that suits the volume best: one of core/rig_io/rig_templates.h.
std::string suggest_template(const LabelVolume& volume, Progress& progress = no_progress());

}  // namespace limber
