// SPDX-License-Identifier: AGPL-3.0-or-later
// Runs the commands that the user guide tells its readers to type. Each must work as it is printed.
#include <fstream>

#include <doctest/doctest.h>

#include "core/phantom/phantom.h"
#include "core/volume_io/volume_io.h"
#include "tests/support/program.h"

using namespace limber;
using namespace limber::test;
namespace fs = std::filesystem;

namespace {

// Writes the CT that a recipe asks its reader for: the densities of a body, in Hounsfield units.
void write_ct(const fs::path& path) {
  const Phantom body = make_body_phantom(8);
  std::ofstream file(path, std::ios::binary);
  const Grid& grid = body.volume.grid;
  file << "NRRD0005\ntype: short\ndimension: 3\nspace: left-posterior-superior\nendian: little\nencoding: raw\nsizes: "
       << grid.size.x << ' ' << grid.size.y << ' ' << grid.size.z
       << "\nspace directions: (8,0,0) (0,8,0) (0,0,8)\nspace origin: (" << grid.origin.x << ',' << grid.origin.y << ','
       << grid.origin.z << ")\n\n";
  for (std::size_t i = 0; i < body.volume.voxels.size(); ++i) {
    const Tissue* tissue = body.tissues.find(body.volume.voxels[i]);
    const int density = !tissue || tissue->kind == TissueKind::Cavity ? -1000
                        : is_bone(tissue->kind)                       ? 700
                        : tissue->kind == TissueKind::Fat             ? -100
                        : tissue->name.ends_with("lung")              ? -800
                                                                      : 50;
    const int noisy = density + static_cast<int>(i * 7919 % 41) - 20;
    file.put(static_cast<char>(noisy & 0xFF)).put(static_cast<char>((noisy >> 8) & 0xFF));
  }
}

// Runs the commands in the bullet points of a page, one after the other, in a new folder. Returns their number.
int run_commands_of(const fs::path& page) {
  const TemporaryFolder folder;
  std::ifstream guide(page);
  int commands = 0;
  for (std::string line; std::getline(guide, line);) {
    const std::string begin = "- `limber ";
    if (!line.starts_with(begin)) continue;
    if (line.find("ct.nrrd") != std::string::npos && !fs::exists(folder / "ct.nrrd")) write_ct(folder / "ct.nrrd");
    const std::string arguments = line.substr(begin.size(), line.find('`', begin.size()) - begin.size());
    const auto run =
        run_program("/bin/sh", {"-c", "cd " + folder.path().string() + " && " LIMBER_PROGRAM " " + arguments});
    CHECK_MESSAGE(run.exit_code == 0, page.stem().string(), ": ", arguments, ": ", run.err);
    ++commands;
  }
  return commands;
}

}  // namespace

TEST_CASE("user guide: every point that is a command runs, one after the other, in an empty folder for each page" *
          doctest::test_suite("slow")) {
  const fs::path docs = LIMBER_SOURCE_DIR "/assets/docs";
  int commands = run_commands_of(docs / "guide.md"), recipes = 0;
  for (const auto& entry : fs::directory_iterator(docs / "guide")) {
    if (entry.path().extension() != ".md") continue;
    const int here = run_commands_of(entry.path());
    commands += here;
    if (entry.path().stem().string().starts_with("recipe-")) {
      CHECK(here >= 4);
      ++recipes;
    }
  }
  CHECK(commands >= 24);
  CHECK(recipes == 3);
}
