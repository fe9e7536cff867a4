// SPDX-License-Identifier: AGPL-3.0-or-later
// The document is all that the user works on, held as shared immutable parts. An operator copies the document (a few
// pointers), replaces the parts that it changes and commits the copy to the History, so no operator writes an undo.
// Equal pointers mean unchanged parts: comparing pointers tells what to upload, what to save and which results are
// stale.
#pragma once

#include <map>
#include <memory>
#include <string>
#include <vector>

#include <glm/glm.hpp>

#include "core/bones/bone_identity.h"
#include "core/measure/measurement.h"
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

// The display of one tissue. A label without an entry is visible and opaque.
struct TissueLook {
  bool visible = true;
  float opacity = 1;  // opacity in the X-ray and tissue displays, [0, 1]

  bool operator==(const TissueLook&) const = default;
};

// The box outside which the volume is hidden, in voxel coordinates of the volume's grid. Voxel centres have integer
// coordinates, voxel faces lie half a voxel beside them.
struct ClipBox {
  bool enabled = false;
  glm::dvec3 low{0}, high{0};

  bool operator==(const ClipBox&) const = default;
};

// A plane that hides everything on the side that its normal points to.
struct ClipPlane {
  bool enabled = false;
  glm::dvec3 point{0}, normal{0, 0, 1};  // point in world space, mm; unit normal

  bool operator==(const ClipPlane&) const = default;
};

// The tissues and the region of the volume that are shown. Edits of the visibility can be undone like any other edit.
struct Visibility {
  std::map<Label, TissueLook> looks;
  ClipBox clip_box;
  ClipPlane clip_plane;

  bool operator==(const Visibility&) const = default;
};

// Voxels of a resampled volume that the pose fills twice, as ascending voxel indices.
struct Overlap {
  // tissue: voxels filled by two tissue regions that are not adjacent at rest. bones: voxels filled by two bones.
  std::vector<std::int64_t> tissue, bones;

  bool operator==(const Overlap&) const = default;
};

// A posed volume made by resampling. It keeps pointers to the document parts that it was made from. When the document
// has other parts by now, the result is stale.
struct Result {
  std::string name;    // unique among the document's results
  std::string method;  // method that made the result: "lbs", "dqs", "fem", "fem-contact"
  std::shared_ptr<const LabelVolume> volume;
  std::string report;  // report on the result, JSON of the schema limber-report/1
  std::shared_ptr<const LabelVolume> from_volume;
  std::shared_ptr<const TissueTable> from_tissues;
  std::shared_ptr<const Armature> from_armature;
  std::shared_ptr<const SkinWeights> from_weights;
  std::shared_ptr<const Pose> from_pose;
  std::shared_ptr<const SolvedMesh> solved;      // the posed mesh of the FEM solver; null where no joint bends
  std::shared_ptr<const Overlap> overlap;        // null if the overlap was not stored
  std::shared_ptr<const Seams> from_seams;       // Document::seams at the time of resampling
  std::shared_ptr<const BoneMap> from_bone_map;  // Document::bone_map at the time of resampling
};

// A whole document. Any part may be absent (null). A part that refers to others needs them too: weights need the
// volume, for example, and a pose needs the armature.
struct Document {
  std::shared_ptr<const LabelVolume> volume;
  std::shared_ptr<const TissueTable> tissues;
  std::shared_ptr<const FileType> volume_type;  // the format of the file that the volume was read from
  std::shared_ptr<const Armature> armature;
  std::shared_ptr<const SkinWeights> weights;
  // The shown pose. It is the clip's pose at `frame` until the user changes it.
  std::shared_ptr<const Pose> pose;
  std::shared_ptr<const Visibility> visibility;
  std::vector<std::shared_ptr<const Result>> results;
  std::vector<std::shared_ptr<const Clip>> clips;
  int clip = 0;   // index of the clip that moves the rig, if there are clips
  int frame = 0;  // the current frame of that clip
  PoseLibrary poses;
  std::shared_ptr<const Anchors> anchors;
  std::shared_ptr<const WeightLocks> locks;
  std::shared_ptr<const WeightLayers> layers;  // `weights` is the blend of these layers; null: no layers
  std::shared_ptr<const Seams> seams;  // seams edited by the user (empty: none); null: seams are found automatically
  std::shared_ptr<const BoneMap> bone_map;  // the rig bones that the user assigned to labels; null: none assigned
  std::shared_ptr<const Measurements> measurements;  // the user's measurements; null: none

  const Clip* shown_clip() const { return clips.empty() ? nullptr : clips[static_cast<std::size_t>(clip)].get(); }

  bool operator==(const Document&) const = default;  // compares pointers, not contents
};

}  // namespace limber
