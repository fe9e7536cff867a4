// SPDX-License-Identifier: AGPL-3.0-or-later
// The one entry from a pose to a posed label volume. Deformation is cells with rest and posed vertices (deform/lattice,
// and by finite elements deform/posed_tets), rasterized to the inverse map (deform/inverse_map); labels are then read
// from the rest volume, so there are no holes to fill and the rest pose gives back the input bit for bit. Bones are
// painted rigidly by every method.
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
  bool nearest = false;  // labels by the nearest rest voxel instead of the largest interpolated membership; no mending
  bool mass_exact =
      false;  // soft tissues get their rest volumes by moving borders (tissue_volumes.h); not with `nearest`
  double mass_limit_percent = 3;       // a soft tissue that would have to change by more is refused
  std::optional<double> spacing;       // mm, isotropic output spacing; none keeps the input's
  bool displacement = false;           // also return the displacement field
  bool jacobian = false;               // also return det of the posed-from-rest map
  bool overlap = false;                // also return where the body claims a voxel twice
  const GreyVolume* grey = nullptr;    // moved by the same map
  std::shared_ptr<const Seams> seams;  // across which tissue does not hang together; none: all that touches does
};

// What it took to give soft tissues their rest volumes.
struct MassExactReport {
  struct Tissue {
    std::int64_t wanted = 0, before = 0, after = 0;  // posed voxels
  };
  std::map<Label, Tissue> tissues;
  std::int64_t changed_voxels = 0;
};

// What the resampling itself saw; compare() adds what two volumes tell.
struct DeformReport {
  std::int64_t tissue_voxels = 0;
  std::int64_t dropped_voxels = 0;       // tissue voxels whose image lies outside the output grid
  std::int64_t new_hole_voxels = 0;      // posed voxels inside the image of a tissue cell that carry no label
  std::int64_t overlap_voxels = 0;       // posed voxels claimed by cells that are no neighbours at rest
  std::int64_t bone_overlap_voxels = 0;  // posed voxels claimed by two rig bones' bone tissue
  std::int64_t mended_voxels =
      0;  // given to a neighbouring tissue where the pose had torn it: skin, connected parts (preserve_connectivity.h)
  std::int64_t new_skin_voxels = 0;            // flesh that a seam or a stretch laid bare, and that is skin now
  std::int64_t filled_air_voxels = 0;          // of hollows that the pose closed or made larger
  std::vector<std::int64_t> overlap_by_label;  // [65536], rest voxels that lost their place, by label
  struct BoneResidual {
    std::string name;
    double rigid_residual_mm = 0;  // largest distance of a bone voxel from where the bone's motion takes its rest point
    std::int64_t voxels = 0;       // posed bone tissue voxels of this rig bone
  };
  std::vector<BoneResidual> bones;              // those with bone tissue
  std::optional<SettledFlesh::Report> settled;  // by mixed blending, where anything bends
  std::map<Label, std::int64_t>
      kept_organs;  // voxels that small organs were given, or gave, to keep their volume (organ_volumes.h)
  std::optional<MassExactReport> mass_exact;
  std::optional<MeshReport> mesh;  // by finite elements, where anything bends
  std::optional<SolveReport> solve;
  std::optional<double> seconds_mesh, seconds_solve;
  double seconds_deform = 0, seconds_rasterize = 0;
};

struct Posed {
  LabelVolume volume;
  DeformReport report;
  ZeroedVector<glm::vec3> displacement;  // posed - rest, mm, on the output grid; zero in air
  ZeroedVector<float> jacobian;          // on the output grid; zero in air
  ZeroedVector<Label>
      overlap;  // on the output grid; 1 where two places of tissue claim the voxel, 2 where two bones do
  GreyVolume grey;
  std::shared_ptr<const FemShape> shape;  // by finite elements, where anything bends (fem_shape.h)
};

// Throws Error when mass_exact would have to change a soft tissue of 5000 voxels or more by more than
// mass_limit_percent. By finite elements a pose that cannot be reached ends where report.solve says.
Posed resample(const LabelVolume& volume, const TissueTable& tissues, const Armature& armature,
               const SkinWeights& weights, const Pose& pose, const Method& method,
               const ResampleSettings& settings = {}, Progress& progress = no_progress());

// The same for a run of poses, as the frames of a motion, handed over one after the other with their place in the list.
// Finite elements mesh once for all of them and start each from the shape of the one before (fem_shape.h); what of a
// pose could not be reached, the next one starts from.
void resample_sequence(const LabelVolume& volume, const TissueTable& tissues, const Armature& armature,
                       const SkinWeights& weights, const std::vector<Pose>& poses, const Method& method,
                       const ResampleSettings& settings,
                       const std::function<void(std::size_t place, Posed posed)>& on_posed,
                       Progress& progress = no_progress());

}  // namespace limber
