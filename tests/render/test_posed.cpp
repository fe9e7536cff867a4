// SPDX-License-Identifier: AGPL-3.0-or-later
#include <utility>

#include "core/binding/heat_diffusion.h"
#include "core/deform/preview_map.h"
#include "core/phantom/phantom.h"
#include "core/resample/resample.h"
#include "core/rig_io/rig_io.h"
#include "core/volume_io/volume_io.h"
#include "tests/render/studio.h"
#include "tests/support/bent_tube.h"
#include "tests/support/shared_data.h"

using namespace limber;
using namespace limber::render;
using namespace limber::test;

namespace {

// The arm at 2 mm with its skin weights.
struct Arm {
  std::shared_ptr<const LabelVolume> volume;
  TissueTable tissues;
  Armature rig;
  TissueVoxels tissue;
  SkinWeights weights;

  Arm() {
    Phantom phantom = make_arm_phantom(2);
    tissues = phantom.tissues;
    rig = phantom.armature;
    tissue = TissueVoxels(phantom.volume);
    weights = diffuse_heat(phantom.volume, tissues, rig);
    volume = std::make_shared<const LabelVolume>(std::move(phantom.volume));
  }
  Pose bent(double degrees) const {
    Pose pose = rest_pose(rig);
    flex(pose, rig, require_bone(rig, "Forearm"), degrees);
    return pose;
  }
  std::shared_ptr<const PreviewMap> map(const Pose& pose, Blend blend) const {
    return LivePreview(volume, tissues, tissue, weights, 4).update(posed_from_rest(rig, pose), blend);
  }
  Scene scene() const { return scene_of(volume, std::make_shared<const LabelLooks>(looks_of(tissues))); }
  Scene posed(const Pose& pose, Blend blend) const {
    Scene result = scene();
    result.pose = map(pose, blend);
    return result;
  }
  Scene resampled(const Pose& pose, const Method& method) const {
    Scene result = scene();
    result.volume = std::make_shared<const LabelVolume>(resample(*volume, tissues, rig, weights, pose, method).volume);
    return result;
  }
};

const Arm& arm() {
  static const Arm made;
  return made;
}

// Returns the pixels that only one of the two silhouettes covers, as a fraction of the silhouette of `b`.
double silhouette_difference(const Image& a, const Image& b) {
  int apart = 0;
  for (size_t i = 3; i < a.rgba.size(); i += 4) apart += (a.rgba[i] > 127) != (b.rgba[i] > 127);
  return double(apart) / covered(b);
}

// Returns the fraction of pixels with similar colours among those that both pictures cover.
double colours_agree(const Image& a, const Image& b) {
  int both = 0, near = 0;
  for (size_t i = 0; i < a.rgba.size(); i += 4) {
    if (a.rgba[i + 3] < 128 || b.rgba[i + 3] < 128) continue;
    int most = 0;
    for (size_t c = i; c < i + 3; ++c) most = std::max(most, std::abs(int(a.rgba[c]) - int(b.rgba[c])));
    ++both;
    near += most <= 24;
  }
  return double(near) / both;
}

constexpr glm::ivec2 kSize{480, 480};

// Returns the displacements that resample() found for each voxel as a preview map, before the labels are resampled.
std::shared_ptr<const PreviewMap> dense_map(const LabelVolume& volume, const Posed& posed) {
  auto map = std::make_shared<PreviewMap>();
  map->step = 1;
  map->grid = volume.grid;
  const AffineTransform to_voxel = voxel_from_world(volume.grid);
  constexpr int kAround = 3;  // margin around the result, in voxels
  map->first = glm::ivec3(glm::round(to_voxel * posed.volume.grid.origin)) - kAround;
  map->size = posed.volume.grid.size + 2 * kAround;
  map->low = glm::dvec3(-16);
  map->extent = glm::dvec3(volume.grid.size) + 32.0;
  const auto count = size_t(map->size.x) * map->size.y * map->size.z;
  map->nodes.assign(count, glm::u16vec4(0));
  map->cubes.assign(count, PreviewMap::kNothing);
  map->apart.assign(count, 0);
  map->reach.resize(count);
  std::vector<glm::dvec3> moved(count);  // displacement, in voxels
  const auto set = [&](const glm::ivec3& n, const glm::dvec3& by) {
    const glm::dvec3 rest = glm::dvec3(map->first + n) - by, fraction = (rest - map->low) / map->extent;
    if (glm::any(glm::lessThan(fraction, glm::dvec3(0))) || glm::any(glm::greaterThan(fraction, glm::dvec3(1)))) return;
    moved[map->index(n)] = by;
    map->nodes[map->index(n)] =
        glm::u16vec4(glm::u16vec3(glm::round(fraction * double(PreviewMap::kFullFraction))), PreviewMap::kFullFraction);
  };
  const auto each = [&](const auto& body) {
    for (int z = 0; z < map->size.z; ++z)
      for (int y = 0; y < map->size.y; ++y)
        for (int x = 0; x < map->size.x; ++x) body(glm::ivec3(x, y, z));
  };
  each([&](const glm::ivec3& n) {
    const glm::ivec3 v = n - kAround;
    if (posed.volume.at_or_air(v) != 0)
      set(n, to_voxel.linear * glm::dvec3(posed.displacement[posed.volume.grid.index(v)]));
  });
  // Displacements are extrapolated linearly to the voxels just outside.
  for (int ring = 0; ring < 2; ++ring) {
    std::vector<std::pair<glm::ivec3, glm::dvec3>> found;
    each([&](const glm::ivec3& n) {
      if (map->covers(n) || glm::any(glm::lessThan(n, glm::ivec3(2))) ||
          glm::any(glm::greaterThanEqual(n, map->size - 2)))
        return;
      glm::dvec3 sum(0);
      int neighbours = 0;
      for (int axis = 0; axis < 3; ++axis)
        for (int sign : {-1, 1}) {
          glm::ivec3 next = n, second = n;
          next[axis] += sign;
          second[axis] += 2 * sign;
          if (!map->covers(next) || !map->covers(second)) continue;
          const glm::dvec3 here = moved[map->index(next)], there = moved[map->index(second)];
          if (glm::length(here - there) < 2) sum += 2.0 * here - there, ++neighbours;
        }
      if (neighbours) found.emplace_back(n, sum / double(neighbours));
    });
    for (const auto& [n, by] : found) set(n, by);
  }
  each([&](const glm::ivec3& n) {
    if (glm::any(glm::greaterThanEqual(n, map->size - 1))) return;
    glm::dvec3 low(1e9), high(-1e9);
    glm::u16vec3 least(65535), most(0);
    for (int i = 0; i < 8; ++i) {
      const glm::ivec3 c = n + glm::ivec3(i & 1, i >> 1 & 1, i >> 2);
      if (!map->covers(c)) continue;
      low = glm::min(low, map->rest_of_node(c));
      high = glm::max(high, map->rest_of_node(c));
      least = glm::min(least, glm::u16vec3(map->nodes[map->index(c)]));
      most = glm::max(most, glm::u16vec3(map->nodes[map->index(c)]));
    }
    if (low.x > high.x) return;
    map->cubes[map->index(n)] =
        glm::any(glm::greaterThan(high - low, glm::dvec3(map->jump()))) ? PreviewMap::kBroken : PreviewMap::kWhole;
    map->reach[map->index(n)] = {least, most};
  });
  return map;
}

// Compares three outlines, from three sides: that of the preview, that of the body drawn by the dense map (the
// displacement of every voxel), and that of the resampled labels. Resampling the labels alone moves the outline by 0.2
// to 1.1 % of its area even if an arm only rotates. So the preview may differ from the labels by as much as the dense
// map does, and 0.2 % more.
void check_outline(const std::shared_ptr<const LabelVolume>& volume, const TissueTable& tissues, const Armature& rig,
                   const TissueVoxels& tissue, const SkinWeights& weights, const Pose& pose, bool linear) {
  Studio studio;
  Scene coarse = scene_of(volume, std::make_shared<const LabelLooks>(looks_of(tissues))), fine = coarse,
        labels = coarse;
  coarse.pose = LivePreview(volume, tissues, tissue, weights, 4)
                    .update(posed_from_rest(rig, pose), linear ? Blend::Linear : Blend::DualQuaternion);
  const Posed posed = resample(*volume, tissues, rig, weights, pose,
                               linear ? Method(Blend::Linear) : Method(Blend::DualQuaternion), {.displacement = true});
  fine.pose = dense_map(*volume, posed);
  labels.volume = std::make_shared<const LabelVolume>(posed.volume);
  const Camera front = camera_of(posed.volume.grid),
               side = camera_of(posed.volume.grid, Projection::Perspective, StandardView::Left);
  Camera oblique = front;
  oblique.world_from_view =
      glm::angleAxis(0.8, glm::dvec3(0, 0, 1)) * front.world_from_view * glm::angleAxis(-0.6, glm::dvec3(1, 0, 0));
  for (const Camera& camera : {front, side, oblique}) {
    const Image a = picture_of(studio.renderer, coarse, camera, kSize),
                b = picture_of(studio.renderer, fine, camera, kSize),
                c = picture_of(studio.renderer, labels, camera, kSize);
    CHECK(covered(b) > 5000);
    MESSAGE("to the dense map ", silhouette_difference(a, b), ", to the labels ", silhouette_difference(a, c),
            ", of the dense map to the labels ", silhouette_difference(b, c));
    CHECK(silhouette_difference(a, b) < 0.005);
    CHECK(silhouette_difference(a, c) < silhouette_difference(b, c) + 0.002);
  }
}

}  // namespace

