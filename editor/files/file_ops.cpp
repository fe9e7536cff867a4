// SPDX-License-Identifier: AGPL-3.0-or-later
// Operators that create, open, save and recover projects, and quit the editor.
#include "editor/context/context.h"
#include "editor/context/open_project.h"
#include "editor/context/operator_polls.h"
#include "editor/context/operator_registry.h"
#include "editor/context/project_life.h"
#include "editor/context/recent_files.h"
#include "editor/context/start_screen_state.h"
#include "editor/context/user_folders.h"
#include "editor/context/window_state.h"
#include "editor/dialogs/confirm_dialog.h"
#include "editor/file_browser/file_browser.h"
#include "editor/file_browser/thumbnails.h"
#include "editor/files/file_filters.h"
#include "editor/files/import.h"
#include "editor/files/project_session.h"
#include "editor/files/tour.h"
#include "editor/ui/icons.h"

namespace limber::editor {

namespace {

void open(Context& context) {
  browse(context, {.purpose = "open",
                   .title = "Open",
                   .action = "Open",
                   .filters = {readable_files(), {"Limber projects", {".limber"}}, volume_files()},
                   .takes_dicom = true,
                   .chosen = [](Context& c, const Path& path) { open_files(c, {path}); }});
}

void show_start_screen(Context& context) {
  context.start_screen->shown = true;
  look_at_recents(context);
  look_for_leftovers(context);
}

void save_copy(Context& context) {
  browse(context, {.purpose = "project",
                   .title = "Save a copy",
                   .action = "Save copy",
                   .kind = FileRequest::Kind::Save,
                   .filters = {{"Limber projects", {".limber"}}},
                   .name = (context.project->name.empty() ? std::string("Untitled")
                                                          : Path(context.project->name).stem().string()) +
                           " copy.limber",
                   .chosen = [](Context& c, const Path& path) { save_project_copy(c, path); }});
}

void recover_latest(Context& context) {
  const std::vector<Recoverable> all = context.life->recoverable;
  std::vector<Answer> answers{{"Cancel", {}}};
  const Recoverable latest = all.front();
  answers.push_back({"Discard", [latest](Context& c) { discard_leftover(c, latest); }});
  answers.push_back({"Recover", [latest](Context& c) { recover(c, latest); }, true});
  const std::string name = latest.project.empty() ? "An unnamed project" : latest.project.stem().string();
  ask(context, {.title = "Recover unsaved edits",
                .lines = {name + " closed unexpectedly. " + std::to_string(latest.edits) +
                          " unsaved edits can be recovered. The last one: " + latest.label + "."},
                .icon = icon::kHistory,
                .answers = std::move(answers)});
}

void quit(Context& context) {
  ask_about_unsaved(context, [](Context& c) {
    if (c.life->session) c.life->session->discard();
    c.window->quit = true;
  });
}

Operator sample(const char* id, Sample which) {
  return {id,
          facts_of(which).name,
          icon::kVolume,
          "File",
          "Open a synthetic body to try the editor on.",
          [which](Context& c) { open_sample(c, which); }};
}

std::string nothing_open(const Context& context) {
  return context.document().volume || context.document().armature || !context.document().clips.empty()
             ? ""
             : "The project is empty: there is nothing to save";
}

}  // namespace

std::vector<Operator> file_operators() {
  return {
      {"file.new", "New", icon::kNew, "File", "Start an empty project.", new_project},
      {"file.open", "Open...", icon::kOpen, "File", "Open a project, or a volume, rig or motion as a new project.",
       open},
      {"file.open_recent", "Start screen", icon::kHistory, "File",
       "Show recent projects, samples and recoverable edits.", show_start_screen},
      sample("file.sample_arm", Sample::Arm),
      sample("file.sample_arm_xray", Sample::ArmXray),
      sample("file.sample_body", Sample::Body),
      sample("file.sample_body_open", Sample::BodyTissues),
      {"file.save", "Save", icon::kSave, "File", "Save the changes to the project's file.",
       [](Context& c) { save_project(c); }, nothing_open},
      {"file.save_as", "Save as...", "", "File", "Save the project under another name. Later edits go to the new file.",
       [](Context& c) { ask_where_to_save(c); }, nothing_open},
      {"file.save_copy", "Save a copy...", "", "File",
       "Save a copy of the project under another name. Later edits stay in the current file.", save_copy, nothing_open},
      {"help.tour", "Tour", icon::kTour, "Help", "Show the main steps of the editor on a sample body.", start_tour},
      {"file.recover", "Recover...", icon::kHistory, "File", "Recover unsaved changes after a crash.", recover_latest,
       [](const Context& c) {
         return c.life->recoverable.empty() ? std::string("There is nothing to recover") : std::string();
       }},
      {"file.quit", "Quit", icon::kClose, "File", "Close the editor. Limber asks whether to save unsaved changes.",
       quit},
  };
}

void name_recent_operators(Context& context) {
  std::erase_if(context.operators->all, [](const Operator& op) { return op.id.starts_with("file.recent_"); });
  for (int i = 0; i < std::min<int>(kRecentOperators, std::ssize(context.recent_files->recents)); ++i) {
    const Path path = context.recent_files->recents[i].path;
    context.operators->all.push_back({"file.recent_" + std::to_string(i + 1), path.filename().string(), icon::kHistory,
                                      "File", "Open " + short_path(path) + ".",
                                      [path](Context& c) { open_files(c, {path}); }});
  }
}

}  // namespace limber::editor
