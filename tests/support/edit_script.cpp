// SPDX-License-Identifier: AGPL-3.0-or-later
#include "tests/support/edit_script.h"

#include <chrono>
#include <random>
#include <thread>

#include "tests/support/documents.h"

namespace limber::test {

Document edit_script_start() {
  Document document = small_document();
  document.weights = nullptr;
  document.layers = nullptr;
  document.results.clear();
  // The weights are large (1 MB), so that writing them takes some time.
  const Document large = large_document(1);
  document.volume = large.volume;
  document.seams = nullptr;  // the seams belonged to the small volume
  document.weights = large.weights;
  document.pose = std::make_shared<const Pose>(rest_pose(*document.armature));
  return document;
}

int edit_of(const Document& document) { return static_cast<int>(document.pose->root_translation.x); }

void run_edit_script(const Path& path, const SessionSettings& settings, const EditScript& script) {
  std::mt19937 random(script.seed);
  Project project;
  const auto session = Session::open(path, project, no_progress(), settings);
  if (session->leftover()) project.document = session->recover().document;
  for (int edit = edit_of(project.document) + 1; edit <= script.edits; ++edit) {
    project.document = random_edit(project.document, random);
    Pose pose = *project.document.pose;
    pose.root_translation.x = edit;
    project.document.pose = std::make_shared<const Pose>(std::move(pose));
    session->keep(project.document, "Edit " + std::to_string(edit));
    if (script.after_edit) script.after_edit(edit);
    if (random() % 40 == 0) session->save(project);
    const double pause = script.pause * static_cast<double>(random() % 2000) / 1000;
    std::this_thread::sleep_for(std::chrono::duration<double>(pause));
    if (script.after_pause) script.after_pause(edit, session->status().kept);
  }
}

}  // namespace limber::test
