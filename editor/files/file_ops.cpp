// SPDX-License-Identifier: AGPL-3.0-or-later
// Operators that create, open, save and recover projects, and quit the editor.
#include "editor/context/operator_polls.h"
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

void open(Editor& editor) {
  browse(editor, {.purpose = "open",
                  .title = "Open",
                  .action = "Open",
                  .filters = {readable_files(), {"Limber projects", {".limber"}}, volume_files()},
                  .takes_dicom = true,
                  .chosen = [](Editor& e, const Path& path) { open_files(e, {path}); }});
}

void show_start_screen(Editor& editor) {
  editor.start_screen = true;
  look_at_recents(editor);
  look_for_leftovers(editor);
}

void save_copy(Editor& editor) {
  browse(editor,
         {.purpose = "project",
          .title = "Save a copy",
          .action = "Save copy",
          .kind = FileRequest::Kind::Save,
          .filters = {{"Limber projects", {".limber"}}},
          .name = (editor.name.empty() ? std::string("Untitled") : Path(editor.name).stem().string()) + " copy.limber",
          .chosen = [](Editor& e, const Path& path) { save_project_copy(e, path); }});
}

void recover_latest(Editor& editor) {
  const std::vector<Recoverable> all = editor.life.recoverable;
  std::vector<Answer> answers{{"Cancel", {}}};
  const Recoverable latest = all.front();
  answers.push_back({"Discard", [latest](Editor& e) { discard_leftover(e, latest); }});
  answers.push_back({"Recover", [latest](Editor& e) { recover(e, latest); }, true});
  const std::string name = latest.project.empty() ? "An unnamed project" : latest.project.stem().string();
  ask(editor, {.title = "Recover unsaved edits",
               .lines = {name + " closed unexpectedly. " + std::to_string(latest.edits) +
                         " unsaved edits can be recovered. The last one: " + latest.label + "."},
               .icon = icon::kHistory,
               .answers = std::move(answers)});
}

void quit(Editor& editor) {
  ask_about_unsaved(editor, [](Editor& e) {
    if (e.life.session) e.life.session->discard();
    e.quit = true;
  });
}

Operator sample(const char* id, Sample which) {
  return {id,
          facts_of(which).name,
          icon::kVolume,
          "File",
          "Open a synthetic body to try the editor on.",
          [which](Editor& e) { open_sample(e, which); }};
}

std::string nothing_open(const Editor& editor) {
  return editor.document().volume || editor.document().armature || !editor.document().clips.empty()
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
       [](Editor& e) { save_project(e); }, nothing_open},
      {"file.save_as", "Save as...", "", "File", "Save the project under another name. Later edits go to the new file.",
       [](Editor& e) { ask_where_to_save(e); }, nothing_open},
      {"file.save_copy", "Save a copy...", "", "File",
       "Save a copy of the project under another name. Later edits stay in the current file.", save_copy, nothing_open},
      {"help.tour", "Tour", icon::kTour, "Help", "Show the main steps of the editor on a sample body.", start_tour},
      {"file.recover", "Recover...", icon::kHistory, "File", "Recover unsaved changes after a crash.", recover_latest,
       [](const Editor& e) {
         return e.life.recoverable.empty() ? std::string("There is nothing to recover") : std::string();
       }},
      {"file.quit", "Quit", icon::kClose, "File", "Close the editor. Limber asks whether to save unsaved changes.",
       quit},
  };
}

void name_recent_operators(Editor& editor) {
  std::erase_if(editor.operators, [](const Operator& op) { return op.id.starts_with("file.recent_"); });
  for (int i = 0; i < std::min<int>(kRecentOperators, std::ssize(editor.recent_files.recents)); ++i) {
    const Path path = editor.recent_files.recents[i].path;
    editor.operators.push_back({"file.recent_" + std::to_string(i + 1), path.filename().string(), icon::kHistory,
                                "File", "Open " + short_path(path) + ".",
                                [path](Editor& e) { open_files(e, {path}); }});
  }
}

}  // namespace limber::editor
