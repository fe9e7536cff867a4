// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/skin/weights_io.h"

#include <cmath>
#include <cstring>
#include <fstream>

#include <doctest/doctest.h>

#include "core/base/deflate.h"
#include "core/base/error.h"
#include "core/binding/heat_diffusion.h"
#include "core/rig_io/rig_io.h"
#include "core/volume_io/volume_io.h"
#include "tests/core/skin/small_body.h"
#include "tests/support/program.h"
#include "tests/support/shared_data.h"

using namespace limber;
using namespace limber::test;

namespace {
struct Folder {
  TemporaryFolder made;
  Path path = made.path();
};
struct Made {
  SmallBody body = two_bone_bar(6, 16, 4);
  TissueVoxels tissue{body.volume};
  SkinWeights weights = diffuse_heat(body.volume, body.tissues, body.armature);
};
SkinWeights parse(const std::string& bytes, const LabelVolume& volume, const Armature& armature) {
  const Folder folder;
  std::ofstream(folder.path / "w.nrrd", std::ios::binary) << bytes;
  return read_weights(folder.path / "w.nrrd", volume, TissueVoxels(volume), armature).weights;
}
std::string bytes_of(const Made& made, const Path& folder) {
  write_weights(made.weights, made.body.volume, made.tissue, folder / "w.nrrd");
  return read_file(folder / "w.nrrd");
}
}  // namespace

TEST_CASE("weights io: what is written is read, also when the rig lists its bones in another order") {
  const Folder folder;
  const Made made;
  write_weights(made.weights, made.body.volume, made.tissue, folder.path / "w.nrrd");
  CHECK(read_weights(folder.path / "w.nrrd", made.body.volume, made.tissue, made.body.armature).weights ==
        made.weights);

  Armature turned = made.body.armature;
  std::swap(turned.bones[0], turned.bones[1]);
  const SkinWeights other = read_weights(folder.path / "w.nrrd", made.body.volume, made.tissue, turned).weights;
  CHECK(other.bones() == std::vector<std::string>{"Lower", "Upper"});
  CHECK(other.chunk(0)[0].of(1) == made.weights.chunk(0)[0].of(0));
}

TEST_CASE("weights io: names of bones with quotes, backslashes and accents come back") {
  const Folder folder;
  SmallBody body = two_bone_bar(6, 16, 4);
  body.armature.bones[0].name = "Upper \"left\" \\n";
  body.armature.bones[1].name = "Avant-bras \u00e9";
  const TissueVoxels tissue(body.volume);
  const SkinWeights weights = diffuse_heat(body.volume, body.tissues, body.armature);
  write_weights(weights, body.volume, tissue, folder.path / "w.nrrd");
  const WeightsFile back = read_weights(folder.path / "w.nrrd", body.volume, tissue, body.armature);
  CHECK(back.weights == weights);
  CHECK(back.warnings.empty());
}

TEST_CASE("weights io: the seams that weights were made with come along, and damaged ones are refused") {
  const Folder folder;
  Made made;
  const Path file = folder.path / "w.nrrd";
  const auto read = [&] {
    return read_weights(file, made.body.volume, TissueVoxels(made.body.volume), made.body.armature);
  };
  write_weights(made.weights, made.body.volume, made.tissue, file);
  CHECK_FALSE(read().seams);
  write_weights(made.weights, made.body.volume, made.tissue, file, SeamsOfWeights::OfTissue);
  REQUIRE(read().seams);
  CHECK(*read().seams == nullptr);

  const glm::ivec3 size = made.body.volume.grid.size;
  auto seams = std::make_shared<Seams>(size);
  seams->cut({0, 0, 0}, 2);
  seams->cut({size.x - 2, size.y - 1, size.z - 1}, 0);
  for (int y = 1; y < size.y; ++y) seams->cut({size.x / 2, y, size.z / 2}, 0);
  made.tissue.set_seams(seams);
  write_weights(made.weights, made.body.volume, made.tissue, file, SeamsOfWeights::OfTissue);
  REQUIRE(read().seams);
  REQUIRE(*read().seams);
  CHECK(**read().seams == *seams);
  CHECK(read().weights == made.weights);

  const std::string bytes = read_file(file), key = "limber_seams:=";
  const std::size_t at = bytes.find(key) + key.size();
  for (const char* damage : {"zz", "8", "ffffffffffffffffff7f", "ffffffff7f"}) {
    std::string broken = bytes;
    broken.replace(at, bytes.find('\n', at) - at, damage);
    CHECK_THROWS_AS(parse(broken, made.body.volume, made.body.armature), Error);
  }
}

