// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/context/views.h"

#include <cmath>
#include <limits>

#include "core/deform/preview_map.h"
#include "editor/context/arriving_body.h"
#include "editor/context/selection.h"
#include "editor/context/tissue_bounds.h"
#include "render/scene/tissue_appearance.h"

namespace limber::editor {

namespace {

Box box_of_voxels(const Grid& grid, const glm::dvec3& low, const glm::dvec3& high) {
  const AffineTransform world = world_from_voxel(grid);
  Box box{glm::dvec3(std::numeric_limits<double>::max()), glm::dvec3(std::numeric_limits<double>::lowest())};
  for (int corner = 0; corner < 8; ++corner) {
    const glm::dvec3 p =
        world * glm::dvec3(corner & 1 ? high.x : low.x, corner & 2 ? high.y : low.y, corner & 4 ? high.z : low.z);
    box.low = glm::min(box.low, p);
    box.high = glm::max(box.high, p);
  }
  return box;
}

// Memory limit for the textures of one volume, bytes. It suffices for a body of 300 million tissue voxels. A larger
// body is shown at half its resolution, so that it opens within seconds and leaves memory for other work.
constexpr std::int64_t kMostBytes = 1'500'000'000;

}  // namespace

render::Camera between(const render::Camera& from, const render::Camera& to, double t) {
  render::Camera camera = to;
  camera.centre = glm::mix(from.centre, to.centre, t);
  camera.distance = std::exp(glm::mix(std::log(from.distance), std::log(to.distance), t));
  camera.world_from_view = glm::slerp(from.world_from_view, to.world_from_view, t);
  return t < 1 ? camera : to;
}

Views::Views(int largest_texture) : renderer(largest_texture), arriving(std::make_shared<ArrivingBodies>()) {
  renderer.limit_memory(kMostBytes);
  // The first camera looks from the front, a little from the left and from above.
  body.camera = render::orbited(render::looking_from(render::StandardView::Front, body.camera), {-75, 25});
  body.picture = std::make_unique<render::View3D>(renderer);
  for (int axis = 0; axis < 3; ++axis) {
    slices[axis].camera.axis = static_cast<render::SliceAxis>(axis);
    slices[axis].picture = std::make_unique<render::SliceView>(renderer);
  }
}

render::SliceAxis axis_of(ViewId id) {
  return id == ViewId::Sagittal  ? render::SliceAxis::Sagittal
         : id == ViewId::Coronal ? render::SliceAxis::Coronal
                                 : render::SliceAxis::Axial;
}

ViewId view_of(render::SliceAxis axis) {
  return axis == render::SliceAxis::Sagittal  ? ViewId::Sagittal
         : axis == render::SliceAxis::Coronal ? ViewId::Coronal
                                              : ViewId::Axial;
}

SliceState& slice_of(Views& views, ViewId id) { return views.slices[static_cast<std::size_t>(axis_of(id))]; }

std::string name_of(ViewId id) {
  constexpr const char* kNames[] = {"3D view", "Axial", "Coronal", "Sagittal"};
  return kNames[static_cast<int>(id)];
}

namespace {
// Returns the low and high corner of the clip box in voxels. A face at the volume's border is moved far away, because
// it must not cut a posed body that reaches beyond the volume.
std::array<glm::dvec3, 2> cut_of(const ClipBox& box, const Grid& grid) {
  constexpr double kFar = 1e6;  // position of a face that cuts nothing, voxels
  std::array<glm::dvec3, 2> cut{box.low, box.high};
  for (int axis = 0; axis < 3; ++axis) {
    if (box.low[axis] <= -0.5) cut[0][axis] = -kFar;
    if (box.high[axis] >= grid.size[axis] - 0.5) cut[1][axis] = kFar;
  }
  return cut;
}
}  // namespace

void update_scene(Views& views, const Document& document, const Selection& selection, bool dark_theme) {
  render::Scene& scene = views.scene;
  const auto tissues = views.preview_tissues ? views.preview_tissues : document.tissues;
  const auto visibility = views.preview_visibility ? views.preview_visibility : document.visibility;
  scene.volume = document.volume;
  if (!scene.looks || views.looks_of_tissues != tissues || views.looks_of_visibility != visibility) {
    scene.looks = std::make_shared<const render::LabelLooks>(
        tissues ? render::looks_of(*tissues, visibility ? *visibility : Visibility{}) : render::LabelLooks{});
    views.looks_of_tissues = tissues;
    views.looks_of_visibility = visibility;
  }
  scene.grey = views.image;
  // A document without tissue, such as a CT without labels, would show nothing in any display except that of the image.
  const bool is_bare = views.image && document.volume && tissues && tissues->tissues.empty();
  scene.display = is_bare                                                   ? render::Display::Image
                  : views.display == render::Display::Image && !views.image ? render::Display::Solid
                                                                            : views.display;
  scene.clip = {};
  if (document.volume && visibility && visibility->clip_box.enabled)
    scene.clip.box = cut_of(visibility->clip_box, document.volume->grid);
  if (visibility && visibility->clip_plane.enabled)
    scene.clip.plane = {visibility->clip_plane.point, visibility->clip_plane.normal};
  scene.outlined = selection.tissue;
  scene.armature = !views.bones ? nullptr : views.preview_armature ? views.preview_armature : document.armature;
  scene.bone_shape = views.bone_shape;
  scene.bones_in_front =
      views.bones_in_front || scene.display == render::Display::XRay || scene.display == render::Display::Image;
  scene.bones.assign(scene.armature ? scene.armature->bones.size() : 0, {});
  for (const int bone : selection.bones)
    if (bone < std::ssize(scene.bones)) scene.bones[bone].selected = true;
  if (selection.bone && *selection.bone < std::ssize(scene.bones))
    scene.bones[*selection.bone].active = scene.bones[*selection.bone].selected = true;
  scene.grid = views.grid;
  scene.dark_background = dark_theme;
}

Box world_box(const Document& document) {
  if (!document.volume) return {glm::dvec3(-150), glm::dvec3(150)};
  return box_of_voxels(document.volume->grid, glm::dvec3(-0.5), glm::dvec3(document.volume->grid.size) - 0.5);
}

Box tissue_box(Views& views, const Document& document, std::optional<Label> tissue) {
  if (!document.volume) return world_box(document);
  if (!views.extents || views.extents->volume != document.volume)
    views.extents = std::make_shared<const Extents>(extents_of(document.volume));
  VoxelBox box;
  if (tissue) box = views.extents->boxes[*tissue];
  else if (document.tissues)
    for (const Tissue& t : document.tissues->tissues)
      if (!document.visibility || !document.visibility->looks.contains(t.label) ||
          document.visibility->looks.at(t.label).visible)
        box.add(views.extents->boxes[t.label]);
  if (box.empty()) return world_box(document);
  return box_of_voxels(document.volume->grid, glm::dvec3(box.low) - 0.5, glm::dvec3(box.high) + 0.5);
}

const std::shared_ptr<const TissueVoxels>& tissue_voxels(Views& views, const Document& document) {
  if (views.tissue_voxels_of != document.volume) {
    views.tissue_voxels = std::make_shared<const TissueVoxels>(*document.volume);
    views.tissue_voxels_of = document.volume;
  }
  return views.tissue_voxels;
}

std::vector<BoneWeight> weights_at(Views& views, const Document& document, const glm::ivec3& voxel) {
  const auto& shown = views.preview_weights ? views.preview_weights : document.weights;
  if (!shown || !document.volume || !document.volume->grid.contains(voxel)) return {};
  const TissueVoxels& tissue = *tissue_voxels(views, document);
  const std::int64_t place = tissue.index_of(voxel);
  if (place < 0 || tissue.size() != shown->size()) return {};
  const int brick = tissue.brick_at(voxel);
  const Influence& influence = shown->chunk(brick)[place - tissue.bricks()[brick].first];
  std::vector<BoneWeight> weights;
  for (int i = 0; i < 4; ++i)
    if (influence.weight[i])
      weights.push_back({shown->bones()[influence.bone[i]], influence.weight[i] / double(kFullWeight)});
  return weights;
}

std::optional<glm::ivec3> voxel_shown_at(const render::Scene& scene, const glm::dvec3& world) {
  const glm::dvec3 place = voxel_from_world(scene.volume->grid) * world;
  const auto rest = scene.pose ? scene.pose->rest_at(place) : std::optional(place);
  if (!rest) return std::nullopt;
  return glm::ivec3(glm::floor(*rest + 0.5));
}

void shift(SliceState& slice, const glm::dvec2& pixels) {
  const render::SliceFrame frame = render::frame_of(slice.camera.axis);
  slice.camera.centre -= (frame.right * pixels.x + frame.down * pixels.y) * slice.camera.millimetres_per_pixel;
}

void fit(SliceState& slice, const Box& box, const glm::vec2& size) {
  constexpr double kShare = 0.86;  // fraction of the picture's width or height that the box fills
  const render::SliceFrame frame = render::frame_of(slice.camera.axis);
  const glm::dvec3 extent = box.high - box.low;
  const glm::dvec2 millimetres{glm::dot(glm::abs(frame.right), extent), glm::dot(glm::abs(frame.down), extent)};
  const glm::dvec2 pixels = glm::max(glm::dvec2(size) * kShare, 1.0);
  slice.camera.centre = (box.low + box.high) * 0.5;
  slice.camera.millimetres_per_pixel = std::max({millimetres.x / pixels.x, millimetres.y / pixels.y, 1e-4});
  slice.fitted = true;
}

glm::dvec3 middle_of_body(const Document& document, const Box& box) {
  const glm::dvec3 middle = (box.low + box.high) * 0.5;
  if (!document.volume) return middle;
  const LabelVolume& volume = *document.volume;
  const int z = static_cast<int>(
      std::lround(glm::clamp((voxel_from_world(volume.grid) * middle).z, 0.0, volume.grid.size.z - 1.0)));
  glm::dvec2 sum(0);
  std::int64_t count = 0;
  for (int y = 0; y < volume.grid.size.y; ++y)
    for (int x = 0; x < volume.grid.size.x; ++x)
      if (volume.at({x, y, z}) != 0) {
        sum += glm::dvec2(x, y);
        ++count;
      }
  return count == 0 ? middle
                    : world_from_voxel(volume.grid) * glm::dvec3(glm::round(sum / static_cast<double>(count)), z);
}

glm::dvec3 world_of(const render::SliceCamera& camera, const glm::vec2& pixel, const glm::vec2& size) {
  const render::SliceFrame frame = render::frame_of(camera.axis);
  const glm::dvec2 millimetres = glm::dvec2(pixel - size * 0.5f) * camera.millimetres_per_pixel;
  return camera.centre + frame.right * millimetres.x + frame.down * millimetres.y;
}

glm::vec2 pixel_of(const render::SliceCamera& camera, const glm::dvec3& world, const glm::vec2& size) {
  const render::SliceFrame frame = render::frame_of(camera.axis);
  const glm::dvec3 offset = (world - camera.centre) / camera.millimetres_per_pixel;
  return size * 0.5f + glm::vec2(glm::dot(offset, frame.right), glm::dot(offset, frame.down));
}

}  // namespace limber::editor
