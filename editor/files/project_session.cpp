// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/files/project_session.h"

#include <ctime>
#include <utility>

#include "core/base/error.h"
#include "editor/context/document_edits.h"
#include "editor/context/editor.h"
#include "editor/dialogs/confirm_dialog.h"
#include "editor/file_browser/file_browser.h"
#include "editor/file_browser/thumbnails.h"
#include "editor/files/view_state_json.h"
#include "editor/shown/frame_all.h"
#include "editor/ui/icons.h"
#include "editor/volume/shown_image.h"

namespace limber::editor {

namespace {

constexpr const char* kInUse = "the project is open in another Limber";

std::int64_t seconds_now() { return static_cast<std::int64_t>(std::time(nullptr)); }

SessionSettings settings_of(Editor& editor) {
  return {.edits_folder = editor.folders.edits, .on_change = [&host = editor.host] { host.wake(); }};
}

std::shared_ptr<Session> session_of(Editor& editor) {
  if (!editor.life.session) editor.life.session = Session::start(settings_of(editor));
  return editor.life.session;
}

Project project_of(Editor& editor) {
  Project project;
  project.document = editor.document();
  project.editor = editor_state(editor);
  project.thumbnail = thumbnail_png(editor);
  return project;
}

// Updates the editor after a save: marks the saved revision in the history, and sets the project's path and name. Shows
// `remark` as a message unless it is empty. Call this in the editor's thread.
void met_save(Editor& editor, const Path& path, std::int64_t revision, const std::string& remark) {
  editor.history.mark_saved(revision);
  editor.life.saved_at = seconds_now();
  editor.project_path = path;
  editor.name = path.filename().string();
  add_recent(editor.recent_files, path, editor.life.saved_at);
  if (!remark.empty()) editor.messages.info(path.filename().string(), remark);
}

// Writes the latest document to the session's journal and returns the session. Called before a save, so that no edits
// are lost if the save fails.
std::shared_ptr<Session> session_with_edits(Editor& editor) {
  auto session = session_of(editor);
  session->keep(editor.document(), editor.history.steps()[editor.history.position()].label);
  editor.life.kept_revision = editor.history.revision();
  return session;
}

void open_copy(Editor& editor, const Path& path, Then then) {
  start_task(editor, "Open a copy of " + path.filename().string(),
             [path, then, agreed = editor.history.revision()](Progress& progress) -> Finish {
               auto opened = std::make_shared<Opened>();
               Project project = read_project(path, progress);
               opened->document = std::move(project.document);
               opened->editor = std::move(project.editor);
               opened->name = "Copy of " + path.stem().string();
               opened->label = "Open a copy of " + path.filename().string();
               opened->unsaved = true;
               opened->agreed = agreed;
               opened->then = then;
               return [opened](Editor& e) { replace_project(e, opened); };
             });
}

void offer_copy(Editor& editor, const Path& path, Then then) {
  ask(editor,
      {.title = path.filename().string() + " is open in another Limber",
       .lines = {"Only one editor can write a project. Close the project there, or open a copy of its last save and "
                 "save the copy under another name."},
       .icon = icon::kInfo,
       .answers = {{"Cancel", {}}, {"Open a copy", [path, then](Editor& e) { open_copy(e, path, then); }, true}}});
}

std::string counted(std::int64_t edits) { return edits == 1 ? "1 edit" : std::to_string(edits) + " edits"; }

void forget_leftovers_of(Editor& editor, const Path& project) {
  std::erase_if(editor.life.recoverable, [&](const Recoverable& one) { return one.project == project; });
}

void recover_into_open(Editor& editor) {
  start_task(editor, "Recover edits", [session = editor.life.session](Progress& progress) -> Finish {
    auto recovered = std::make_shared<Recovered>(session->recover(progress));
    return [recovered, session](Editor& e) {
      if (e.life.session != session) return;
      commit(e, "Recover edits", recovered->document);
      for (const std::string& warning : recovered->warnings) e.messages.warn("Recovered in part", warning);
      forget_leftovers_of(e, session->path());
    };
  });
}

void offer_leftover(Editor& editor, bool wanted) {
  const auto session = editor.life.session;
  const auto leftover = session->leftover();
  if (!leftover) return;
  if (wanted) return recover_into_open(editor);
  const auto drop = [session](Editor& e) {
    session->drop_leftover();
    forget_leftovers_of(e, session->path());
  };
  ask(editor, {.title = session->path().stem().string() + " closed unexpectedly",
               .lines = {counted(leftover->edits) + " after the last save " + (leftover->edits == 1 ? "is" : "are") +
                         " kept for recovery. The last one: " + leftover->label + "."},
               .icon = icon::kSave,
               .answers = {{"Discard", drop}, {"Recover", recover_into_open, true}}});
}

// Saves the project's file when there have been unsaved edits for the interval set in the preferences. The journal
// stores every edit in any case; autosave is for users who want the project's file to be up to date too.
void autosave(Editor& editor) {
  ProjectLife& life = editor.life;
  if (!editor.history.unsaved() || editor.project_path.empty() || editor.preferences.autosave_minutes == 0)
    return life.unsaved_since.reset();
  if (!life.unsaved_since) life.unsaved_since = editor.now;
  const double due = *life.unsaved_since + 60.0 * editor.preferences.autosave_minutes;
  if (editor.now < due) return editor.wake_at(due);
  life.unsaved_since = editor.now;
  save_project(editor);
}

// Cancels the running modal tool, drag and button press, because they belong to the project that closes.
void end_gestures(Editor& editor) {
  if (const auto modal = std::exchange(editor.modal, nullptr)) modal->cancel(editor);
  if (const auto drag = std::exchange(editor.drag, std::nullopt); drag && drag->cancelled) drag->cancelled(editor);
  editor.pending_press.reset();
}

}  // namespace

void replace_project(Editor& editor, std::shared_ptr<Opened> opened) {
  // The user agreed to discard unsaved edits before the new file was read. If the user has made edits since then, ask
  // again.
  if (editor.history.unsaved() && editor.history.revision() != opened->agreed)
    return ask_about_unsaved(editor, [opened](Editor& e) {
      opened->agreed = e.history.revision();
      replace_project(e, opened);
    });
  end_gestures(editor);
  if (editor.life.session) editor.life.session->discard();
  ProjectLife life;
  life.session = opened->session;
  life.recoverable = std::move(editor.life.recoverable);
  editor.inputs = opened->inputs;
  editor.life = std::move(life);
  editor.history.reset(opened->document, opened->label);
  editor.life.kept_revision = editor.history.revision();
  if (opened->unsaved) {
    editor.history.mark_unsaved();
    editor.life.kept_revision = 0;
  }
  editor.project_path = opened->session ? opened->session->path() : Path();
  editor.name = opened->name;
  editor.selection = {};
  editor.start_screen = false;
  close_image(editor);
  if (opened->extents) editor.views->extents = opened->extents;
  frame_all(editor, false);
  try {
    if (!opened->editor.empty()) restore_editor_state(editor, opened->editor);
  } catch (const Error& error) {
    editor.messages.warn("Views and tools were reset", error.what());
  }
  editor.touch();
  if (opened->session) offer_leftover(editor, opened->recover);
  if (opened->then) opened->then(editor);
}

void ask_about_unsaved(Editor& editor, Then go_on) {
  if (!editor.history.unsaved()) return go_on(editor);
  const std::string name = editor.name.empty() ? "this project" : editor.name;
  ask(editor,
      {.title = "Save changes to " + name + "?",
       .lines = {"If you do not save, the edits since the last save are lost."},
       .icon = icon::kSave,
       .answers = {
           {"Cancel", {}}, {"Don't save", go_on}, {"Save", [go_on](Editor& e) { save_project(e, go_on); }, true}}});
}

void new_project(Editor& editor) {
  ask_about_unsaved(editor, [](Editor& e) {
    auto opened = std::make_shared<Opened>();
    opened->label = "New project";
    opened->agreed = e.history.revision();
    replace_project(e, opened);
  });
}

void open_project(Editor& editor, const Path& path, Then then, Leftover leftover) {
  std::error_code error;
  const Path file = std::filesystem::weakly_canonical(std::filesystem::absolute(path), error);
  if (editor.life.session && editor.life.session->path() == file && !error)
    return editor.messages.info(path.filename().string(), "This project is already open");
  ask_about_unsaved(editor, [file, then, leftover](Editor& e) {
    start_task(
        e, "Open " + file.filename().string(),
        [file, then, leftover, settings = settings_of(e), agreed = e.history.revision(),
         make_ready = body_maker(*e.views)](Progress& progress) -> Finish {
          auto opened = std::make_shared<Opened>();
          Project project;
          opened->session = Session::open(file, project, progress, settings);
          opened->document = std::move(project.document);
          opened->editor = std::move(project.editor);
          if (opened->document.volume)
            opened->extents = std::make_shared<const Extents>(extents_of(opened->document.volume));
          make_ready(opened->document, progress);
          opened->name = file.filename().string();
          opened->label = "Open " + file.filename().string();
          opened->agreed = agreed;
          opened->then = then;
          opened->recover = leftover == Leftover::Recover;
          return [opened, file, warnings = std::move(project.warnings)](Editor& ed) {
            for (const std::string& warning : warnings) ed.messages.warn(file.filename().string(), warning);
            add_recent(ed.recent_files, file, seconds_now());
            replace_project(ed, opened);
          };
        },
        [file, then](Editor& ed, const std::string& message) {
          if (message.starts_with(kInUse)) offer_copy(ed, file, then);
          else ed.messages.show_error(message);
        });
  });
}

// ---- saving

void ask_where_to_save(Editor& editor, Then then) {
  browse(editor,
         {.purpose = "project",
          .title = "Save the project",
          .action = "Save",
          .kind = FileRequest::Kind::Save,
          .filters = {{"Limber projects", {".limber"}}},
          .name = (editor.name.empty() ? std::string("Untitled") : Path(editor.name).stem().string()) + ".limber",
          .chosen = [then](Editor& e, const Path& path) { save_project_as(e, path, then); }});
}

void save_project(Editor& editor, Then then) {
  if (editor.project_path.empty()) return ask_where_to_save(editor, std::move(then));
  auto session = session_with_edits(editor);
  const auto project = std::make_shared<const Project>(project_of(editor));
  start_task(editor, "Save " + editor.project_path.filename().string(),
             [session, project, then, revision = editor.history.revision()](Progress& progress) -> Finish {
               const std::string remark = session->save(*project, progress);
               return [session, revision, remark, then](Editor& e) {
                 if (e.life.session == session) met_save(e, session->path(), revision, remark);
                 if (then) then(e);
               };
             });
}

void save_project_as(Editor& editor, const Path& path, Then then) {
  auto session = session_with_edits(editor);
  const auto project = std::make_shared<const Project>(project_of(editor));
  start_task(editor, "Save " + path.filename().string(),
             [session, project, path, then, revision = editor.history.revision()](Progress& progress) -> Finish {
               session->save_as(*project, path, progress);
               return [session, revision, then](Editor& e) {
                 if (e.life.session == session) met_save(e, session->path(), revision, "");
                 if (then) then(e);
               };
             });
}

void save_project_copy(Editor& editor, const Path& path) {
  const auto project = std::make_shared<const Project>(project_of(editor));
  start_task(editor, "Save " + path.filename().string(), [project, path](Progress& progress) -> Finish {
    Session::save_copy(*project, path, progress);
    return [path](Editor& e) { e.messages.ok("Copy saved", path.filename().string()); };
  });
}

// ---- recovery of edits left by sessions that ended in a crash

void look_for_leftovers(Editor& editor) {
  if (editor.folders.edits.empty()) return;
  start_task(editor, "", [folder = editor.folders.edits](Progress&) -> Finish {
    auto found = std::make_shared<std::vector<Recoverable>>(all_recoverable(folder));
    return [found](Editor& e) { e.life.recoverable = std::move(*found); };
  });
}

void recover(Editor& editor, const Recoverable& leftover) {
  std::error_code ignored;
  const Path beside = leftover.project.empty() ? Path() : journal_path(leftover.project);
  // If the project's file exists and the journal lies beside this file, opening the project recovers the edits.
  if (!leftover.project.empty() && std::filesystem::exists(leftover.project, ignored) && leftover.journal == beside)
    return open_project(editor, leftover.project, {}, Leftover::Recover);
  ask_about_unsaved(editor, [leftover](Editor& e) {
    start_task(
        e, "Recover edits",
        [leftover, settings = settings_of(e), agreed = e.history.revision(),
         folder = e.folders.edits](Progress& progress) -> Finish {
          Recovered recovered = limber::recover(leftover.journal, progress);
          auto opened = std::make_shared<Opened>();
          opened->document = recovered.document;
          opened->name = leftover.project.empty() ? "Recovered" : "Recovered " + leftover.project.stem().string();
          opened->label = "Recovered: " + recovered.label;
          opened->unsaved = true;
          opened->agreed = agreed;
          // The old journal is deleted only when the new one contains all recovered edits.
          opened->session = Session::start(settings);
          opened->session->keep(opened->document, opened->label);
          if (opened->session->flush(60)) limber::discard(leftover.journal, folder.empty() ? edits_folder() : folder);
          return [opened, leftover, warnings = recovered.warnings](Editor& ed) {
            for (const std::string& warning : warnings) ed.messages.warn("Recovered in part", warning);
            std::erase_if(ed.life.recoverable, [&](const Recoverable& one) { return one.journal == leftover.journal; });
            replace_project(ed, opened);
          };
        });
  });
}

void discard_leftover(Editor& editor, const Recoverable& leftover) {
  limber::discard(leftover.journal, editor.folders.edits.empty() ? edits_folder() : editor.folders.edits);
  std::erase_if(editor.life.recoverable, [&](const Recoverable& one) { return one.journal == leftover.journal; });
}

void keep_edits(Editor& editor) {
  ProjectLife& life = editor.life;
  autosave(editor);
  if (life.kept_revision != editor.history.revision() && !editor.folders.edits.empty()) {
    life.kept_revision = editor.history.revision();
    session_of(editor)->keep(editor.document(), editor.history.steps()[editor.history.position()].label);
  }
  if (!life.session) return;
  const std::string trouble = life.session->status().message;
  if (trouble == life.trouble) return;
  life.trouble = trouble;
  editor.touch();
  if (trouble.empty()) return editor.messages.ok("Edits are again saved for recovery after a crash");
  const auto description = trouble.find(". ");
  if (description != std::string::npos)
    return editor.messages.warn(trouble.substr(0, description), trouble.substr(description + 2));
  const ErrorMessage parts = parts_of(trouble);
  editor.messages.warn("Edits are not saved for recovery after a crash: " + parts.what,
                       parts.what_to_do.empty() ? parts.where : parts.what_to_do);
}

}  // namespace limber::editor
