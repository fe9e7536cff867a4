// SPDX-License-Identifier: AGPL-3.0-or-later
// One dab of a weight brush on the paper's arm (or the procedural one): which voxels it reaches, and a whole dab, in which it
// also changes their weights. Dabs run along the arm's bones, through its middle, where the ball holds most tissue.
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <optional>

#include "core/rig/armature_io.h"
#include "core/rig/bone_parts.h"
#include "core/skin/geodesic.h"
#include "core/skin/stroke.h"
#include "core/volume/phantom.h"
#include "core/volume/volume_io.h"
#include "tests/bench/bench.h"

namespace limber::bench {

namespace {

struct Arm {
  LabelVolume volume;
  TissueTable tissues;
  Armature armature;
  TissueVoxels tissue;
  std::shared_ptr<const SkinWeights> weights;
  std::vector<glm::dvec3> path;  // world
};

const Arm& arm() {
  static const Arm one = [] {
    Arm made;
    const char* shared = std::getenv("LIMBER_SHARED");
    const Path folder = Path(shared ? shared : "") / "data/bender";
    if (shared && std::filesystem::exists(folder / "man-arm-2mm.mha")) {
      VolumeFile file = read_volume(folder / "man-arm-2mm.mha");
      made.volume = std::move(file.volume);
      made.tissues = std::move(file.tissues);
      made.armature = read_armature(folder / "man-arm-2mm-armature.vtk");
    } else {
      Phantom phantom = make_arm_phantom(2);
      made.volume = std::move(phantom.volume);
      made.tissues = std::move(phantom.tissues);
      made.armature = std::move(phantom.armature);
    }
    made.tissue = TissueVoxels(made.volume);
    const BoneParts parts = split_bones(made.volume, made.tissue, made.tissues, made.armature);
    made.weights = std::make_shared<const SkinWeights>(bind_geodesic(made.volume, made.tissue, made.armature, parts));
    for (const Bone& bone : made.armature.bones)
      for (int i = 0; i < 40; ++i) made.path.push_back(glm::mix(bone.head, bone.tail, i / 40.0));
    return made;
  }();
  return one;
}

void brush_reach(benchmark::State& state, BrushDistance distance, double voxels, double goal_ms) {
  const Arm& body = arm();
  BrushReach reach(body.volume, body.tissue);
  const double radius = voxels * body.volume.grid.spacing.x;
  std::size_t next = 0;
  std::int64_t touched = 0, dabs = 0;
  for (auto _ : state) {
    touched += reach.dab(body.path[next], radius, distance).size();
    next = (next + 1) % body.path.size();
    ++dabs;
  }
  state.counters["voxels"] = double(touched) / double(dabs);
  state.counters["goal_ms"] = goal_ms;
}

// Strokes of 40 dabs along one bone after the other, painting that bone; bone tissue stays as it is.
void brush_dab(benchmark::State& state, BrushKind kind, BrushDistance distance, double voxels, double goal_ms) {
  const Arm& body = arm();
  StrokeSettings settings;
  settings.brush.kind = kind;
  settings.brush.radius = voxels * body.volume.grid.spacing.x;
  settings.brush.distance = distance;
  settings.brush.strength = 0.5;
  std::optional<Stroke> stroke;
  std::size_t next = 0;
  std::int64_t memory = 0;
  for (auto _ : state) {
    if (next % 40 == 0) {
      state.PauseTiming();
      if (stroke) memory = std::max(memory, stroke->memory_bytes());
      settings.bones = {static_cast<int>(next / 40)};
      stroke.emplace(StrokeBody{body.volume, body.tissue, body.tissues, body.armature}, body.weights, settings);
      state.ResumeTiming();
    }
    stroke->dab(body.path[next]);
    next = (next + 1) % body.path.size();
  }
  state.counters["stroke_mb"] = double(memory) / 1e6;
  state.counters["goal_ms"] = goal_ms;
}

}  // namespace

BENCHMARK_CAPTURE(brush_reach, euclidean_16, BrushDistance::Euclidean, 16, 0.12)->Apply(five_times);
BENCHMARK_CAPTURE(brush_reach, geodesic_16, BrushDistance::Geodesic, 16, 0.6)->Apply(five_times);
BENCHMARK_CAPTURE(brush_reach, geodesic_32, BrushDistance::Geodesic, 32, 4)->Apply(five_times);
BENCHMARK_CAPTURE(brush_dab, add_euclidean_16, BrushKind::Add, BrushDistance::Euclidean, 16, 0.12)->Apply(five_times);
BENCHMARK_CAPTURE(brush_dab, add_geodesic_16, BrushKind::Add, BrushDistance::Geodesic, 16, 0.6)->Apply(five_times);
BENCHMARK_CAPTURE(brush_dab, add_geodesic_32, BrushKind::Add, BrushDistance::Geodesic, 32, 4)->Apply(five_times);
BENCHMARK_CAPTURE(brush_dab, smooth_geodesic_16, BrushKind::Smooth, BrushDistance::Geodesic, 16, 0.6)->Apply(five_times);

}  // namespace limber::bench
