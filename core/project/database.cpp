// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/project/database.h"

#include <algorithm>
#include <array>
#include <fstream>
#include <new>
#include <utility>

#include <sqlite3.h>

#include "core/base/error.h"

namespace limber {

namespace {
constexpr int kBusyMilliseconds = 2000;
// Upper limit on the size of a value, bytes. SQLite then allocates no more, even if a damaged file asks for it.
constexpr int kLargestValue = 32 << 20;

// Limits set for SQLite. Each limit is what a project and Limber's own SQL statements need at most, plus a margin.
constexpr std::array<std::pair<int, int>, 10> kLimits = {{{SQLITE_LIMIT_LENGTH, kLargestValue},
                                                          {SQLITE_LIMIT_SQL_LENGTH, 1 << 16},
                                                          {SQLITE_LIMIT_COLUMN, 16},
                                                          {SQLITE_LIMIT_EXPR_DEPTH, 16},
                                                          {SQLITE_LIMIT_COMPOUND_SELECT, 2},
                                                          {SQLITE_LIMIT_VDBE_OP, 50'000},
                                                          {SQLITE_LIMIT_FUNCTION_ARG, 8},
                                                          {SQLITE_LIMIT_ATTACHED, 0},
                                                          {SQLITE_LIMIT_TRIGGER_DEPTH, 1},
                                                          {SQLITE_LIMIT_WORKER_THREADS, 0}}};
constexpr std::array<std::pair<int, int>, 9> kSwitches = {{{SQLITE_DBCONFIG_DEFENSIVE, 1},
                                                           {SQLITE_DBCONFIG_TRUSTED_SCHEMA, 0},
                                                           {SQLITE_DBCONFIG_ENABLE_TRIGGER, 0},
                                                           {SQLITE_DBCONFIG_ENABLE_VIEW, 0},
                                                           {SQLITE_DBCONFIG_ENABLE_FKEY, 0},
                                                           {SQLITE_DBCONFIG_ENABLE_FTS3_TOKENIZER, 0},
                                                           {SQLITE_DBCONFIG_ENABLE_LOAD_EXTENSION, 0},
                                                           {SQLITE_DBCONFIG_DQS_DDL, 0},
                                                           {SQLITE_DBCONFIG_DQS_DML, 0}}};

// Reads the file's first bytes through SQLite's own file handle. If this process opened and closed the file a second
// time, the system would drop the process's locks on it.
std::string first_bytes_of(sqlite3* handle, int size) {
  sqlite3_file* file = nullptr;
  sqlite3_int64 there = 0;
  if (sqlite3_file_control(handle, "main", SQLITE_FCNTL_FILE_POINTER, &file) != SQLITE_OK || !file->pMethods) return "";
  if (file->pMethods->xFileSize(file, &there) != SQLITE_OK) return "";
  std::string bytes(static_cast<std::size_t>(std::min<sqlite3_int64>(there, size)), '\0');
  const int code = file->pMethods->xRead(file, bytes.data(), static_cast<int>(bytes.size()), 0);
  return code == SQLITE_OK ? bytes : "";
}

// Returns true if another program has switched the database to write-ahead logging, which Limber never does.
bool uses_wal(sqlite3* handle) {
  const std::string header = first_bytes_of(handle, 20);
  return header.size() == 20 && (header[18] == 2 || header[19] == 2);
}

// Returns true if the file begins like a journal or a write-ahead log of SQLite. A journal whose transaction has ended
// is empty or begins with zeros.
bool begins_as_journal(const Path& path) {
  constexpr std::string_view kJournal = "\xd9\xd5\x05\xf9\x20\xa1\x63\xd7", kLog = "\x37\x7f\x06";
  std::array<char, 8> bytes{};
  std::ifstream in(path, std::ios::binary);
  in.read(bytes.data(), bytes.size());
  const std::string_view begin(bytes.data(), static_cast<std::size_t>(in.gcount()));
  return begin.empty() || begin[0] == '\0' || begin.starts_with(kJournal) || begin.starts_with(kLog);
}
}  // namespace

void Database::fail(int code) const {
  if (const auto& refusal = vfs_.refusal(); !refusal.what.empty())
    throw Error(refusal.what, refusal.where, refusal.what_to_do);
  switch (code & 0xff) {
    case SQLITE_NOMEM: throw std::bad_alloc();
    case SQLITE_FULL:
      throw Error("the project cannot be written: the disk is full", where_, "free some space, or save elsewhere");
    case SQLITE_BUSY:
    case SQLITE_LOCKED:
      throw ProjectInUse("another program is using the project", where_, "wait until it is done and try again");
    case SQLITE_READONLY:
    case SQLITE_PERM:
      throw Error("the project cannot be written: it or its folder is read-only", where_, "save elsewhere");
    case SQLITE_CANTOPEN:
      throw Error("the project cannot be opened", where_, "check that you may read and write the file and its folder");
    case SQLITE_NOTADB: throw Error("this is not a Limber project", where_, "name a .limber file");
    case SQLITE_CORRUPT:
    case SQLITE_TOOBIG:
      throw Error(
          "the project is damaged", where_,
          "open an earlier copy, or recover the undamaged parts: limber project " + where_ + " recover -o OUT.limber");
    case SQLITE_IOERR: {
      const bool reading = code == SQLITE_IOERR_READ || code == SQLITE_IOERR_SHORT_READ || code == SQLITE_IOERR_FSTAT;
      throw Error(reading ? "the project cannot be read" : "the project cannot be written", where_,
                  reading ? "check the disk" : "check that the disk has room and works, or save elsewhere");
    }
    default:
      throw Error("the project cannot be used", where_, handle_ ? sqlite3_errmsg(handle_) : sqlite3_errstr(code));
  }
}

Database::Database(const Path& path, Mode mode) : where_(path.string()), vfs_(path) {
  if (mode != Mode::Create) {
    std::error_code error;
    if (!std::filesystem::exists(path, error)) throw Error("the project does not exist", where_, "check the name");
    if (!std::filesystem::is_regular_file(path, error))
      throw Error("this is not a file", where_, "name a .limber file");
  }
  // Opens the file for writing even for a reader, since the reader may have to roll back an interrupted transaction.
  // Where writing is not allowed, SQLite opens the file for reading.
  const int flags = SQLITE_OPEN_READWRITE | SQLITE_OPEN_NOMUTEX | (mode == Mode::Create ? SQLITE_OPEN_CREATE : 0);
  const int opened = sqlite3_open_v2(vfs_.database().c_str(), &handle_, flags, vfs_.name().c_str());
  try {
    if (!handle_) throw std::bad_alloc();
    if (opened != SQLITE_OK) fail(opened);
    sqlite3_extended_result_codes(handle_, 1);
    sqlite3_busy_timeout(handle_, kBusyMilliseconds);
    distrust();
    run("PRAGMA cell_size_check = ON; PRAGMA temp_store = MEMORY; PRAGMA mmap_size = 0");
    // A write-ahead log is normally shared by connections through shared memory, which is off here. So the one
    // connection needs exclusive access.
    if (uses_wal(handle_)) run("PRAGMA locking_mode = EXCLUSIVE");
  } catch (...) {
    sqlite3_close(handle_);
    throw;
  }
}

std::string Database::first_bytes(const Path& path, int size) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error)) return "";
  const NamedFileVfs vfs(path);
  sqlite3* handle = nullptr;
  std::string bytes;
  if (sqlite3_open_v2(vfs.database().c_str(), &handle, SQLITE_OPEN_READONLY | SQLITE_OPEN_NOMUTEX,
                      vfs.name().c_str()) == SQLITE_OK)
    bytes = first_bytes_of(handle, size);
  sqlite3_close(handle);
  return bytes;
}

