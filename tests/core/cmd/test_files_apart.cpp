// SPDX-License-Identifier: AGPL-3.0-or-later
// No command writes over a file that it reads, under whatever name, nor writes two outputs to one file. A command that
// is asked to do so ends with exit code 2 before it reads anything.
#include <filesystem>

#include <doctest/doctest.h>
#include <CLI/CLI.hpp>

#include "core/base/file.h"
#include "core/cmd/command.h"
#include "core/phantom/phantom.h"
#include "core/rig_io/rig_io.h"
#include "core/volume_io/volume_io.h"
#include "tests/support/program.h"

using namespace limber;
using namespace limber::test;

namespace {

using Words = std::vector<std::string>;

// A small arm and the files that belong to it. The commands below fail before they read most of them.
struct Files {
  TemporaryFolder folder;
  Files() {
    const Phantom phantom = make_arm_phantom(10);
    write_volume(phantom.volume, folder / "volume.nrrd", phantom.tissues);
    write_volume(phantom.volume, folder / "detached.mhd", phantom.tissues);
    write_armature(phantom.armature, folder / "rig.json");
    write_bvh(phantom.motion, folder / "motion.bvh");
    write_file_atomically(folder / "pose.json", R"({"bones":{}})");
    write_file_atomically(folder / "tissues.json", R"({"1":"Skin"})");
    write_file_atomically(folder / "weights.nrrd", "hours of painting");
    write_file_atomically(folder / "points.csv", "name,x,y,z\n");
    write_file_atomically(folder / "arm.node", "a mesh");
    write_file_atomically(folder / "body.limber", "a project");
    write_file_atomically(folder / "job.json",
                          R"({"command": "prepare", "volume": "volume.nrrd", "output": "job.json"})");
    std::filesystem::create_symlink("volume.nrrd", folder / "link.nrrd");
    std::filesystem::create_symlink("nowhere.nrrd", folder / "dangling.nrrd");
    std::filesystem::create_hard_link(folder / "volume.nrrd", folder / "twin.nrrd");
  }
  std::string hash() const { return sha256_of_file(folder.path()); }
};

// Returns `words` with each @NAME replaced by the path of file NAME in the folder.
Words in_folder(Words words, const TemporaryFolder& folder) {
  for (std::string& word : words)
    for (std::size_t at; (at = word.find('@')) != std::string::npos;) word.replace(at, 1, folder.path().string() + "/");
  return words;
}

std::string text_of(const Words& words) {
  std::string text;
  for (const std::string& word : words) text += word + " ";
  return text;
}

void check_refused(const Files& files, const Words& words, const char* sentence) {
  const std::string before = files.hash();
  const ProgramRun run = run_limber(in_folder(words, files.folder));
  CAPTURE(text_of(words));
  CAPTURE(run.err);
  CHECK(run.exit_code == 2);
  CHECK(run.err.starts_with(std::string("limber: ") + sentence));
  CHECK(std::count(run.err.begin(), run.err.end(), '\n') == 1);
  CHECK(files.hash() == before);
}

}  // namespace

