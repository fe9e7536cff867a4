// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/platform/open_file.h"

#include <string>

#include <doctest/doctest.h>

#include "core/base/file.h"
#include "tests/support/program.h"

using namespace limber;

TEST_CASE("open file: a new file does not take the place of another, and its bytes are read where they were written") {
  const test::TemporaryFolder folder;
  std::error_code error;
  OpenFile file(folder.path() / "new", Opening::New, error);
  REQUIRE_FALSE(error);
  CHECK_FALSE(file.write("abcdef"));
  CHECK_FALSE(file.write_at(1, "XY"));
  CHECK_FALSE(file.cut(5));
  CHECK(file.size() == 5);
  std::string bytes(8, '-');
  CHECK(file.read_at(2, bytes.data(), bytes.size()) == 3);
  CHECK(bytes == "Yde-----");
  CHECK_FALSE(OpenFile(folder.path() / "new", Opening::New, error).is_open());
  CHECK(error == std::errc::file_exists);
  CHECK_FALSE(OpenFile(folder.path() / "missing", Opening::Read, error).is_open());
  CHECK(error == std::errc::no_such_file_or_directory);
}

TEST_CASE("open file: a lock belongs to one open file, and ends when it is closed") {
  const test::TemporaryFolder folder;
  std::error_code error;
  OpenFile first(folder.path() / "locked", Opening::New, error), second(folder.path() / "locked", Opening::Read, error);
  CHECK(first.lock() == OpenFile::Lock::Taken);
  CHECK(second.lock() == OpenFile::Lock::Busy);
  first.close();
  CHECK(second.lock() == OpenFile::Lock::Taken);
}

TEST_CASE("open file: a nameless file is in no folder until it gets a name, and replaces no file then") {
  const test::TemporaryFolder folder;
  OpenFile file = OpenFile::nameless(folder.path());
  if (!file.is_open()) return;  // this file system does not support files without a name (O_TMPFILE)
  CHECK_FALSE(file.write("bytes"));
  CHECK(std::filesystem::is_empty(folder.path()));
  CHECK_FALSE(file.give_name(folder.path() / "named"));
  CHECK(read_file(folder.path() / "named") == "bytes");
  CHECK(file.give_name(folder.path() / "named") == std::errc::file_exists);
  CHECK(file.status()->is_same_file(*status_of_file(folder.path() / "named")));
}

TEST_CASE("open file: a link is followed or refused, as the caller says") {
  const test::TemporaryFolder folder;
  write_file_atomically(folder.path() / "file", "bytes");
  std::filesystem::create_symlink(folder.path() / "file", folder.path() / "link");
  std::error_code error;
  CHECK(OpenFile(folder.path() / "link", Opening::Read, error).size() == 5);
  CHECK_FALSE(OpenFile(folder.path() / "link", Opening::Read, error, {.follows_links = false}).is_open());
  CHECK_FALSE(status_of_link(folder.path() / "link")->is_regular);
  CHECK(status_of_file(folder.path() / "link")->is_regular);
}
