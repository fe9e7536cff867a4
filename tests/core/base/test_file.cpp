// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/base/file.h"

#include <csignal>
#include <fstream>

#include <doctest/doctest.h>
#include <sys/resource.h>
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

namespace {
std::filesystem::perms mode_of(const Path& path) { return std::filesystem::status(path).permissions(); }
}  // namespace

TEST_CASE(
    "file: a file that is replaced keeps its permissions, and what is on its way there cannot be read by others") {
  const test::TemporaryFolder folder;
  using std::filesystem::perms;
  for (const perms mode : {perms(0600), perms(0640), perms(0444), perms(0755)}) {
    write_file_atomically(folder / "a.bin", "old");
    std::filesystem::permissions(folder / "a.bin", mode);
    write_atomically(folder / "a.bin", [&](const Path& path) {
      CHECK((mode_of(path) & perms(0077)) == perms::none);
      std::ofstream(path) << "new";
    });
    CHECK(read_file(folder / "a.bin") == "new");
    CHECK(mode_of(folder / "a.bin") == mode);
  }
}

TEST_CASE("file: a write through links replaces the file that they name, there or not yet, and the links stay") {
  const test::TemporaryFolder folder;
  std::filesystem::create_directories(folder / "far");
  std::filesystem::create_symlink("far/b.bin", folder / "a.bin");
  std::filesystem::create_symlink(folder / "a.bin", folder / "c.bin");
  for (const char* text : {"first", "second"}) {
    write_file_atomically(folder / "c.bin", text);
    CHECK(std::filesystem::is_symlink(folder / "a.bin"));
    CHECK(std::filesystem::is_symlink(folder / "c.bin"));
    CHECK_FALSE(std::filesystem::is_symlink(folder / "far/b.bin"));
    CHECK(read_file(folder / "far/b.bin") == text);
  }
  CHECK(entries(folder.path()) == 3);
  CHECK(entries(folder / "far") == 1);
  std::filesystem::create_symlink("loop", folder / "loop");
  CHECK_THROWS_AS(write_file_atomically(folder / "loop", ""), Error);
  std::filesystem::create_symlink("none/x", folder / "nowhere");
  CHECK_THROWS_AS(write_file_atomically(folder / "nowhere", ""), Error);
  CHECK_THROWS_AS(write_file_atomically("/dev/null", ""), Error);
}

TEST_CASE("file: where there is no room the message names the file that was asked for") {
  const test::TemporaryFolder folder;
  ::signal(SIGXFSZ, SIG_IGN);
  rlimit old{};
  ::getrlimit(RLIMIT_FSIZE, &old);
  rlimit small = old;
  small.rlim_cur = 1000;
  for (const bool there : {false, true}) {
    if (there) write_file_atomically(folder / "a.bin", "old");
    ::setrlimit(RLIMIT_FSIZE, &small);
    std::string message;
    try {
      write_atomically(folder / "a.bin", [](const Path& path) {
        std::ofstream out(path);
        out << std::string(5000, 'x') << std::flush;
        if (!out) throw Error("the volume cannot be written", path.string(), "check permissions and free space");
      });
    } catch (const Error& error) {
      message = error.what();
    }
    ::setrlimit(RLIMIT_FSIZE, &old);
    CHECK(message ==
          "the volume cannot be written: " + (folder / "a.bin").string() + ": check permissions and free space");
  }
  CHECK(read_file(folder / "a.bin") == "old");
}

TEST_CASE("file: SHA-256 agrees with the standard's own example") {
  CHECK(sha256_of_bytes("abc", 3) == "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  const test::TemporaryFolder folder;
  write_file_atomically(folder / "abc", "abc");
  CHECK(sha256_of_file(folder / "abc") == sha256_of_bytes("abc", 3));
}