void Database::distrust() {
  for (const auto& [limit, most] : kLimits) sqlite3_limit(handle_, limit, most);
  for (const auto& [option, on] : kSwitches) {
    const int code = sqlite3_db_config(handle_, option, on, nullptr);
    if (code != SQLITE_OK) fail(code);
  }
}

void Database::clear_journal(const Path& path) {
  std::error_code error;
  const auto is_there = [&](const Path& file) {
    return std::filesystem::symlink_status(file, error).type() != std::filesystem::file_type::not_found;
  };
  const Path journal = path.string() + "-journal", log = path.string() + "-wal";
  if (!is_there(journal) && !is_there(log)) return;
  if (std::filesystem::is_regular_file(path, error)) {
    const Database database(path, Mode::Read);
    sqlite3_stmt* statement = nullptr;
    int code = sqlite3_prepare_v2(database.handle_, "PRAGMA schema_version", -1, &statement, nullptr);
    if (code == SQLITE_OK) sqlite3_step(statement);
    code = sqlite3_finalize(statement);
    // A broken database does not stop the call, since the caller replaces the file by a new one.
    const bool is_broken = (code & 0xff) == SQLITE_NOTADB || (code & 0xff) == SQLITE_CORRUPT;
    if (code != SQLITE_OK && !is_broken) database.fail(code);
  }
  for (const Path& file : {journal, log}) {
    if (!is_there(file)) continue;
    const bool ours = std::filesystem::symlink_status(file, error).type() == std::filesystem::file_type::regular &&
                      begins_as_journal(file);
    if (!ours)
      throw Error("another file has the name of the project's journal", file.string(),
                  "move that file away, or choose another name");
    std::filesystem::remove(file, error);
    if (error) throw Error("the journal of an earlier project cannot be removed", file.string(), error.message());
  }
}

