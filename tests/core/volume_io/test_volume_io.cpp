// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/volume_io/volume_io.h"

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <sstream>

#include <doctest/doctest.h>
#include <unistd.h>
#include <zlib.h>

#include "core/base/error.h"
#include "core/volume_io/nifti.h"
#include "core/volume_io/volume_header.h"
#include "tests/support/shared_data.h"

using namespace limber;
namespace fs = std::filesystem;

namespace {
struct TemporaryFolder {
  Path path = fs::temp_directory_path() / ("limber-volume-io-" + std::to_string(::getpid()));
  TemporaryFolder() { fs::create_directories(path); }
  ~TemporaryFolder() { fs::remove_all(path); }
  Path write(const std::string& name, const std::string& bytes) const {
    std::ofstream(path / name, std::ios::binary) << bytes;
    return path / name;
  }
};

const glm::dmat3 kMirroredTurn(0, 1, 0, -1, 0, 0, 0, 0, -1);

LabelVolume small_volume(int labels = 5) {
  LabelVolume volume{{{5, 4, 3}, {0.5, 3, 20}, {-7, 11, 0.125}, kMirroredTurn}, ZeroedVector<Label>(60)};
  for (std::size_t i = 0; i < volume.voxels.size(); ++i)
    volume.voxels[i] = static_cast<Label>(i * 7 % static_cast<std::size_t>(labels));
  return volume;
}

std::string meta(const std::string& fields, const std::string& data) {
  return "ObjectType = Image\nNDims = 3\n" + fields + "ElementDataFile = LOCAL\n" + data;
}
std::string nrrd(const std::string& fields, const std::string& data) { return "NRRD0005\n" + fields + "\n" + data; }
const std::string kCube = "type: uint8\ndimension: 3\nsizes: 2 2 2\nencoding: raw\n";
const std::string kMetaCube = "DimSize = 2 2 2\nElementType = MET_UCHAR\n";
const std::string kEight("\0\1\2\3\4\5\6\7", 8);

std::string packed(const std::string& plain, int window_bits) {
  std::string out(plain.size() + 200, '\0');
  z_stream stream{};
  deflateInit2(&stream, 6, Z_DEFLATED, window_bits, 8, Z_DEFAULT_STRATEGY);
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(plain.data()));
  stream.avail_in = static_cast<uInt>(plain.size());
  stream.next_out = reinterpret_cast<Bytef*>(out.data());
  stream.avail_out = static_cast<uInt>(out.size());
  deflate(&stream, Z_FINISH);
  out.resize(stream.total_out);
  deflateEnd(&stream);
  return out;
}

std::string nifti(int version = 1) {
  return make_nifti_header({{2, 2, 2}, {1, 2, 3}, {4, 5, 6}, kMirroredTurn}, VoxelType::UInt8, 1, version, false) +
         kEight;
}
template <class T>
std::string patched(std::string bytes, std::size_t place, T value) {
  std::memcpy(bytes.data() + place, &value, sizeof value);
  return bytes;
}

// Returns the error message; empty if the file is read.
std::string refusal(const Path& path) {
  try {
    read_volume(path);
    return "";
  } catch (const Error& error) {
    return error.what();
  }
}
bool refused_for(const Path& path, const std::string& reason) {
  const std::string said = refusal(path);
  INFO(path.string(), " said: ", said);
  CHECK(said.find(reason) != std::string::npos);
  CHECK(said.find('\n') == std::string::npos);
  return said.find(reason) != std::string::npos;
}
}  // namespace

TEST_CASE("volume io: what is written is read back, in every format and voxel type, mirrored and anisotropic too" *
          doctest::test_suite("slow")) {
  const TemporaryFolder folder;
  const std::pair<const char*, const char*> formats[] = {
      {"a.nrrd", "NRRD"},      {"a.seg.nrrd", "NRRD"}, {"a.nhdr", "NRRD"},
      {"a.mha", "MetaImage"},  {"a.mhd", "MetaImage"}, {"a.nii", "NIfTI-1"},
      {"a.nii.gz", "NIfTI-1"}, {"b.nii", "NIfTI-2"},   {"a.hdr", "NIfTI-1"}};
  for (const auto& [name, format] : formats)
    for (const char* type :
         {"int8", "uint8", "int16", "uint16", "int32", "uint32", "int64", "uint64", "float32", "float64"})
      for (bool compressed : {false, true}) {
        CAPTURE(name);
        CAPTURE(type);
        CAPTURE(compressed);
        const LabelVolume volume = small_volume();
        write_volume(volume, folder.path / name, {}, {format, type, compressed});
        const VolumeFile back = read_volume(folder.path / name);
        CHECK(back.volume.grid == volume.grid);
        CHECK(back.volume.voxels == volume.voxels);
        CHECK(back.type.voxel_type == type);
        CHECK(back.type.format == format);
        CHECK(back.warnings.empty());
        CHECK(back.tissues.tissues.size() == 4);
      }
}