TEST_CASE("posed body: at rest the picture is that of the volume itself, in every display") {
  Studio studio;
  const Scene still = arm().scene(), posed = arm().posed(rest_pose(arm().rig), Blend::Linear);
  const Camera camera = camera_of(arm().volume->grid, Projection::Perspective, StandardView::Left);
  for (const Display display : {Display::Solid, Display::XRay, Display::Tissue}) {
    Scene a = posed, b = still;
    a.display = b.display = display;
    const Difference apart =
        difference(picture_of(studio.renderer, a, camera, kSize), picture_of(studio.renderer, b, camera, kSize));
    INFO("display ", int(display), " mean ", apart.mean, " share ", apart.share);
    CHECK(apart.mean < 0.1);
    CHECK(apart.share < 0.002);
  }
}

TEST_CASE("posed body: at rest the light by rays is that of the volume itself") {
  Studio studio;
  const Camera camera = camera_of(arm().volume->grid, Projection::Perspective, StandardView::Left);
  const auto rested = [&](const Scene& scene, Light light) {
    studio.renderer.light_at_rest(light);
    View3D view(studio.renderer);
    for (double now = 0; now == 0 || !view.complete(); now += 1) view.draw(scene, camera, kSize, now);
    return view.read();
  };
  const Scene still = arm().scene(), posed = arm().posed(rest_pose(arm().rig), Blend::Linear);
  // The light of a posed body is computed at only every second pixel and averaged over a larger square, so it may
  // differ a little from the light of the same body drawn at rest.
  const Difference apart = difference(rested(posed, Light::Fine), rested(still, Light::Fine)),
                   without = difference(rested(still, Light::Draft), rested(still, Light::Fine));
  INFO("mean ", apart.mean, ", share ", apart.share, "; of the light itself ", without.mean, ", ", without.share);
  CHECK(apart.mean < 0.06);
  CHECK(apart.mean < 0.5 * without.mean);
}