TEST_CASE("command files: an output that is also an input is refused by every command, and nothing is changed" *
          doctest::test_suite("slow")) {
  const Files files;
  const Words resample{"resample", "@volume.nrrd", "--rig", "@rig.json", "--flex", "Forearm=20", "--method", "lbs"};
  const auto with = [](Words words, const Words& more) {
    words.insert(words.end(), more.begin(), more.end());
    return words;
  };
  for (const Words& words : {
           with(resample, {"-o", "@volume.nrrd"}),
           with(resample, {"-o", "@link.nrrd"}),
           with(resample, {"-o", "@twin.nrrd"}),
           with(resample, {"-o", "@./volume.nrrd"}),
           with(resample, {"-o", "@out.nrrd", "--report", "@rig.json"}),
           with(resample, {"-o", "@out.nrrd", "--weights", "@weights.nrrd", "--field", "@weights.nrrd"}),
           with(resample, {"-o", "@out.nrrd", "--with", "@twin.nrrd=@link.nrrd"}),
           with(resample, {"-o", "@out.nrrd", "--landmarks", "@points.csv=@points.csv"}),
           Words{"resample", "@volume.nrrd", "--rig", "@rig.json", "--pose", "@pose.json", "-o", "@out.nrrd",
                 "--report", "@pose.json"},
           Words{"weights", "@volume.nrrd", "--rig", "@rig.json", "-o", "@volume.nrrd"},
           Words{"prepare", "@volume.nrrd", "-o", "@volume.nrrd"},
           Words{"prepare", "@detached.mhd", "-o", "@out.nrrd", "--statistics", "@detached.zraw"},
           Words{"prepare", "@volume.nrrd", "-o", "@out.nrrd", "--tissues", "@tissues.json", "--statistics",
                 "@tissues.json"},
           Words{"convert", "@volume.nrrd", "@twin.nrrd"},
           Words{"convert", "@tissues.json", "@tissues.json"},
           Words{"convert", "@rig.json", "@rig.json"},
           Words{"fit-joint", "@volume.nrrd", "--rig", "@rig.json", "--bone", "Forearm", "-o", "@rig.json"},
           Words{"bake-joint", "@volume.nrrd", "--rig", "@rig.json", "--weights", "@weights.nrrd", "--bone", "Forearm",
                 "-o", "@weights.nrrd"},
           Words{"repair-joint", "@volume.nrrd", "--rig", "@rig.json", "--weights", "@weights.nrrd", "--bone",
                 "Forearm", "-o", "@weights.nrrd"},
           Words{"clean-motion", "@rig.json", "--motion", "@motion.bvh", "-o", "@motion.bvh"},
           Words{"mesh", "@arm.node", "-o", "@arm.node"},
           Words{"fit-rig", "@volume.nrrd", "--template", "@rig.json", "-o", "@rig.json"},
           Words{"export-gltf", "@volume.nrrd", "--rig", "@rig.json", "--weights", "@weights.nrrd", "-o",
                 "@weights.nrrd"},
           Words{"surfaces", "@volume.nrrd", "--tissues", "@tissues.json", "-o", "@tissues.json"},
           Words{"tissues", "@volume.nrrd", "--frequency", "1e9", "--tissues", "@tissues.json", "-o", "@tissues.json"},
           Words{"project", "@body.limber", "export", "volume", "-o", "@body.limber"},
           Words{"project", "@volume.nrrd", "create", "@volume.nrrd", "--replace"},
           Words{"experiment", "@cells.json", "-o", "@."},
           Words{"batch", "@cells.csv", "-o", "@."},
           Words{"job", "@job.json"},
       }) {
    if (words[0] == "experiment") write_file_atomically(files.folder / "cells.json", "{}");
    if (words[0] == "batch") write_file_atomically(files.folder / "cells.csv", "{}");
    check_refused(files, words, "the output is also an input: ");
  }
}

TEST_CASE("command files: two outputs that are one file are refused, also through a link to what is not there yet") {
  const Files files;
  const Words resample{"resample", "@volume.nrrd", "--rig", "@rig.json", "--flex", "Forearm=20", "--method", "lbs"};
  for (const Words& more :
       {Words{"-o", "@out.nrrd", "--field", "@out.nrrd"}, Words{"-o", "@nowhere.nrrd", "--jacobian", "@dangling.nrrd"},
        Words{"-o", "@out.mhd", "--report", "@out.zraw"}, Words{"-o", "@out.nrrd", "--overlap", "@./out.nrrd"}}) {
    Words words = resample;
    words.insert(words.end(), more.begin(), more.end());
    check_refused(files, words, "two outputs would be the same file: ");
  }
}

TEST_CASE("command files: a frame of a sequence is not written over an input") {
  const Files files;
  std::filesystem::rename(files.folder / "volume.nrrd", files.folder / "posed-0003.nrrd");
  const Words words{"resample",    "@posed-0003.nrrd", "--rig", "@rig.json", "--motion",
                    "@motion.bvh", "--method",         "lbs",   "-o",        "@posed-{frame}.nrrd"};
  const auto frames = [&](const char* range) {
    Words all = words;
    all.insert(all.end(), {"--frames", range});
    return all;
  };
  check_refused(files, frames("0:5"), "the output is also an input: ");
  const ProgramRun others = run_limber(in_folder(frames("4:4"), files.folder));
  CHECK_MESSAGE(others.exit_code == 0, others.err);
}

TEST_CASE("command files: what is apart is written, also over an older output") {
  const Files files;
  for (int i = 0; i < 2; ++i) {
    const ProgramRun run = run_limber(in_folder({"convert", "@volume.nrrd", "@out.mha"}, files.folder));
    CHECK_MESSAGE(run.exit_code == 0, run.err);
  }
}

TEST_CASE("command files: every command that takes -o says that it is written") {
  CLI::App app;
  cmd::add_commands(app, "");
  int outputs = 0;
  for (CLI::App* command : app.get_subcommands({}))
    for (CLI::Option* option : command->get_options([](const CLI::Option* one) { return one->check_name("-o"); })) {
      CAPTURE(command->get_name());
      CHECK_NOTHROW(option->get_validator("files"));
      ++outputs;
    }
  CHECK(outputs == 15);
}