Database::~Database() { sqlite3_close(handle_); }

void Database::run(const char* sql) {
  const int code = sqlite3_exec(handle_, sql, nullptr, nullptr, nullptr);
  if (code != SQLITE_OK) fail(code);
}

std::int64_t Database::number(const std::string& sql) {
  Statement statement(*this, sql.c_str());
  return statement.step() ? statement.number(0) : 0;
}

Statement::Statement(Database& database, const char* sql) : database_(database) {
  const int code = sqlite3_prepare_v2(database.handle_, sql, -1, &handle_, nullptr);
  if (code != SQLITE_OK) database.fail(code);
}

Statement::~Statement() { sqlite3_finalize(handle_); }

Statement& Statement::bind(int place, std::string_view bytes) {
  const char* from = bytes.empty() ? "" : bytes.data();  // a null pointer would bind NULL
  const int code = sqlite3_bind_blob64(handle_, place, from, bytes.size(), SQLITE_STATIC);
  if (code != SQLITE_OK) database_.fail(code);
  return *this;
}

bool Statement::step() {
  const int code = sqlite3_step(handle_);
  if (code == SQLITE_ROW) return true;
  if (code != SQLITE_DONE) database_.fail(code);
  return false;
}

std::string Statement::bytes(int column) const {
  const void* from = sqlite3_column_blob(handle_, column);
  const int size = sqlite3_column_bytes(handle_, column);
  return from ? std::string(static_cast<const char*>(from), static_cast<std::size_t>(size)) : std::string();
}

std::int64_t Statement::number(int column) const { return sqlite3_column_int64(handle_, column); }

void Statement::reset() {
  sqlite3_reset(handle_);
  sqlite3_clear_bindings(handle_);
}

void Statement::run(std::string_view first, std::string_view second) {
  bind(1, first);
  bind(2, second);
  step();
  reset();
}

Transaction::Transaction(Database& database) : database_(database) { database_.run("BEGIN IMMEDIATE"); }

Transaction::~Transaction() {
  if (done_) return;
  try {
    database_.run("ROLLBACK");
  } catch (const std::exception&) {  // ignored: SQLite has already rolled back, or will when the file is opened again
  }
}

void Transaction::commit() {
  database_.run("COMMIT");
  done_ = true;
}

}  // namespace limber