TEST_CASE("posed body: a bent elbow has the outline of the dense map, from any side, by both methods") {
  for (const auto& [linear, degrees] : {std::pair{true, 60.0}, std::pair{false, 90.0}}) {
    CAPTURE(linear);
    CAPTURE(degrees);
    check_outline(arm().volume, arm().tissues, arm().rig, arm().tissue, arm().weights, arm().bent(degrees), linear);
  }
}

TEST_CASE("posed body: so has the elbow of a real arm") {
  NEEDS_SHARED("data/bender/man-arm-2mm.mha");
  VolumeFile file = read_volume(shared_path("data/bender/man-arm-2mm.mha"));
  const TissueTable tissues = merge_tissue_tables(file.tissues, nullptr);
  const Armature rig = read_armature(shared_path("data/bender/man-arm-2mm-armature.vtk"));
  const TissueVoxels tissue(file.volume);
  const SkinWeights weights = diffuse_heat(file.volume, tissues, rig);
  const auto volume = std::make_shared<const LabelVolume>(std::move(file.volume));
  for (const auto& [linear, degrees] : {std::pair{true, 60.0}, std::pair{false, 90.0}}) {
    Pose pose = rest_pose(rig);
    flex(pose, rig, require_bone(rig, "Forearm"), degrees);
    CAPTURE(degrees);
    check_outline(volume, tissues, rig, tissue, weights, pose, linear);
  }
}

