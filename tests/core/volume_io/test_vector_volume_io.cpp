// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/volume_io/vector_volume_io.h"

#include <fstream>
#include <limits>
#include <random>

#include <doctest/doctest.h>

#include "core/base/error.h"
#include "core/volume_io/volume_io.h"
#include "tests/support/program.h"

using namespace limber;
using namespace limber::test;

namespace {
Grid small_grid() { return {.size = {7, 5, 6}, .spacing = {2, 2, 3.5}, .origin = {-10, 4, 8}}; }

void write_bytes(const Path& path, const std::string& bytes) { std::ofstream(path, std::ios::binary) << bytes; }
}  // namespace

TEST_CASE("vector volumes: what is written is read back to the bit, on its grid") {
  const TemporaryFolder folder;
  std::mt19937 random(4);
  std::normal_distribution<float> number(0, 100);
  ZeroedVector<glm::vec3> field(7 * 5 * 6);
  for (glm::vec3& v : field) v = {number(random), number(random), number(random)};
  field[11] = field[12] = glm::vec3(0);
  write_vector_volume(small_grid(), {field.data(), field.size()}, folder / "field.nrrd");
  const VectorVolume read = read_vector_volume(folder / "field.nrrd");
  CHECK(read.grid == small_grid());
  CHECK(read.voxels == field);
  CHECK(read.warnings.empty());
}

TEST_CASE("vector volumes: what is no field is refused, with the file's name") {
  const TemporaryFolder folder;
  const Grid grid = small_grid();
  write_volume({grid, ZeroedVector<Label>(210, 3)}, folder / "labels.nrrd");
  const std::string header =
      "NRRD0005\ntype: float\ndimension: 4\nspace: left-posterior-superior\nsizes: 3 2 1 1\nspace directions: none "
      "(1,0,0) (0,1,0) (0,0,1)\n"
      "kinds: vector domain domain domain\nendian: little\nencoding: raw\nspace origin: (0,0,0)\n\n";
  const float values[6] = {1, 2, 3, 4, 5, std::numeric_limits<float>::quiet_NaN()};
  const std::string bytes(reinterpret_cast<const char*>(values), sizeof values);
  write_bytes(folder / "good.nrrd", header + bytes.substr(0, 20) + bytes.substr(0, 4));
  write_bytes(folder / "nan.nrrd", header + bytes);
  write_bytes(folder / "short.nrrd", header + bytes.substr(0, 20));
  write_bytes(folder / "four.nrrd", std::string(header).replace(header.find("sizes: 3"), 8, "sizes: 4") + bytes);
  write_bytes(folder / "double.nrrd", std::string(header).replace(header.find("float"), 5, "double") + bytes + bytes);
  write_bytes(folder / "text.nrrd", "sizes: 3 2 1 1\n\n");
  write_bytes(folder / "empty.nrrd", "");
  CHECK(read_vector_volume(folder / "good.nrrd").voxels[1] == glm::vec3(4, 5, 1));
  for (const char* name : {"labels.nrrd", "nan.nrrd", "short.nrrd", "four.nrrd", "double.nrrd", "text.nrrd",
                           "empty.nrrd", "absent.nrrd"}) {
    CAPTURE(name);
    try {
      read_vector_volume(folder / name);
      FAIL("was read");
    } catch (const Error& error) {
      CHECK(std::string(error.what()).find(name) != std::string::npos);
    }
  }
}
