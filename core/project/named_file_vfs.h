// SPDX-License-Identifier: AGPL-3.0-or-later
// SQLite's view of the disk while a project is open: the database NAME, its journal NAME-journal and its log NAME-wal,
// and no other file. SQLite by itself obeys a journal that lies beside a database: such a journal can name a
// "super-journal", a file that SQLite then opens and deletes. Limber never writes one, so a journal that has such a
// name is refused before anything is rolled back; a journal without it is rolled back as usual.
//
// One of these is made for every connection, is registered under a name of its own, and must outlive the connection. It
// works on top of the VFS that is SQLite's default at that time.
#pragma once

#include <memory>
#include <string>

#include "core/base/file.h"

namespace limber {

class NamedFileVfs {
 public:
  // throws Error when the name cannot be made absolute
  explicit NamedFileVfs(const Path& database);
  ~NamedFileVfs();
  NamedFileVfs(const NamedFileVfs&) = delete;
  NamedFileVfs& operator=(const NamedFileVfs&) = delete;

  const std::string& name() const;      // for sqlite3_open_v2
  const std::string& database() const;  // absolute, with symlinks resolved; never an URI

  // Why a file was refused, as an Error's three parts; `what` is empty when none was.
  struct Refusal {
    std::string what, where, what_to_do;
  };
  const Refusal& refusal() const;

  struct State;

 private:
  std::unique_ptr<State> state_;
};

}  // namespace limber
