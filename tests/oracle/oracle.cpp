// SPDX-License-Identifier: AGPL-3.0-or-later
// The oracle: a variant of Limber that reads the true bone of each voxel, and the places where parts only touch, from
// files. Errors that remain are not caused by finding bone parts or seams, but by blending. It is never shipped.
//
// It takes the command line of `limber weights` and `limber resample`, VOLUME first, and finds the ground truth of a
// test body beside the volume [body_truth.h]. The check of the hard bodies can therefore run it instead of the program:
//   check_hard.py BODY --limber build/tests/limber_oracle --rows 3
// Only bone parts and seams are replaced: weights are computed by the same heat diffusion, and everything after that is
// the program's own command. The environment variables LIMBER_ORACLE_BONES=found and LIMBER_ORACLE_SEAMS=found or none
// disable one of the two truths, to measure the effect of each. With both `found` it is the program itself. Default:
// `truth`.
//
// glue.nrrd leaves out places within 50 mm (5 mm for fingers) of where two parts are naturally connected, so glued
// faces there stay joined. Seams that Limber finds may reach further than the true ones. LIMBER_ORACLE_SEAMS=free also
// cuts the faces between glued parts there, if the limb is naturally free.
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/base/error.h"
#include "core/binding/heat_diffusion.h"
#include "core/cmd/body_options.h"
#include "core/cmd/command.h"
#include "core/rig_io/rig_io.h"
#include "core/seams/find_seams.h"
#include "core/seams/seams_io.h"
#include "core/skin/weights_io.h"
#include "tests/oracle/body_truth.h"

namespace {

using namespace limber;

enum class Source { Truth, Free, Found, None };

Source source_named(const char* variable, bool is_of_seams) {
  const char* value = std::getenv(variable);
  const std::string name = value ? value : "truth";
  if (name == "truth") return Source::Truth;
  if (name == "found") return Source::Found;
  if (name == "free" && is_of_seams) return Source::Free;
  if (name == "none" && is_of_seams) return Source::None;
  throw Error("this is no source of what the oracle tells", std::string(variable) + "=" + name,
              is_of_seams ? "use truth, free, found or none" : "use truth or found");
}

struct Options {
  cmd::BodyOptions body;
  cmd::RunOptions run;
  std::string weights, output;
};

// A body whose bone parts and seams come from the ground truth.
struct ToldBody {
  Body body;
  TissueVoxels tissue;
  BoneParts parts;

  ToldBody(const Options& options, Progress& progress)
      : body(cmd::read_body(options.body, progress)),
        tissue(body.file.volume) {
    const LabelVolume& volume = body.file.volume;
    const Path folder = Path(options.body.volume).parent_path();
    const Source bones = source_named("LIMBER_ORACLE_BONES", false), seams = source_named("LIMBER_ORACLE_SEAMS", true);
    parts = bones == Source::Truth ? oracle::true_bones(folder, volume, tissue, body.tissues, body.rig)
                                   : split_bones(volume, tissue, body.tissues, body.rig, progress, body.bone_map);
    if (seams == Source::None) return;
    tissue.set_seams(std::make_shared<const Seams>(
        seams == Source::Found ? find_seams(volume, tissue, body.tissues, body.rig, parts, progress)
                               : oracle::true_seams(folder, volume, seams == Source::Free ? &body.rig : nullptr)));
  }
  void write_weights_to(const Path& path, Progress& progress) const {
    WeightsReport report;
    const LabelVolume& volume = body.file.volume;
    const SkinWeights weights = diffuse_heat(volume, tissue, body.tissues, body.rig, parts, {}, progress, &report);
    cmd::warn(report.warnings);
    write_weights(weights, volume, tissue, path);
  }
};

// A temporary folder, which the destructor removes.
class Scratch {
 public:
  Scratch() : folder_(std::filesystem::temp_directory_path() / ("limber-oracle-" + std::to_string(getpid()))) {
    std::filesystem::create_directories(folder_);
  }
  ~Scratch() {
    std::error_code ignored;
    std::filesystem::remove_all(folder_, ignored);
  }
  Scratch(const Scratch&) = delete;
  Scratch& operator=(const Scratch&) = delete;
  std::string file(const char* name) const { return (folder_ / name).string(); }

 private:
  Path folder_;
};

void make_weights(const Options& options) {
  std::optional<ThreadCount> threads;
  if (options.run.threads > 0) threads.emplace(options.run.threads);
  cmd::CommandProgress progress(options.run.progress);
  check_weights_writable(options.output);
  const ToldBody told(options, progress);
  told.write_weights_to(options.output, progress);
  std::int64_t voxels = 0;
  for (const BoneParts::Part& part : told.parts.parts) voxels += part.voxel_count;
  std::printf("bones told: %lld voxels for %zu rig bones; seams told: %lld faces\n", static_cast<long long>(voxels),
              told.parts.parts.size(), static_cast<long long>(told.tissue.seams() ? told.tissue.seams()->size() : 0));
}

int run_limber(std::vector<std::string> words) {
  std::vector<char*> pointers;
  for (std::string& word : words) pointers.push_back(word.data());
  CLI::App app("The program itself.", "limber");
  app.require_subcommand(1);
  cmd::add_commands(app, "");
  return cmd::run(app, static_cast<int>(pointers.size()), pointers.data());
}

// Runs the program's own `resample` command with the seams of ToldBody in a file. If the user gave no weights, first
// computes weights from the bones and seams of ToldBody.
//   words  the oracle's command line
int resample(const Options& options, std::vector<std::string> words) {
  const Scratch scratch;
  {
    cmd::CommandProgress progress("");
    const ToldBody told(options, progress);
    std::string seams = "none";
    if (const Seams* known = told.tissue.seams()) {
      seams = scratch.file("seams.nrrd");
      write_seams(*known, told.body.file.volume.grid, seams);
    }
    words.insert(words.end(), {"--seams", seams});
    if (options.weights.empty()) {
      const std::string weights = scratch.file("weights.nrrd");
      told.write_weights_to(weights, progress);
      words.insert(words.end(), {"--weights", weights});
    }
  }
  return run_limber(std::move(words));
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Limber that is told the true bones and seams of a hard body, for tests.", "limber_oracle");
  app.require_subcommand(1);
  Options options;
  int exit_code = 0;
  CLI::App* weights = app.add_subcommand("weights", "as of limber, of the true bones and seams");
  cmd::add_body_options(*weights, options.body);
  weights->add_option("-o,--output", options.output, "W.nrrd")->required();
  cmd::add_run_options(*weights, options.run);
  weights->callback([&] { make_weights(options); });
  CLI::App* posed = app.add_subcommand("resample", "as of limber, with the true seams; VOLUME comes first");
  cmd::add_body_options(*posed, options.body);
  posed->add_option("--weights", options.weights, "W.nrrd (default: of the true bones and seams)");
  posed->allow_extras();
  posed->callback([&] { exit_code = resample(options, std::vector<std::string>(argv, argv + argc)); });
  const int own = cmd::run(app, argc, argv);
  return own != 0 ? own : exit_code;
}