TEST_CASE("volume io: Virtual Family models keep labels, names, colours and steps") {
  const TemporaryFolder folder;
  LabelVolume volume = small_volume();
  volume.grid.direction = glm::dmat3(1);
  volume.grid.origin = glm::dvec3(0);
  TissueTable tissues;
  for (int i = 1; i < 5; ++i)
    tissues.tissues.push_back({static_cast<Label>(i),
                               double(i),
                               "Tissue_" + std::to_string(i),
                               {0.25f, 0.5f, 1},
                               TissueKind::Unknown,
                               1,
                               1,
                               0.4,
                               0});
  write_volume(volume, folder.path / "duke.txt", tissues);
  for (const char* name : {"duke.txt", "duke.raw"}) {
    CHECK(is_volume_path(folder.path / name));
    const VolumeFile back = read_volume(folder.path / name);
    CHECK(back.volume.grid == volume.grid);
    CHECK(back.volume.voxels == volume.voxels);
    CHECK(back.tissues.find(3)->name == "Tissue_3");
    CHECK(back.tissues.find(3)->colour.r == 0.25f);
  }
  fs::remove(folder.path / "duke.raw");
  refused_for(folder.path / "duke.txt", "missing");
}

TEST_CASE(
    "volume io: negative, large and many labels come back as they were, also beside small ones that want the same "
    "number") {
  const TemporaryFolder folder;
  const std::vector<std::int64_t> values = {0, -5, 4000000000, 65535, 65534, 70000, -1, 7};
  std::string data;
  for (std::int64_t value : values) data.append(reinterpret_cast<const char*>(&value), 8);
  const Path in =
      folder.write("wide.nrrd", nrrd("type: int64\ndimension: 3\nsizes: 2 2 2\nendian: little\nencoding: raw\n", data));
  const VolumeFile file = read_volume(in);
  for (std::size_t i = 0; i < values.size(); ++i) {
    const Label label = file.volume.voxels[i];
    CHECK((label == 0 ? 0.0 : file.tissues.find(label)->file_value) == static_cast<double>(values[i]));
  }
  CHECK(file.tissues.tissues.size() == 7);
  write_volume(file.volume, folder.path / "again.nrrd", file.tissues, file.type);
  const std::string written = read_file(folder.path / "again.nrrd");
  CHECK(written.substr(written.size() - data.size()) == data);
}

TEST_CASE("volume io: voxels are widened when a value does not fit the type") {
  const TemporaryFolder folder;
  LabelVolume volume = small_volume();
  volume.voxels[0] = 300;
  write_volume(volume, folder.path / "a.mha", {}, {"MetaImage", "uint8", true});
  CHECK(read_volume(folder.path / "a.mha").type.voxel_type == "uint16");
  TissueTable tissues;
  tissues.tissues.push_back({300, -4, "", {}, TissueKind::Unknown, 1, 1, 0.4, 0});
  write_volume(volume, folder.path / "a.mha", tissues, {"MetaImage", "uint8", true});
  CHECK(read_volume(folder.path / "a.mha").type.voxel_type == "int8");
}

