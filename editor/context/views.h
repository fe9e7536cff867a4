// SPDX-License-Identifier: AGPL-3.0-or-later
// The state of the views in the middle of the window: a 3D view and three slices, linked by a cross-hair.
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/base/file.h"
#include "core/project/document.h"
#include "core/volume/tissue_voxels.h"
#include "editor/context/view_place.h"
#include "render/scene/scene.h"
#include "render/view.h"

namespace limber::editor {

class ArrivingBodies;
struct Extents;
struct Selection;

// A move of the camera, shown as an animation of 180 ms that slows down towards its end. Any input ends the animation.
struct CameraMove {
  render::Camera from, to;
  double start = 0;
};
// Returns the camera at a fraction t of a camera move, [0, 1].
render::Camera between(const render::Camera& from, const render::Camera& to, double t);

struct BodyView {
  render::Camera camera;
  std::optional<CameraMove> move;
  // Name of the standard view that the camera shows, such as "Front"; empty if the camera was turned away from them.
  std::string name;
  std::unique_ptr<render::View3D> picture;
  std::unique_ptr<render::View3D> other;    // picture of result A (Views::other_scene) in a comparison
  std::unique_ptr<render::View3D> refined;  // picture of Views::refined_scene
  bool shows_refined = false;  // true: the view shows `refined`, which has been complete once, instead of `picture`
};

struct SliceState {
  render::SliceCamera camera;
  bool fitted = false;  // true: the camera shows the whole body, for which the view's size had to be known
  std::unique_ptr<render::SliceView> picture, other;
};

struct BoneWeight {
  std::string bone;
  double value;  // the weight, [0, 1]
};

// What is under the pointer in the views.
struct Hover {
  std::optional<ViewId> view;
  bool inside = false;  // true: the point is inside the body
  Label label = 0;
  glm::ivec3 voxel{0};              // voxel of the volume at rest, even if the body is shown posed
  glm::dvec3 point{0};              // the point under the pointer, world, mm
  std::vector<BoneWeight> weights;  // skin weights of the voxel, largest first; empty if it has none
};

class ScratchFolder;

// The grey image that was posed together with a result.
struct PosedImage {
  std::weak_ptr<const LabelVolume> result;  // the volume of the result that was posed together with the image
  std::shared_ptr<const GreyLevels> levels;
  std::shared_ptr<const ScratchFolder> folder;  // folder of `file`; deleted when no result needs the file any more
  Path file;                                    // file with the posed image, in the original image's grey values
};

struct Views {
  // Creates the renderer and the pictures of the views. Needs a current OpenGL context. Throws Error when the context
  // is older than OpenGL 3.3.
  //   largest_texture  largest number of texels per axis of a 3D texture; 0: the driver's limit
  explicit Views(int largest_texture = 0);

  render::Renderer renderer;
  std::shared_ptr<ArrivingBodies> arriving;  // the bodies that wait for their upload; never null
  BodyView body;
  std::array<SliceState, 3> slices;  // the three slices, indexed by render::SliceAxis
  glm::dvec3 cross_hair{0};          // the point at which the three slices meet, world, mm
  bool show_cross_hair = true;
  render::Display display = render::Display::Solid;
  render::SliceDisplay slice_display = render::SliceDisplay::Labels;
  bool grid = true, axes = true, scale_bar = true, letters = true, bones = true, rulers = false;
  render::BoneShape bone_shape = render::BoneShape::Octahedron;
  bool bone_names = false, bone_axes = false, bones_in_front = false;
  std::optional<render::ShownGrey> image;  // the grey image shown with the labels (editor/volume/shown_image.h)
  Path image_path;                         // the file or the DICOM folder from which `image` was read
  std::vector<PosedImage> posed_images;    // grey images that were posed together with results
  ViewId active = ViewId::Body;
  Hover hover;

  std::shared_ptr<const Extents> extents;  // the tissues' bounding boxes in the document's volume
  // Tissue voxels of the volume `tissue_voxels_of`; computed at first use.
  std::shared_ptr<const TissueVoxels> tissue_voxels;
  std::shared_ptr<const LabelVolume> tissue_voxels_of;
  // Objects that the views show instead of the document's objects while the user drags. When the drag ends, they are
  // committed to the document or discarded. Null: the view shows the document's object.
  std::shared_ptr<const Visibility> preview_visibility;
  std::shared_ptr<const TissueTable> preview_tissues;
  std::shared_ptr<const Pose> preview_pose;
  std::shared_ptr<const Armature> preview_armature;
  std::shared_ptr<const SkinWeights> preview_weights;
  glm::vec2 handle_from{0};                  // the pointer's position when the drag of a handle began, pixels
  render::Scene scene;                       // the scene of the last frame
  std::optional<render::Scene> other_scene;  // scene of result A in a comparison; no value: no comparison
  // The scene with the resampled volume of the shown pose, which pictures show instead of `scene`; no value: the pose
  // is not refined (resample/refined_pose.h).
  std::optional<render::Scene> refined_scene;
  std::shared_ptr<const TissueTable> looks_of_tissues;
  std::shared_ptr<const Visibility> looks_of_visibility;
};

render::SliceAxis axis_of(ViewId id);
ViewId view_of(render::SliceAxis axis);
SliceState& slice_of(Views& views, ViewId id);
std::string name_of(ViewId id);

// Returns the scene that pictures show: that of the refined pose, or else Views::scene.
inline const render::Scene& drawn_scene(const Views& views) {
  return views.refined_scene ? *views.refined_scene : views.scene;
}

// Sets Views::scene to the scene that shows this document.
void update_scene(Views& views, const Document& document, const Selection& selection, bool dark_theme);

// A box in the world, mm. world_box() returns the bounding box of the volume's grid, or without a volume a cube of 300
// mm.
struct Box {
  glm::dvec3 low, high;
};
Box world_box(const Document& document);
// Returns the bounding box in the world, mm, of one tissue, or of all visible tissues if `tissue` has no value. If
// these tissues have no voxels, returns the volume's box.
Box tissue_box(Views& views, const Document& document, std::optional<Label> tissue);

// Returns the voxel of the volume at rest that is shown at a world point of the scene. The body in the scene may be
// posed. Returns no value if there is no tissue at the point.
std::optional<glm::ivec3> voxel_shown_at(const render::Scene& scene, const glm::dvec3& world);

// Moves a slice's picture by `pixels`.
void shift(SliceState& slice, const glm::dvec2& pixels);
// Returns the tissue voxels of the document's volume. They are computed once for each volume. The document must have a
// volume.
const std::shared_ptr<const TissueVoxels>& tissue_voxels(Views& views, const Document& document);
// Returns the skin weights of a voxel of the document's volume; empty if the voxel has none. While a tool previews
// changed weights (Views::preview_weights), returns the changed weights.
std::vector<BoneWeight> weights_at(Views& views, const Document& document, const glm::ivec3& voxel);

// Sets the slice's camera so that a view of `size` pixels shows the whole box.
void fit(SliceState& slice, const Box& box, const glm::vec2& size);
// Returns a point near the middle of the box that very likely lies inside the body. It is the centroid of the tissue in
// the axial slice through the middle of the box.
glm::dvec3 middle_of_body(const Document& document, const Box& box);

// These functions convert a pixel of a slice view, which is `size` pixels large, to a world point in mm and back.
glm::dvec3 world_of(const render::SliceCamera& camera, const glm::vec2& pixel, const glm::vec2& size);
glm::vec2 pixel_of(const render::SliceCamera& camera, const glm::dvec3& world, const glm::vec2& size);

}  // namespace limber::editor
