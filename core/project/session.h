// SPDX-License-Identifier: AGPL-3.0-or-later
// A project that is open in an editor: its file, its lock, and the journal that keeps what was edited since the last
// save.
//
//   auto session = Session::open(path, project);        // or Session::start() for a new project
//   if (session->leftover()) ...                        // a crash left edits: offer them; recover() gives the document
//   session->keep(history.current(), "Pose");           // after every commit, undo and redo; returns at once
//   session->save(project);                             // in a job: it takes as long as it takes
//   session->discard();                                 // the user does not want the unsaved edits
//
// keep() hands the document to a thread that writes it into the journal at once, so all edits but those of the last
// moment survive a crash of the program or of the machine. When the journal cannot be written (a full disk), status()
// says so and it is tried again every second. A project file that is removed or replaced underneath makes the journal
// start anew with the whole document. Two sessions never have one project: the second is refused.
//
// Every function may be called from any thread; keep(), status() and path() never wait for a disk.
#pragma once

#include <condition_variable>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "core/project/journal.h"
#include "core/project/project_io.h"

namespace limber {

struct SessionSettings {
  Path edits_folder;  // empty: limber::edits_folder()
  OpenLog open_log = limber::open_log;
  std::function<void()> on_change;  // called from any thread when status() has changed
  double retry_seconds = 1;         // after a failure
  double watch_seconds = 2;         // how often the project file is looked after
  // A journal that has become this large, and several times as large as when it began, begins anew.
  std::int64_t large_journal = std::int64_t{256} << 20;  // bytes
};

struct SessionStatus {
  bool kept = true;     // everything handed to keep() is on the disk
  std::string message;  // what is wrong, "" when nothing is
};

class Session {
 public:
  // A project without a file.
  static std::unique_ptr<Session> start(SessionSettings settings = {});
  // throws Error when it cannot be read, or another session has it
  static std::unique_ptr<Session> open(const Path& path, Project& project, Progress& progress = no_progress(),
                                       SessionSettings settings = {});
  // Ends without a trace when what was kept last is saved or discarded; else the journal stays and is offered again.
  ~Session();
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;

  Path path() const;  // absolute; empty before the first save
  SessionStatus status() const;

  // What an earlier session left of this project. Until it is recovered or dropped, keep() sets it aside as
  // NAME.limber-edits-1, where it is offered again.
  std::optional<Recoverable> leftover() const;
  Recovered recover(Progress& progress = no_progress());
  void drop_leftover();

  void keep(const Document& document, std::string label);
  // Waits until everything kept is on the disk, that long; false when it is not.
  bool flush(double seconds);

  // Saves into the project's file; the first time save_as. throws Error, and all is as before.
  // Returns a remark worth showing: that the file was gone and has been written anew.
  std::string save(const Project& project, Progress& progress = no_progress());
  // From then on the project is that file. throws Error, also when another session has that file.
  void save_as(const Project& project, const Path& path, Progress& progress = no_progress());
  // A file of its own; the session stays with its own.
  static void save_copy(const Project& project, const Path& path, Progress& progress = no_progress());

  // What was kept since the last save is not wanted.
  void discard();

 private:
  explicit Session(SessionSettings settings);
  struct FileIdentity {
    std::uint64_t device = 0, inode = 0;
    std::int64_t size = 0, seconds = 0, nanoseconds = 0;
    bool operator==(const FileIdentity&) const = default;
  };
  static std::optional<FileIdentity> identity_of(const Path& path);

  // with disk_ held
  bool journal_in_use() const;
  void begin_journal(const Document* document, const std::string& label);
  void write_journal(const Document& document, const std::string& label);
  void after_save(const Document& saved, const SaveMark& mark);
  void write_file(const std::function<SaveMark()>& write, const Document& saved);
  Document last() const;
  void look_at_leftover();
  void set_leftover_aside();
  void move_leftover_aside();
  void watch_project();
  void choose_journal_path(const Path& project);
  void note_journal() const;
  void remove_journal(const Path& journal) const;

  void work(const std::stop_token& stop);
  void set_message(std::string message);

  const SessionSettings settings_;
  const Path folder_;  // for journals and links to them

  mutable std::mutex state_;  // guards what keep() and status() touch
  std::condition_variable_any changed_;
  Path path_;
  std::optional<Document> waiting_;
  std::string waiting_label_;
  Document last_;  // handed to keep() last, or saved or opened
  std::int64_t handed_ = 0, written_ = 0;
  SessionStatus status_;

  std::mutex saving_;        // one save at a time; taken before disk_
  mutable std::mutex disk_;  // guards what follows; taken before state_
  bool save_runs_ = false;
  Path journal_path_;
  std::unique_ptr<JournalWriter> journal_;
  std::optional<FileLock> leftover_lock_;
  std::optional<Recoverable> leftover_;
  std::optional<SaveMark> base_;  // what the journal builds on
  std::optional<SaveMark> mark_;  // the last save of ours
  std::optional<FileIdentity> identity_;
  std::int64_t fresh_bytes_ = 0;  // of the journal when it began
  Document saved_;
  DocumentWriter save_writer_, journal_writer_;

  std::jthread thread_;
};

}  // namespace limber