TEST_CASE("volume io: segment names and colours of a .seg.nrrd are kept") {
  const TemporaryFolder folder;
  TissueTable tissues;
  tissues.tissues.push_back({1, 1, "Left femur \\ \"quoted\"", {0.25f, 0.5f, 0.75f}, TissueKind::Bone, 1, 1, 0.4, 0});
  tissues.tissues.push_back({2, 2, "M. vastus lateralis", {1, 0, 0}, TissueKind::Muscle, 1, 1, 0.4, 0});
  const LabelVolume volume = small_volume(3);
  write_volume(volume, folder.path / "a.seg.nrrd", tissues);
  const VolumeFile back = read_volume(folder.path / "a.seg.nrrd");
  REQUIRE(back.tissues.tissues.size() == 2);
  CHECK(back.tissues.find(1)->name == "Left femur \\ \"quoted\"");
  CHECK(back.tissues.find(1)->kind == TissueKind::Bone);
  CHECK(back.tissues.find(1)->colour == glm::vec3(0.25f, 0.5f, 0.75f));
  CHECK(back.tissues.find(2)->kind == TissueKind::Muscle);
  CHECK(summarize_volume(folder.path / "a.seg.nrrd").labels[1].name == "Left femur \\ \"quoted\"");
}

TEST_CASE("volume io: writing twice gives the same bytes, and an unwritable name is refused before") {
  const TemporaryFolder folder;
  for (const char* name : {"a.nrrd", "a.mha", "a.nii.gz"}) {
    write_volume(small_volume(), folder.path / name);
    const std::string once = read_file(folder.path / name);
    write_volume(small_volume(), folder.path / name);
    CHECK(read_file(folder.path / name) == once);
  }
  CHECK_THROWS_AS(check_writable(folder.path / "a.png"), Error);
  CHECK_THROWS_AS(check_writable(folder.path / "nowhere" / "a.nrrd"), Error);
  CHECK_THROWS_AS(write_volume(small_volume(), folder.path / "a"), Error);
}

TEST_CASE("volume io: every encoding of NRRD gives the same voxels, either byte order, CRLF, lines and bytes to skip") {
  const TemporaryFolder folder;
  const ZeroedVector<Label> expected = {0, 1, 2, 3, 4, 5, 6, 7};
  const auto check = [&](const std::string& name, const std::string& bytes) {
    CAPTURE(name);
    const VolumeFile file = read_volume(folder.write(name, bytes));
    CHECK(file.volume.voxels == expected);
    CHECK(file.warnings.empty());
  };
  const std::string shape = "dimension: 3\nsizes: 2 2 2\n";
  check("raw.nrrd", nrrd(kCube, kEight));
  check("gzip.nrrd", nrrd("type: uchar\n" + shape + "encoding: gz\n", packed(kEight, 31)));
  check("members.nrrd", nrrd("type: uchar\n" + shape + "encoding: gz\n",
                             packed(kEight.substr(0, 3), 31) + packed(kEight.substr(3), 31)));
  check("ascii.nrrd", nrrd("type: short\n" + shape + "encoding: text\n", "0 1 2\n3, 4 5\n6 7\n"));
  check("hex.nrrd", nrrd("type: unsigned char\n" + shape + "encoding: hex\n", "00010203 0405\n0607\n"));
  check("crlf.nrrd", "NRRD0004\r\ntype: uint8\r\ndimension: 3\r\nsizes: 2 2 2\r\nencoding: raw\r\n\r\n" + kEight);
  check("big.nrrd", nrrd("type: ushort\n" + shape + "endian: big\nencoding: raw\n",
                         std::string("\0\0\0\1\0\2\0\3\0\4\0\5\0\6\0\7", 16)));
  check("list.nrrd", nrrd("type: uint8\ndimension: 4\nsizes: 1 2 2 2\nkinds: list domain domain domain\nspace: "
                          "LPS\nspace directions: none (1,0,0) (0,1,0) (0,0,1)\nencoding: raw\n",
                          kEight));

  folder.write("voxels.raw", "two\nlines\n###" + kEight);
  check("skip.nhdr", nrrd(kCube + "data file: voxels.raw\nline skip: 2\nbyte skip: 3\n", ""));
  check("last.nhdr", "NRRD0004\n" + kCube + "data file: voxels.raw\nbyte skip: -1");
  folder.write("slice1.raw", kEight.substr(0, 4));
  folder.write("slice2.raw", kEight.substr(4));
  check("pattern.nhdr", nrrd(kCube + "data file: slice%d.raw 1 2 1\n", ""));
  check("files.nhdr", "NRRD0004\n" + kCube + "data file: LIST\nslice1.raw\nslice2.raw\n");
}

