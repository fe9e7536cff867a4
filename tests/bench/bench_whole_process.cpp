// SPDX-License-Identifier: AGPL-3.0-or-later
// Runs whole processes: weights and resampling of the arm of the Bender project at 2 mm, and how the cost grows with
// the number of tissue voxels. Bender's ComputeArmatureWeight takes 17 CPU s and 213 MB on the same arm, its
// PoseLabelmap 8.4 CPU s and 1244 MB. Where the arm's files are missing, the rows run on the procedural arm.
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "tests/bench/bench.h"

namespace limber::bench {

namespace fs = std::filesystem;

namespace {

struct Subject {
  std::string volume, rig, flexed_bone;
  std::vector<std::string> tissues;  // --tissues FILE, or nothing
};

fs::path shared(const std::string& relative) {
  const char* set = std::getenv("LIMBER_SHARED");
  return fs::path(set ? set : LIMBER_SOURCE_DIR "/../shared") / relative;
}

test::TemporaryFolder& scratch() {
  static test::TemporaryFolder folder;
  return folder;
}

Subject procedural_arm(const std::string& spacing) {
  const fs::path folder = scratch() / ("phantom-" + spacing);
  if (!fs::exists(folder)) test::run_limber({"phantom", "arm", "--spacing", spacing, "-o", folder.string()});
  return {folder / "volume.nrrd", folder / "rig.json", "Forearm", {"--tissues", folder / "tissues.json"}};
}

Subject arm() {
  const fs::path volume = shared("data/bender/man-arm-2mm.mha");
  if (!fs::exists(volume)) return procedural_arm("2");
  return {volume, shared("data/bender/man-arm-2mm-armature.vtk"), "Forearm", {}};
}

// Returns the arm and shoulder of data/bp3d, resampled to `spacing` (mm), or the procedural arm if it is missing.
Subject shoulder(const std::string& spacing) {
  const fs::path source = shared("data/bp3d/arm_shoulder_1mm_tissue.mha");
  if (!fs::exists(source)) return procedural_arm(spacing);
  const fs::path volume = scratch() / ("shoulder-" + spacing + ".nrrd");
  const std::vector<std::string> tissues{"--tissues", shared("data/bp3d/tissue.labels.json")};
  if (!fs::exists(volume)) test::run_limber({"prepare", source, "--spacing", spacing, "-o", volume});
  return {volume, shared("data/bp3d/arm_shoulder.armature.json"), "RightForearm", tissues};
}

std::vector<std::string> words(std::vector<std::string> head, const std::vector<std::string>& tail) {
  head.insert(head.end(), tail.begin(), tail.end());
  return head;
}

std::string weights_of(const Subject& subject) {
  const fs::path file = scratch() / (fs::path(subject.volume).filename().string() + ".weights.nrrd");
  if (!fs::exists(file))
    test::run_limber(words({"weights", subject.volume, "--rig", subject.rig, "-o", file}, subject.tissues));
  return file;
}

void weights(benchmark::State& state) {
  const Subject subject = arm();
  const auto arguments =
      words({"weights", subject.volume, "--rig", subject.rig, "-o", scratch() / "w.nrrd"}, subject.tissues);
  for (auto _ : state) against_peer_seconds(state, run_whole_process(state, arguments), 17, 10);
}

std::vector<std::string> resample_arguments(const Subject& subject, const std::string& method) {
  return words({"resample", subject.volume, "--rig", subject.rig, "--weights", weights_of(subject), "--flex",
                subject.flexed_bone + "=90", "--method", method, "-o", scratch() / "posed.nrrd"},
               subject.tissues);
}

void resample(benchmark::State& state, const std::string& method) {
  const auto arguments = resample_arguments(arm(), method);
  for (auto _ : state) against_peer_seconds(state, run_whole_process(state, arguments), 8.4, 20);
}

std::int64_t tissue_voxels_of(const Subject& subject) {
  const auto weights_file = weights_of(subject);  // uncompressed: 16 bytes for each tissue voxel
  return static_cast<std::int64_t>(fs::file_size(weights_file) / 16);
}

void weights_by_spacing(benchmark::State& state, const std::string& spacing) {
  const Subject subject = shoulder(spacing);
  const auto arguments =
      words({"weights", subject.volume, "--rig", subject.rig, "-o", scratch() / "w.nrrd"}, subject.tissues);
  for (auto _ : state)
    state.counters["us_per_voxel"] =
        1e6 * run_whole_process(state, arguments) / static_cast<double>(tissue_voxels_of(subject));
  state.counters["tissue_voxels"] = static_cast<double>(tissue_voxels_of(subject));
}

void resample_by_spacing(benchmark::State& state, const std::string& spacing) {
  const Subject subject = shoulder(spacing);
  const auto arguments = resample_arguments(subject, "dqs");
  for (auto _ : state)
    state.counters["us_per_voxel"] =
        1e6 * run_whole_process(state, arguments) / static_cast<double>(tissue_voxels_of(subject));
  state.counters["tissue_voxels"] = static_cast<double>(tissue_voxels_of(subject));
}

void process_rows(benchmark::internal::Benchmark* row) { five_times(row->UseManualTime()->Iterations(1)); }

}  // namespace

BENCHMARK(weights)->Apply(process_rows);
BENCHMARK_CAPTURE(resample, linear, "lbs")->Apply(process_rows);
BENCHMARK_CAPTURE(resample, dual_quaternion, "dqs")->Apply(process_rows);
BENCHMARK_CAPTURE(weights_by_spacing, 4mm, "4")->Apply(process_rows);
BENCHMARK_CAPTURE(weights_by_spacing, 3mm, "3")->Apply(process_rows);
BENCHMARK_CAPTURE(weights_by_spacing, 2mm, "2")->Apply(process_rows);
BENCHMARK_CAPTURE(weights_by_spacing, 1mm, "1")->Apply(process_rows);
BENCHMARK_CAPTURE(resample_by_spacing, 4mm, "4")->Apply(process_rows);
BENCHMARK_CAPTURE(resample_by_spacing, 3mm, "3")->Apply(process_rows);
BENCHMARK_CAPTURE(resample_by_spacing, 2mm, "2")->Apply(process_rows);
BENCHMARK_CAPTURE(resample_by_spacing, 1mm, "1")->Apply(process_rows);

}  // namespace limber::bench
