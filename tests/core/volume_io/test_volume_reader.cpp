// SPDX-License-Identifier: AGPL-3.0-or-later
// Tests that volumes are parsed in a process without rights: the results are the same bytes as without that process,
// and a malicious parser can do no harm.
#include "core/volume_io/volume_reader.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <fstream>
#include <functional>
#include <string>
#include <thread>
#include <vector>

#include <doctest/doctest.h>

#include "core/base/error.h"
#include "core/platform/module.h"
#include "core/volume_io/reader_messages.h"
#include "core/volume_io/vector_volume_io.h"
#include "core/volume_io/volume_io.h"
#include "tests/support/dicom_image.h"
#include "tests/support/program.h"
#include "tests/support/sanitizer.h"
#include "tests/support/shared_data.h"

using namespace limber;
using namespace limber::test;
namespace fs = std::filesystem;

namespace {

// Returns all that a volume's parser delivers as one string: header, voxels and the data after them, or its error.
std::string told(const std::function<OpenedVolume()>& open) {
  try {
    OpenedVolume opened = open();
    std::string all = bytes_of(opened.header);
    if (!opened.voxels) return all;
    std::string voxels(static_cast<std::size_t>(opened.header.grid.voxel_count() * size_of(opened.header.voxel_type)),
                       '\0');
    // Reads in pieces of growing size, which do not match the reader's messages.
    for (std::size_t done = 0, piece = 1; done < voxels.size(); done += piece) {
      piece = std::min(voxels.size() - done, piece * 3 % 100'003 + 1);
      opened.voxels->read(voxels.data() + done, piece);
    }
    return all + voxels + bytes_of(opened.voxels->finish());
  } catch (const Error& error) {
    return std::string("error: ") + error.what();
  }
}

std::string told_here(const Path& path, Holding holding = Holding::Volume) {
  return told([&] { return open_volume_here(std::make_shared<LocalFiles>(locate_volume(path)), holding); });
}
std::string told_by_reader(const Path& path, Holding holding = Holding::Volume) {
  const auto program = find_own_program(kReaderName);
  REQUIRE(program);
  return told([&] { return open_in_reader(locate_volume(path), holding, no_progress(), {.program = *program}); });
}

void check_same(const Path& path, Holding holding = Holding::Volume) {
  CAPTURE(path.string());
  const std::string here = told_here(path, holding);
  CHECK_FALSE(here.empty());
  CHECK((told_by_reader(path, holding) == here));
}

LabelVolume small_volume() {
  LabelVolume volume{{{37, 29, 23}, {0.5, 3, 20}, {-7, 11, 0.125}, glm::dmat3(0, 1, 0, -1, 0, 0, 0, 0, -1)}, {}};
  volume.voxels.resize(static_cast<std::size_t>(volume.grid.voxel_count()));
  for (std::size_t i = 0; i < volume.voxels.size(); ++i)
    volume.voxels[i] = static_cast<Label>(i * 7 % 11 * (i % 5 == 0));
  return volume;
}

void write(const Path& path, const std::string& bytes) { std::ofstream(path, std::ios::binary) << bytes; }

const std::string kNrrd = "NRRD0005\ntype: uint8\ndimension: 3\nsizes: 2 2 2\nencoding: raw\n";

// Writes a volume on which the bad reader misbehaves in the given way.
Path bad_volume(const TemporaryFolder& folder, const std::string& what) {
  fs::create_directories(folder / "inner");
  const Path path = folder / "inner" / "bad.nrrd";
  write(path, kNrrd + "# misbehave:" + what + "\n\n12345678");
  return path;
}

struct Limits {
  double busy_seconds = 20, silent_seconds = 120;
};

// Opens a volume with a reader that misbehaves as `what` says. Returns the error; empty if the volume is read all the
// same.
std::string outcome(const std::string& what, const Limits& limits = {}) {
  const TemporaryFolder folder;
  write(folder / "other.raw", "12345678");
  const Path path = bad_volume(folder, what);
  write(path.parent_path() / "victim", "");
  const ReaderSettings settings{LIMBER_BAD_READER, 64 << 20, limits.busy_seconds, limits.silent_seconds};
  const std::string all =
      told([&] { return open_in_reader(locate_volume(path), Holding::Volume, no_progress(), settings); });
  CHECK(fs::exists(path.parent_path() / "victim"));
  CHECK_FALSE(fs::exists(path.parent_path() / "made"));
  if (!all.starts_with("error: ")) return "";
  CHECK(all.find('\n') == std::string::npos);
  return all;
}

}  // namespace

TEST_CASE(
    "volume reader: what it says of a file is what the parsers say in this process, byte for byte, in every format" *
    doctest::test_suite("slow")) {
  const TemporaryFolder folder;
  const LabelVolume volume = small_volume();
  const std::pair<const char*, const char*> formats[] = {
      {"a.nrrd", "NRRD"},      {"a.seg.nrrd", "NRRD"}, {"a.nhdr", "NRRD"},
      {"a.mha", "MetaImage"},  {"a.mhd", "MetaImage"}, {"a.nii", "NIfTI-1"},
      {"a.nii.gz", "NIfTI-1"}, {"b.nii", "NIfTI-2"},   {"a.hdr", "NIfTI-1"}};
  for (const auto& [name, format] : formats)
    for (const char* type : {"uint8", "int16", "float64"})
      for (bool compressed : {false, true}) {
        write_volume(volume, folder / name, {}, {format, type, compressed});
        check_same(folder / name);
        check_same(folder / name, Holding::Header);
      }
  write_volume(volume, folder / "model.txt", {}, {"Virtual Family", "uint8", false});
  check_same(folder / "model.raw");
  write(folder / "text.nrrd",
        "NRRD0005\ntype: int16\ndimension: 3\nsizes: 2 2 2\nencoding: ascii\nkey:=value\n\n1 2 3 4 5 6 7 8 9\n");
  check_same(folder / "text.nrrd");
  const std::vector<glm::vec3> shifts(static_cast<std::size_t>(volume.grid.voxel_count()), glm::vec3(1, 2, 3));
  write_displacement_field(volume.grid, shifts, FieldDirection::ToPosed, folder / "field.nrrd");
  check_same(folder / "field.nrrd", Holding::Vectors);
  CHECK(read_vector_volume(folder / "field.nrrd").voxels[77] == glm::vec3(1, 2, 3));

  fs::create_directory(folder / "series");
  for (int i = 0; i < 5; ++i)
    write(folder / "series" / std::to_string(i), dicom_image(i < 3 ? "1" : "2", "1\\1", std::to_string(3 - i)));
  check_same(folder / "series");
  check_same(folder / "series" / "0");
}

TEST_CASE("volume reader: what the parsers refuse it refuses with the same words") {
  const TemporaryFolder folder;
  write(folder / "short.nrrd", kNrrd + "\n1234");
  write(folder / "outside.nhdr", kNrrd + "data file: ../../other.raw\n");
  write(folder / "missing.nhdr", kNrrd + "data file: no.raw\n");
  write(folder / "empty.mha", "");
  write(folder / "gone.nii.gz", std::string("\x1f\x8b\x08\0\0\0\0\0\0\3", 10));
  write(folder / "image.dcm", dicom_image("nan"));
  for (const char* name : {"short.nrrd", "outside.nhdr", "missing.nhdr", "empty.mha", "gone.nii.gz", "image.dcm"}) {
    const std::string here = told_here(folder / name);
    CHECK(here.starts_with("error: "));
    CHECK(told_by_reader(folder / name) == here);
  }
}

TEST_CASE("volume reader: shared volumes are the same by both ways" * doctest::test_suite("slow")) {
  NEEDS_SHARED("data/edge");
  for (const auto& entry : fs::directory_iterator(shared_path("data/edge")))
    if (is_volume_path(entry.path())) check_same(entry.path());
  check_same(shared_path("data/bender/man-arm-2mm.mha"));
  check_same(shared_path("data/torso/dicom_ct"));
}

TEST_CASE("volume reader: one that crashes, leaves or says what it must not is one error, and nothing else happens") {
  for (const char* what : {"crash", "abort", "late crash"})
    CHECK(outcome(what).find("the file's reader crashed") != std::string::npos);
  CHECK(outcome("leave").find("the file's reader failed (exit code 7)") != std::string::npos);
  for (const char* what : {"long message",   "unknown message",     "no header",      "wrong index",   "negative grid",
                           "huge grid",      "no spacing",          "unknown type",   "unknown kind",  "early end",
                           "other file",     "plain beyond",        "plain overflow", "plain before",  "plain long",
                           "plain negative", "plain most negative", "sparse short",   "sparse none",   "sparse few",
                           "sparse beyond",  "sparse long",         "sparse after",   "sparse promise"}) {
    CAPTURE(what);
    CHECK(outcome(what) != "");
  }
  CHECK(outcome("other file").find("lies outside the header's folder") != std::string::npos);
  CHECK(outcome("nothing bad") == "");
  CHECK(outcome("sparse right") == "");
}

TEST_CASE(
    "volume reader: one that lacks a library is not blamed on the file, and libraries are sought where they were") {
  const TemporaryFolder folder;
  const Path path = bad_volume(folder, "nothing bad"), program = folder / "reader";
  const auto said = [&](const std::string& script) {
    write(program, "#!/bin/sh\n" + script);
    fs::permissions(program, fs::perms::owner_all);
    const ReaderSettings settings{program};
    return told([&] { return open_in_reader(locate_volume(path), Holding::Volume, no_progress(), settings); });
  };
  CHECK(said("exit 127").find("the reader of volumes cannot be started: " + program.string()) != std::string::npos);
  const char* before = std::getenv("LD_LIBRARY_PATH");
  const std::string kept = before ? before : "";
  ::setenv("LD_LIBRARY_PATH", "/libraries/of/limber", 1);
  CHECK(said("[ \"$LD_LIBRARY_PATH\" = /libraries/of/limber ] && exit 9").find("exit code 9") != std::string::npos);
  before ? ::setenv("LD_LIBRARY_PATH", kept.c_str(), 1) : ::unsetenv("LD_LIBRARY_PATH");
}

TEST_CASE("volume reader: one that spins, waits or takes memory is ended" * doctest::test_suite("slow")) {
  CHECK(outcome("spin", {.busy_seconds = 0.3}).find("made no progress") != std::string::npos);
  CHECK(outcome("silence", {.silent_seconds = 0.3}).find("has not answered") != std::string::npos);
#ifndef LIMBER_ADDRESS_SANITIZER
  CHECK(outcome("memory").find("exceeded its memory limit") != std::string::npos);
#endif
}

TEST_CASE("volume reader: it can open, make and remove no file, reach no network, start and touch no process") {
  const Protection protection = reader_protection();
  CHECK(protection.own_process);
  if (!protection.system_calls) {
    MESSAGE("SKIPPED: this kernel filters no system calls");
    return;
  }
  CHECK(outcome("rights").find("rights: end") != std::string::npos);
}

TEST_CASE("volume reader: a cancel ends it at once, whatever it does") {
  const TemporaryFolder folder;
  const Path path = bad_volume(folder, "spin");
  class Quiet final : public Progress {
  } progress;
  std::chrono::steady_clock::time_point asked;
  const std::jthread user([&] {
    std::this_thread::sleep_for(std::chrono::milliseconds(200));
    asked = std::chrono::steady_clock::now();
    progress.cancel();
  });
  CHECK_THROWS_AS(open_in_reader(locate_volume(path), Holding::Volume, progress, {.program = LIMBER_BAD_READER}),
                  Cancelled);
  CHECK(std::chrono::steady_clock::now() - asked < std::chrono::milliseconds(1000));
}

TEST_CASE("volume reader: many threads read at once") {
  const TemporaryFolder folder;
  write_volume(small_volume(), folder / "a.nii.gz", {}, {"NIfTI-1", "uint8", true});
  const std::string here = told_here(folder / "a.nii.gz");
  std::array<std::string, 6> read;
  {
    std::vector<std::jthread> threads;
    for (std::string& text : read) threads.emplace_back([&] { text = told_by_reader(folder / "a.nii.gz"); });
  }
  for (const std::string& text : read) CHECK((text == here));
}

TEST_CASE(
    "volume reader: the program says in one line what a file did to its reader, and `info` says what protects from "
    "it") {
  const TemporaryFolder folder;
  fs::copy_file(LIMBER_PROGRAM, folder / "limber");
  fs::copy_file(LIMBER_BAD_READER, folder / "limber_reader");
  const Path path = bad_volume(folder, "crash");
  const ProgramRun crashed = run_program(folder / "limber", {"info", path.string()});
  CHECK(crashed.exit_code == 1);
  CHECK(crashed.err.starts_with("limber: the file's reader crashed"));
  CHECK(std::count(crashed.err.begin(), crashed.err.end(), '\n') == 1);

  const ProgramRun sound = run_limber({"info", path.string(), "--json"});
  CHECK(sound.exit_code == 0);
  CHECK(sound.out.find("\"own_process\": true") != std::string::npos);
  fs::remove(folder / "limber_reader");
  const ProgramRun without = run_program(folder / "limber", {"info", path.string(), "--json"});
  CHECK(without.exit_code == 0);
  CHECK(without.out.find("\"own_process\": false") != std::string::npos);
  write(folder / "image.dcm", dicom_image("1"));
  CHECK(run_program(folder / "limber", {"info", folder / "image.dcm"}).err.find("limber_reader is missing") !=
        std::string::npos);
}
