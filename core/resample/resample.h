// SPDX-License-Identifier: AGPL-3.0-or-later
// Computes the label volume of a body in a pose, by any method. The method moves the vertices of cells: of the voxels
// (deform/lattice), and with finite elements of the tets (deform/posed_tets). The posed cells are rasterized to the
// inverse map, which gives each posed voxel its position at rest (deform/inverse_map), and labels are read from the
// rest volume at these positions. So there are no holes to fill, and the rest pose gives back the input bit for bit.
// Bones move rigidly with every method.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "core/base/progress.h"
#include "core/deform/settled_flesh.h"
#include "core/resample/baked_pose.h"
#include "core/resample/fem.h"
#include "core/rig/pose.h"
#include "core/skin/skin_weights.h"
#include "core/tissue/tissue_table.h"
#include "core/volume/tiled_labels.h"
#include "core/volume_io/volume_io.h"

namespace limber {

using Method = std::variant<Blend, Fem>;

struct ResampleSettings {
  // true: a posed voxel gets the label of the nearest rest voxel, and nothing is repaired. false: it gets the label
  // whose interpolated share (membership) is largest.
  bool nearest = false;
  // true: gives soft tissues their rest volumes by moving borders (tissue_volumes.h); not with `nearest`.
  bool mass_exact = false;
  // Upper limit on the volume change, in %, that mass_exact may correct in a soft tissue; beyond it, Error is thrown.
  double mass_limit_percent = 3;
  std::optional<double> spacing;    // voxel size of the output along all axes, mm; none: that of the input
  bool displacement = false;        // true: Posed::displacement is filled
  bool tiled_displacement = false;  // true: Posed::tiled_displacement is filled
  bool jacobian = false;  // true: Posed::jacobian is filled (det of the Jacobian of the map from rest to pose)
  bool overlap = false;   // true: Posed::overlap is filled (voxels in which regions of the body overlap)
  const GreyVolume* grey = nullptr;  // grey values to move together with the labels; nullptr: none
  // Voxel faces at which limbs touch without being connected. Null: all tissue that touches is connected.
  std::shared_ptr<const Seams> seams;
  // Baked joints, whose shifts are added to blending by dual quaternions. With any other method they are an error.
  BakedJoints baked;
};

// Report of the correction by mass_exact, which gives soft tissues their volumes at rest.
struct MassExactReport {
  struct Tissue {
    // Number of the tissue's posed voxels: wanted, before the correction, and after it.
    std::int64_t wanted = 0, before = 0, after = 0;
  };
  std::map<Label, Tissue> tissues;
  std::int64_t changed_voxels = 0;
};

// Counts and times of one call of resample(). Metrics that need only the rest volume and the posed volume are computed
// by compare().
struct DeformReport {
  std::int64_t tissue_voxels = 0;
  std::int64_t dropped_voxels = 0;   // number of tissue voxels whose posed position is outside the output grid
  std::int64_t new_hole_voxels = 0;  // number of posed voxels inside a posed tissue cell that have no label
  // Number of voxels in which posed cells overlap that are not neighbours at rest.
  std::int64_t overlap_voxels = 0;
  std::int64_t bone_overlap_voxels = 0;  // number of posed voxels in which bone tissue of two rig bones overlaps
  // Number of voxels that were moved to another tissue to repair skin, connected components (preserve_connectivity.h)
  // and volumes.
  std::int64_t mended_voxels = 0;
  // Number of voxels that became skin because the pose exposed flesh or bone to air.
  std::int64_t new_skin_voxels = 0;
  std::int64_t filled_air_voxels = 0;  // number of air voxels filled in hollows that the pose closed or made larger
  // Number of voxels that each label lost to another tissue where tissues overlap; 65536 values, by label.
  std::vector<std::int64_t> overlap_by_label;
  struct BoneResidual {
    std::string name;
    // Largest distance between a posed bone voxel and the position to which the bone's motion moves its rest point, mm.
    double rigid_residual_mm = 0;
    std::int64_t voxels = 0;  // number of posed voxels of bone tissue of this rig bone
  };
  std::vector<BoneResidual> bones;              // one entry for each rig bone with posed bone tissue
  std::optional<SettledFlesh::Report> settled;  // report of mixed blending; none: other method, or nothing bends
  std::vector<BakedJointReport> baked;          // report on each baked joint of the settings
  // Number of voxels that each organ gained (positive) or lost (negative) to keep its volume (organ_volumes.h), by
  // label.
  std::map<Label, std::int64_t> kept_organs;
  std::optional<MassExactReport> mass_exact;
  std::optional<MeshReport> mesh;                     // the mesh; none: no finite elements, or nothing bends
  std::optional<SolveReport> solve;                   // the solve; none: no finite elements, or nothing bends
  std::vector<ObjectReport> objects;                  // one entry for each object that presses on the body
  std::optional<double> seconds_mesh, seconds_solve;  // times; none: no finite elements, or nothing bends
  double seconds_deform = 0, seconds_rasterize = 0;
};

struct Posed {
  LabelVolume volume;
  DeformReport report;
  ZeroedVector<glm::vec3> displacement;  // posed - rest, mm, on the output grid; zero in air
  TiledVectors tiled_displacement;       // the same vectors as in `displacement`, stored in tiles in less memory
  // Det of the Jacobian of the map from rest to pose, on the output grid; zero in air.
  ZeroedVector<float> jacobian;
  // Overlap in each voxel of the output grid: 0: none, 1: tissue overlaps, 2: bone tissue of two bones overlaps.
  ZeroedVector<Label> overlap;
  GreyVolume grey;
  // The mesh that finite elements have solved (fem_shape.h); null: skinning, or the pose bends nothing.
  std::shared_ptr<const FemShape> shape;
};

// Returns the posed volume. With finite elements, a pose may be out of reach: then the result is the last pose reached
// on the way from rest, and report.solve says so. Throws Error for baked joints without dual quaternions, and when
// mass_exact would have to change a soft tissue of 5000 voxels or more by more than mass_limit_percent.
Posed resample(const LabelVolume& volume, const TissueTable& tissues, const Armature& armature,
               const SkinWeights& weights, const Pose& pose, const Method& method,
               const ResampleSettings& settings = {}, Progress& progress = no_progress());

// Computes the posed volume of each pose of a sequence, such as the frames of a motion, and calls on_posed(index,
// volume) for each. Finite elements use one mesh for all poses. Each solve starts from the shape that the previous
// solve reached (fem_shape.h), even if that solve did not reach its pose.
void resample_sequence(const LabelVolume& volume, const TissueTable& tissues, const Armature& armature,
                       const SkinWeights& weights, const std::vector<Pose>& poses, const Method& method,
                       const ResampleSettings& settings,
                       const std::function<void(std::size_t place, Posed posed)>& on_posed,
                       Progress& progress = no_progress());

}  // namespace limber