TEST_CASE("posed body: a bent elbow has the colours of the resampled volume") {
  Studio studio;
  const Pose pose = arm().bent(60);
  for (const bool linear : {true, false}) {
    const Scene posed = arm().posed(pose, linear ? Blend::Linear : Blend::DualQuaternion);
    const Scene dense = arm().resampled(pose, linear ? Method(Blend::Linear) : Method(Blend::DualQuaternion));
    for (const StandardView side : {StandardView::Front, StandardView::Left}) {
      const Camera camera = camera_of(dense.volume->grid, Projection::Perspective, side);
      const Image a = picture_of(studio.renderer, posed, camera, kSize),
                  b = picture_of(studio.renderer, dense, camera, kSize);
      INFO("linear ", linear, " side ", int(side));
      CHECK(covered(b) > 5000);
      CHECK(colours_agree(a, b) > 0.87);
    }
  }
}

TEST_CASE("posed body: a volume in bricks looks the same posed") {
  const Scene posed = arm().posed(arm().bent(60), Blend::Linear);
  const Camera camera = camera_of(arm().volume->grid, Projection::Perspective, StandardView::Left);
  Image whole;
  {
    Studio studio;
    whole = picture_of(studio.renderer, posed, camera, kSize / 3);
  }
  Studio studio(256);
  CHECK(difference(whole, picture_of(studio.renderer, posed, camera, kSize / 3)).mean < 0.1);
}

TEST_CASE("posed body: a slice shows the labels of the resampled volume") {
  Studio studio;
  const Pose pose = arm().bent(60);
  const Scene posed = arm().posed(pose, Blend::Linear), dense = arm().resampled(pose, Blend::Linear);
  const AffineTransform to_world = world_from_voxel(dense.volume->grid);
  SliceCamera camera{.axis = SliceAxis::Sagittal,
                     .centre = to_world * (glm::dvec3(dense.volume->grid.size) / 2.0),
                     .millimetres_per_pixel = 2};
  SliceView view(studio.renderer);
  view.draw(posed, camera, SliceDisplay::Labels, kSize);
  const Image a = view.read();
  view.draw(dense, camera, SliceDisplay::Labels, kSize);
  const Difference apart = difference(a, view.read());
  Scene rest = posed;
  rest.pose = nullptr;
  view.draw(rest, camera, SliceDisplay::Labels, kSize);
  const Difference unposed = difference(a, view.read());
  INFO("share ", apart.share, " of the volume at rest ", unposed.share);
  CHECK(apart.share < 0.01);
  CHECK(apart.share < unposed.share / 3);
}

TEST_CASE("posed body: what is picked is the voxel at rest, where the point on the posed body comes from") {
  Studio studio;
  const Pose pose = arm().bent(60);
  const Scene posed = arm().posed(pose, Blend::DualQuaternion);
  const auto motions = posed_from_rest(arm().rig, pose);
  const int forearm = require_bone(arm().rig, "Forearm");
  const glm::dvec3 middle = motions[forearm] * ((arm().rig.bones[forearm].head + arm().rig.bones[forearm].tail) / 2.0);
  Camera camera = camera_of(arm().volume->grid, Projection::Perspective, StandardView::Left);
  camera.centre = middle;
  View3D view(studio.renderer);
  draw(view, posed, camera, kSize);
  const auto hit = view.pick(kSize / 2);
  REQUIRE(hit);
  CHECK(hit->label == arm().volume->at(hit->voxel));
  const glm::dvec3 carried = motions[forearm] * (world_from_voxel(arm().volume->grid) * glm::dvec3(hit->voxel));
  CHECK(glm::distance(carried, hit->point) < 2 * 2.0);
}
