// SPDX-License-Identifier: AGPL-3.0-or-later
// Tests what the command line prints: names from files cannot control the terminal, and output that cannot be written
// is an error.
#include <algorithm>
#include <cstdlib>

#include <doctest/doctest.h>
#include <nlohmann/json.hpp>

#include "core/base/file.h"
#include "core/cmd/print.h"
#include "core/phantom/phantom.h"
#include "core/platform/module.h"
#include "core/rig_io/rig_io.h"
#include "core/volume_io/volume_io.h"
#include "tests/support/program.h"

using namespace limber;
using namespace limber::test;

namespace {

// Text that would clear the screen, rename the window by a C1 code, and hide text by a carriage return.
const std::string kHostile =
    "Fore\x1b[2J\xc2\x9d"
    "0;x\x07\x7f\rarm";

bool is_clean(const std::string& text) {
  for (std::size_t i = 0; i < text.size(); ++i) {
    const auto byte = static_cast<unsigned char>(text[i]);
    if ((byte < 0x20 && byte != '\n' && byte != '\t') || byte == 0x7f) return false;
    if (byte == 0xc2 && i + 1 < text.size() && static_cast<unsigned char>(text[i + 1]) < 0xa0) return false;
  }
  return true;
}

struct HostileArm {
  TemporaryFolder folder;
  HostileArm() {
    Phantom phantom = make_arm_phantom(10);
    for (Tissue& tissue : phantom.tissues.tissues) tissue.name += kHostile;
    for (Bone& bone : phantom.armature.bones) bone.name += kHostile;
    for (BvhJoint& joint : phantom.motion.joints) joint.name += "\x1b[2J";
    write_volume(phantom.volume, folder / "volume.nrrd", phantom.tissues);
    write_tissue_table(phantom.tissues, folder / "tissues.json");
    write_armature(phantom.armature, folder / "rig.json");
    write_bvh(phantom.motion, folder / "motion.bvh");
  }
};

ProgramRun run_shell(const std::string& command) { return run_program("/bin/sh", {"-c", command}); }

}  // namespace

TEST_CASE("printed text: control characters and broken UTF-8 are made visible, letters of any script are kept") {
  CHECK(cmd::printable("Schädel 頭 \xf0\x9f\xa6\xb4\n\tA") == "Schädel 頭 \xf0\x9f\xa6\xb4\n\tA");
  CHECK(cmd::printable("a\x1b[31mb\x7f") == "a?[31mb?");
  CHECK(cmd::printable("a\xc2\x9b"
                       "31m") == "a?31m");  // the control character CSI of the C1 set
  CHECK(cmd::printable("a\x9b"
                       "31m\xe9") == "a?31m?");  // the single byte CSI, and a letter in Latin-1
  CHECK(cmd::printable("\xed\xa0\x80\xc0\x80\xf4\x90\x80\x80\xe2\x82").find_first_not_of('?') == std::string::npos);
  CHECK(cmd::one_line("a\nb\tc\rd\x1b") == "a b c d?");
}

TEST_CASE("printed text: names from files give no orders to the terminal, and JSON keeps them whole" *
          doctest::test_suite("slow")) {
  const HostileArm arm;
  const std::string volume = arm.folder / "volume.nrrd", rig = arm.folder / "rig.json",
                    tissues = arm.folder / "tissues.json";
  const std::vector<std::vector<std::string>> commands = {
      {"info", volume},
      {"info", rig},
      {"info", arm.folder / "motion.bvh"},
      {"info", tissues},
      {"info", rig, "--json"},
      {"fk", rig},
      {"fk", rig, "--json"},
      {"fk", arm.folder / "motion.bvh"},
      {"weights", volume, "--rig", rig, "--tissues", tissues, "-o", arm.folder / "w.nrrd"},
      {"tissues", volume, "--frequency", "1e9"},
      {"tissues", volume, "--frequency", "1e9", "--json"},
      {"report", volume, volume},
      {"report", volume, volume, "--json"},
      {"surfaces", volume, "-o", arm.folder / "s.obj"},
      {"prepare", volume, "-o", arm.folder / "p.nrrd", "--close-skin", "outward", "--merge", "1=2"},
      {"info", arm.folder / kHostile},
      {"resample", kHostile, "--" + kHostile},
      {"fk", rig, "--flex", kHostile + "=4"},
  };
  for (const auto& words : commands) {
    const ProgramRun run = run_limber(words);
    CAPTURE(words[0]);
    CAPTURE(words[1]);
    CHECK_FALSE((run.out + run.err).empty());
    CHECK(is_clean(run.out));
    CHECK(is_clean(run.err));
    if (words.back() == "--json") CHECK(run.out.find("\\u001b[2J") != std::string::npos);
  }
  const auto json = nlohmann::json::parse(run_limber({"fk", rig, "--json"}).out);
  CHECK(json["joints"][0]["name"].get<std::string>().ends_with(kHostile));
}

