// SPDX-License-Identifier: AGPL-3.0-or-later
// Turns a pose into a posed label volume; the one entry for all methods. A deformation is a set of cells with rest and
// posed vertices (deform/lattice, and by finite elements deform/posed_tets). The cells are rasterized to the inverse
// map (deform/inverse_map), and labels are read through it from the rest volume. So there are no holes to fill, and the
// rest pose gives back the input bit for bit. Every method paints bones rigidly.
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
#include "core/resample/fem.h"
#include "core/rig/pose.h"
#include "core/skin/skin_weights.h"
#include "core/tissue/tissue_table.h"
#include "core/volume_io/volume_io.h"

namespace limber {

using Method = std::variant<Blend, Fem>;

struct ResampleSettings {
  // true: reads labels from the nearest rest voxel, without repairs; false: by the largest interpolated membership.
  bool nearest = false;
  // true: gives soft tissues their rest volumes by moving borders (tissue_volumes.h); not with `nearest`.
  bool mass_exact = false;
  // With mass_exact, Error is thrown when a soft tissue would have to change by more, %.
  double mass_limit_percent = 3;
  std::optional<double> spacing;     // mm, isotropic output spacing; none keeps the input's
  bool displacement = false;         // also return the displacement field
  bool jacobian = false;             // also return det of the Jacobian of the map from rest to the pose
  bool overlap = false;              // also return the voxels in which regions of the body overlap
  const GreyVolume* grey = nullptr;  // grey values to move together with the labels; nullptr: none
  // Faces across which tissue is not connected. Null: all touching tissue is connected.
  std::shared_ptr<const Seams> seams;
};

// Report of the correction that gave soft tissues their rest volumes (mass_exact).
struct MassExactReport {
  struct Tissue {
    // Numbers of posed voxels: wanted, before the correction, and after it.
    std::int64_t wanted = 0, before = 0, after = 0;
  };
  std::map<Label, Tissue> tissues;
  std::int64_t changed_voxels = 0;
};

// Counts and times of one resampling. Metrics that need only the two volumes are computed by compare().
struct DeformReport {
  std::int64_t tissue_voxels = 0;
  std::int64_t dropped_voxels = 0;       // tissue voxels whose image lies outside the output grid
  std::int64_t new_hole_voxels = 0;      // posed voxels inside the image of a tissue cell that carry no label
  std::int64_t overlap_voxels = 0;       // posed voxels in which cells overlap that are no neighbours at rest
  std::int64_t bone_overlap_voxels = 0;  // posed voxels in which bone tissue of two rig bones overlaps
  // Number of voxels that were moved to another tissue to repair skin, connected components (preserve_connectivity.h)
  // and volumes.
  std::int64_t mended_voxels = 0;
  std::int64_t new_skin_voxels = 0;    // voxels made skin because a seam or a stretch exposed flesh or bone
  std::int64_t filled_air_voxels = 0;  // air voxels filled in hollows that the pose closed or made larger
  // Size 65536, by label: number of overlapping voxels that the label lost to another tissue.
  std::vector<std::int64_t> overlap_by_label;
  struct BoneResidual {
    std::string name;
    // Largest distance of a posed bone voxel from the position to which the bone's motion takes its rest point.
    double rigid_residual_mm = 0;
    std::int64_t voxels = 0;  // posed voxels of bone tissue of this rig bone
  };
  std::vector<BoneResidual> bones;              // rig bones with posed bone tissue
  std::optional<SettledFlesh::Report> settled;  // only with mixed blending, and only where something bends
  // Voxels that organs gained (positive) or lost (negative) to keep their volume (organ_volumes.h).
  std::map<Label, std::int64_t> kept_organs;
  std::optional<MassExactReport> mass_exact;
  std::optional<MeshReport> mesh;                     // only with finite elements, and only where something bends
  std::optional<SolveReport> solve;                   // only with finite elements, and only where something bends
  std::optional<double> seconds_mesh, seconds_solve;  // only with finite elements, and only where something bends
  double seconds_deform = 0, seconds_rasterize = 0;
};

struct Posed {
  LabelVolume volume;
  DeformReport report;
  ZeroedVector<glm::vec3> displacement;  // posed - rest, mm, on the output grid; zero in air
  ZeroedVector<float> jacobian;          // on the output grid; zero in air
  // On the output grid. 1: tissue overlaps in the voxel, 2: bone tissue of two bones overlaps.
  ZeroedVector<Label> overlap;
  GreyVolume grey;
  // Only with finite elements, and only where something bends (fem_shape.h).
  std::shared_ptr<const FemShape> shape;
};

// Returns the posed volume. With finite elements, a pose may be out of reach: then the result is the last pose reached
// on the way from rest, and report.solve says so. Throws Error when mass_exact would have to change a soft tissue of
// 5000 voxels or more by more than mass_limit_percent.
Posed resample(const LabelVolume& volume, const TissueTable& tissues, const Armature& armature,
               const SkinWeights& weights, const Pose& pose, const Method& method,
               const ResampleSettings& settings = {}, Progress& progress = no_progress());

// Resamples a sequence of poses, such as the frames of a motion, and calls on_posed with the index and the result of
// each. Finite elements mesh once for all poses and start each solve from the shape that the solve before it reached
// (fem_shape.h), even where that shape falls short of its pose.
void resample_sequence(const LabelVolume& volume, const TissueTable& tissues, const Armature& armature,
                       const SkinWeights& weights, const std::vector<Pose>& poses, const Method& method,
                       const ResampleSettings& settings,
                       const std::function<void(std::size_t place, Posed posed)>& on_posed,
                       Progress& progress = no_progress());

}  // namespace limber
