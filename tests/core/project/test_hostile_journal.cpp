// SPDX-License-Identifier: AGPL-3.0-or-later
// Tests files that may lie beside a project: journals that name other files, links and pipes, and the valid journal of
// an interrupted save.
#include <algorithm>
#include <fstream>
#include <map>

#include <doctest/doctest.h>
#include <sqlite3.h>
#include <sys/stat.h>

#include "core/base/error.h"
#include "core/project/database.h"
#include "core/project/project_io.h"
#include "tests/support/documents.h"
#include "tests/support/program.h"

using namespace limber;
using namespace limber::test;

namespace {

namespace fs = std::filesystem;

constexpr std::size_t kPage = 8192, kSector = 512;
const std::string kMagic = "\xd9\xd5\x05\xf9\x20\xa1\x63\xd7";

void put_bytes(const Path& path, const std::string& bytes) { std::ofstream(path, std::ios::binary) << bytes; }

std::string big_endian(std::uint32_t value) {
  std::string bytes;
  for (int shift = 24; shift >= 0; shift -= 8) bytes += static_cast<char>(value >> shift & 0xff);
  return bytes;
}

std::string journal_header(std::uint32_t records, std::uint32_t pages) {
  std::string header =
      kMagic + big_endian(records) + big_endian(0) + big_endian(pages) + big_endian(kSector) + big_endian(kPage);
  header.resize(kSector, '\0');
  return header;
}

// Returns the journal record of a page's old content, with SQLite's checksum: the sum of every 200th byte from the end.
std::string journal_record(std::uint32_t page, const std::string& bytes) {
  std::uint32_t sum = 0;
  for (std::size_t at = bytes.size() - 200; at > 0 && at < bytes.size(); at -= 200)
    sum += static_cast<unsigned char>(bytes[at]);
  return big_endian(page) + bytes + big_endian(sum);
}

std::string super_journal(const std::string& name) {
  std::uint32_t sum = 0;
  for (const char letter : name) sum += static_cast<std::uint32_t>(static_cast<signed char>(letter));
  return big_endian(0x40000000 / kPage + 1) + name + big_endian(static_cast<std::uint32_t>(name.size())) +
         big_endian(sum) + kMagic;
}

std::map<std::string, std::string> contents(const Path& folder) {
  std::map<std::string, std::string> all;
  for (const auto& entry : fs::directory_iterator(folder))
    all[entry.path().filename()] = entry.is_regular_file() ? read_file(entry.path()) : "";
  return all;
}

std::string message_of(const std::function<void()>& work) {
  try {
    work();
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

void make_project(const Path& path, const Document& document = {}) {
  DocumentWriter writer;
  create_project({.document = document}, path, writer);
}

// Opens the database by plain SQLite, as another process would, without the program's own checks.
struct PlainConnection {
  sqlite3* handle = nullptr;
  explicit PlainConnection(const Path& path) { REQUIRE(sqlite3_open(path.c_str(), &handle) == SQLITE_OK); }
  ~PlainConnection() { sqlite3_close(handle); }
  void run(const std::string& sql) {
    char* message = nullptr;
    const int code = sqlite3_exec(handle, sql.c_str(), nullptr, nullptr, &message);
    INFO(sql, ": ", (message ? message : ""));
    REQUIRE(code == SQLITE_OK);
    sqlite3_free(message);
  }
};

}  // namespace

TEST_CASE(
    "hostile journal: one that names another file is refused by whoever opens the project, and nothing is deleted" *
    doctest::test_suite("slow")) {
  const TemporaryFolder folder;
  const Path project = folder / "x.limber", victim = folder / "precious.txt";
  make_project(project);
  put_bytes(victim, "hours of work\n");
  const auto pages = static_cast<std::uint32_t>(fs::file_size(project) / kPage);
  for (const std::string& name :
       {victim.string(), project.string(), project.string() + "-journal", (folder / "none").string()}) {
    put_bytes(project.string() + "-journal", journal_header(0, pages) + super_journal(name));
    const auto before = contents(folder.path());
    for (const std::vector<std::string>& words :
         std::vector<std::vector<std::string>>{{"info", project},
                                               {"project", project},
                                               {"project", project, "verify"},
                                               {"project", project, "export", "rig", "-o", folder / "rig.json"},
                                               {"project", project, "create", "--replace"}}) {
      const ProgramRun run = run_limber(words);
      INFO(words[0], " ", words.back(), " beside ", name, ": ", run.out, run.err);
      CHECK(run.exit_code == 1);
      CHECK(run.err.find("the journal beside the project names another file") != std::string::npos);
      CHECK(contents(folder.path()) == before);
    }
    DocumentWriter writer;
    CHECK_THROWS_AS(update_project({}, project, {}, Unused::Remove, writer), Error);
    CHECK(read_thumbnail(project).empty());
    CHECK(contents(folder.path()) == before);
  }
}

TEST_CASE("hostile journal: a link or a pipe beside the project is refused, not followed and not waited for") {
  const TemporaryFolder folder;
  const Path project = folder / "x.limber", victim = folder / "precious.txt", journal = folder / "x.limber-journal";
  make_project(project);
  put_bytes(victim, "hours of work\n");
  fs::create_symlink(victim, journal);
  CHECK(message_of([&] { read_project(project); }).starts_with("the file beside the project is not a regular file"));
  CHECK(fs::is_symlink(journal));
  fs::remove(journal);
  REQUIRE(::mkfifo(journal.c_str(), 0600) == 0);
  CHECK(message_of([&] { read_project(project); }).starts_with("the file beside the project is not a regular file"));
  CHECK(read_file(victim) == "hours of work\n");
}

TEST_CASE("hostile journal: an honest one, of a save that was cut off, is still rolled back") {
  const TemporaryFolder folder;
  const Path project = folder / "x.limber", journal = folder / "x.limber-journal";
  make_project(project, small_document());
  const std::string whole = read_file(project);
  std::string records, torn = whole;
  const auto pages = static_cast<std::uint32_t>(whole.size() / kPage);
  for (std::uint32_t page = 1; page <= pages; page += 2) {
    records += journal_record(page, whole.substr((page - 1) * kPage, kPage));
    for (std::size_t at = (page - 1) * kPage + (page == 1 ? 100 : 0); at < page * kPage; ++at) torn[at] ^= 0x5a;
  }
  put_bytes(project, torn);
  put_bytes(journal, journal_header((pages + 1) / 2, pages) + records);
  CHECK(same_contents(read_project(project).document, small_document()));
  CHECK_FALSE(fs::exists(journal));
  CHECK(read_file(project) == whole);
}

TEST_CASE("hostile journal: a new project takes a name beside which a cut-off save left its journal, and stays whole") {
  const TemporaryFolder folder;
  const Path project = folder / "x.limber", journal = folder / "x.limber-journal";
  make_project(project, small_document());
  const std::string old = read_file(project);
  const std::string left =
      journal_header(1, static_cast<std::uint32_t>(old.size() / kPage)) + journal_record(1, old.substr(0, kPage));
  for (const bool old_is_there : {true, false}) {
    put_bytes(project, old);
    put_bytes(journal, left);
    if (!old_is_there) fs::remove(project);
    make_project(project, large_document(1));
    CHECK(same_contents(read_project(project).document, large_document(1)));
    CHECK_FALSE(fs::exists(journal));
  }
  put_bytes(journal, "notes on the journal");
  CHECK(message_of([&] {
          read_project(project);
        }).starts_with("the file beside the project is not the project's journal"));
  CHECK(message_of([&] {
          make_project(project);
        }).starts_with("the file beside the project is not the project's journal"));
  fs::remove(project);
  CHECK(message_of([&] { make_project(project); }).starts_with("another file has the name of the project's journal"));
  CHECK(read_file(journal) == "notes on the journal");
}

TEST_CASE("hostile database: a name is never an URI, and nothing can be attached, loaded or triggered") {
  const TemporaryFolder folder;
  const Path project = folder / "x.limber", other = folder / "other.db";
  make_project(project, small_document());
  {
    Database database(project, Database::Mode::Write);
    CHECK_THROWS_AS(database.run(("ATTACH '" + other.string() + "' AS other").c_str()), Error);
    CHECK_THROWS_AS(database.run(("VACUUM INTO '" + other.string() + "'").c_str()), Error);
    CHECK_THROWS_AS(database.run("SELECT load_extension('x')"), Error);
    CHECK_THROWS_AS(database.run("PRAGMA writable_schema = ON; UPDATE sqlite_schema SET sql = ''"), Error);
  }
  CHECK_FALSE(fs::exists(other));
  {
    PlainConnection plain(project);
    plain.run("CREATE TRIGGER hidden AFTER INSERT ON chunk BEGIN DELETE FROM state; END");
  }
  {
    Database database(project, Database::Mode::Write);
    database.run("INSERT INTO chunk VALUES (x'00', x'00')");
    CHECK(database.number("SELECT count(*) FROM state") == 5);
  }
  CHECK(message_of([&] { read_project(project); }).starts_with("the project is damaged"));

  const Path here = fs::current_path();
  fs::current_path(folder.path());
  const std::string uri =
      message_of([] { Database("file:made.db?mode=rwc", Database::Mode::Create).run("CREATE TABLE t(x)"); });
  const bool made = fs::exists("file:made.db?mode=rwc") && !fs::exists("made.db");
  fs::current_path(here);
  CHECK(uri.empty());
  CHECK(made);
}

TEST_CASE(
    "hostile database: one that another program set to write-ahead logging is read with its log, and no third file is "
    "made") {
  const TemporaryFolder folder;
  const Path project = folder / "x.limber", copy = folder / "y.limber";
  make_project(project, small_document());
  const SaveMark mark = read_mark(project);
  {
    PlainConnection plain(project);
    plain.run(
        "PRAGMA journal_mode = WAL; PRAGMA wal_autocheckpoint = 0; INSERT INTO chunk VALUES (zeroblob(32), x'02')");
    fs::copy_file(project, copy);
    fs::copy_file(project.string() + "-wal", copy.string() + "-wal");
  }
  CHECK(same_contents(read_project(copy).document, small_document()));
  CHECK(summarize_project(copy).chunks == summarize_project(project).chunks);
  CHECK_FALSE(fs::exists(copy.string() + "-shm"));
  DocumentWriter writer;
  update_project({.document = large_document(1)}, copy, mark, Unused::Remove, writer);
  CHECK(same_contents(read_project(copy).document, large_document(1)));
  CHECK_FALSE(fs::exists(copy.string() + "-wal"));
}

TEST_CASE("project locks: looking at a project while it is saved takes no lock from the save" *
          doctest::test_suite("slow")) {
  const TemporaryFolder folder;
  const Path project = folder / "x.limber";
  make_project(project);
  Database saving(project, Database::Mode::Write);
  saving.run("BEGIN EXCLUSIVE");
  CHECK(is_project(project));
  const ProgramRun other = run_limber({"info", project});
  CHECK(other.exit_code == 1);
  CHECK(other.err.find("another program is using the project") != std::string::npos);
  saving.run("ROLLBACK");
  CHECK(run_limber({"info", project}).exit_code == 0);
  CHECK_FALSE(is_project(folder.path()));
  CHECK_FALSE(is_project(folder / "none"));
  put_bytes(folder / "short", "SQLite format 3");
  CHECK_FALSE(is_project(folder / "short"));
}