TEST_CASE("printed text: a full disk or a closed stdout is told, and no command says that it is done" *
          doctest::test_suite("slow")) {
  const HostileArm arm;
  const std::string program = LIMBER_PROGRAM, folder = arm.folder.path().string() + "/";
  for (const std::string& words : std::vector<std::string>{
           "info " + folder + "rig.json", "info --json " + folder + "rig.json", "fk " + folder + "rig.json",
           "fk --json " + folder + "rig.json",
           "fk --json --all-frames " + folder + "rig.json --motion " + folder + "motion.bvh", "tissues --frequency 1e9",
           "tissues --frequency 1e9 --json", "report " + folder + "volume.nrrd " + folder + "volume.nrrd",
           "surfaces " + folder + "volume.nrrd -o " + folder + "s.obj", "--help", "--version"})
    for (const char* to : {" > /dev/full", " >&-"}) {
      const ProgramRun run = run_shell(program + " " + words + to);
      CAPTURE(words);
      CAPTURE(to);
      CAPTURE(run.err);
      CHECK(run.exit_code == 1);
      CHECK(run.err.find("limber: the printed text could not be written") != std::string::npos);
    }
  CHECK(run_shell(program + " fk nothing.json > /dev/full").exit_code == 1);
}

TEST_CASE("printed text: without stdout and stderr the files that are written hold no messages") {
  const HostileArm arm;
  const std::string folder = arm.folder.path().string() + "/";
  run_shell(std::string(LIMBER_PROGRAM) + " prepare " + folder + "volume.nrrd --close-skin outward -o " + folder +
            "closed.nrrd <&- >&- 2>&-");
  const auto run =
      run_limber({"prepare", folder + "volume.nrrd", "--close-skin", "outward", "-o", folder + "again.nrrd"});
  CHECK_MESSAGE(run.exit_code == 0, run.err);
  CHECK(read_file(folder + "closed.nrrd") == read_file(folder + "again.nrrd"));
}

TEST_CASE("modules: a planted one in the working folder is not loaded, whatever the environment says") {
  const TemporaryFolder folder;
  // Plants a library under the module's name. A program that loads by the bare name would load this one and call it
  // damaged.
  const std::string planted = folder / "limber_dicom.so";
  write_file_atomically(
      folder / "planted.c",
      "#include <stdio.h>\n__attribute__((constructor)) static void run(void) { fclose(fopen(\"ran\", \"w\")); }\n");
  const auto built = run_program("cc", {"-shared", "-fPIC", "-o", planted, folder / "planted.c"});
  REQUIRE_MESSAGE(built.exit_code == 0, built.err);
  std::string dicom(128, '\0');
  dicom += "DICM";
  write_file_atomically(folder / "image.dcm", dicom);
  const auto run =
      run_shell("cd " + folder.path().string() + " && LD_LIBRARY_PATH=: " + LIMBER_PROGRAM + " info image.dcm");
  CHECK(run.exit_code == 1);
  CHECK(run.err.find("missing or damaged") == std::string::npos);
  CHECK_FALSE(std::filesystem::exists(folder / "ran"));
  CHECK(find_program("sh").has_value());
  CHECK_FALSE(find_program("no-such-program-anywhere").has_value());
}

TEST_CASE("printed text: a zero byte in a name is refused, where the system would cut the name") {
  const HostileArm arm;
  CHECK_THROWS_WITH(check_place(std::string("a\0b", 3)), doctest::Contains("zero byte"));
  write_file_atomically(arm.folder / "job.json",
                        R"({"command": "prepare", "volume": "volume.nrrd", "output": "cut\u0000.nrrd"})");
  const auto run = run_limber({"job", arm.folder / "job.json"});
  CHECK(run.exit_code == 1);
  CHECK(run.err.find("a setting contains a zero byte") != std::string::npos);
  CHECK_FALSE(std::filesystem::exists(arm.folder / "cut"));
}
