// SPDX-License-Identifier: AGPL-3.0-or-later
// Limits SQLite's view of the disk while a project is open to three files: the database NAME, its journal NAME-journal
// and its log NAME-wal. Plain SQLite obeys any journal that lies beside a database, and a journal can name a
// "super-journal", a file that SQLite then opens and deletes. Limber never writes a super-journal's name, so a journal
// with such a name is refused before anything is rolled back; any other journal is rolled back as usual.
//
// Every connection has its own NamedFileVfs, registered under its own name, which must outlive the connection. It
// works on top of the VFS that is SQLite's default when it is made.
#pragma once

#include <memory>
#include <string>

#include "core/base/file.h"

namespace limber {

class NamedFileVfs {
 public:
  // Throws Error when the database's path cannot be made absolute.
  explicit NamedFileVfs(const Path& database);
  ~NamedFileVfs();
  NamedFileVfs(const NamedFileVfs&) = delete;
  NamedFileVfs& operator=(const NamedFileVfs&) = delete;

  const std::string& name() const;      // the name to pass to sqlite3_open_v2
  const std::string& database() const;  // absolute path with symlinks resolved; never a URI

  // Why a file was refused, as the three parts of an Error; `what` is empty when no file was refused.
  struct Refusal {
    std::string what, where, what_to_do;
  };
  const Refusal& refusal() const;

  struct State;

 private:
  std::unique_ptr<State> state_;
};

}  // namespace limber
