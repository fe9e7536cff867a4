// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/project/session.h"

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <random>
#include <utility>

#include "core/base/error.h"

namespace limber {

namespace {

namespace fs = std::filesystem;
using std::chrono::duration;

constexpr std::int64_t kMostGrowth = 4;  // a large journal is replaced when it exceeds this multiple of its first size

constexpr const char* kGone =
    "The project's file was removed or replaced by another program. Your edits are kept; save to write it again.";

std::string random_name() {
  std::random_device random;
  char name[20];
  std::snprintf(name, sizeof name, "%08x%08x", random(), random());
  return name;
}

Path absolute_of(const Path& path) {
  std::error_code error;
  const Path canonical = fs::weakly_canonical(fs::absolute(path), error);
  return error ? fs::absolute(path) : canonical;
}

std::string short_hash(const Path& path) {
  const std::string text = path.string();
  return sha256_of_bytes(text.data(), text.size()).substr(0, 16);
}

Error in_use(const Path& project) {
  return {"the project is open in another Limber", project.string(), "close it there, or work on a copy"};
}

}  // namespace

Session::Session(SessionSettings settings)
    : settings_(std::move(settings)),
      folder_(settings_.edits_folder.empty() ? limber::edits_folder() : settings_.edits_folder) {
  std::error_code ignored;
  fs::create_directories(folder_, ignored);
}

std::unique_ptr<Session> Session::start(SessionSettings settings) {
  std::unique_ptr<Session> session(new Session(std::move(settings)));
  session->journal_path_ = session->folder_ / (random_name() + ".edits");
  session->thread_ = std::jthread([s = session.get()](const std::stop_token& stop) { s->work(stop); });
  return session;
}

std::unique_ptr<Session> Session::open(const Path& path, Project& project, Progress& progress,
                                       SessionSettings settings) {
  std::unique_ptr<Session> session(new Session(std::move(settings)));
  const Path file = absolute_of(path);
  session->choose_journal_path(file);
  std::error_code error;
  if (fs::exists(session->journal_path_, error)) {
    session->leftover_lock_.emplace(session->journal_path_);
    if (!session->leftover_lock_->taken()) throw in_use(file);
  }
  project = read_project(file, progress);
  session->path_ = file;
  session->base_ = session->mark_ = project.mark;
  session->identity_ = status_of_file(file);
  session->saved_ = session->last_ = project.document;
  if (session->leftover_lock_) session->look_at_leftover();
  if (!session->leftover_) {
    try {
      session->begin_journal(nullptr, "");
    } catch (const Error& failure) {
      if (session->journal_in_use()) throw in_use(file);
      session->status_.message = failure.what();
    }
  }
  session->thread_ = std::jthread([s = session.get()](const std::stop_token& stop) { s->work(stop); });
  return session;
}

Session::~Session() {
  flush(settings_.retry_seconds);
  thread_.request_stop();
  changed_.notify_all();
  if (thread_.joinable()) thread_.join();
  const std::lock_guard disk(disk_);
  if (last_ == saved_ && journal_) remove_journal(journal_path_);
}

// Chooses the journal's path: beside the project, or in the edits folder where the project's folder is not writable.
void Session::choose_journal_path(const Path& project) {
  const std::string name = short_hash(project) + ".edits";
  const bool beside = is_writable(project.parent_path());
  journal_path_ = beside ? journal_path(project) : folder_ / name;
}

// Makes a link in the edits folder to the journal, so that all_recoverable() finds the journal.
void Session::note_journal() const {
  if (journal_path_.parent_path() == folder_) return;
  const Path link = folder_ / (short_hash(journal_path_) + ".edits");
  std::error_code ignored;
  if (fs::is_symlink(link, ignored)) return;
  fs::create_symlink(journal_path_, link, ignored);
}

void Session::remove_journal(const Path& journal) const { limber::discard(journal, folder_); }

Path Session::path() const {
  const std::lock_guard lock(state_);
  return path_;
}

SessionStatus Session::status() const {
  const std::lock_guard lock(state_);
  SessionStatus status = status_;
  status.kept = written_ == handed_;
  return status;
}

void Session::set_message(std::string message) {
  {
    const std::lock_guard lock(state_);
    if (status_.message == message) return;
    status_.message = std::move(message);
  }
  if (settings_.on_change) settings_.on_change();
}

// ---- the journal: call these functions with disk_ locked

bool Session::journal_in_use() const {
  std::error_code ignored;
  return !journal_ && !leftover_lock_ && fs::exists(journal_path_, ignored) && !FileLock(journal_path_).taken();
}

void Session::begin_journal(const Document* document, const std::string& label) {
  if (journal_in_use()) throw in_use(path());
  JournalWriter::Start start{
      .path = journal_path_, .project = path(), .base = base_, .document = document, .label = label};
  if (base_) start.base_chunks = reachable_chunks(start.project);
  std::error_code ignored;
  start.replace = fs::exists(journal_path_, ignored);
  journal_ = std::make_unique<JournalWriter>(std::move(start), journal_writer_, settings_.open_log);
  leftover_lock_.reset();
  fresh_bytes_ = journal_->bytes();
  note_journal();
}

// Reads the journal that an earlier session left. Its unsaved edits, if any, are offered to the user. If the journal
// cannot be read (another version may have written it), it is moved aside, since this session must not remove it.
void Session::look_at_leftover() {
  try {
    const JournalReader reader(journal_path_);
    if (!reader.edits().empty() && reader.edits().back().root != mark_->root)
      leftover_ = recoverable(reader, journal_path_);
  } catch (const Error& error) {
    status_.message = error.what();
    move_leftover_aside();
  }
}

void Session::set_leftover_aside() {
  if (leftover_) move_leftover_aside();
}

void Session::move_leftover_aside() {
  for (int number = 1;; ++number) {
    const Path aside = journal_path_.string() + "-" + std::to_string(number);
    std::error_code error, ignored;
    if (fs::exists(aside, error)) continue;
    fs::rename(journal_path_, aside, error);
    if (error)
      throw Error("the unsaved edits of an earlier session cannot be moved aside", journal_path_.string(),
                  error.message());
    fs::create_symlink(aside, folder_ / (random_name() + ".edits"), ignored);
    break;
  }
  leftover_.reset();
  leftover_lock_.reset();
}

void Session::write_journal(const Document& document, const std::string& label) {
  if (leftover_) set_leftover_aside();
  const bool large =
      journal_ && journal_->bytes() > settings_.large_journal && journal_->bytes() > kMostGrowth * fresh_bytes_;
  if (!journal_ || journal_->broken() || large) begin_journal(&document, label);
  else journal_->write(document, label, journal_writer_);
}

// Starts a journal with the whole document when another program removed or replaced the project's file. The old journal
// is of no use then, since it omits the chunks that were in that file.
void Session::watch_project() {
  if (!base_ || !identity_ || save_runs_) return;
  const auto now = status_of_file(path());
  if (now == identity_) return;
  try {
    if (now && read_mark(path()) == *mark_) {  // the file has the same save, only its time or inode differs
      identity_ = now;
      return;
    }
  } catch (const Error&) {
  }
  base_.reset();
  identity_.reset();
  if (leftover_) return;  // leftover edits build on the missing file, so their journal is not touched
  const Document document = last();
  begin_journal(&document, "The project's file is missing");
  set_message(kGone);
}

void Session::work(const std::stop_token& stop) {
  const auto watch = duration<double>(settings_.watch_seconds), retry = duration<double>(settings_.retry_seconds);
  bool failed = false;
  for (;;) {
    {
      std::unique_lock lock(state_);
      changed_.wait_for(lock, stop, failed ? retry : watch, [&] { return !failed && waiting_.has_value(); });
      if (stop.stop_requested() && (failed || !waiting_)) return;
    }
    std::optional<Document> document;
    std::string message;
    {
      const std::lock_guard disk(disk_);
      // Reads waiting_ only after disk_ is locked, since a save may have written that document in the meantime.
      std::string label;
      std::int64_t handed = 0;
      {
        const std::lock_guard lock(state_);
        document = waiting_;
        label = waiting_label_;
        handed = handed_;
      }
      failed = true;
      try {
        watch_project();
        if (document) write_journal(*document, label);
        failed = false;
        if (!identity_ && mark_) message = kGone;
      } catch (const std::bad_alloc&) {
        message = Error("there is not enough memory to keep your edits between saves", path().string(),
                        "save, and close other programs")
                      .what();
      } catch (const std::exception& error) {
        message = error.what();
      }
      const std::lock_guard lock(state_);
      if (document && !failed) {
        written_ = std::max(written_, handed);
        if (handed_ == handed) waiting_.reset();
      }
    }
    if (document || failed) set_message(message);
    if (document && settings_.on_change) settings_.on_change();
    changed_.notify_all();
  }
}

void Session::keep(const Document& document, std::string label) {
  {
    const std::lock_guard lock(state_);
    if (document == last_) return;
    last_ = document;
    waiting_ = document;
    waiting_label_ = std::move(label);
    ++handed_;
  }
  changed_.notify_all();
}

bool Session::flush(double seconds) {
  std::unique_lock lock(state_);
  return changed_.wait_for(lock, duration<double>(seconds), [&] { return written_ == handed_; });
}

Document Session::last() const {
  const std::lock_guard lock(state_);
  return last_;
}

std::optional<Recoverable> Session::leftover() const {
  const std::lock_guard disk(disk_);
  return leftover_;
}

Recovered Session::recover(Progress& progress) {
  const std::lock_guard disk(disk_);
  if (!leftover_) throw Error("there is nothing to recover", path().string(), "continue with the project as it is");
  Recovered recovered = limber::recover(leftover_->journal, progress);
  // The new journal replaces the old one in one step, so one of the two exists at any moment.
  begin_journal(&recovered.document, "Recovered: " + recovered.label);
  leftover_.reset();
  const std::lock_guard lock(state_);
  last_ = recovered.document;
  return recovered;
}

void Session::drop_leftover() {
  const std::lock_guard disk(disk_);
  if (!leftover_) return;
  begin_journal(nullptr, "");
  leftover_.reset();
}

// ---- saving

// Starts a journal that builds on this save, and only then removes the chunks that earlier saves needed. The save
// itself has succeeded, so a failure here is only shown; the next save tries again.
void Session::after_save(const Document& saved, const SaveMark& mark) {
  const Path file = path();
  mark_ = base_ = mark;
  saved_ = saved;
  identity_ = status_of_file(file);
  Document last;
  std::int64_t handed = 0;
  {
    const std::lock_guard lock(state_);
    last = last_;
    handed = handed_;
  }
  const bool all_saved = last == saved;
  std::string message;
  try {
    set_leftover_aside();
    begin_journal(all_saved ? nullptr : &last, "Edits made while saving");
    prune_project(file);
  } catch (const std::exception& error) {
    message = error.what();
  }
  identity_ = status_of_file(file);
  if (all_saved || message.empty()) {
    const std::lock_guard lock(state_);
    written_ = std::max(written_, handed);
    if (handed_ == handed) waiting_.reset();
  }
  set_message(message);
  changed_.notify_all();
}

// Writes the project file without locking disk_, so that edits can be written to the journal in the meantime.
void Session::write_file(const std::function<SaveMark()>& write, const Document& saved) {
  {
    const std::lock_guard disk(disk_);
    save_runs_ = true;
  }
  std::optional<SaveMark> mark;
  std::exception_ptr failure;
  try {
    mark = write();
  } catch (...) {
    failure = std::current_exception();
  }
  const std::lock_guard disk(disk_);
  save_runs_ = false;
  if (failure) std::rethrow_exception(failure);
  after_save(saved, *mark);
}

std::string Session::save(const Project& project, Progress& progress) {
  const Path file = path();
  if (file.empty()) throw Error("the project has no file yet", "save", "choose a name for the project");
  const std::lock_guard one_at_a_time(saving_);
  std::error_code error;
  const bool gone = !fs::exists(file, error);
  write_file(
      [&] {
        if (gone) return create_project(project, file, save_writer_, progress);
        return update_project(project, file, *mark_, Unused::Keep, save_writer_, progress);
      },
      project.document);
  return gone ? "The project's file had been removed. It was written again." : "";
}

void Session::save_as(const Project& project, const Path& new_path, Progress& progress) {
  const Path file = absolute_of(new_path);
  const std::lock_guard one_at_a_time(saving_);
  if (file == path()) {  // overwrites the session's own file, even if another program changed it
    write_file([&] { return create_project(project, file, save_writer_, progress); }, project.document);
    return;
  }
  std::error_code error;
  if (fs::exists(journal_path(file), error) && !FileLock(journal_path(file)).taken()) throw in_use(file);
  const SaveMark mark = create_project(project, file, save_writer_, progress);

  const std::lock_guard disk(disk_);
  const Path old_path = journal_path_;
  const auto old_journal = std::move(journal_);  // keeps the old journal and its lock until the new journal exists
  const bool leave_old = leftover_.has_value();
  leftover_.reset();
  leftover_lock_.reset();
  {
    const std::lock_guard lock(state_);
    path_ = file;
  }
  choose_journal_path(file);
  after_save(project.document, mark);
  if (!leave_old && journal_) remove_journal(old_path);
}

void Session::save_copy(const Project& project, const Path& path, Progress& progress) {
  DocumentWriter writer;
  create_project(project, path, writer, progress);
}

void Session::discard() {
  const std::lock_guard disk(disk_);
  {
    const std::lock_guard lock(state_);
    waiting_.reset();
    written_ = handed_;
    last_ = saved_;
  }
  if (leftover_ || !journal_) return;
  try {
    if (base_) return begin_journal(nullptr, "");
  } catch (const Error&) {  // there is no space even for an empty journal, so the journal is removed below
  }
  journal_.reset();
  remove_journal(journal_path_);
}

}  // namespace limber
