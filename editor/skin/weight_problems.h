// SPDX-License-Identifier: AGPL-3.0-or-later
// Finds problems of the document's weights in a job, lists them, moves the views to a selected problem, and repairs
// problems one at a time.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "core/project/job.h"
#include "core/skin/weight_problems.h"

namespace limber::editor {

struct Context;

struct FoundProblems {
  std::shared_ptr<const SkinWeights> in;  // the weights in which the problems were found
  std::shared_ptr<const Armature> armature;
  std::vector<WeightProblem> problems;
  std::vector<bool> repaired;  // for each problem, true if the user has repaired it with its button in the list
};

// Returns why the weights cannot be searched or repaired (they are not shown, or belong to another rig); "" if they
// can.
std::string why_not_these_weights(const Context& context);

// Starts a job that searches the weights for problems, which the sidebar then lists. The weights must belong to the
// rig.
void start_finding_problems(Context& context);
bool finds_problems(const Jobs& jobs);
// Returns true if the weights or the rig have changed since the search for problems, other than by repairs from the
// list.
bool problems_stale(const Context& context);

// Selects the problem in the list, makes its bone active, and moves the view and the crosshair to its position.
void go_to_problem(Context& context, int problem);
// Repairs the problem in a job, as one edit. If locked bones prevent the repair, tells the user so.
void repair_problem(Context& context, int problem);

const char* name_of(WeightProblem::Kind kind);  // returns the heading of the problems of this kind, such as "Islands"

}  // namespace limber::editor