TEST_CASE("volume io: the space, spacings and axis ranges of NRRD lead to the right place in LPS") {
  const TemporaryFolder folder;
  const auto grid = [&](const std::string& fields) {
    return read_volume(folder.write("a.nrrd", nrrd("type: uint8\nencoding: raw\n" + fields, kEight))).volume.grid;
  };
  const Grid ras = grid(
      "dimension: 3\nsizes: 2 2 2\nspace: right-anterior-superior\nspace directions: (2,0,0) (0,3,0) (0,0,4)\nspace "
      "origin: (10,20,30)\n");
  CHECK(ras.spacing == glm::dvec3(2, 3, 4));
  CHECK(ras.origin == glm::dvec3(-10, -20, 30));
  CHECK(ras.direction == glm::dmat3(-1, 0, 0, 0, -1, 0, 0, 0, 1));
  const Grid las = grid(
      "dimension: 3\nsizes: 2 2 2\nspace: LAS\nspace directions: (2,0,0) (0,3,0) (0,0,4)\nspace origin: (10,20,30)\n");
  CHECK(las.origin == glm::dvec3(10, -20, 30));
  const Grid spaced =
      grid("dimension: 3\nsizes: 2 2 2\nspacings: 0.5 3 20\naxis mins: 1 2 3\ncenters: node cell cell\n");
  CHECK(spaced.spacing == glm::dvec3(0.5, 3, 20));
  CHECK(spaced.origin == glm::dvec3(1, 3.5, 13));
  const Grid plane =
      grid("dimension: 2\nsizes: 4 2\nspace: LPS\nspace directions: (0,2,0) (0,0,2)\nspace origin: (1,2,3)\n");
  CHECK(plane.size == glm::ivec3(4, 2, 1));
  CHECK(plane.direction[2] == glm::dvec3(1, 0, 0));
}

TEST_CASE(
    "volume io: MetaImage data may be text, big-endian, detached, compressed, in slices, or have a wrong compressed "
    "size") {
  const TemporaryFolder folder;
  const ZeroedVector<Label> expected = {0, 1, 2, 3, 4, 5, 6, 7};
  const auto read = [&](const std::string& name, const std::string& bytes) {
    VolumeFile file = read_volume(folder.write(name, bytes));
    CAPTURE(name);
    CHECK(file.volume.voxels == expected);
    return file.warnings;
  };
  CHECK(read("text.mha", meta("BinaryData = False\n" + kMetaCube, "0 1 2 3 4 5 6 7\n")).empty());
  CHECK(read("big.mha", meta("BinaryDataByteOrderMSB = True\nDimSize = 2 2 2\nElementType = MET_USHORT\n",
                             std::string("\0\0\0\1\0\2\0\3\0\4\0\5\0\6\0\7", 16)))
            .empty());
  const std::string zlib = packed(kEight, 15);
  CHECK(
      read("right.mha",
           meta("CompressedData = True\nCompressedDataSize = " + std::to_string(zlib.size()) + "\n" + kMetaCube, zlib))
          .empty());
  CHECK(read("wrong.mha", meta("CompressedData = True\nCompressedDataSize = 5\n" + kMetaCube, zlib)).size() == 1);
  CHECK(read("longer.mha", meta(kMetaCube, kEight + "more")).size() == 1);
  folder.write("h.raw", "HEAD" + kEight);
  CHECK(read("h.mhd", "NDims = 3\n" + kMetaCube + "HeaderSize = 4\nElementDataFile = h.raw\n").empty());
  CHECK(read("end.mhd", "NDims = 3\n" + kMetaCube + "HeaderSize = -1\nElementDataFile = h.raw\n").empty());
  folder.write("s1.raw", kEight.substr(0, 4));
  folder.write("s2.raw", kEight.substr(4));
  CHECK(read("list.mhd", "NDims = 3\n" + kMetaCube + "ElementDataFile = LIST\ns1.raw\ns2.raw\n").empty());
  CHECK(read("pattern.mhd", "NDims = 3\n" + kMetaCube + "ElementDataFile = s%d.raw 1 2 1\n").empty());
}