TEST_CASE("weights io: packed weights are read, and refused when a byte is wrong or missing") {
  const Folder folder;
  const Made made;
  const std::string raw = bytes_of(made, folder.path);
  const std::size_t begin = raw.find("\n\n") + 2;
  std::string header = raw.substr(0, begin), packed;
  header.replace(header.find("raw"), 3, "gzip");
  Deflater deflater(Deflater::Wrap::Gzip,
                    [&](const void* bytes, std::size_t size) { packed.append(static_cast<const char*>(bytes), size); });
  deflater.write(raw.data() + begin, raw.size() - begin);
  deflater.end();

  auto parse = [&](const std::string& data) { return ::parse(header + data, made.body.volume, made.body.armature); };
  CHECK(parse(packed) == made.weights);
  CHECK_THROWS_AS(parse(packed.substr(0, packed.size() - 1)), Error);
  std::string wrong = packed;
  wrong[wrong.size() - 6] ^= 1;  // a bit of the checksum
  CHECK_THROWS_AS(parse(wrong), Error);
}

TEST_CASE("weights io: damaged weights and weights of another volume or rig are refused") {
  const Folder folder;
  const Made made;
  const std::string whole = bytes_of(made, folder.path);
  auto parse = [&](const std::string& bytes) { return ::parse(bytes, made.body.volume, made.body.armature); };
  CHECK(parse(whole) == made.weights);
  CHECK_THROWS_AS(parse(whole.substr(0, whole.size() - 1)), Error);
  CHECK_THROWS_WITH_AS(parse(whole + "x"), doctest::Contains("more weights than"), Error);
  CHECK_THROWS_AS(parse(whole.substr(0, 60)), Error);
  CHECK_THROWS_AS(parse(""), Error);

  std::string sum = whole, bone = whole;
  sum[sum.size() - 8] ^= 1;        // changes the last voxel's largest weight
  bone[bone.size() - 16 + 1] = 9;  // changes the bone of the last voxel's largest weight
  CHECK_THROWS_WITH_AS(parse(sum), doctest::Contains("sum to"), Error);
  CHECK_THROWS_WITH_AS(parse(bone), doctest::Contains("belongs to bone"), Error);

  LabelVolume less = made.body.volume;
  less.at({2, 2, 2}) = 0;
  CHECK_THROWS_WITH_AS(::parse(whole, less, made.body.armature), doctest::Contains("another volume"), Error);
  Armature renamed = made.body.armature;
  renamed.bones[1].name = "Tail";
  CHECK_THROWS_WITH_AS(::parse(whole, made.body.volume, renamed), doctest::Contains("Lower"), Error);
}

TEST_CASE("weights io: Bender's series of weight_NN.mha is written and read again") {
  const Folder folder;
  const Made made;
  const Path series = folder.path / "series";
  write_bender_weights(made.weights, made.body.volume, made.tissue, series);
  const WeightsFile back = read_weights(series, made.body.volume, made.tissue, made.body.armature);
  CHECK(back.warnings.empty());
  for (std::int64_t c = 0; c < made.weights.chunk_count(); ++c)
    for (size_t i = 0; i < made.weights.chunk(c).size(); ++i)
      for (int bone = 0; bone < 2; ++bone)
        CHECK(std::abs(back.weights.chunk(c)[i].of(bone) - made.weights.chunk(c)[i].of(bone)) < 2e-5);

  std::filesystem::remove(series / "weight_01.mha");
  CHECK_THROWS_WITH_AS(read_weights(series, made.body.volume, made.tissue, made.body.armature),
                       doctest::Contains("1 files"), Error);
}

TEST_CASE("weights io: Bender's skin map makes each voxel rigid with the bone it names") {
  NEEDS_SHARED("data/bender/man-arm-2mm-skinned.mha");
  const VolumeFile file = read_volume(shared_path("data/bender/man-arm-2mm.mha"));
  const Armature armature = read_armature(shared_path("data/bender/man-arm-2mm-armature.vtk"));
  const VolumeFile map = read_volume(shared_path("data/bender/man-arm-2mm-skinned.mha"));
  const TissueVoxels tissue(file.volume);
  const SkinWeights weights =
      read_weights(shared_path("data/bender/man-arm-2mm-skinned.mha"), file.volume, tissue, armature).weights;
  std::int64_t named = 0, wrong = 0;
  for (std::int64_t b = 0; b < weights.chunk_count(); ++b)
    tissue.for_each(b, b + 1, [&](std::int64_t place, const glm::ivec3& v) {
      const Influence& influence = weights.chunk(b)[place - tissue.bricks()[b].first];
      wrong += influence.weight[0] != kFullWeight;
      const Tissue* value = map.tissues.find(map.volume.at(v));
      if (!value || value->file_value < 2) return;
      ++named;
      wrong += influence.bone[0] + 2 != value->file_value;
    });
  MESSAGE(named, " of ", tissue.size(), " tissue voxels are named");
  CHECK(wrong == 0);
  CHECK(named > tissue.size() * 9 / 10);
}
