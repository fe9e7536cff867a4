// SPDX-License-Identifier: AGPL-3.0-or-later
// Draws the progress of the running jobs in a slot of the status bar. A click on the slot opens a list of all jobs. A
// row of the list shows a job's stage and its time left, and has a Cancel button.
#include "editor/screen/job_progress.h"

#include <algorithm>
#include <cctype>
#include <cmath>

#include "editor/context/background_task.h"
#include "editor/context/context.h"
#include "editor/context/panels.h"
#include "editor/context/preferences.h"
#include "editor/context/resampling_settings.h"
#include "editor/shown/fem_live_view.h"
#include "editor/ui/icons.h"

namespace limber::editor {

namespace {

constexpr double kFirstEstimate = 3;                    // running time of a job after which its time left is shown, s
constexpr double kQuickEnd = 0.1;                       // delay from Cancel until a job is shown as stopping, s
constexpr double kSpin = 1.0 / 12;                      // time between two steps of the spinner, s
constexpr float kRowHeight = 62, kSolveRowHeight = 80;  // height of a job's row; of a FEM solve's row; px at scale 1

std::vector<JobStatus> at_work(const Context& context) {
  std::vector<JobStatus> jobs = context.jobs->statuses();
  std::erase_if(jobs, [](const JobStatus& job) { return !job.active() || job.label.empty(); });
  return jobs;
}

float row_height(const FemView& fem, const JobStatus& job) {
  return fem.solves.contains(job.id) ? kSolveRowHeight : kRowHeight;
}

// Returns the time left of a job, s. A FEM solve estimates its time left itself. For other jobs, and while the solve
// has no estimate yet, the time is estimated from the job's progress.
std::optional<double> seconds_left(const FemView& fem, const JobStatus& job) {
  const auto solve = fem.solves.find(job.id);
  if (solve != fem.solves.end())
    if (const auto left = solve->second.feed->seen().progress.seconds_left) return left;
  return job.seconds_left;
}

std::string state_of(Context& context, const JobStatus& job) {
  if (job.state == JobState::Queued) return "Waiting";
  std::string stage = job.stage.empty() ? "starting" : job.stage;
  stage[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(stage[0])));
  if (job.state != JobState::Stopping) return stage;
  const double since = context.background->stopping_since.try_emplace(job.id, context.ui->now).first->second;
  context.ui->wake_at(since + kQuickEnd);
  return context.ui->now - since >= kQuickEnd ? "Stopping" : stage;
}

void draw_spinner(Context& context, const glm::vec2& centre, float radius) {
  const Look& look = context.ui->look;
  const int step = context.preferences->reduce_motion ? 0 : static_cast<int>(std::floor(context.ui->now / kSpin));
  for (int i = 0; i < 12; i += 2) {
    const float angle = static_cast<float>(i + step % 12) * 0.5235988f;
    ImGui::GetWindowDrawList()->AddCircleFilled(
        im(centre + radius * glm::vec2(std::cos(angle), std::sin(angle))), std::max(1.0f, radius * 0.24f),
        with_alpha(look.theme.accent_text, 0.25f + 0.07f * static_cast<float>(i)), 8);
  }
  if (!context.preferences->reduce_motion) context.ui->wake_at(context.ui->now + kSpin);
}

void draw_track(const Ui& ui, const Rect& track, double fraction) {
  const Look& look = ui.look;
  fill(track, look.theme.field, track.height() / 2);
  const float width = track.width() * static_cast<float>(std::clamp(fraction, 0.0, 1.0));
  if (width >= 1)
    fill({track.low, {track.low.x + std::max(width, track.height()), track.high.y}}, look.theme.accent,
         track.height() / 2);
}

void draw_job_row(Context& context, const JobStatus& job, const Rect& row) {
  const Look& look = context.ui->look;
  const PathScope path(context.ui, job.label);
  const float left = row.low.x + look.px(10), right = row.high.x - look.px(10);
  const Rect cancel{{right - look.px(84), row.high.y - look.px(30)}, {right, row.high.y - look.px(6)}};
  const float line = row.low.y + look.px(20);
  if (const auto solve = context.fem->solves.find(job.id); solve != context.fem->solves.end())
    put_text(context.ui, look.fonts.small, look.theme.text2,
             Rect{{left, line + look.px(10)}, {right, line + look.px(28)}}, progress_text(solve->second));
  char percent[16];
  std::snprintf(percent, sizeof percent, "%.0f %%", 100 * job.fraction);
  put_text(context.ui, look.fonts.semibold, look.theme.text,
           Rect{{left, row.low.y + look.px(2)}, {right - look.px(50), line}}, job.label);
  if (job.state != JobState::Queued)
    put_text(context.ui, look.fonts.mono, look.theme.accent_text,
             Rect{{right - look.px(50), row.low.y + look.px(2)}, {right, line}}, percent, Align::Right);
  draw_track(context.ui, {{left, line + look.px(3)}, {right, line + look.px(8)}}, job.fraction);
  float end = cancel.low.x - look.px(8);
  if (const auto time = seconds_left(context.fem, job); time && job.seconds >= kFirstEstimate) {
    const std::string words = time_left_text(*time) + " left";
    const float begin = end - text_size(look.fonts.small, words).x - 1;
    put_text(context.ui, look.fonts.small, look.theme.text2, Rect{{begin, cancel.low.y}, {end, cancel.high.y}}, words);
    end = begin - look.px(8);
  }
  put_text(context.ui, look.fonts.small, look.theme.text2, Rect{{left, cancel.low.y}, {end, cancel.high.y}},
           state_of(context, job));
  const bool stopping = job.state == JobState::Stopping;
  if (button(context.ui, "Cancel", cancel, {icon::kClose, "Cancel", ButtonStyle::Plain, !stopping}))
    context.jobs->cancel(job.id);
  if (ImGui::IsItemHovered(ImGuiHoveredFlags_AllowWhenDisabled))
    tooltip(context.ui, cancel, "Cancel",
            stopping ? "The job is stopping." : "Stop this job. The project does not change.");
}

}  // namespace

