// SPDX-License-Identifier: AGPL-3.0-or-later
// Reads small files that ask for much memory, and numbers that no image or rig can have. Each file must be refused with
// one line of error, without using much memory.
#include <algorithm>
#include <cstring>
#include <limits>

#include <doctest/doctest.h>
#include <zlib.h>

#include "core/base/error.h"
#include "core/base/file.h"
#include "core/volume_io/volume_header.h"
#include "tests/support/dicom_image.h"
#include "tests/support/program.h"
#include "tests/support/sanitizer.h"

using namespace limber;
using namespace limber::test;

namespace {

// A gzip stream of `megabytes` zeros.
std::string packed_zeros(int megabytes) {
  const std::string block(1 << 20, '\0');
  std::string packed(static_cast<std::size_t>(megabytes) * 1200 + 1000, '\0');
  z_stream stream{};
  REQUIRE(deflateInit2(&stream, 9, Z_DEFLATED, 31, 9, Z_DEFAULT_STRATEGY) == Z_OK);
  stream.next_out = reinterpret_cast<Bytef*>(packed.data());
  stream.avail_out = static_cast<uInt>(packed.size());
  for (int i = 0; i < megabytes; ++i) {
    stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(block.data()));
    stream.avail_in = static_cast<uInt>(block.size());
    deflate(&stream, i + 1 < megabytes ? Z_NO_FLUSH : Z_FINISH);
  }
  packed.resize(stream.total_out);
  deflateEnd(&stream);
  return packed;
}

ProgramRun info(const TemporaryFolder& folder, const std::string& name, const std::string& bytes) {
  write_file_atomically(folder / name, bytes);
  return run_limber({"info", folder / name});
}

void check_refused(const ProgramRun& run) {
  CAPTURE(run.err);
  CHECK(run.exit_code == 1);
  CHECK(std::count(run.err.begin(), run.err.end(), '\n') == 1);
#ifndef LIMBER_ADDRESS_SANITIZER  // the sanitizer's reader has no memory limit
  CHECK(run.peak_mb < 150);
#endif
  CHECK(run.cpu_seconds < 5);
}

}  // namespace

TEST_CASE("hostile headers: a DICOM element that claims four gigabytes gets no memory" * doctest::test_suite("slow")) {
  const TemporaryFolder folder;
  const std::string claim = little_endian(9, 2) + little_endian(0x1001, 2) + "UN" + little_endian(0, 2);
  for (const std::uint32_t length : {0xfffffff0u, 0x7ffffff0u, 0x20000000u})
    check_refused(info(folder, "image.dcm", dicom_start() + claim + little_endian(length, 4) + "a few bytes"));
  // Makes a file of one megabyte that claims to hold an image of 65535 x 65535 pixels.
  std::string large = dicom_image("1");
  for (const std::uint16_t side : {0x10, 0x11}) {
    const std::string name = little_endian(0x28, 2) + little_endian(side, 2) + "US" + little_endian(2, 2);
    large.replace(large.find(name) + name.size(), 2, little_endian(65535, 2));
  }
  check_refused(info(folder, "image.dcm", large + std::string(1 << 20, '\0')));
  const ProgramRun whole = info(folder, "image.dcm", dicom_image("1"));
  CHECK_MESSAGE(whole.exit_code == 0, whole.err);
}

TEST_CASE(
    "hostile headers: packed zeros are unpacked as far as the header promises, and a promise beyond the file is "
    "refused at once" *
    doctest::test_suite("slow")) {
  const TemporaryFolder folder;
  const std::string bomb = packed_zeros(600);
  const std::string nrrd = "NRRD0004\ntype: uint8\ndimension: 3\nencoding: gzip\nsizes: ";
  const ProgramRun small = info(folder, "small.nrrd", nrrd + "8 8 8\n\n" + bomb);
  CAPTURE(small.err);
  CHECK(small.exit_code == 0);
  CHECK(small.err.find("more data than the header promises") != std::string::npos);
  CHECK(small.peak_mb < 150);
  check_refused(info(folder, "large.nrrd", nrrd + "40000 40000 1000\n\n" + packed_zeros(1)));
  const std::string meta =
      "ObjectType = Image\nNDims = 3\nCompressedData = True\nElementType = MET_UCHAR\nElementSpacing = 1 1 1\n";
  check_refused(
      info(folder, "large.mha", meta + "DimSize = 40000 40000 1000\nElementDataFile = LOCAL\n" + packed_zeros(1)));
}

TEST_CASE("hostile headers: scales that are no finite number, or beyond what an image has, are refused" *
          doctest::test_suite("slow")) {
  const TemporaryFolder folder;
  for (const char* slope : {"nan", "inf", "1e300", "-1e300", "1e-300"}) {
    CAPTURE(slope);
    const ProgramRun run = info(folder, "image.dcm", dicom_image(slope));
    check_refused(run);
    CHECK(run.err.find("scaled") != std::string::npos);
  }
  check_refused(info(folder, "image.dcm", dicom_image("1", "1e300\\1e300")));
  check_refused(info(folder, "image.dcm", dicom_image("1", "nan\\1")));
  const double nan = std::numeric_limits<double>::quiet_NaN(), infinite = std::numeric_limits<double>::infinity();
  for (const auto& [slope, intercept] :
       {std::pair{nan, 0.0}, {infinite, 0.0}, {1.0, nan}, {1.0, -infinite}, {1e300, 0.0}, {1.0, 1e300}, {0.0, 0.0}})
    CHECK_THROWS_AS(check_scale(slope, intercept, "image"), Error);
  CHECK_NOTHROW(check_scale(-2.5e-6, -1024, "image"));
}

TEST_CASE("hostile headers: a bone beyond any body, and numbers on the command line that are none, are refused" *
          doctest::test_suite("slow")) {
  const TemporaryFolder folder;
  for (const char* far : {"1e308", "-1e12", "1e999"}) {
    const ProgramRun run =
        info(folder, "rig.json",
             R"({"space":"LPS","unit":"mm","bones":[{"name":"a","parent":null,"head":[0,0,0],"tail":[0,0,)" +
                 std::string(far) + "]}]}");
    check_refused(run);
  }
  write_file_atomically(
      folder / "rig.json",
      R"({"space":"LPS","unit":"mm","bones":[{"name":"a","parent":null,"head":[0,0,0],"tail":[0,0,9]}]})");
  for (const char* pose :
       {R"({"bones":{},"root_translation":[1e308,0,0]})", R"({"bones":{"a":{"axis":[0,0,1],"degrees":1e308}}})",
        R"({"bones":{"a":{"rotation_wxyz":[1e308,1,0,0]}}})"}) {
    write_file_atomically(folder / "pose.json", std::string(pose));
    check_refused(run_limber({"fk", folder / "rig.json", "--pose", folder / "pose.json"}));
  }
  for (const char* number : {"nan", "-nan", "inf", "1e999"})
    for (const auto& words : {std::vector<std::string>{"prepare", "in.nrrd", "-o", "out.nrrd", "--spacing", number},
                              {"phantom", "arm", "-o", "arm", "--spacing", number},
                              {"tissues", "--frequency", number}}) {
      CAPTURE(words[0]);
      const ProgramRun run = run_limber(words);
      CAPTURE(run.err);
      CHECK(run.exit_code == 2);
      CHECK(run.err.starts_with("limber: this is not a finite number: "));
    }
}
