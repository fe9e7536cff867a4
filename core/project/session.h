// SPDX-License-Identifier: AGPL-3.0-or-later
// A session holds a project that is open in an editor: its file, its lock, and the journal of the edits since the last
// save.
//
//   auto session = Session::open(path, project);        // or Session::start() for a new project
//   if (session->leftover()) ...                        // a crash left edits: offer them; recover() gives the document
//   session->keep(history.current(), "Pose");           // after every commit, undo and redo; returns at once
//   session->save(project);                             // in a job, since it can take long
//   session->discard();                                 // the user does not want the unsaved edits
//
// keep() hands the document to a thread that writes it into the journal at once. So all edits except those of the last
// moment survive a crash of the program or of the machine. When the journal cannot be written (a full disk), status()
// says so and the thread tries again every second. When another program removes or replaces the project file, a new
// journal starts with the whole document. A second session on the same project is refused.
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
  Path edits_folder;  // folder for journals; empty: the folder that limber::edits_folder() returns
  OpenLog open_log = limber::open_log;
  std::function<void()> on_change;  // called from any thread when status() has changed
  double retry_seconds = 1;         // seconds until a failed write is tried again
  double watch_seconds = 2;         // seconds between checks of the project file
  // Size, bytes, above which a journal is started anew once it has also grown to several times its first size.
  std::int64_t large_journal = std::int64_t{256} << 20;
};

struct SessionStatus {
  bool kept = true;     // true: every document handed to keep() is on the disk
  std::string message;  // message for the user that says what is wrong; "" when nothing is
};

class Session {
 public:
  // Starts a session for a project without a file.
  static std::unique_ptr<Session> start(SessionSettings settings = {});
  // Opens a project and reads it into `project`. Throws Error when it cannot be read or another session has it open.
  static std::unique_ptr<Session> open(const Path& path, Project& project, Progress& progress = no_progress(),
                                       SessionSettings settings = {});
  // Removes the journal when the last document handed to keep() has been saved or discarded. Otherwise the journal
  // stays, and the next session offers its edits for recovery.
  ~Session();
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;

  Path path() const;  // absolute; empty before the first save
  SessionStatus status() const;

  // Returns the unsaved edits of this project that an earlier session left. If keep() is called before recover() or
  // drop_leftover(), the edits are moved to the file NAME.limber-edits-1 and offered again later.
  std::optional<Recoverable> leftover() const;
  Recovered recover(Progress& progress = no_progress());
  void drop_leftover();

  void keep(const Document& document, std::string label);
  // Waits up to `seconds` until every document handed to keep() is on the disk. Returns false when a document is still
  // not on the disk then.
  bool flush(double seconds);

  // Saves into the project's file; the first save must be save_as(). On failure throws Error and leaves the file as it
  // was. Returns a remark for the user when the file was missing and had to be written anew, else "".
  std::string save(const Project& project, Progress& progress = no_progress());
  // Saves into another file, which is the session's file from then on. Throws Error when the file cannot be written or
  // when another session has it open.
  void save_as(const Project& project, const Path& path, Progress& progress = no_progress());
  // Writes a copy of the project into another file, without changing the file of any session.
  static void save_copy(const Project& project, const Path& path, Progress& progress = no_progress());

  // Drops the unsaved edits: the documents handed to keep() since the last save.
  void discard();

 private:
  explicit Session(SessionSettings settings);
  // Call these functions with disk_ locked.
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
  const Path folder_;  // the folder for journals and links to journals

  mutable std::mutex state_;  // guards the members up to status_
  std::condition_variable_any changed_;
  Path path_;
  std::optional<Document> waiting_;
  std::string waiting_label_;
  Document last_;  // the document last passed to keep(), saved or opened
  std::int64_t handed_ = 0, written_ = 0;
  SessionStatus status_;

  std::mutex saving_;        // serializes saves; locked before disk_
  mutable std::mutex disk_;  // guards the members below; locked before state_
  bool save_runs_ = false;
  Path journal_path_;
  std::unique_ptr<JournalWriter> journal_;
  std::optional<FileLock> leftover_lock_;
  std::optional<Recoverable> leftover_;
  std::optional<SaveMark> base_;  // the save whose chunks the journal omits
  std::optional<SaveMark> mark_;  // the mark of this session's last save
  std::optional<FileStatus> identity_;
  std::int64_t fresh_bytes_ = 0;  // size of the current journal when it was started, bytes
  Document saved_;
  DocumentWriter save_writer_, journal_writer_;

  std::jthread thread_;
};

}  // namespace limber
