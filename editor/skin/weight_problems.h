// SPDX-License-Identifier: AGPL-3.0-or-later
// What is wrong with the document's weights: looked for beside the editor, listed, gone to, repaired one by one.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "core/skin/weight_problems.h"
#include "editor/context/editor.h"

namespace limber::editor {

struct FoundProblems {
  std::shared_ptr<const SkinWeights> in;  // the weights that were looked through; others: the list is stale
  std::shared_ptr<const Armature> armature;
  std::vector<WeightProblem> problems;
  std::vector<bool> repaired;  // by an edit that was made from here
};

// As a job; what it finds is shown in the sidebar. Needs weights of the rig.
void start_finding_problems(Editor& editor);
bool finds_problems(const Editor& editor);
// Edits were made since, other than repairs from the list.
bool problems_stale(const Editor& editor);

// The list with the problem chosen: its bone is active, the view and the cross-hair go to its place.
void go_to_problem(Editor& editor, int problem);
// One edit, beside the editor; says which lock was in the way where nothing changed.
void repair_problem(Editor& editor, int problem);

const char* name_of(WeightProblem::Kind kind);  // "Islands"

}  // namespace limber::editor
