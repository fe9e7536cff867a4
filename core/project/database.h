// SPDX-License-Identifier: AGPL-3.0-or-later
// Wraps the few SQLite calls that a project needs. Every failure is an Error with a cause that the user can act on: the
// disk is full, the file cannot be written, another program is writing the file, it is not a database, or it is
// damaged.
//
// A database is treated as hostile: SQLite sees only the database and its journal (core/project/named_file_vfs.h), and
// triggers, views, attached databases and extensions are off.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "core/base/error.h"
#include "core/base/file.h"
#include "core/project/named_file_vfs.h"

struct sqlite3;
struct sqlite3_stmt;

namespace limber {

// Error thrown while another program uses the file. The user can try again later; the file is not damaged.
class ProjectInUse : public Error {
 public:
  using Error::Error;
};

class Statement;

class Database {
 public:
  enum class Mode { Read, Write, Create };
  Database(const Path& path, Mode mode);
  ~Database();
  Database(const Database&) = delete;
  Database& operator=(const Database&) = delete;

  // Returns up to `size` first bytes of the file, or "" where it cannot be read. Reads through SQLite: if this process
  // opened and closed the file itself, the system would drop all locks of the process on the file, and a running save
  // would lose its lock.
  static std::string first_bytes(const Path& path, int size);

  // Rolls back what an interrupted save left unfinished in the database at `path`, and removes the database's journal,
  // so that a new file can take the name. Throws Error when the database is in use, or when the file with the journal's
  // name is not a journal of SQLite.
  static void clear_journal(const Path& path);

  void run(const char* sql);
  std::int64_t number(const std::string& sql);  // returns the first column of the first row, or 0 without a row
  [[noreturn]] void fail(int code) const;

 private:
  friend class Statement;
  void distrust();
  std::string where_;
  NamedFileVfs vfs_;
  sqlite3* handle_ = nullptr;
};

class Statement {
 public:
  Statement(Database& database, const char* sql);
  ~Statement();
  Statement(const Statement&) = delete;
  Statement& operator=(const Statement&) = delete;

  Statement& bind(int place, std::string_view bytes);  // binds a blob, which must live until the next step
  bool step();                                         // moves to the next row; returns false when there is none
  std::string bytes(int column) const;
  std::int64_t number(int column) const;
  void reset();
  // Binds the two blobs to the parameters 1 and 2, runs the statement to its end and resets it.
  void run(std::string_view first, std::string_view second);

 private:
  Database& database_;
  sqlite3_stmt* handle_ = nullptr;
};

// A transaction (BEGIN IMMEDIATE) that is rolled back at the end of its scope unless it was committed.
class Transaction {
 public:
  explicit Transaction(Database& database);
  ~Transaction();
  void commit();

 private:
  Database& database_;
  bool done_ = false;
};

}  // namespace limber
