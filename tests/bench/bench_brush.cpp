// SPDX-License-Identifier: AGPL-3.0-or-later
// Times one dab of a weight brush on the arm of the Bender project (or the procedural one) and on a body of 43 million
// voxels (or the procedural body at 4 mm): first only the search for the voxels that it reaches, then the whole dab,
// which also changes their weights. Dabs run along the bones, through the middle of limbs and trunk, where the ball
// holds most tissue. Also measures a stroke of 200 dabs up and down a leg: its memory while it is painted (stroke_mb),
// that memory without the bricks that the document takes over (own_mb), the memory that the history keeps for undo
// (undo_mb), and the time of the undo.
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <optional>

#include "core/binding/geodesic.h"
#include "core/bones/bone_parts.h"
#include "core/paint/stroke.h"
#include "core/phantom/phantom.h"
#include "core/project/history.h"
#include "core/rig_io/rig_io.h"
#include "core/volume_io/volume_io.h"
#include "tests/bench/bench.h"

namespace limber::bench {

namespace {

struct Body {
  LabelVolume volume;
  TissueTable tissues;
  Armature armature;
  TissueVoxels tissue;
  std::shared_ptr<const SkinWeights> weights;
  std::vector<glm::dvec3> path;  // positions of the dabs: 40 on each bone, world, mm
};

Body finished(Body made) {
  made.tissue = TissueVoxels(made.volume);
  const BoneParts parts = split_bones(made.volume, made.tissue, made.tissues, made.armature);
  made.weights = std::make_shared<const SkinWeights>(bind_geodesic(made.volume, made.tissue, made.armature, parts));
  for (const Bone& bone : made.armature.bones)
    for (int i = 0; i < 40; ++i) made.path.push_back(glm::mix(bone.head, bone.tail, i / 40.0));
  return made;
}

Body of_phantom(Phantom phantom) {
  Body made;
  made.volume = std::move(phantom.volume);
  made.tissues = std::move(phantom.tissues);
  made.armature = std::move(phantom.armature);
  return made;
}

Path shared_folder(const char* name) {
  const char* shared = std::getenv("LIMBER_SHARED");
  return Path(shared ? shared : "") / "data" / name;
}

const Body& arm() {
  static const Body one = [] {
    const Path folder = shared_folder("bender");
    if (!std::filesystem::exists(folder / "man-arm-2mm.mha")) return finished(of_phantom(make_arm_phantom(2)));
    VolumeFile file = read_volume(folder / "man-arm-2mm.mha");
    Body made;
    made.volume = std::move(file.volume);
    made.tissues = std::move(file.tissues);
    made.armature = read_armature(folder / "man-arm-2mm-armature.vtk");
    return finished(std::move(made));
  }();
  return one;
}

const Body& whole_body() {
  static const Body one = [] {
    const Path folder = shared_folder("bp3d");
    if (!std::filesystem::exists(folder / "body_2mm_tissue.mha")) return finished(of_phantom(make_body_phantom(4)));
    Body made;
    made.volume = read_volume(folder / "body_2mm_tissue.mha").volume;
    made.tissues = read_tissue_table(folder / "tissue.labels.json");
    made.armature = read_armature(folder / "body.armature.json");
    return finished(std::move(made));
  }();
  return one;
}

void brush_reach(benchmark::State& state, const Body& (*of)(), BrushDistance distance, double voxels, double goal_ms) {
  const Body& body = of();
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

// Paints a stroke of 40 dabs along each bone, with that bone's weight; the weights of bone tissue do not change.
//   seen  true: the changed bricks are asked for after every dab, which computes their weights; false: only at the
//         end of the stroke
void brush_dab(benchmark::State& state, const Body& (*of)(), BrushKind kind, BrushDistance distance, double voxels,
               double goal_ms, BrushDepth depth, bool seen) {
  const Body& body = of();
  StrokeSettings settings;
  settings.brush.kind = kind;
  settings.brush.radius = voxels * body.volume.grid.spacing.x;
  settings.brush.distance = distance;
  settings.brush.strength = 0.5;
  settings.filter.depth = depth;
  settings.filter.depth_mm = 25;  // mm below the surface, the editor's default
  std::optional<Stroke> stroke;
  std::size_t next = 0;
  std::int64_t memory = 0;
  for (auto _ : state) {
    if (next % 40 == 0) {
      state.PauseTiming();
      if (stroke) memory = std::max(memory, stroke->memory_bytes());
      settings.bones = {static_cast<int>(next / 40)};
      stroke.emplace(WeightedBody{body.volume, body.tissue, body.tissues, body.armature}, body.weights, settings);
      state.ResumeTiming();
    }
    stroke->dab(body.path[next]);
    if (seen || next % 40 == 39) benchmark::DoNotOptimize(stroke->take_dirty());
    next = (next + 1) % body.path.size();
  }
  state.counters["stroke_mb"] = double(memory) / 1e6;
  state.counters["goal_ms"] = goal_ms;
}

void brush_stroke(benchmark::State& state, const Body& (*of)(), double voxels) {
  const Body& body = of();
  // Collects the bones of one leg: the first one named "Thigh" or "thigh", and the chain of its descendants.
  std::vector<int> limb;
  for (int b = 0; b < std::ssize(body.armature.bones); ++b) {
    const bool begins = limb.empty() && body.armature.bones[b].name.find("high") != std::string::npos &&
                        body.armature.bones[b].parent >= 0;
    if (begins || (!limb.empty() && body.armature.bones[b].parent == limb.back())) limb.push_back(b);
  }
  StrokeSettings settings;
  settings.brush.radius = voxels * body.volume.grid.spacing.x;
  settings.bones = {limb.at(0)};
  double stroke_mb = 0, own_mb = 0, undo_mb = 0;
  for (auto _ : state) {
    Document first;
    first.weights = body.weights;
    History history(first);
    Stroke stroke(WeightedBody{body.volume, body.tissue, body.tissues, body.armature}, body.weights, settings);
    for (int round = 0; stroke.dab_count() < 200; ++round)
      for (std::size_t i = 0; i < limb.size(); ++i) {
        const Bone& bone = body.armature.bones[limb[round % 2 ? limb.size() - 1 - i : i]];
        for (int k = 0; k <= 20 && stroke.dab_count() < 200; ++k) {
          stroke.to(glm::mix(bone.head, bone.tail, (round % 2 ? 20 - k : k) / 20.0));
          (void)stroke.weights();  // the editor reads the weights in every frame
        }
      }
    std::int64_t handed_on = 0;
    for (const int brick : stroke.take_dirty()) handed_on += stroke.weights().chunk(brick).heap_bytes();
    stroke_mb = double(stroke.memory_bytes()) / 1e6;
    own_mb = double(stroke.memory_bytes() - handed_on) / 1e6;
    const std::int64_t before = history.bytes();
    Document next = first;
    next.weights = std::make_shared<const SkinWeights>(stroke.finish());
    history.commit("Stroke", std::move(next));
    undo_mb = double(history.bytes() - before) / 1e6;
    const auto begin = std::chrono::steady_clock::now();
    history.undo();
    state.SetIterationTime(std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count());
    if (history.current().weights != body.weights) state.SkipWithError("the undo does not bring the weights back");
  }
  state.counters["stroke_mb"] = stroke_mb;
  state.counters["own_mb"] = own_mb;
  state.counters["undo_mb"] = undo_mb;
  state.counters["goal_ms"] = 50;
}

}  // namespace

BENCHMARK_CAPTURE(brush_reach, arm_euclidean_16, arm, BrushDistance::Euclidean, 16, 0.12)->Apply(five_times);
BENCHMARK_CAPTURE(brush_reach, arm_geodesic_16, arm, BrushDistance::Geodesic, 16, 0.6)->Apply(five_times);
BENCHMARK_CAPTURE(brush_reach, arm_geodesic_32, arm, BrushDistance::Geodesic, 32, 4)->Apply(five_times);
BENCHMARK_CAPTURE(brush_dab, arm_add_euclidean_16, arm, BrushKind::Add, BrushDistance::Euclidean, 16, 0.12,
                  BrushDepth::Through, false)
    ->Apply(five_times);
BENCHMARK_CAPTURE(brush_dab, arm_add_euclidean_16_seen, arm, BrushKind::Add, BrushDistance::Euclidean, 16, 0.12,
                  BrushDepth::Through, true)
    ->Apply(five_times);
BENCHMARK_CAPTURE(brush_dab, arm_add_geodesic_16_seen, arm, BrushKind::Add, BrushDistance::Geodesic, 16, 0.6,
                  BrushDepth::Through, true)
    ->Apply(five_times);
BENCHMARK_CAPTURE(brush_dab, arm_add_geodesic_16, arm, BrushKind::Add, BrushDistance::Geodesic, 16, 0.6,
                  BrushDepth::Through, false)
    ->Apply(five_times);
BENCHMARK_CAPTURE(brush_dab, arm_add_geodesic_32, arm, BrushKind::Add, BrushDistance::Geodesic, 32, 4,
                  BrushDepth::Through, false)
    ->Apply(five_times);
BENCHMARK_CAPTURE(brush_dab, arm_add_to_depth_32, arm, BrushKind::Add, BrushDistance::Geodesic, 32, 4,
                  BrushDepth::ToDepth, false)
    ->Apply(five_times);
BENCHMARK_CAPTURE(brush_dab, arm_smooth_geodesic_16, arm, BrushKind::Smooth, BrushDistance::Geodesic, 16, 0.6,
                  BrushDepth::Through, false)
    ->Apply(five_times);
BENCHMARK_CAPTURE(brush_dab, body_add_euclidean_16, whole_body, BrushKind::Add, BrushDistance::Euclidean, 16, 0.12,
                  BrushDepth::Through, false)
    ->Apply(five_times);
BENCHMARK_CAPTURE(brush_dab, body_add_geodesic_16, whole_body, BrushKind::Add, BrushDistance::Geodesic, 16, 0.6,
                  BrushDepth::Through, false)
    ->Apply(five_times);
BENCHMARK_CAPTURE(brush_dab, body_add_geodesic_32, whole_body, BrushKind::Add, BrushDistance::Geodesic, 32, 4,
                  BrushDepth::Through, false)
    ->Apply(five_times);
BENCHMARK_CAPTURE(brush_dab, body_add_euclidean_16_seen, whole_body, BrushKind::Add, BrushDistance::Euclidean, 16, 0.12,
                  BrushDepth::Through, true)
    ->Apply(five_times);
BENCHMARK_CAPTURE(brush_stroke, body_leg_16, whole_body, 16)->UseManualTime()->Iterations(1)->Apply(five_times);
BENCHMARK_CAPTURE(brush_stroke, body_leg_32, whole_body, 32)->UseManualTime()->Iterations(1)->Apply(five_times);

}  // namespace limber::bench
