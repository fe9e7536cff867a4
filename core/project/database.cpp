// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/project/database.h"

#include <new>

#include <sqlite3.h>

#include "core/base/error.h"

namespace limber {

namespace {
constexpr int kBusyMilliseconds = 2000;
constexpr int kLargestValue = 32 << 20;  // bytes: no damaged length makes SQLite allocate more
}  // namespace

void Database::fail(int code) const {
  switch (code & 0xff) {
    case SQLITE_NOMEM:
      throw std::bad_alloc();
    case SQLITE_FULL:
      throw Error("the project cannot be written: the disk is full", where_, "free some space, or save elsewhere");
    case SQLITE_BUSY:
    case SQLITE_LOCKED:
      throw Error("another program is using the project", where_, "wait until it is done and try again");
    case SQLITE_READONLY:
    case SQLITE_PERM:
      throw Error("the project cannot be written: it or its folder is read-only", where_, "save elsewhere");
    case SQLITE_CANTOPEN:
      throw Error("the project cannot be opened", where_, "check that it and its folder may be read and written");
    case SQLITE_NOTADB:
      throw Error("this is not a Limber project", where_, "name a .limber file");
    case SQLITE_CORRUPT:
    case SQLITE_TOOBIG:
      throw Error("the project is damaged", where_, "open an earlier copy, or keep what is whole: limber project " + where_ + " recover -o OUT.limber");
    case SQLITE_IOERR: {
      const bool reading = code == SQLITE_IOERR_READ || code == SQLITE_IOERR_SHORT_READ || code == SQLITE_IOERR_FSTAT;
      throw Error(reading ? "the project cannot be read" : "the project cannot be written", where_,
                  reading ? "check the disk" : "check that the disk has room and works, or save elsewhere");
    }
    default:
      throw Error("the project cannot be used", where_, handle_ ? sqlite3_errmsg(handle_) : sqlite3_errstr(code));
  }
}

Database::Database(const Path& path, Mode mode) : where_(path.string()) {
  if (mode != Mode::Create) {
    std::error_code error;
    if (!std::filesystem::exists(path, error)) throw Error("the project does not exist", where_, "check the name");
    if (!std::filesystem::is_regular_file(path, error)) throw Error("this is not a file", where_, "name a .limber file");
  }
  // A reader may have to undo a transaction that was cut off, so it too asks to write; SQLite falls back by itself.
  const int flags = SQLITE_OPEN_READWRITE | SQLITE_OPEN_NOMUTEX | (mode == Mode::Create ? SQLITE_OPEN_CREATE : 0);
  const int opened = sqlite3_open_v2(path.c_str(), &handle_, flags, nullptr);
  try {
    if (!handle_) throw std::bad_alloc();
    if (opened != SQLITE_OK) fail(opened);
    sqlite3_extended_result_codes(handle_, 1);
    sqlite3_busy_timeout(handle_, kBusyMilliseconds);
    sqlite3_limit(handle_, SQLITE_LIMIT_LENGTH, kLargestValue);
    sqlite3_db_config(handle_, SQLITE_DBCONFIG_DEFENSIVE, 1, nullptr);
    sqlite3_db_config(handle_, SQLITE_DBCONFIG_TRUSTED_SCHEMA, 0, nullptr);
    run("PRAGMA cell_size_check = ON; PRAGMA temp_store = MEMORY; PRAGMA mmap_size = 0");
  } catch (...) {
    sqlite3_close(handle_);
    throw;
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
  } catch (const std::exception&) {  // SQLite has rolled back by itself, or will when the file is opened again
  }
}

void Transaction::commit() {
  database_.run("COMMIT");
  done_ = true;
}

}  // namespace limber
