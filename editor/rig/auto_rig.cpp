// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/rig/auto_rig.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numeric>

#include "core/autorig/place_in_tissue.h"
#include "core/base/error.h"
#include "core/rig_io/rig_templates.h"
#include "editor/context/background_task.h"
#include "editor/context/context.h"
#include "editor/context/dialogs.h"
#include "editor/context/document_edits.h"
#include "editor/dialogs/confirm_dialog.h"
#include "editor/dialogs/form_dialog.h"
#include "editor/rig/rig_edits.h"
#include "editor/shown/frame_all.h"
#include "editor/ui/icons.h"
#include "editor/ui/messages.h"
#include "editor/ui/ui.h"
#include "editor/volume/tissue_edits.h"

namespace limber::editor {

namespace {

constexpr double kMostlyInside = 0.5;

std::string percent(double share) { return std::to_string(static_cast<int>(std::lround(100 * share))) + " %"; }

// Returns the document with another rig and without the weights and the pose of the old rig.
Document with_rig(const Document& now, std::shared_ptr<const Armature> rig) {
  Document next = now;
  next.armature = std::move(rig);
  next.weights.reset();
  next.pose.reset();
  return next;
}

std::string what_goes(const Document& document) {
  const Document& now = document;
  std::string parts;
  for (const auto& [is_there, name] :
       {std::pair(now.armature != nullptr, "rig"), std::pair(now.weights != nullptr, "weights"),
        std::pair(now.pose != nullptr, "pose")})
    if (is_there) parts += (parts.empty() ? "" : ", ") + std::string(name);
  return parts.empty() ? "Runs in the background. You can undo the change."
                       : "Replaces: " + parts + ". You can undo the change.";
}

std::vector<std::string> template_labels() {
  std::vector<std::string> labels;
  for (const RigTemplate& one : rig_templates()) labels.push_back(one.label);
  return labels;
}

}  // namespace

void start_auto_fit(Context& context, const std::string& which) {
  const Document from = context.document();
  auto fitted = std::make_shared<AutoFit>();
  const int id = context.jobs->start("Auto-fit rig", [from, which, fitted](Progress& progress) -> Edit {
    const Armature rig = which == "rig"
                             ? *from.armature
                             : rig_template(which.empty() ? suggest_template(*from.volume, progress) : which);
    *fitted = fitted_or_placed(*from.volume, *from.tissues, rig, progress);
    auto laid = std::make_shared<const Armature>(fitted->armature);
    return [from, laid](const Document& now) {
      if (now.volume != from.volume)
        throw Error("the volume was changed meanwhile", "fitting the rig", "run the command again");
      return with_rig(now, laid);
    };
  });
  context.background->step_of_job[id] = StepOfWork::Rig;
  context.background->after_job[id] = [fitted, before = from.armature](Context& c, const JobStatus& job) {
    if (job.state != JobState::Done) return;
    show_fit(c.messages, *fitted);
    if (before) warn_of_moved_targets(c, "Rig fitted", *before, bones_of(*before, *c.document().armature));
  };
  context.ui->touch();
}

void offer_fit(Context& context, const std::string& file, double inside) {
  const auto place = [](Context& c) {
    const Document from = c.document();
    start_task(c, "Position the rig in the tissue", [from](Progress&) -> Finish {
      auto rig = std::make_shared<const Armature>(placed_in_tissue(*from.volume, *from.armature));
      return [from, rig](Context& c) {
        if (c.document().volume != from.volume || c.document().armature != from.armature)
          throw Error("the rig or the volume was changed meanwhile", "positioning the rig", "run the command again");
        commit(c, "Position rig", with_rig(c.document(), rig));
        warn_of_moved_targets(c, "Position rig", *from.armature, bones_of(*from.armature, *rig));
        frame_all(c, true);
      };
    });
  };
  ask(context, {.title = "This rig does not lie in the body",
                .lines = {percent(inside) + " of the length of its bones is in tissue. " + file +
                              " may belong to another body or use other units.",
                          "Fit rig finds the rig's joints in the volume if the names of its bones are recognised."},
                .icon = icon::kWarning,
                .answers = {{"Keep rig", {}},
                            {"Only position and scale", place},
                            {"Fit rig", [](Context& c) { start_auto_fit(c, "rig"); }, true}}});
}

void show_fit(Messages& messages, const AutoFit& fitted) {
  const auto sure = std::count_if(fitted.joints.begin(), fitted.joints.end(),
                                  [](const JointFit& joint) { return joint.confidence >= 0.5; });
  std::vector<std::size_t> order(fitted.joints.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return fitted.joints[a].confidence > fitted.joints[b].confidence;
  });
  // The least certain joints come last, because the console scrolls to its last line.
  for (std::size_t b : order) {
    char line[200];
    std::snprintf(line, sizeof line, "%s: found by %s, confidence %.0f %%, may be %.0f mm off, %.0f %% in tissue",
                  fitted.armature.bones[b].name.c_str(), std::string(to_string(fitted.joints[b].how)).c_str(),
                  100 * fitted.joints[b].confidence, fitted.joints[b].error, 100 * fitted.check.share[b]);
    messages.log.push_back({Severity::Info, line});
  }
  for (const std::string& warning : fitted.warnings) messages.warn("Check the fit", capitalized(warning));
  const std::string result = std::to_string(sure) + " of " + std::to_string(fitted.joints.size()) +
                             " joints found with confidence, " + percent(fitted.check.whole) +
                             " of bone length in tissue";
  if (sure > 0 && fitted.check.whole >= kMostlyInside) messages.ok("Rig fitted", result, "view.console");
  else
    messages.warn(sure > 0 ? "Rig fitted, but partly outside the body" : "Rig positioned, but every joint is uncertain",
                  result);
}