TEST_CASE("volume io: NIfTI places voxels by sform, else qform, else voxel size, in mm and LPS, and scales labels") {
  const TemporaryFolder folder;
  const Grid wanted{{2, 2, 2}, {1, 2, 3}, {4, 5, 6}, kMirroredTurn};
  for (int version : {1, 2}) {
    CAPTURE(version);
    const std::size_t qform = version == 1 ? 252 : 344, sform = qform + (version == 1 ? 2 : 4),
                      srow = version == 1 ? 280 : 400;
    const std::string whole = nifti(version);
    const auto read = [&](const std::string& bytes) { return read_volume(folder.write("a.nii", bytes)); };
    CHECK(read(whole).volume.grid == wanted);

    const VolumeFile by_qform = read(patched<std::int16_t>(whole, sform, 0));
    for (int i = 0; i < 3; ++i) CHECK(glm::length(by_qform.volume.grid.direction[i] - wanted.direction[i]) < 1e-6);
    CHECK(by_qform.volume.grid.origin == wanted.origin);
    CHECK(by_qform.warnings.empty());

    std::string singular = whole;
    std::fill_n(singular.begin() + static_cast<std::ptrdiff_t>(srow), version == 1 ? 48 : 96, '\0');
    CHECK(read(singular).warnings.size() == 1);
    CHECK(read(singular).volume.grid.origin == wanted.origin);
    refused_for(folder.write("b.nii", patched<std::int16_t>(singular, qform, 0)), "sform is singular");

    const Grid plain = read(patched<std::int16_t>(patched<std::int16_t>(whole, sform, 0), qform, 0)).volume.grid;
    CHECK(plain.spacing == wanted.spacing);
    CHECK(plain.direction == glm::dmat3(-1, 0, 0, 0, -1, 0, 0, 0, 1));
  }
  const std::string half = patched<float>(patched<float>(nifti(), 112, 0.5f), 116, 10.0f);
  refused_for(folder.write("c.nii", half), "not a whole number");
  const VolumeFile doubled = read_volume(folder.write("d.nii", patched<float>(nifti(), 112, 2.0f)));
  CHECK(doubled.volume.voxels == ZeroedVector<Label>{0, 2, 4, 6, 8, 10, 12, 14});
  CHECK(read_volume(folder.write("e.nii.gz", packed(nifti(), 31))).volume.grid == wanted);
  CHECK(read_volume(folder.write("f.nii", patched<float>(nifti(), 108, 0.0f))).warnings.size() == 1);
}