std::string time_left_text(double seconds) {
  if (seconds < 8) return "a few seconds";
  if (seconds < 55) return "about " + std::to_string(static_cast<int>(std::ceil(seconds / 5) * 5)) + " s";
  if (seconds < 90) return "about 1 min";
  if (seconds < 55 * 60) return "about " + std::to_string(static_cast<int>(std::lround(seconds / 60))) + " min";
  return "about " + std::to_string(static_cast<int>(std::lround(seconds / 3600 + 0.2))) + " h";
}

void draw_running(Context& context, Column& column) {
  const std::vector<JobStatus> jobs = at_work(context);
  const auto queued =
      std::count_if(jobs.begin(), jobs.end(), [](const JobStatus& job) { return job.state == JobState::Queued; });
  const auto running = std::ssize(jobs) - queued;
  std::string count = jobs.empty() ? "" : running == 1 ? "1 job" : std::to_string(running) + " jobs";
  if (queued > 0) count += ", " + std::to_string(queued) + " queued";
  if (column.begin_section("Running", count)) {
    if (jobs.empty()) {
      // As high as the row of the job that "Resample this pose" starts, so that the sections below do not move then.
      const Rect row = column.row(context.resampling->method == kFiniteElements ? kSolveRowHeight : kRowHeight);
      put_text(context.ui, context.ui->look.fonts.regular, context.ui->look.theme.text2,
               Rect{{row.low.x + context.ui->look.px(10), row.low.y}, row.high}, "Nothing is running");
    }
    for (const JobStatus& job : jobs) draw_job_row(context, job, column.row(row_height(context.fem, job)));
  }
  column.end_section();
}

float draw_job_slot(Context& context, const Rect& bar, float right) {
  const Look& look = context.ui->look;
  const std::vector<JobStatus> jobs = at_work(context);
  std::erase_if(context.background->stopping_since, [&](const auto& one) {
    return std::none_of(jobs.begin(), jobs.end(), [&](const JobStatus& job) { return job.id == one.first; });
  });
  const Rect slot{{right - look.px(150), bar.low.y}, {right, bar.high.y}};
  if (!jobs.empty()) {
    const auto running =
        std::find_if(jobs.begin(), jobs.end(), [](const JobStatus& job) { return job.state != JobState::Queued; });
    const JobStatus& job = running == jobs.end() ? jobs.front() : *running;
    const Pressed pressed = press_area(context.ui, "Running", slot);
    if (pressed.hovered) {
      fill({slot.low + glm::vec2(0, look.px(2)), slot.high - glm::vec2(0, look.px(2))}, look.theme.hover, look.px(4));
      tooltip(context.ui, slot, job.label, state_of(context, job) + "\nClick to open the list of jobs.");
    }
    draw_spinner(context, {slot.low.x + look.px(12), slot.centre().y}, look.px(6));
    const Rect track{{slot.high.x - look.px(58), slot.centre().y - look.px(3)},
                     {slot.high.x - look.px(6), slot.centre().y + look.px(3)}};
    const std::string words = jobs.size() > 1                   ? std::to_string(jobs.size()) + " jobs"
                              : job.state == JobState::Stopping ? state_of(context, job)
                                                                : job.label;
    put_text(context.ui, look.fonts.small, look.theme.text2,
             Rect{{slot.low.x + look.px(24), slot.low.y}, {track.low.x - look.px(6), slot.high.y}}, words);
    draw_track(context.ui, track, job.fraction);
    if (pressed.clicked) ImGui::OpenPopup("running jobs");
  }
  float rows = jobs.empty() ? kRowHeight : 0;
  for (const JobStatus& job : jobs) rows += row_height(context.fem, job);
  const float width = look.px(320), height = look.px(rows + 8);
  ImGui::SetNextWindowPos({slot.high.x - width, bar.low.y - height - look.px(4)});
  ImGui::SetNextWindowSize({width, height});
  if (ImGui::BeginPopup("running jobs", ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoScrollbar)) {
    context.ui->place.region = Region::Popup;
    push_path(context.ui, "running");
    float y = bar.low.y - height;
    const float left = slot.high.x - width;
    if (jobs.empty()) ImGui::CloseCurrentPopup();
    for (const JobStatus& job : jobs) {
      const float row = look.px(row_height(context.fem, job));
      draw_job_row(context, job, {{left, y}, {left + width, y + row}});
      y += row;
    }
    pop_path(context.ui);
    context.ui->place.region = Region::Status;
    ImGui::EndPopup();
  }
  return jobs.empty() ? right : slot.low.x - look.px(12);
}

}  // namespace limber::editor
