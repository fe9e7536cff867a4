// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/volume/volume_io.h"

#include <filesystem>

#include <doctest/doctest.h>
#include <unistd.h>

#include "core/base/error.h"
#include "tests/support/shared_data.h"

using namespace limber;
namespace fs = std::filesystem;

namespace {
struct TemporaryFolder {
  Path path = fs::temp_directory_path() / ("limber-volume-io-" + std::to_string(::getpid()));
  TemporaryFolder() { fs::create_directories(path); }
  ~TemporaryFolder() { fs::remove_all(path); }
};

LabelVolume small_volume() {
  LabelVolume volume{{{5, 4, 3}, {0.5, 3, 20}, {-7, 11, 0.1}, glm::dmat3(0, 1, 0, -1, 0, 0, 0, 0, -1)}, std::vector<Label>(60)};
  for (std::size_t i = 0; i < volume.voxels.size(); ++i) volume.voxels[i] = static_cast<Label>(i * 7 % 5);
  return volume;
}
}  // namespace

TEST_CASE("volume io: what is written is read back, in every format, mirrored and anisotropic too") {
  const TemporaryFolder folder;
  const LabelVolume volume = small_volume();
  for (const char* name : {"a.nrrd", "a.nhdr", "a.mha", "a.mhd"})
    for (bool compressed : {false, true}) {
      CAPTURE(name);
      CAPTURE(compressed);
      const Path path = folder.path / name;
      FileType type{Path(name).extension() == ".nrrd" || Path(name).extension() == ".nhdr" ? "NRRD" : "MetaImage", "uint16", compressed};
      write_volume(volume, path, {}, type);
      const VolumeFile back = read_volume(path);
      CHECK(back.volume.grid == volume.grid);
      CHECK(back.volume.voxels == volume.voxels);
      CHECK(back.type.voxel_type == "uint16");
      CHECK(back.type.compressed == compressed);
      CHECK(back.warnings.empty());
      CHECK(back.tissues.tissues.size() == 4);
    }
}

TEST_CASE("volume io: Bender's arm is read with its mirrored z axis and its twelve tissues") {
  NEEDS_SHARED("data/bender/man-arm-2mm.mha");
  const VolumeFile file = read_volume(test::shared_path("data/bender/man-arm-2mm.mha"));
  CHECK(file.volume.grid.size == glm::ivec3(128, 170, 335));
  CHECK(file.volume.grid.direction[2] == glm::dvec3(0, 0, -1));
  CHECK(std::count(file.volume.voxels.begin(), file.volume.voxels.end(), 17) == 346446);
  const TissueTable tissues = merge_tissue_tables(file.tissues, nullptr);
  CHECK(tissues.tissues.size() == 14);
  CHECK(tissues.find(111)->kind == TissueKind::CorticalBone);
  CHECK(file.warnings.empty());
}
