// SPDX-License-Identifier: AGPL-3.0-or-later
// limber phantom arm|body [--spacing MM] -o DIR: writes a procedural sample: a volume, its tissues, a rig and a motion.
#include <memory>
#include <optional>

#include "core/base/error.h"
#include "core/base/parallel.h"
#include "core/cmd/command.h"
#include "core/cmd/command_files.h"
#include "core/phantom/phantom.h"
#include "core/rig_io/rig_io.h"
#include "core/volume_io/volume_io.h"

namespace limber::cmd {

namespace {
struct PhantomOptions {
  std::string subject, folder;
  std::optional<double> spacing;
  RunOptions run;
};

void make_phantom(const PhantomOptions& options) {
  std::optional<ThreadCount> threads;
  if (options.run.threads > 0) threads.emplace(options.run.threads);
  CommandProgress progress(options.run.progress);
  const Phantom phantom = options.subject == "arm" ? make_arm_phantom(options.spacing.value_or(2), progress)
                                                   : make_body_phantom(options.spacing.value_or(4), progress);
  const Path folder = options.folder;
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) throw Error("the folder cannot be made", folder.string(), error.message());
  progress.update("write", 0);
  write_volume(phantom.volume, folder / "volume.nrrd", phantom.tissues, {"NRRD", "uint8", true});
  write_tissue_table(phantom.tissues, folder / "tissues.json");
  write_armature(phantom.armature, folder / "rig.json");
  write_bvh(phantom.motion, folder / "motion.bvh");
  progress.update("write", 1);
}

OptionFiles files_of_folder(const std::string& folder) {
  OptionFiles files;
  for (const char* name : {"volume.nrrd", "tissues.json", "rig.json", "motion.bvh"})
    files.written.push_back(Path(folder) / name);
  return files;
}
}  // namespace

void add_phantom(CLI::App& app) {
  auto* command =
      app.add_subcommand("phantom", "makes a procedural sample: volume.nrrd, tissues.json, rig.json, motion.bvh");
  auto options = std::make_shared<PhantomOptions>();
  command->add_option("SUBJECT", options->subject, "sample to make: arm or body")
      ->required()
      ->check(CLI::IsMember({"arm", "body"}));
  command->add_option("--spacing", options->spacing, "size of a voxel in mm, 0.5 to 10 (default: arm 2, body 4)");
  writes(command->add_option("-o,--output", options->folder, "folder for the four files; created if missing"),
         files_of_folder)
      ->required();
  add_run_options(*command, options->run);
  command->callback([options] { make_phantom(*options); });
}

}  // namespace limber::cmd
