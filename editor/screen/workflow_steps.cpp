// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/screen/workflow_steps.h"

#include "editor/context/background_task.h"
#include "editor/context/context.h"
#include "editor/context/keep_preferences.h"
#include "editor/context/operator.h"
#include "editor/context/operator_button.h"
#include "editor/context/panels.h"
#include "editor/context/preferences.h"
#include "editor/context/views.h"
#include "editor/resample/resample_job.h"
#include "editor/resample/results.h"
#include "editor/seams/seam_view.h"
#include "editor/ui/icons.h"
#include "editor/volume/image_labels.h"
#include "editor/volume/volume_edits.h"

namespace limber::editor {

namespace {

// Returns a text that names the running job of a workflow step and the job's stage, such as "Heat diffusion, weights".
// Returns "" if no job of this step is running.
std::string at_work(const Context& context, StepOfWork step) {
  for (const JobStatus& job : context.jobs->statuses()) {
    const auto known = context.background->step_of_job.find(job.id);
    if (job.active() && known != context.background->step_of_job.end() && known->second == step)
      return job.label + ", " + (job.stage.empty() ? "waiting" : job.stage);
  }
  return "";
}

Step prepare_step(const Context& context) {
  Step step{"Prepare", StepState::Later, "No volume is open", "file.open", "Open...", {}};
  const Document& document = context.document();
  if (!document.volume) return step;
  if ((!document.tissues || document.tissues->tissues.empty()) && context.views->image) {
    // An image without labels (a bare CT or MR) has no tissue that could move with bones. The step offers only the
    // operators that change the grid or paint labels, not those that need tissue.
    step.line = "No labels yet";
    step.operator_id = labels_operator(context.views);
    step.button = find_operator(context.operators, step.operator_id)->label;
    step.more = {"labels.new_tissue",        "labels.brush", "prepare.regrid",
                 "prepare.crop_to_clip_box", "prepare.pad",  "prepare.orient"};
    return step;
  }
  step.state = StepState::Done;
  const std::size_t tissues = document.tissues ? document.tissues->tissues.size() : 0;
  step.line = std::to_string(tissues) + (tissues == 1 ? " tissue" : " tissues");
  step.operator_id = "prepare.statistics";
  step.button = "Statistics";
  step.more = {"prepare.regrid", "prepare.crop",  "prepare.crop_to_clip_box", "prepare.pad",
               "prepare.orient", "prepare.merge", "prepare.specks",           "labels.brush"};
  return step;
}

Step rig_step(const Document& document) {
  Step step{"Rig",          StepState::Later, "No rig yet",
            "rig.auto_fit", "Auto-fit",       {"rig.auto_fit", "rig.templates", "file.import_rig"}};
  if (!document.armature) return step;
  step.state = StepState::Done;
  const std::size_t bones = document.armature->bones.size();
  step.line = std::to_string(bones) + (bones == 1 ? " bone" : " bones");
  return step;
}

Step skin_step(const Context& context) {
  Step step{"Skin",      StepState::Later, "No weights yet",
            "skin.heat", "Compute",        {"skin.heat", "skin.geodesic", "skin.rigid", "skin.drop_weights"}};
  const Document& document = context.document();
  if (!document.weights) return step;
  step.state = StepState::Done;
  step.line = grouped(document.weights->size()) + " voxels";
  if (document.armature && document.weights->bones().size() != document.armature->bones.size()) {
    step.state = StepState::Warning;
    step.line = "The weights belong to another rig";
  } else if (const std::string why = why_weights_are_old(context); !why.empty()) {
    step.state = StepState::Warning;
    step.line = why;
  }
  return step;
}

Step pose_step(const Document& document) {
  Step step{"Pose",      StepState::Later, "At rest",
            "pose.flex", "Flex...",        {"pose.flex", "file.import_pose", "pose.clear"}};
  if (!document.armature || !document.pose || *document.pose == rest_pose(*document.armature)) return step;
  step.state = StepState::Done;
  step.line = name_of_pose(*document.armature, *document.pose);
  return step;
}

Step resample_step(const Document& document) {
  Step step{"Resample",     StepState::Later, "Not resampled yet",
            "resample.run", "Resample",       method_operators(Methods::All)};
  step.more.push_back("result.toggle");
  // Describe the newest result of this pose that is up to date. If all results of this pose are stale (an input has
  // changed since), describe the newest of them.
  for (auto at = document.results.rbegin(); at != document.results.rend(); ++at) {
    const auto& result = *at;
    if (!is_of_this_pose(document, *result)) continue;
    const std::string reason = stale_reason(document, *result);
    if (!reason.empty() && step.state == StepState::Warning) continue;
    step.state = reason.empty() ? StepState::Done : StepState::Warning;
    step.line = reason.empty() ? result->name : "Stale: " + reason;
    if (reason.empty()) break;
  }
  return step;
}

// Heights of a step and of a row of small buttons; width of a step's number with the gap after it; px at scale 1.
constexpr float kRow = 40, kMore = 26, kNumber = 16;

struct Sign {
  const char* icon;
  Colour colour;
};
Sign sign_of(const Theme& theme, StepState state) {
  switch (state) {
    case StepState::Done: return {icon::kOk, theme.ok};
    case StepState::Next: return {icon::kNext, theme.accent_text};
    case StepState::Working: return {icon::kRunning, theme.accent_text};
    case StepState::Warning: return {icon::kWarning, theme.warn};
    case StepState::Later: break;
  }
  return {icon::kWaiting, theme.text3};
}

void draw_step(Context& context, Column& column, const Step& step, int number) {
  const Look& look = context.ui->look;
  const Rect row = column.row(kRow);
  const PathScope path(context.ui, step.title);
  const Sign sign = sign_of(look.theme, step.state);
  put_icon(look.fonts.regular, sign.colour,
           Rect{{row.low.x + look.px(8), row.low.y}, {row.low.x + look.px(28), row.high.y}}, sign.icon);

  const Operator* op = find_operator(context.operators, step.operator_id);
  const bool next = step.state == StepState::Next;
  const float text = std::ceil(text_size(look.fonts.regular, step.button).x) + look.px(20);
  const float width = op && !step.button.empty() && step.state != StepState::Working ? std::max(look.px(88), text) : 0;
  const Rect place{{row.high.x - look.px(10) - width, row.low.y + look.px(7)},
                   {row.high.x - look.px(10), row.high.y - look.px(7)}};
  const float left = row.low.x + look.px(34), right = width > 0 ? place.low.x - look.px(8) : row.high.x - look.px(10),
              middle = row.centre().y;
  ImFont* font = next ? look.fonts.semibold : look.fonts.regular;
  const Colour colour = step.state == StepState::Later ? look.theme.text2 : look.theme.text;
  const float title = left + look.px(kNumber);
  put_text(context.ui, font, colour, Rect{{left, middle - look.px(18)}, {title, middle}}, std::to_string(number));
  put_text(context.ui, font, colour, Rect{{title, middle - look.px(18)}, {right, middle}}, step.title);
  put_text(context.ui, look.fonts.small, step.state == StepState::Warning ? look.theme.warn : look.theme.text2,
           Rect{{left, middle}, {right, middle + look.px(16)}}, step.line);
  if (width <= 0) return;
  const bool enabled = disabled_reason(context, *op).empty();
  if (button(context.ui, step.button, place,
             {"", step.button, next && enabled ? ButtonStyle::Primary : ButtonStyle::Plain, enabled}))
    run(context, *op);
  if (ImGui::IsItemHovered(ImGuiHoveredFlags_AllowWhenDisabled)) operator_tooltip(context, *op, place);
}

// Draws the additional operators of a step as small buttons, in as many rows as needed.
void draw_more(Context& context, Column& column, const Step& step) {
  const Look& look = context.ui->look;
  const PathScope path(context.ui, step.title + " more");
  Rect row = column.row(kMore);
  float x = row.low.x + look.px(34);
  for (const std::string& id : step.more) {
    const Operator* op = find_operator(context.operators, id);
    if (!op) continue;
    const bool on = op->checked && op->checked(context);
    const float width = text_size(look.fonts.regular, full_label(*op)).x + look.px(14);
    if (x + width > row.high.x - look.px(10)) {
      row = column.row(kMore);
      x = row.low.x + look.px(34);
    }
    const Rect place{{x, row.low.y + look.px(1)}, {x + width, row.high.y - look.px(1)}};
    const bool enabled = disabled_reason(context, *op).empty();
    if (button(context.ui, id, place, {"", full_label(*op), on ? ButtonStyle::Soft : ButtonStyle::Plain, enabled}))
      run(context, *op);
    if (ImGui::IsItemHovered(ImGuiHoveredFlags_AllowWhenDisabled)) operator_tooltip(context, *op, place);
    x += width + look.px(4);
  }
  column.space(6);
}

}  // namespace

std::vector<Step> steps(const Context& context) {
  std::vector<Step> all = {prepare_step(context), rig_step(context.document()), skin_step(context),
                           pose_step(context.document()), resample_step(context.document())};
  bool found = false;
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (const std::string working = at_work(context, static_cast<StepOfWork>(i)); !working.empty()) {
      all[i].state = StepState::Working;
      all[i].line = working;
      found = true;
    }
    if (found || all[i].state == StepState::Done) continue;
    if (all[i].state == StepState::Later) all[i].state = StepState::Next;
    found = true;
  }
  return all;
}

void draw_steps(Context& context, Column& column) {
  const Look& look = context.ui->look;
  const bool open = column.begin_section("Steps");
  const Rect head = column.head();
  const bool advanced = context.preferences->advanced_steps;
  const Rect place{{head.high.x - look.px(88), head.low.y + look.px(4)},
                   {head.high.x - look.px(10), head.high.y - look.px(3)}};
  if (button(context.ui, "Advanced", place, {"", "Advanced", advanced ? ButtonStyle::Soft : ButtonStyle::Flat})) {
    context.preferences->advanced_steps = !advanced;
    keep_preferences(context);
  }
  if (ImGui::IsItemHovered())
    tooltip(context.ui, place, advanced ? "Basic" : "Advanced",
            advanced ? "Show only the main button of each step." : "Show all tools of each step.");
  if (open) {
    int number = 1;
    for (const Step& step : steps(context)) {
      draw_step(context, column, step, number++);
      if (context.preferences->advanced_steps && !step.more.empty()) draw_more(context, column, step);
    }
    column.space(4);
  }
  column.end_section();
}

}  // namespace limber::editor
