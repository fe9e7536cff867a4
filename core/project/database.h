// SPDX-License-Identifier: AGPL-3.0-or-later
// SQLite, in the few words that a project needs. Every failure is an Error that says what the user can do: the disk is
// full, the file cannot be written, another program is writing it, it is no database, it is damaged.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "core/base/file.h"

struct sqlite3;
struct sqlite3_stmt;

namespace limber {

class Statement;

class Database {
 public:
  enum class Mode { Read, Write, Create };
  Database(const Path& path, Mode mode);
  ~Database();
  Database(const Database&) = delete;
  Database& operator=(const Database&) = delete;

  void run(const char* sql);
  std::int64_t number(const std::string& sql);  // the first column of the first row; 0 without one
  [[noreturn]] void fail(int code) const;

 private:
  friend class Statement;
  std::string where_;
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
