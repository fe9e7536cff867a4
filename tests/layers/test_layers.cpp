// SPDX-License-Identifier: AGPL-3.0-or-later
// Checks the layers: render may include core, and editor may include both, never the other way. Each heavy library may
// be included only by the files listed for it.
#include <algorithm>
#include <filesystem>
#include <regex>
#include <string>
#include <vector>

#include <doctest/doctest.h>

#include "tests/layers/sources.h"

using namespace limber::layers;

namespace {

struct Door {
  std::string library;
  std::vector<std::string> headers;  // prefixes of include paths
  std::vector<std::string> allowed;  // prefixes of the paths of files that may include them
};

const std::vector<Door> kDoors = {
    {"pybind11", {"pybind11/"}, {"core/python/"}},
    {"GDCM", {"gdcm"}, {"core/volume_io/dicom_codec.cpp"}},
    {"HDF5", {"hdf5"}, {"core/export/hdf5_codec.cpp"}},
    {"ISA-L", {"isa-l"}, {"core/base/deflate.cpp"}},
    {"bzip2", {"bzlib"}, {"core/volume_io/voxel_stream.cpp"}},
    {"TetGen", {"tetgen"}, {"core/mesh/tetrahedralize.cpp"}},
    {"CGAL", {"CGAL/"}, {"tests/independent/", "tests/bench/mesh_cgal.cpp", "tests/support/crossings_cgal.h"}},
    {"ITK", {"itk"}, {"tests/independent/"}},
    {"CHOLMOD", {"cholmod", "suitesparse/"}, {"core/base/cholesky.cpp"}},
    {"TBB", {"tbb/", "oneapi/"}, {"core/base/parallel.cpp", "core/base/background.cpp"}},
    {"SQLite", {"sqlite3"}, {"core/project/", "tests/core/project/", "tests/support/power_cut.cpp"}},
    {"zstd", {"zstd"}, {"core/project/"}},
    {"CLI11", {"CLI/"}, {"core/cmd/", "editor/cli/main.cpp", "editor/cli/", "tests/core/cmd/test_files_apart.cpp"}},
    {"Expat", {"expat"}, {"core/rig_io/bender_rig.cpp", "core/volume_io/vti.cpp"}},
    {"OpenSSL", {"openssl/"}, {"core/base/sha256.cpp"}},
    {"GLFW", {"GLFW/"}, {"editor/app/glfw_window.cpp"}},
    {"libpng", {"png"}, {"render/image_io.cpp"}},
    {"FreeType", {"ft2build", "freetype"}, {"editor/"}},
    {"OpenGL", {"epoxy/", "GL/", "EGL/"}, {"render/", "editor/", "tests/"}},
    {"Dear ImGui", {"imgui"}, {"editor/"}},
};

}  // namespace

TEST_CASE("layers: no file includes a floor above its own") {
  for (const auto& file : sources())
    for (const auto& include : includes_of(file)) {
      INFO(include.file, " includes ", include.header);
      if (include.file.starts_with("core/"))
        CHECK_FALSE(starts_with_any(include.header, {"render/", "editor/", "tests/"}));
      if (include.file.starts_with("render/")) CHECK_FALSE(starts_with_any(include.header, {"editor/", "tests/"}));
      if (include.file.starts_with("editor/")) CHECK_FALSE(starts_with_any(include.header, {"tests/"}));
    }
}

TEST_CASE("layers: each heavy library is included only behind its door") {
  for (const auto& file : sources())
    for (const auto& include : includes_of(file))
      for (const auto& door : kDoors)
        if (starts_with_any(include.header, door.headers)) {
          INFO(include.file, " includes ", include.header, " of ", door.library);
          CHECK(starts_with_any(include.file, door.allowed));
        }
}

TEST_CASE("layers: JSON stays in sources, never in a header") {
  for (const auto& file : sources())
    for (const auto& include : includes_of(file))
      if (include.header.starts_with("nlohmann/")) {
        INFO(include.file);
        CHECK(file.extension() == ".cpp");
      }
}

TEST_CASE("layers: core's own folders are used from the command line downward, never the other way") {
  for (const auto& file : sources())
    for (const auto& include : includes_of(file))
      if (include.file.starts_with("core/") && !include.file.starts_with("core/cmd/")) {
        INFO(include.file, " includes ", include.header);
        CHECK_FALSE(include.header.starts_with("core/cmd/"));
      }
}

namespace {
// Returns the program's source lines that match `pattern`, with file and line number.
std::vector<std::string> lines_with(const std::regex& pattern) {
  std::vector<std::string> found;
  for (const auto& file : sources()) {
    if (file.generic_string().starts_with("tests/")) continue;
    for (const std::string& line : lines_of(file))
      if (std::regex_search(line, pattern)) found.push_back(file.generic_string() + ": " + line);
  }
  return found;
}
}  // namespace

TEST_CASE("layers: the terminal is written to at one place, which lets no control character out") {
  const auto lines = lines_with(std::regex(R"(\b(printf|fprintf|vprintf|vfprintf|puts|fputs|putchar|perror)\()"
                                           R"(|\bfwrite\(.*\bstd(out|err)\b|\bstd::(cout|cerr|clog)\b)"));
  CHECK_FALSE(lines.empty());
  for (const std::string& line : lines) {
    INFO(line);
    CHECK(line.starts_with("core/cmd/print.cpp: "));
  }
}

TEST_CASE("layers: modules and programs are opened by their whole path, at one place") {
  for (const std::string& line :
       lines_with(std::regex(R"(\b(dlopen|dlmopen|execvp|execlp|execvpe|posix_spawnp|popen|system)\()"))) {
    INFO(line);
    CHECK(line.starts_with("core/platform/module.cpp: "));
  }
}

TEST_CASE("layers: every source names its licence in its first line") {
  for (const auto& file : sources()) {
    INFO(file.generic_string());
    CHECK(lines_of(file).front() == "// SPDX-License-Identifier: AGPL-3.0-or-later");
  }
}

TEST_CASE("layers: the top level holds what the map of the tree says, and nothing else") {
  const std::vector<std::string> allowed = {"CMakeLists.txt", "core",      "render",  "editor", "assets", "tests",
                                            "third_party",    "README.md", "LICENSE", "run",    "out"};
  for (const auto& entry : fs::directory_iterator(root())) {
    const std::string name = entry.path().filename().string();
    if (name.starts_with(".") || name.starts_with("build")) continue;
    INFO(name);
    CHECK(std::find(allowed.begin(), allowed.end(), name) != allowed.end());
  }
}
