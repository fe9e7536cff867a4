// SPDX-License-Identifier: AGPL-3.0-or-later
// What the user works on, as a value: shared immutable parts. An operator copies the document (a few pointers),
// replaces the parts it changes, and commits the copy to the History; nobody writes an undo. Equal pointers mean
// unchanged parts: that tells what to upload, to save and what has become stale.
#pragma once

#include <map>
#include <memory>
#include <string>
#include <vector>

#include <glm/glm.hpp>

#include "core/bones/bone_identity.h"
#include "core/motion/clip.h"
#include "core/pose/ik_constraints.h"
#include "core/pose/pose_library.h"
#include "core/rig/armature.h"
#include "core/rig/pose.h"
#include "core/skin/skin_weights.h"
#include "core/skin/weight_locks.h"
#include "core/tissue/tissue_table.h"
#include "core/volume/label_volume.h"
#include "core/volume/seams.h"
#include "core/volume_io/volume_io.h"

namespace limber {

struct WeightLayers;
struct SolvedMesh;

// How one tissue is shown. A label without an entry is shown as it is.
struct TissueLook {
  bool visible = true;
  float opacity = 1;  // [0, 1], in the X-ray and tissue displays

  bool operator==(const TissueLook&) const = default;
};

// The part of the volume that is shown, in voxel coordinates of the volume's grid (faces at whole numbers - 0.5).
struct ClipBox {
  bool enabled = false;
  glm::dvec3 low{0}, high{0};

  bool operator==(const ClipBox&) const = default;
};

// What lies on the side that the normal points to is hidden.
struct ClipPlane {
  bool enabled = false;
  glm::dvec3 point{0}, normal{0, 0, 1};  // world, mm; unit

  bool operator==(const ClipPlane&) const = default;
};

// What of the body is shown. Edits of it are undone like any other.
struct Visibility {
  std::map<Label, TissueLook> looks;
  ClipBox clip_box;
  ClipPlane clip_plane;

  bool operator==(const Visibility&) const = default;
};

// Where a resampling's map claimed a posed voxel twice: indices into the posed volume, rising.
struct Overlap {
  std::vector<std::int64_t> tissue, bones;  // by two places of tissue; by two bones

  bool operator==(const Overlap&) const = default;
};

// A posed volume that a resampling made, with what it was made from, to tell when it has become stale.
struct Result {
  std::string name;    // unique among the results
  std::string method;  // "lbs", "dqs", "fem", "fem-contact"
  std::shared_ptr<const LabelVolume> volume;
  std::string report;  // limber-report/1, JSON
  std::shared_ptr<const LabelVolume> from_volume;
  std::shared_ptr<const TissueTable> from_tissues;
  std::shared_ptr<const Armature> from_armature;
  std::shared_ptr<const SkinWeights> from_weights;
  std::shared_ptr<const Pose> from_pose;
  std::shared_ptr<const SolvedMesh> solved;      // by finite elements, where anything bends; else null
  std::shared_ptr<const Overlap> overlap;        // null where it was not kept
  std::shared_ptr<const Seams> from_seams;       // as the document's
  std::shared_ptr<const BoneMap> from_bone_map;  // as the document's
};

// Any part may be absent (null); weights, their layers, pose and results need what they belong to.
struct Document {
  std::shared_ptr<const LabelVolume> volume;
  std::shared_ptr<const TissueTable> tissues;
  std::shared_ptr<const FileType> volume_type;  // what the volume's file was
  std::shared_ptr<const Armature> armature;
  std::shared_ptr<const SkinWeights> weights;
  std::shared_ptr<const Pose> pose;  // at `frame`: as the clip says there, until it is changed
  std::shared_ptr<const Visibility> visibility;
  std::vector<std::shared_ptr<const Result>> results;
  std::vector<std::shared_ptr<const Clip>> clips;
  int clip = 0;   // the one that moves the rig, where there are any
  int frame = 0;  // of that clip
  PoseLibrary poses;
  std::shared_ptr<const Anchors> anchors;
  std::shared_ptr<const WeightLocks> locks;
  std::shared_ptr<const WeightLayers> layers;  // `weights` are what comes out of them; null: the weights have no layers
  std::shared_ptr<const Seams>
      seams;  // as the user left them, none where they are empty; null: those that are found by themselves
  std::shared_ptr<const BoneMap> bone_map;  // which rig bones labels follow where the user says so; null: nowhere

  const Clip* shown_clip() const { return clips.empty() ? nullptr : clips[static_cast<std::size_t>(clip)].get(); }

  bool operator==(const Document&) const = default;  // the same parts: pointers, not contents
};

}  // namespace limber
