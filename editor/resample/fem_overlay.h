// SPDX-License-Identifier: AGPL-3.0-or-later
// Finite elements looked at: a measure of the solved mesh (core/report/fem_measures.h) as the colours of its voxels,
// through the same field that weights are shown by, and its tets as lines where the views cut. Of a result that keeps
// its mesh, and of a solve that is watched while it settles. What is shown is made beside the editor, once for a mesh
// and a measure.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/deform/preview_map.h"
#include "core/report/fem_measures.h"
#include "render/scene/scene.h"

namespace limber::editor {

struct Editor;

// Scales are the same for all results, so that they can be compared; what lies beyond has the colour of the end.
struct FemScale {
  std::string name, unit;
  double low, high;
  bool ratio;  // even steps are equal ratios
  std::vector<double> ticks;
};
const FemScale& scale_of(FemMeasure measure);
double place_on(const FemScale& scale, double value);   // [0, 1] from its low end to its high one
glm::vec3 colour_at(FemMeasure measure, double place);  // sRGB
glm::vec3 colour_of(FemMeasure measure, float value);   // of joints and where nothing is near: grey
std::string text_of(FemMeasure measure, float value);   // "0.93", "joint"

// A mesh as a volume shows it.
struct ShownMesh {
  std::shared_ptr<const LabelVolume> volume;
  std::shared_ptr<const FemMesh> rest;
  std::shared_ptr<const Eigen::MatrixX3d> posed;  // #V
  bool settling = false;  // the volume's voxels are where the mesh is at rest, and seen through a map

  bool operator==(const ShownMesh&) const = default;
};

// What is made of it.
struct MeasuredMesh {
  ShownMesh of;
  std::optional<FemMeasure> measure;
  std::shared_ptr<const Eigen::MatrixX3i> faces;
  std::shared_ptr<const TissueVoxels> tissue;
  std::shared_ptr<const std::vector<std::int32_t>> tets;  // #tissue
  std::vector<float> values;                              // #T; none without a measure
  float least = 0, most = 0;                              // of flesh
  std::shared_ptr<const std::vector<glm::u8vec3>> field;  // #tissue
};

std::string range_text(const MeasuredMesh& shown);  // "0.17 \u2013 3.30", "up to 12"

struct FemOverlay {
  std::optional<FemMeasure> measure;  // nothing: the tissues
  bool tets = false;
  std::vector<std::shared_ptr<const MeasuredMesh>> made;  // the last ones, newest last
  std::optional<int> task;
};

// Why there is no mesh to look at; "" when there is.
std::string why_no_fem_overlay(const Editor& editor);
// Into the scenes of this frame. After the result or the settling tissue was put there.
void show_fem(Editor& editor);
// Of what the views show; null: nothing is measured there.
const MeasuredMesh* shown_measure(const Editor& editor);
// Of a voxel of what the views show: "det F 0.93"; "" without a measure.
std::string measure_text_at(const Editor& editor, const glm::ivec3& voxel);

}  // namespace limber::editor