TEST_CASE("volume io: bad files are refused with one line, whatever their format") {
  const TemporaryFolder folder;
  const auto nan = std::numeric_limits<float>::quiet_NaN();
  int number = 0;
  const auto refuse = [&](const std::string& extension, const std::string& bytes, const std::string& reason) {
    refused_for(folder.write("bad" + std::to_string(number++) + extension, bytes), reason);
  };
  // Tests data that are missing, damaged, or too short.
  refuse(".nrrd", nrrd(kCube, kEight.substr(1)), "promises 8 bytes");
  refuse(".nrrd", nrrd("type: uint8\ndimension: 3\nsizes: 2 2 2\nencoding: gzip\n", packed(kEight, 31).substr(0, 12)),
         "data end after");
  refuse(".nrrd",
         nrrd("type: uint8\ndimension: 3\nsizes: 2 2 2\nencoding: gzip\n",
              packed(kEight, 31).substr(0, packed(kEight, 31).size() - 4)),
         "checksum");
  refuse(".nrrd", nrrd("type: uint8\ndimension: 3\nsizes: 2 2 2\nencoding: gzip\n", packed(kEight.substr(1), 31)),
         "data end after");
  std::string damaged = packed(std::string(4000, 'x') + kEight, 15);
  damaged[damaged.size() - 2] = static_cast<char>(damaged[damaged.size() - 2] ^ 0x55);
  refuse(".mha", meta("CompressedData = True\nDimSize = 2 2 1002\nElementType = MET_UCHAR\n", damaged), "damaged");
  refuse(".nrrd", nrrd("type: uint8\ndimension: 3\nsizes: 2 2 2\nencoding: hex\n", "0001020304050"), "");
  refuse(".nrrd", nrrd("type: uint8\ndimension: 3\nsizes: 2 2 2\nencoding: ascii\n", "0 1 2 3 4 5 6 300"),
         "does not fit");
  refuse(".nii", nifti().substr(0, 352), "promises 8 bytes");
  refuse(".nii", nifti().substr(0, 300), "not a NIfTI");
  // Tests impossible sizes, spacings and directions.
  refuse(".mha", meta("DimSize = 0 2 2\nElementType = MET_UCHAR\n", kEight), "at least one voxel");
  refuse(".mha", meta("DimSize = 2000000000 2000000000 2000000000\nElementType = MET_UCHAR\n", kEight), "too large");
  refuse(".mha", meta("CompressedData = True\nDimSize = 4000 4000 4000\nElementType = MET_UCHAR\n", packed(kEight, 15)),
         "too few");
  refuse(".mha", meta("ElementSpacing = 1 -1 1\n" + kMetaCube, kEight), "spacing");
  refuse(".mha", meta("ElementSpacing = 1 nan 1\n" + kMetaCube, kEight), "spacing");
  refuse(".mha", meta("TransformMatrix = 1 0 0 1 0 0 0 0 1\n" + kMetaCube, kEight), "inverted");
  refuse(".mha", meta("Offset = 1 inf 1\n" + kMetaCube, kEight), "origin");
  refuse(".nrrd", nrrd(kCube + "space: LPS\nspace directions: (nan,0,0) (0,1,0) (0,0,1)\n", kEight), "spacing");
  refuse(".nrrd", nrrd(kCube + "space: LPS\nspace directions: (1,0,0) (1,0,0) (0,0,1)\n", kEight), "inverted");
  refuse(".nrrd", nrrd("type: uint8\ndimension: 3\nsizes: 2 2\nencoding: raw\n", kEight), "sizes");
  refuse(".nii", patched<float>(nifti(), 80, -1.0f), "pixdim");
  refuse(".nii", patched<float>(nifti(), 84, nan), "pixdim");
  // Tests files of several volumes, colours and other unsupported content.
  refuse(".mha", "NDims = 4\nDimSize = 2 2 1 2\nElementType = MET_UCHAR\nElementDataFile = LOCAL\n" + kEight, "4-D");
  refuse(".mha", meta("ElementNumberOfChannels = 2\nDimSize = 2 2 1\nElementType = MET_UCHAR\n", kEight), "channels");
  refuse(".mha", meta("ElementType = MET_UCHAR\n", kEight), "DimSize");
  refuse(
      ".nrrd",
      nrrd("type: uint8\ndimension: 4\nsizes: 2 2 2 1\nkinds: RGB-color domain domain domain\nencoding: raw\n", kEight),
      "values per voxel");
  refuse(".nrrd",
         nrrd("type: uint8\ndimension: 4\nsizes: 2 1 2 2\nkinds: list domain domain domain\nencoding: raw\n", kEight),
         "overlapping segments");
  refuse(".nii", patched<std::int16_t>(patched<std::int16_t>(nifti(), 40, 4), 48, 2), "4-D");
  refuse(".nii", patched<std::int16_t>(nifti(), 70, 128), "colours");
  refuse(
      ".nrrd",
      nrrd("type: float\ndimension: 3\nsizes: 1 1 1\nendian: little\nencoding: raw\n", patched<float>("....", 0, 1.5f)),
      "not a whole number");
  refuse(
      ".nrrd",
      nrrd("type: float\ndimension: 3\nsizes: 1 1 1\nendian: little\nencoding: raw\n", patched<float>("....", 0, nan)),
      "not a whole number");
  refuse(".nrrd", nrrd(kCube + "limber_bones:=[]\n", kEight), "weights");
  refuse(".nrrd", "version https://git-lfs.github.com/spec/v1\noid sha256:00\nsize 12\n", "not an NRRD");
  refuse(".xyz", "hello", "not a volume");
}

TEST_CASE("volume io: more than 65 535 distinct labels are refused, 65 535 are read" * doctest::test_suite("slow")) {
  const TemporaryFolder folder;
  const auto with = [&](std::uint32_t first, std::uint32_t count) {
    std::string data;
    for (std::uint32_t i = 0; i < count; ++i) {
      const std::uint32_t value = first + i;
      data.append(reinterpret_cast<const char*>(&value), 4);
    }
    return folder.write("many.nrrd", nrrd("type: uint32\ndimension: 3\nsizes: " + std::to_string(count) +
                                              " 1 1\nendian: little\nencoding: raw\n",
                                          data));
  };
  CHECK(read_volume(with(1000, 65535)).tissues.tissues.size() == 65535);
  refused_for(with(1000, 65536), "65 535");
}

