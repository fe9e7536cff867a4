// SPDX-License-Identifier: AGPL-3.0-or-later
// The pictures of the body in the middle of the window: one in 3D and three slices, linked by a cross-hair.
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "core/project/document.h"
#include "core/volume/tissue_voxels.h"
#include "editor/context/layout.h"
#include "editor/context/tissue_bounds.h"
#include "render/scene/scene.h"
#include "render/view.h"

namespace limber::editor {

// A camera on its way: eased out over 180 ms, ended by any input.
struct CameraMove {
  render::Camera from, to;
  double start = 0;
};
render::Camera between(const render::Camera& from, const render::Camera& to, double t);  // t in [0, 1]

struct BodyView {
  render::Camera camera;
  std::optional<CameraMove> move;
  std::string name;  // "Front", while seen from there; else empty
  std::unique_ptr<render::View3D> picture;
  std::unique_ptr<render::View3D> other;  // of the scene that it is compared with
};

struct SliceState {
  render::SliceCamera camera;
  bool fitted = false;  // to the body, which waits until the slice is shown and has a size
  std::unique_ptr<render::SliceView> picture, other;
};

// What is picked in the scene. Not a part of the document: choosing is no edit.
struct Selection {
  std::optional<Label> tissue;  // the active one
  std::set<Label> tissues;      // with the active one
  std::optional<int> bone;
  std::set<int> bones;
};

// One of the things that lie under the pointer.
struct Pickable {
  std::optional<int> bone;  // none: the tissue
  Label tissue = 0;

  bool operator==(const Pickable&) const = default;
};

struct BoneWeight {
  std::string bone;
  double value;  // of 1
};

// What the pointer is over.
struct Hover {
  std::optional<ViewId> view;
  bool inside = false;  // of the body
  Label label = 0;
  glm::ivec3 voxel{0};              // at rest where the body is posed
  glm::dvec3 point{0};              // where the pointer is
  std::vector<BoneWeight> weights;  // of that voxel, largest first; empty where there are none
};

struct Views {
  // Needs a current context; throws Error when it is too old.
  explicit Views(int largest_texture = 0);

  render::Renderer renderer;
  BodyView body;
  std::array<SliceState, 3> slices;  // by render::SliceAxis
  glm::dvec3 cross_hair{0};          // world, mm
  bool show_cross_hair = true;
  render::Display display = render::Display::Solid;
  render::SliceDisplay slice_display = render::SliceDisplay::Labels;
  bool grid = true, axes = true, scale_bar = true, letters = true, bones = true;
  render::BoneShape bone_shape = render::BoneShape::Octahedron;
  bool bone_names = false, bone_axes = false, bones_in_front = false;
  ViewId active = ViewId::Body;
  Hover hover;

  std::shared_ptr<const Extents> extents;             // of the document's volume
  std::shared_ptr<const TissueVoxels> tissue_voxels;  // likewise, once weights are asked for
  std::shared_ptr<const LabelVolume> tissue_voxels_of;
  // What is shown instead of the document's while the user drags; dropped or committed at the end.
  std::shared_ptr<const Visibility> preview_visibility;
  std::shared_ptr<const TissueTable> preview_tissues;
  std::shared_ptr<const Pose> preview_pose;
  std::shared_ptr<const Armature> preview_armature;
  std::shared_ptr<const SkinWeights> preview_weights;
  glm::vec2 handle_from{0};                  // where the pointer pressed the handle that is dragged
  render::Scene scene;                       // of the last frame
  std::optional<render::Scene> other_scene;  // what it is compared with; nothing: no comparison
  std::shared_ptr<const TissueTable> looks_of_tissues;
  std::shared_ptr<const Visibility> looks_of_visibility;
};

render::SliceAxis axis_of(ViewId id);
ViewId view_of(render::SliceAxis axis);
SliceState& slice_of(Views& views, ViewId id);
std::string name_of(ViewId id);

// The scene that shows this document.
void update_scene(Views& views, const Document& document, const Selection& selection, bool dark_theme);

// World box of the volume's grid, or of 300 mm without one.
struct Box {
  glm::dvec3 low, high;
};
Box world_box(const Document& document);
// The same around one tissue, or around all that are visible.
Box tissue_box(Views& views, const Document& document, std::optional<Label> tissue);

// The voxel that a scene shows at a point of the world; none where that is nothing of a posed body.
std::optional<glm::ivec3> voxel_shown_at(const render::Scene& scene, const glm::dvec3& world);

// Shifts what a slice shows by so many pixels.
void shift(SliceState& slice, const glm::dvec2& pixels);
// The tissue voxels of the document's volume, found once; it has one.
const std::shared_ptr<const TissueVoxels>& tissue_voxels(Views& views, const Document& document);
// The weights of a voxel of the document's volume.
std::vector<BoneWeight> weights_at(Views& views, const Document& document, const glm::ivec3& voxel);

// The slice's camera sees that box, `size` pixels large.
void fit(SliceState& slice, const Box& box, const glm::vec2& size);
// A point inside the body near the middle of that box: the middle of what its axial slice there holds.
glm::dvec3 middle_of_body(const Document& document, const Box& box);

// The slice picture of `camera`, `size` pixels large, as points of the world and back.
glm::dvec3 world_of(const render::SliceCamera& camera, const glm::vec2& pixel, const glm::vec2& size);
glm::vec2 pixel_of(const render::SliceCamera& camera, const glm::dvec3& world, const glm::vec2& size);

}  // namespace limber::editor
