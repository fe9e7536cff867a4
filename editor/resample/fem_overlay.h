// SPDX-License-Identifier: AGPL-3.0-or-later
// Shows finite elements: colours voxels by a measure of the solved mesh (core/report/fem_measures.h), and draws the
// mesh's tets as lines where slices and clip planes cut them. Works for a result that was stored with its mesh, and for
// a running solve that the user watches. A task computes the colours once for a mesh and a measure.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/deform/preview_map.h"
#include "core/report/fem_measures.h"
#include "render/scene/scene.h"

namespace limber::editor {

struct Context;

// The colour scale of a measure. It is the same for all results, so that results can be compared. Values beyond an end
// of the scale have the colour of that end.
struct FemScale {
  std::string name, unit;
  double low, high;
  bool ratio;  // true: the scale is logarithmic
  std::vector<double> ticks;
};
const FemScale& scale_of(FemMeasure measure);
// Returns the position of the value on the scale: 0 at `low`, 1 at `high`.
double place_on(const FemScale& scale, double value);
glm::vec3 colour_at(FemMeasure measure, double place);  // returns the colour at a position of the scale, sRGB
// Returns the colour of a value of a measure, sRGB; grey for the tets in joints, which have no value, and for a gap if
// no other skin is near.
glm::vec3 colour_of(FemMeasure measure, float value);
std::string text_of(FemMeasure measure, float value);  // returns the value as text: "0.93", "joint"

// A tet mesh, and the label volume whose voxels are coloured by the tets that they lie in.
struct ShownMesh {
  std::shared_ptr<const LabelVolume> volume;
  std::shared_ptr<const FemMesh> rest;
  std::shared_ptr<const Eigen::MatrixX3d> posed;  // #V by 3: positions of the nodes in the pose, world, mm
  bool settling = false;  // true: a solve is running; `volume` is at rest and is drawn deformed by the mesh

  bool operator==(const ShownMesh&) const = default;
};

// A tet mesh with its values of one measure, such as the volume ratio, and the voxel colours of these values.
struct MeasuredMesh {
  ShownMesh of;
  std::optional<FemMeasure> measure;
  std::shared_ptr<const Eigen::MatrixX3i> faces;
  std::shared_ptr<const TissueVoxels> tissue;
  // For each tissue voxel, the index of the tet at the voxel; -1: there is no tet.
  std::shared_ptr<const std::vector<std::int32_t>> tets;
  std::vector<float> values;                              // the measure of each tet; empty: no measure is shown
  float least = 0, most = 0;                              // least and largest of `values` in soft tissue
  std::shared_ptr<const std::vector<glm::u8vec3>> field;  // for each tissue voxel, its colour, sRGB
};

// Returns the range of the values as text: "0.17 \u2013 3.30", "up to 12".
std::string range_text(const MeasuredMesh& shown);

struct FemOverlay {
  std::optional<FemMeasure> measure;  // the measure that colours show; none: voxels have the colours of their tissues
  bool tets = false;
  std::vector<std::shared_ptr<const MeasuredMesh>> made;  // cache of meshes with their colours, newest last
  std::optional<int> task;
};

// Returns why there is no FEM mesh to show, such as "Resample by FEM first"; "" when there is a mesh.
std::string why_no_fem_overlay(const Context& context);
// Puts the FEM colours and tets into the scenes of this frame. Call it after show_posed(), which puts the result or the
// watched solve into the scenes.
void show_fem(Context& context);
// Returns the mesh whose colours the views show; null if they show no such colours.
const MeasuredMesh* shown_measure(const Context& context);
// Returns the shown measure's value at a voxel of the shown volume, such as "det F 0.93"; "" if no measure is shown.
std::string measure_text_at(const Context& context, const glm::ivec3& voxel);

}  // namespace limber::editor
