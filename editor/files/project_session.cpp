// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/files/project_session.h"

#include <ctime>
#include <utility>

#include "core/base/error.h"
#include "editor/context/arriving_body.h"
#include "editor/context/background_task.h"
#include "editor/context/context.h"
#include "editor/context/document_edits.h"
#include "editor/context/interaction.h"
#include "editor/context/modal_tool.h"
#include "editor/context/open_project.h"
#include "editor/context/platform_window.h"
#include "editor/context/preferences.h"
#include "editor/context/project_life.h"
#include "editor/context/recent_files.h"
#include "editor/context/selection.h"
#include "editor/context/start_screen_state.h"
#include "editor/context/tissue_bounds.h"
#include "editor/context/user_folders.h"
#include "editor/dialogs/confirm_dialog.h"
#include "editor/file_browser/file_browser.h"
#include "editor/file_browser/thumbnails.h"
#include "editor/files/view_state_json.h"
#include "editor/shown/frame_all.h"
#include "editor/ui/icons.h"
#include "editor/ui/messages.h"
#include "editor/ui/ui.h"
#include "editor/volume/shown_image.h"

namespace limber::editor {

namespace {

constexpr const char* kInUse = "the project is open in another Limber";

std::int64_t seconds_now() { return static_cast<std::int64_t>(std::time(nullptr)); }

SessionSettings settings_of(Context& context) {
  return {.edits_folder = context.folders->edits, .on_change = [&host = *context.host] { host.wake(); }};
}

std::shared_ptr<Session> session_of(Context& context) {
  if (!context.life->session) context.life->session = Session::start(settings_of(context));
  return context.life->session;
}

Project project_of(Context& context) {
  Project project;
  project.document = context.document();
  project.editor = editor_state(context);
  project.thumbnail = thumbnail_png(context);
  return project;
}

// Updates the editor after a save: marks the saved revision in the history, and sets the project's path and name. Shows
// `remark` as a message unless it is empty. Call this in the editor's thread.
void met_save(Context& context, const Path& path, std::int64_t revision, const std::string& remark) {
  context.history->mark_saved(revision);
  context.life->saved_at = seconds_now();
  context.project->path = path;
  context.project->name = path.filename().string();
  add_recent(context.recent_files, path, context.life->saved_at);
  if (!remark.empty()) context.messages->info(path.filename().string(), remark);
}

// Writes the latest document to the session's journal and returns the session. Called before a save, so that no edits
// are lost if the save fails.
std::shared_ptr<Session> session_with_edits(Context& context) {
  auto session = session_of(context);
  session->keep(context.document(), context.history->steps()[context.history->position()].label);
  context.life->kept_revision = context.history->revision();
  return session;
}

void open_copy(Context& context, const Path& path, Then then) {
  start_task(context, "Open a copy of " + path.filename().string(),
             [path, then, agreed = context.history->revision()](Progress& progress) -> Finish {
               auto opened = std::make_shared<Opened>();
               Project project = read_project(path, progress);
               opened->document = std::move(project.document);
               opened->editor = std::move(project.editor);
               opened->name = "Copy of " + path.stem().string();
               opened->label = "Open a copy of " + path.filename().string();
               opened->unsaved = true;
               opened->agreed = agreed;
               opened->then = then;
               return [opened](Context& c) { replace_project(c, opened); };
             });
}

void offer_copy(Context& context, const Path& path, Then then) {
  ask(context,
      {.title = path.filename().string() + " is open in another Limber",
       .lines = {"Only one editor can write a project. Close the project there, or open a copy of its last save and "
                 "save the copy under another name."},
       .icon = icon::kInfo,
       .answers = {{"Cancel", {}}, {"Open a copy", [path, then](Context& c) { open_copy(c, path, then); }, true}}});
}

std::string counted(std::int64_t edits) { return edits == 1 ? "1 edit" : std::to_string(edits) + " edits"; }

void forget_leftovers_of(ProjectLife& life, const Path& project) {
  std::erase_if(life.recoverable, [&](const Recoverable& one) { return one.project == project; });
}

void recover_into_open(Context& context) {
  start_task(context, "Recover edits", [session = context.life->session](Progress& progress) -> Finish {
    auto recovered = std::make_shared<Recovered>(session->recover(progress));
    return [recovered, session](Context& c) {
      if (c.life->session != session) return;
      commit(c, "Recover edits", recovered->document);
      for (const std::string& warning : recovered->warnings) c.messages->warn("Recovered in part", warning);
      forget_leftovers_of(c.life, session->path());
    };
  });
}

void offer_leftover(Context& context, bool wanted) {
  const auto session = context.life->session;
  const auto leftover = session->leftover();
  if (!leftover) return;
  if (wanted) return recover_into_open(context);
  const auto drop = [session](Context& c) {
    session->drop_leftover();
    forget_leftovers_of(c.life, session->path());
  };
  ask(context, {.title = session->path().stem().string() + " closed unexpectedly",
                .lines = {counted(leftover->edits) + " after the last save " + (leftover->edits == 1 ? "is" : "are") +
                          " kept for recovery. The last one: " + leftover->label + "."},
                .icon = icon::kSave,
                .answers = {{"Discard", drop}, {"Recover", recover_into_open, true}}});
}

// Saves the project's file when there have been unsaved edits for the interval set in the preferences. The journal
// stores every edit in any case; autosave is for users who want the project's file to be up to date too.
void autosave(Context& context) {
  ProjectLife& life = context.life;
  if (!context.history->unsaved() || context.project->path.empty() || context.preferences->autosave_minutes == 0)
    return life.unsaved_since.reset();
  if (!life.unsaved_since) life.unsaved_since = context.ui->now;
  const double due = *life.unsaved_since + 60.0 * context.preferences->autosave_minutes;
  if (context.ui->now < due) return context.ui->wake_at(due);
  life.unsaved_since = context.ui->now;
  save_project(context);
}

// Cancels the running modal tool, drag and button press, because they belong to the project that closes.
void end_gestures(Context& context) {
  if (const auto modal = std::exchange(context.interaction->modal, nullptr)) modal->cancel(context);
  if (const auto drag = std::exchange(context.interaction->drag, std::nullopt); drag && drag->cancelled)
    drag->cancelled(context);
  context.interaction->pending_press.reset();
}

}  // namespace

void replace_project(Context& context, std::shared_ptr<Opened> opened) {
  // The user agreed to discard unsaved edits before the new file was read. If the user has made edits since then, ask
  // again.
  if (context.history->unsaved() && context.history->revision() != opened->agreed)
    return ask_about_unsaved(context, [opened](Context& c) {
      opened->agreed = c.history->revision();
      replace_project(c, opened);
    });
  end_gestures(context);
  if (context.life->session) context.life->session->discard();
  ProjectLife life;
  life.session = opened->session;
  life.recoverable = std::move(context.life->recoverable);
  context.project->inputs = opened->inputs;
  *context.life = std::move(life);
  context.history->reset(opened->document, opened->label);
  context.life->kept_revision = context.history->revision();
  if (opened->unsaved) {
    context.history->mark_unsaved();
    context.life->kept_revision = 0;
  }
  context.project->path = opened->session ? opened->session->path() : Path();
  context.project->name = opened->name;
  *context.selection = {};
  context.start_screen->shown = false;
  close_image(context);
  if (opened->extents) context.views->extents = opened->extents;
  frame_all(context, false);
  try {
    if (!opened->editor.empty()) restore_editor_state(context, opened->editor);
  } catch (const Error& error) {
    context.messages->warn("Views and tools were reset", error.what());
  }
  context.ui->touch();
  if (opened->session) offer_leftover(context, opened->recover);
  if (opened->then) opened->then(context);
}

void ask_about_unsaved(Context& context, Then go_on) {
  if (!context.history->unsaved()) return go_on(context);
  const std::string name = context.project->name.empty() ? "this project" : context.project->name;
  ask(context,
      {.title = "Save changes to " + name + "?",
       .lines = {"If you do not save, the edits since the last save are lost."},
       .icon = icon::kSave,
       .answers = {
           {"Cancel", {}}, {"Don't save", go_on}, {"Save", [go_on](Context& c) { save_project(c, go_on); }, true}}});
}

void new_project(Context& context) {
  ask_about_unsaved(context, [](Context& c) {
    auto opened = std::make_shared<Opened>();
    opened->label = "New project";
    opened->agreed = c.history->revision();
    replace_project(c, opened);
  });
}

void open_project(Context& context, const Path& path, Then then, Leftover leftover) {
  std::error_code error;
  const Path file = std::filesystem::weakly_canonical(std::filesystem::absolute(path), error);
  if (context.life->session && context.life->session->path() == file && !error)
    return context.messages->info(path.filename().string(), "This project is already open");
  ask_about_unsaved(context, [file, then, leftover](Context& c) {
    start_task(
        c, "Open " + file.filename().string(),
        [file, then, leftover, settings = settings_of(c), agreed = c.history->revision(),
         make_ready = body_maker(*c.views)](Progress& progress) -> Finish {
          auto opened = std::make_shared<Opened>();
          Project project;
          opened->session = Session::open(file, project, progress, settings);
          opened->document = std::move(project.document);
          opened->editor = std::move(project.editor);
          if (opened->document.volume)
            opened->extents = std::make_shared<const Extents>(extents_of(opened->document.volume));
          make_ready(opened->document, progress, {});
          opened->name = file.filename().string();
          opened->label = "Open " + file.filename().string();
          opened->agreed = agreed;
          opened->then = then;
          opened->recover = leftover == Leftover::Recover;
          return [opened, file, warnings = std::move(project.warnings)](Context& c) {
            for (const std::string& warning : warnings) c.messages->warn(file.filename().string(), warning);
            add_recent(c.recent_files, file, seconds_now());
            replace_project(c, opened);
          };
        },
        [file, then](Context& c, const std::string& message) {
          if (message.starts_with(kInUse)) offer_copy(c, file, then);
          else c.messages->show_error(message);
        });
  });
}

// ---- Saving the project

void ask_where_to_save(Context& context, Then then) {
  browse(context, {.purpose = "project",
                   .title = "Save the project",
                   .action = "Save",
                   .kind = FileRequest::Kind::Save,
                   .filters = {{"Limber projects", {".limber"}}},
                   .name = (context.project->name.empty() ? std::string("Untitled")
                                                          : Path(context.project->name).stem().string()) +
                           ".limber",
                   .chosen = [then](Context& c, const Path& path) { save_project_as(c, path, then); }});
}

void save_project(Context& context, Then then) {
  if (context.project->path.empty()) return ask_where_to_save(context, std::move(then));
  auto session = session_with_edits(context);
  const auto project = std::make_shared<const Project>(project_of(context));
  start_task(context, "Save " + context.project->path.filename().string(),
             [session, project, then, revision = context.history->revision()](Progress& progress) -> Finish {
               const std::string remark = session->save(*project, progress);
               return [session, revision, remark, then](Context& c) {
                 if (c.life->session == session) met_save(c, session->path(), revision, remark);
                 if (then) then(c);
               };
             });
}

void save_project_as(Context& context, const Path& path, Then then) {
  auto session = session_with_edits(context);
  const auto project = std::make_shared<const Project>(project_of(context));
  start_task(context, "Save " + path.filename().string(),
             [session, project, path, then, revision = context.history->revision()](Progress& progress) -> Finish {
               session->save_as(*project, path, progress);
               return [session, revision, then](Context& c) {
                 if (c.life->session == session) met_save(c, session->path(), revision, "");
                 if (then) then(c);
               };
             });
}

void save_project_copy(Context& context, const Path& path) {
  const auto project = std::make_shared<const Project>(project_of(context));
  start_task(context, "Save " + path.filename().string(), [project, path](Progress& progress) -> Finish {
    Session::save_copy(*project, path, progress);
    return [path](Context& c) { c.messages->ok("Copy saved", path.filename().string()); };
  });
}

// ---- Recovery of edits left by sessions that ended in a crash

void look_for_leftovers(Context& context) {
  if (context.folders->edits.empty()) return;
  start_task(context, "", [folder = context.folders->edits](Progress&) -> Finish {
    auto found = std::make_shared<std::vector<Recoverable>>(all_recoverable(folder));
    return [found](Context& c) { c.life->recoverable = std::move(*found); };
  });
}

void recover(Context& context, const Recoverable& leftover) {
  std::error_code ignored;
  const Path beside = leftover.project.empty() ? Path() : journal_path(leftover.project);
  // If the project's file exists and the journal lies beside this file, opening the project recovers the edits.
  if (!leftover.project.empty() && std::filesystem::exists(leftover.project, ignored) && leftover.journal == beside)
    return open_project(context, leftover.project, {}, Leftover::Recover);
  ask_about_unsaved(context, [leftover](Context& c) {
    start_task(
        c, "Recover edits",
        [leftover, settings = settings_of(c), agreed = c.history->revision(),
         folder = c.folders->edits](Progress& progress) -> Finish {
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
          return [opened, leftover, warnings = recovered.warnings](Context& c) {
            for (const std::string& warning : warnings) c.messages->warn("Recovered in part", warning);
            std::erase_if(c.life->recoverable, [&](const Recoverable& one) { return one.journal == leftover.journal; });
            replace_project(c, opened);
          };
        });
  });
}

void discard_leftover(Context& context, const Recoverable& leftover) {
  limber::discard(leftover.journal, context.folders->edits.empty() ? edits_folder() : context.folders->edits);
  std::erase_if(context.life->recoverable, [&](const Recoverable& one) { return one.journal == leftover.journal; });
}

void keep_edits(Context& context) {
  ProjectLife& life = context.life;
  autosave(context);
  if (life.kept_revision != context.history->revision() && !context.folders->edits.empty()) {
    life.kept_revision = context.history->revision();
    session_of(context)->keep(context.document(), context.history->steps()[context.history->position()].label);
  }
  if (!life.session) return;
  const std::string trouble = life.session->status().message;
  if (trouble == life.trouble) return;
  life.trouble = trouble;
  context.ui->touch();
  if (trouble.empty()) return context.messages->ok("Edits are again saved for recovery after a crash");
  const auto description = trouble.find(". ");
  if (description != std::string::npos)
    return context.messages->warn(trouble.substr(0, description), trouble.substr(description + 2));
  const ErrorMessage parts = parts_of(trouble);
  context.messages->warn("Edits are not saved for recovery after a crash: " + parts.what,
                         parts.what_to_do.empty() ? parts.where : parts.what_to_do);
}

}  // namespace limber::editor
