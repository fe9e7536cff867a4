// SPDX-License-Identifier: AGPL-3.0-or-later
// SQLite, in the few words that a project needs. Every failure is an Error that says what the user can do: the disk is
// full, the file cannot be written, another program is writing it, it is no database, it is damaged.
//
// A database is hostile until it has shown otherwise: SQLite sees only the database and its journal
// (core/project/named_file_vfs.h), and triggers, views, attached databases and extensions are off.
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

// Thrown where another program has the file just now: trying again helps, recovering does not.
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

  // The first bytes of the file, as many as there are; nothing where it cannot be read. Not with a descriptor of our
  // own: when that is closed the system takes the locks of this process's connections, and a save would lose its own.
  static std::string first_bytes(const Path& path, int size);

  // Rolls back what a save that was cut off has left beside `path`, and removes a journal that belongs to no database
  // any more, so that a new file may take the name. throws Error when the database is in use, or when what stands
  // beside it is no journal of Limber's.
  static void clear_journal(const Path& path);

  void run(const char* sql);
  std::int64_t number(const std::string& sql);  // the first column of the first row; 0 without one
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

  Statement& bind(int place, std::string_view bytes);  // as a blob; must live until the next step
  bool step();                                         // true while there is a row
  std::string bytes(int column) const;
  std::int64_t number(int column) const;
  void reset();
  // Binds, runs to the end and resets.
  void run(std::string_view first, std::string_view second);

 private:
  Database& database_;
  sqlite3_stmt* handle_ = nullptr;
};

// BEGIN IMMEDIATE, rolled back unless committed.
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