void ask_auto_fit(Context& context) {
  std::vector<std::string> choices{"Automatic"};
  for (const std::string& label : template_labels()) choices.push_back(label);
  if (context.document().armature) choices.push_back("The current rig");
  const auto outcome = [](const Context& c, const std::vector<FormField>&) { return what_goes(c.document()); };
  const auto act = [](Context& c, const std::vector<FormField>& fields) {
    const std::size_t chosen = static_cast<std::size_t>(fields[0].chosen);
    start_auto_fit(c, chosen == 0 ? "" : chosen <= rig_templates().size() ? rig_templates()[chosen - 1].name : "rig");
  };
  context.dialogs->open(
      make_form({"Auto-fit rig",
                 "Finds the joints from the bone tissue, or from the body's shape where no bone is labelled.",
                 "Fit",
                 {choice_of("Rig", "The rig to fit to the body in the volume.", choices)},
                 outcome,
                 act}));
}

void ask_template(Context& context) {
  const auto outcome = [](const Context& c, const std::vector<FormField>& fields) {
    return rig_templates()[fields[0].chosen].about + ". " + what_goes(c.document());
  };
  const auto act = [](Context& c, const std::vector<FormField>& fields) {
    const RigTemplate& chosen = rig_templates()[fields[0].chosen];
    auto rig = std::make_shared<const Armature>(scaled_to_tissue(*c.document().volume, rig_template(chosen.name)));
    const std::shared_ptr<const Armature> before = c.document().armature;
    c.history->commit("Add template " + chosen.label, with_rig(c.document(), rig));
    if (before) warn_of_moved_targets(c, "Add template " + chosen.label, *before, bones_of(*before, *rig));
    c.messages->ok("Add template " + chosen.label,
                   "The rig is scaled to the tissue. Use Auto-fit rig to find its joints");
  };
  context.dialogs->open(
      make_form({"Templates",
                 "Adds a rig, scaled to the tissue's bounding box. You can then move its joints by hand.",
                 "Add",
                 {choice_of("Rig", "The rig to add.", template_labels())},
                 outcome,
                 act}));
}

}  // namespace limber::editor
