// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/base/file.h"

#include <csignal>
#include <fstream>

#include <doctest/doctest.h>
#include <sys/wait.h>
#include <unistd.h>

#include "core/base/error.h"
#include "tests/support/program.h"

using namespace limber;

namespace {
std::ptrdiff_t entries(const Path& folder) {
  return std::distance(std::filesystem::directory_iterator(folder), std::filesystem::directory_iterator());
}
}  // namespace

TEST_CASE("file: what is written atomically is read back, also over an older file") {
  const test::TemporaryFolder folder;
  write_file_atomically(folder / "a.bin", std::string("one\0two", 7));
  CHECK(read_file(folder / "a.bin") == std::string("one\0two", 7));
  write_file_atomically(folder / "a.bin", "three");
  CHECK(read_file(folder / "a.bin") == "three");
  CHECK(entries(folder.path()) == 1);
}

TEST_CASE("file: a writer that fails leaves the old file and nothing else") {
  const test::TemporaryFolder folder;
  write_file_atomically(folder / "a.bin", "old");
  CHECK_THROWS_AS(write_atomically(folder / "a.bin",
                                   [](const Path& path) {
                                     std::ofstream(path) << "half";
                                     throw Error("a", "b", "c");
                                   }),
                  Error);
  CHECK(read_file(folder / "a.bin") == "old");
  CHECK(entries(folder.path()) == 1);
}

TEST_CASE("file: a process killed while it writes leaves nothing behind") {
  const test::TemporaryFolder folder;
  const pid_t child = ::fork();
  if (child == 0) {
    write_atomically(folder / "a.bin", [](const Path& path) {
      std::ofstream(path) << std::string(100000, 'x') << std::flush;
      ::raise(SIGKILL);
    });
    ::_exit(0);
  }
  int status = 0;
  REQUIRE(::waitpid(child, &status, 0) == child);
  CHECK(WIFSIGNALED(status));
  CHECK(entries(folder.path()) == 0);
}

TEST_CASE("file: a missing folder, a folder in the file's place and a file over the limit are refused in one line") {
  const test::TemporaryFolder folder;
  CHECK_THROWS_AS(write_file_atomically(folder.path() / "no" / "a.bin", ""), Error);
  CHECK_THROWS_AS(write_file_atomically(folder.path(), ""), Error);
  write_file_atomically(folder / "a.bin", "12345");
  CHECK_THROWS_AS(read_file(folder / "a.bin", 4), Error);
  CHECK_THROWS_AS(read_file(folder.path()), Error);
}

TEST_CASE("file: SHA-256 agrees with the standard's own example") {
  CHECK(sha256_of_bytes("abc", 3) == "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  const test::TemporaryFolder folder;
  write_file_atomically(folder / "abc", "abc");
  CHECK(sha256_of_file(folder / "abc") == sha256_of_bytes("abc", 3));
}
