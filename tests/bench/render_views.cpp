// SPDX-License-Identifier: AGPL-3.0-or-later
// render_views VOLUME [OUT-PNG-PREFIX | --turning]
// Draws the volume from far and close, at two sizes, solid and in X-ray, and turns the camera before each picture.
// Prints as JSON what each picture cost (CPU seconds of the whole process, median of five) and the cameras, so that
// another program can be measured with the same ones. Then prints how fast the volume turns at 1280x720: at fixed
// resolutions (frames a second of two cores, computed from CPU seconds, so other work on the machine does not count),
// and when the view chooses its resolution. With --turning only the second part runs.
#include <sys/resource.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <memory>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "core/volume_io/volume_io.h"
#include "render/gl/egl_context.h"
#include "render/scene/tissue_appearance.h"
#include "render/view.h"

namespace {

using namespace limber;
using namespace limber::render;

constexpr int kPictures = 5;
constexpr double kTurn = 7;  // angle by which the camera turns before each picture, degrees

double cpu_seconds() {
  rusage used{};
  getrusage(RUSAGE_SELF, &used);
  const auto seconds = [](const timeval& t) { return double(t.tv_sec) + 1e-6 * double(t.tv_usec); };
  return seconds(used.ru_utime) + seconds(used.ru_stime);
}
double wall_seconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

double median(std::vector<double> values) {
  std::nth_element(values.begin(), values.begin() + values.size() / 2, values.end());
  return values[values.size() / 2];
}

Camera turned(const Camera& camera, double degrees) {
  Camera result = camera;
  result.world_from_view =
      glm::angleAxis(degrees * std::numbers::pi / 180, glm::dvec3(0, 0, 1)) * camera.world_from_view;
  return result;
}

void print_camera(const Camera& camera) {
  const glm::dvec3 eye = eye_of(camera), up = camera.world_from_view * glm::dvec3(0, 1, 0);
  std::printf(
      "{\"eye\": [%.9g, %.9g, %.9g], \"centre\": [%.9g, %.9g, %.9g], \"up\": [%.9g, %.9g, %.9g], \"angle\": %.9g}",
      eye.x, eye.y, eye.z, camera.centre.x, camera.centre.y, camera.centre.z, up.x, up.y, up.z,
      camera.field_of_view * 180 / std::numbers::pi);
}

int covered_pixels(const Image& image) {
  int count = 0;
  for (size_t i = 3; i < image.rgba.size(); i += 4) count += image.rgba[i] != 0;
  return count;
}

void measure_view(Renderer& renderer, Scene scene, const char* distance, const Camera& first, const glm::ivec2& size,
                  const std::string& png) {
  View3D view(renderer);
  const bool xray = scene.display == Display::XRay;
  scene.transparent_background = true;  // so that alpha is the silhouette
  Camera camera = first;
  view.draw(scene, camera, size, 0, 1);
  renderer.finish();
  std::vector<double> seconds;
  std::vector<int> pixels;
  std::printf("{\"view\": \"%s %dx%d %s\", \"display\": \"%s\", \"size\": [%d, %d], \"cameras\": [", distance, size.x,
              size.y, xray ? "xray" : "solid", xray ? "xray" : "solid", size.x, size.y);
  for (int i = 0; i < kPictures; ++i) {
    camera = turned(camera, kTurn);
    const double begin = cpu_seconds();
    view.draw(scene, camera, size, 0, 1);
    renderer.finish();
    seconds.push_back(cpu_seconds() - begin);
    pixels.push_back(covered_pixels(view.read()));
    if (i > 0) std::printf(", ");
    print_camera(camera);
  }
  std::printf("], \"pixels\": [");
  for (int i = 0; i < kPictures; ++i) std::printf(i > 0 ? ", %d" : "%d", pixels[static_cast<size_t>(i)]);
  std::printf("], \"cpu_seconds\": %.6f}", median(seconds));
  if (!png.empty()) write_png(view.read(), png);
}

void measure_turning(Renderer& renderer, const Scene& scene, const Camera& first) {
  const glm::ivec2 size(1280, 720);
  View3D view(renderer);
  Camera camera = first;
  std::vector<double> wall, cpu;
  for (int i = 0; i < 60; ++i) {
    camera = turned(camera, 3);
    const double begin = wall_seconds(), cpu_begin = cpu_seconds();
    view.draw(scene, camera, size, begin);
    renderer.finish();
    if (i < 20) continue;  // not measured: the view may still change its resolution
    wall.push_back(wall_seconds() - begin);
    cpu.push_back(cpu_seconds() - cpu_begin);
  }
  std::printf("{\"view\": \"turning 1280x720\", \"scale\": %d, \"frames_per_second\": %.1f, \"cpu_seconds\": %.6f}",
              view.scale(), 1 / median(wall), median(cpu));
}

// Measures how fast the volume turns if only every `scale`-th pixel is drawn in x and in y, and prints it.
void measure_turning_at(Renderer& renderer, const Scene& scene, const Camera& first, int scale) {
  View3D view(renderer);
  Camera camera = first;
  std::vector<double> cpu;
  for (int i = 0; i < 25; ++i) {
    camera = turned(camera, 3);
    const double begin = cpu_seconds();
    view.draw(scene, camera, {1280, 720}, 0, scale);
    renderer.finish();
    if (i >= 5) cpu.push_back(cpu_seconds() - begin);
  }
  std::printf("{\"scale\": %d, \"cpu_seconds\": %.6f, \"frames_per_second\": %.1f}", scale, median(cpu),
              2 / median(cpu));
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2) return 2;
  try {
    VolumeFile file = read_volume(argv[1]);
    Scene scene;
    scene.looks = std::make_shared<const LabelLooks>(looks_of(merge_tissue_tables(file.tissues, nullptr)));
    scene.volume = std::make_shared<const LabelVolume>(std::move(file.volume));
    scene.grid = false;

    const HeadlessContext context;
    Renderer renderer;
    const AffineTransform to_world = world_from_voxel(scene.volume->grid);
    const glm::dvec3 a = to_world * glm::dvec3(-0.5), b = to_world * (glm::dvec3(scene.volume->grid.size) - 0.5);
    const Camera far = framing(looking_from(StandardView::Front, {}), glm::min(a, b), glm::max(a, b), 4.0 / 3);
    const Camera close = zoomed(far, 0.45);

    const double begin = cpu_seconds();
    View3D first(renderer);
    first.draw(scene, far, {64, 64}, 0, 1);
    renderer.finish();
    std::printf("{\"upload_cpu_seconds\": %.6f,\n \"views\": [\n", cpu_seconds() - begin);
    bool is_first = true;
    const bool turning_alone = argc > 2 && std::string(argv[2]) == "--turning";
    for (const Display display : {Display::Solid, Display::XRay}) {
      if (turning_alone) break;
      for (const bool near : {false, true})
        for (const glm::ivec2 size : {glm::ivec2(640, 480), glm::ivec2(1280, 720)}) {
          if (!std::exchange(is_first, false)) std::printf(",\n");
          scene.display = display;
          const char* distance = near ? "close" : "far";
          std::string png;
          if (argc > 2)
            png = std::string(argv[2]) + "-" + distance + "-" + std::to_string(size.x) +
                  (display == Display::XRay ? "-xray" : "-solid") + ".png";
          measure_view(renderer, scene, distance, near ? close : far, size, png);
        }
    }
    scene.display = Display::Solid;
    std::printf("],\n \"turning_at_scale\": [");
    for (const int scale : {1, 2, 3}) {
      if (scale > 1) std::printf(", ");
      measure_turning_at(renderer, scene, far, scale);
    }
    std::printf("],\n \"turning\": ");
    measure_turning(renderer, scene, far);
    std::printf("}\n");
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
}
