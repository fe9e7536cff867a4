// SPDX-License-Identifier: AGPL-3.0-or-later
// preview_updates
// Measures what it costs until a new pose can be drawn (vertices, cells, the map on the graphics card, the hull from
// which rays start) on the procedural arm and body, and what a picture of it costs beside one of the volume at rest.
// Prints medians as JSON, in CPU seconds of the whole process; on two cores an update takes half of them.
#include <sys/resource.h>

#include <algorithm>
#include <cstdio>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "core/binding/heat_diffusion.h"
#include "core/deform/preview_map.h"
#include "core/phantom/phantom.h"
#include "render/gl/egl_context.h"
#include "render/scene/tissue_appearance.h"
#include "render/view.h"

namespace {

using namespace limber;
using namespace limber::render;

constexpr int kUpdates = 25;

double cpu_seconds() {
  rusage used{};
  getrusage(RUSAGE_SELF, &used);
  const auto seconds = [](const timeval& t) { return double(t.tv_sec) + 1e-6 * double(t.tv_usec); };
  return seconds(used.ru_utime) + seconds(used.ru_stime);
}

double median(std::vector<double> values) {
  std::nth_element(values.begin(), values.begin() + values.size() / 2, values.end());
  return values[values.size() / 2];
}

struct Subject {
  std::string name;
  Phantom phantom;
  int step;
};

// Measures a drag, a sequence of poses, and prints one JSON object: the medians of the CPU times of updating the map,
// of uploading it, and of drawing the posed and the resting volume.
//   drag      name of the drag in the output
//   pose_at   pose_at(i) returns the i-th pose of the drag
//   is_first  false: prints a comma before the object; set to false
void measure(const Subject& subject, const char* drag, LivePreview& preview, Renderer& renderer, const Scene& rest,
             Blend blend, const std::function<Pose(int)>& pose_at, bool& is_first) {
  const glm::ivec2 small(16, 12), large(640, 480);
  const AffineTransform to_world = world_from_voxel(rest.volume->grid);
  const glm::dvec3 a = to_world * glm::dvec3(-0.5), b = to_world * (glm::dvec3(rest.volume->grid.size) - 0.5);
  Camera camera = framing(looking_from(StandardView::Front, {}), glm::min(a, b), glm::max(a, b), 4.0 / 3);
  View3D view(renderer);
  Scene scene = rest;
  const auto picture = [&](const Scene& what, const glm::ivec2& size, int scale = 1) {
    camera.distance *= 1.0001;  // a changed camera makes the view draw again
    const double begin = cpu_seconds();
    view.draw(what, camera, size, 0, scale);
    renderer.finish();
    return cpu_seconds() - begin;
  };
  std::vector<double> map, card, posed, unposed;
  for (int i = 0; i < kUpdates; ++i) {
    const auto motions = posed_from_rest(subject.phantom.armature, pose_at(i));
    const double begin = cpu_seconds();
    scene.pose = preview.update(motions, blend);
    map.push_back(cpu_seconds() - begin);
    // The first picture includes the upload of the map, the second one does not.
    const double first = picture(scene, small);
    card.push_back(first - picture(scene, small));
    if (i % 5) continue;
    posed.push_back(picture(scene, large));
    unposed.push_back(picture(rest, large));
  }
  std::printf(
      "%s{\"subject\": \"%s\", \"step\": %d, \"drag\": \"%s\", \"blend\": \"%s\", \"map_cpu_ms\": %.3f, "
      "\"upload_cpu_ms\": %.3f, "
      "\"update_ms_on_two_cores\": %.3f, \"picture_cpu_ms\": %.1f, \"picture_at_rest_cpu_ms\": %.1f}",
      is_first ? "" : ",\n ", subject.name.c_str(), subject.step, drag,
      blend == Blend::Linear ? "linear" : "dual quaternion", 1e3 * median(map), 1e3 * median(card),
      500 * (median(map) + median(card)), 1e3 * median(posed), 1e3 * median(unposed));
  is_first = false;
}

Pose turned(const Armature& rig, const std::string& bone, double degrees) {
  Pose pose = rest_pose(rig);
  flex(pose, rig, require_bone(rig, bone), degrees);
  return pose;
}

// Returns a pose in which every bone is turned a little, by an angle that depends on i.
Pose new_pose(const Armature& rig, int i) {
  Pose pose = rest_pose(rig);
  for (size_t bone = 0; bone < pose.rotation.size(); ++bone)
    pose.rotation[bone] = glm::angleAxis(0.02 * (i % 7 + 1), glm::normalize(glm::dvec3(1, double(bone % 3), 2)));
  return pose;
}

}  // namespace

int main() {
  try {
    const HeadlessContext context;
    Renderer renderer;
    bool is_first = true;
    std::printf("[");
    for (Subject& subject :
         std::vector<Subject>{{"arm 2 mm", make_arm_phantom(2), 4}, {"body 2.5 mm", make_body_phantom(2.5), 8}}) {
      const Armature& rig = subject.phantom.armature;
      const std::string bone = subject.step == 4 ? "Forearm" : "LeftForearm";
      const SkinWeights weights = diffuse_heat(subject.phantom.volume, subject.phantom.tissues, rig);
      const TissueVoxels tissue(subject.phantom.volume);
      Scene scene;
      scene.looks = std::make_shared<const LabelLooks>(looks_of(subject.phantom.tissues));
      scene.volume = std::make_shared<const LabelVolume>(subject.phantom.volume);
      scene.grid = false;
      LivePreview preview(scene.volume, subject.phantom.tissues, tissue, weights, subject.step);
      for (const Blend blend : {Blend::Linear, Blend::DualQuaternion}) {
        measure(
            subject, "one elbow", preview, renderer, scene, blend, [&](int i) { return turned(rig, bone, 20 + i); },
            is_first);
        measure(
            subject, "every bone", preview, renderer, scene, blend, [&](int i) { return new_pose(rig, i); }, is_first);
      }
    }
    std::printf("]\n");
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
}