TEST_CASE("volume io: data files outside the header's folder are not opened, by no path, link or device") {
  const TemporaryFolder folder;
  fs::create_directories(folder.path / "in" / "deeper");
  folder.write("secret.raw", kEight);
  folder.write("in/deeper/voxels.raw", kEight);
  const auto named = [&](const std::string& name) {
    return folder.write("in/a.mhd", "NDims = 3\n" + kMetaCube + "ElementDataFile = " + name + "\n");
  };
  CHECK(read_volume(named("deeper/voxels.raw")).volume.voxels.size() == 8);
  refused_for(named("../secret.raw"), "outside");
  refused_for(named("deeper/../../secret.raw"), "outside");
  refused_for(named((folder.path / "secret.raw").string()), "outside");
  refused_for(named("/dev/zero"), "outside");
  fs::create_symlink(folder.path / "secret.raw", folder.path / "in" / "link.raw");
  refused_for(named("link.raw"), "outside");
  fs::create_directory_symlink(folder.path, folder.path / "in" / "up");
  refused_for(named("up/secret.raw"), "outside");
  refused_for(named("deeper"), "not a plain file");
  refused_for(folder.write("in/a.nhdr", "NRRD0004\n" + kCube + "data file: ../secret.raw\n"), "outside");
  refused_for(folder.path / "in" / "deeper", "no DICOM");
}

TEST_CASE("volume io: every volume of the expectations is read, warned of or refused as they say") {
  NEEDS_SHARED("data/EXPECT.tsv");
  std::ifstream table(test::shared_path("data/EXPECT.tsv"));
  int volumes = 0;
  for (std::string line; std::getline(table, line);) {
    std::istringstream columns(line);
    std::string name, expected;
    if (line.empty() || line[0] == '#' || !std::getline(columns, name, '\t') || !std::getline(columns, expected, '\t'))
      continue;
    const Path path = test::shared_path("data") / name;
    if (!is_volume_path(path)) continue;
    ++volumes;
    std::string got;
    try {
      const auto warnings = summarize_volume(path).warnings;
      CHECK(warnings.size() <= 1);
      got = warnings.empty() ? "ok" : "warn";
    } catch (const Error& error) {
      CHECK(std::string(error.what()).find('\n') == std::string::npos);
      got = "refuse";
    }
    INFO(name, ": ", got, ", expected ", expected);
    CHECK(("|" + expected + "|").find("|" + got + "|") != std::string::npos);
  }
  CHECK(volumes >= 30);
}

TEST_CASE("volume io: Bender's arm is read with its mirrored z axis and its twelve tissues") {
  NEEDS_SHARED("data/bender/man-arm-2mm.mha");
  const VolumeFile file = read_volume(test::shared_path("data/bender/man-arm-2mm.mha"));
  CHECK(file.volume.grid.size == glm::ivec3(128, 170, 335));
  CHECK(file.volume.grid.origin == glm::dvec3(-127, -169, 334));
  CHECK(file.volume.grid.direction[2] == glm::dvec3(0, 0, -1));
  CHECK(std::count(file.volume.voxels.begin(), file.volume.voxels.end(), 17) == 346446);
  const TissueTable tissues = merge_tissue_tables(file.tissues, nullptr);
  CHECK(tissues.tissues.size() == 14);
  CHECK(tissues.find(111)->kind == TissueKind::CorticalBone);
  CHECK(file.warnings.empty());
}

TEST_CASE("volume io: a DICOM series and the labels made from it lie at the same place" * doctest::test_suite("slow")) {
  NEEDS_SHARED("data/torso/dicom_ct");
  const GreyVolume series = read_grey_volume(test::shared_path("data/torso/dicom_ct"));
  const Grid labels = read_volume(test::shared_path("data/torso/ts_seg_of_dicom.nii.gz")).volume.grid;
  CHECK(series.grid.size == labels.size);
  CHECK(glm::length(series.grid.spacing - labels.spacing) < 1e-5);
  // The rows of the labels run in the opposite order, so the last row of the labels lies where the first row of the
  // series lies.
  const glm::dvec3 corner = world_from_voxel(labels) * glm::dvec3(0, labels.size.y - 1, 0);
  CHECK(glm::length(corner - series.grid.origin) < 1e-3);
  CHECK(*std::min_element(series.voxels.begin(), series.voxels.end()) == -1024);
}
