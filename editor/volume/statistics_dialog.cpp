// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/volume/statistics_dialog.h"

#include <cstdio>

#include "core/prepare/prepare.h"
#include "editor/context/background_task.h"
#include "editor/context/context.h"
#include "editor/context/dialogs.h"
#include "editor/context/open_project.h"
#include "editor/context/platform_window.h"
#include "editor/dialogs/dialog.h"
#include "editor/file_browser/file_browser.h"
#include "editor/ui/icons.h"
#include "editor/ui/messages.h"
#include "editor/ui/section.h"
#include "editor/volume/volume_edits.h"

namespace limber::editor {

namespace {

// The table's contents. The dialog shares them with the job that counts the voxels, because the dialog may be closed
// before the job ends.
struct Counted {
  std::shared_ptr<const LabelVolume> volume;
  std::shared_ptr<const TissueTable> tissues;
  std::vector<LabelStatistics> rows;
  bool done = false;
  std::string problem;
};

class StatisticsDialog final : public Dialog {
 public:
  StatisticsDialog(std::shared_ptr<Counted> counted, int job) : counted_(std::move(counted)), job_(job) {}

  void draw(Context& context) override;
  void escape(Context& context) override {
    context.jobs->cancel(job_);
    context.dialogs->close();
  }

 private:
  void draw_table(Context& context, const Rect& rect);
  void draw_foot(Context& context, const Rect& rect);

  std::shared_ptr<Counted> counted_;
  int job_;
};

constexpr float kSwatch = 14;

// Opens the file browser to export the table. Afterwards, the dialog with the table opens again.
void browse_csv(Context& context, const std::shared_ptr<Counted>& counted) {
  const auto back = [counted](Context& c) { c.dialogs->open(std::make_unique<StatisticsDialog>(counted, 0)); };
  browse(context, {.purpose = "statistics",
                   .title = "Export statistics",
                   .action = "Export",
                   .kind = FileRequest::Kind::Save,
                   .filters = {{"Tables", {".csv"}}},
                   .name = (context.project->name.empty() ? std::string("volume")
                                                          : Path(context.project->name).stem().string()) +
                           "-statistics.csv",
                   .folder = context.project->path.parent_path(),
                   .chosen =
                       [counted, back](Context& c, const Path& path) {
                         back(c);
                         write_file_atomically(path, to_csv(counted->rows, *counted->tissues));
                         c.messages->ok("Statistics exported", path.string());
                       },
                   .left = back});
}

void put_row(Ui& ui, const Rect& row, Colour colour, const Theme& theme, const std::array<std::string, 5>& words,
             ImFont* digits) {
  const Look& look = ui.look;
  const float right = row.high.x - look.px(12);
  const float columns[] = {right - look.px(380), right - look.px(250), right - look.px(110), right};
  put_text(ui, look.fonts.regular, colour,
           Rect{{row.low.x + look.px(40), row.low.y}, {columns[0] - look.px(60), row.high.y}}, words[0]);
  for (int i = 0; i < 4; ++i)
    put_text(ui, digits, i == 0 ? theme.text2 : colour,
             Rect{{columns[i] - look.px(110), row.low.y}, {columns[i], row.high.y}}, words[i + 1], Align::Right);
}

void StatisticsDialog::draw_table(Context& context, const Rect& rect) {
  const Look& look = context.ui->look;
  const Rect head{rect.low, {rect.high.x, rect.low.y + look.px(26)}};
  fill(head, look.theme.head);
  // The titles leave room for the scroll bar, as the rows below do, so that each title stands above its column.
  const Rect heads{head.low, {head.high.x - ImGui::GetStyle().ScrollbarSize, head.high.y}};
  put_row(context.ui, heads, look.theme.text2, look.theme, {"Tissue", "Label", "Voxels", "mm\u00b3", "Pieces"},
          look.fonts.regular);
  if (!counted_->done) {
    put_text(context.ui, look.fonts.regular, look.theme.text2,
             Rect{{rect.low.x, head.high.y}, {rect.high.x, head.high.y + look.px(80)}},
             counted_->problem.empty() ? "Counting voxels" : counted_->problem, Align::Centre);
    return;
  }
  Column column(context.ui, "table", {{rect.low.x, head.high.y}, rect.high});
  int index = 0;
  for (const LabelStatistics& one : counted_->rows) {
    Rect row;
    if (!column.list_row(row, index++, false)) continue;
    const Tissue* tissue = counted_->tissues->find(one.label);
    if (tissue) {
      const float side = look.px(kSwatch), y = std::round(row.centre().y - side / 2), x = row.low.x + look.px(14);
      const Rect swatch{{x, y}, {x + side, y + side}};
      fill(swatch, rgb(tissue->colour.r, tissue->colour.g, tissue->colour.b), look.px(3));
      outline(swatch, look.theme.line2, look.px(3), look.line());
    }
    char volume[40];
    std::snprintf(volume, sizeof volume, one.volume_mm3 < 1000 ? "%.1f" : "%.0f", one.volume_mm3);
    put_row(context.ui, row, look.theme.text, look.theme,
            {tissue ? tissue->name : "Unknown", std::to_string(one.label), grouped(one.voxels),
             one.volume_mm3 < 1000 ? volume : grouped(std::llround(one.volume_mm3)), std::to_string(one.components)},
            look.fonts.mono);
  }
}

void StatisticsDialog::draw_foot(Context& context, const Rect& rect) {
  const Look& look = context.ui->look;
  const ButtonLook export_face{icon::kExport, "Export CSV...", ButtonStyle::Primary, counted_->done},
      copy_face{icon::kCopy, "Copy", ButtonStyle::Plain, counted_->done};
  const float export_width = width_of_button(context.ui, export_face) + look.px(8),
              copy_width = width_of_button(context.ui, copy_face);
  const Rect write{{rect.high.x - export_width, rect.low.y}, rect.high},
      copy{{write.low.x - look.px(8) - copy_width, rect.low.y}, {write.low.x - look.px(8), rect.high.y}};
  if (button(context.ui, "Copy", copy, copy_face))
    context.host->set_clipboard(to_csv(counted_->rows, *counted_->tissues));
  if (ImGui::IsItemHovered()) tooltip(context.ui, copy, "Copy", "Copy the table to the clipboard as CSV.");
  const bool pressed = button(context.ui, "Export CSV", write, export_face);
  if (ImGui::IsItemHovered())
    tooltip(context.ui, write, "Export CSV",
            "Save the table as a CSV file, with each tissue's mass, centre, bounding box and surface area.");
  if (pressed) browse_csv(context, counted_);
}

void StatisticsDialog::draw(Context& context) {
  const Look& look = context.ui->look;
  const Rect rect = begin_dialog(context, "Statistics", 760, 520);
  const float foot = rect.high.y - look.px(28);
  draw_table(context, {{rect.low.x - look.px(18) + look.line(), rect.low.y - look.px(18)},
                       {rect.high.x + look.px(18) - look.line(), foot - look.px(12)}});
  draw_foot(context, {{rect.low.x, foot}, rect.high});
  end_dialog(context);
}

}  // namespace

std::unique_ptr<Dialog> open_statistics(Context& context) {
  auto counted = std::make_shared<Counted>();
  counted->volume = context.document().volume;
  counted->tissues = context.document().tissues;
  auto rows = std::make_shared<std::vector<LabelStatistics>>();
  const int job = context.jobs->start("Statistics", [volume = counted->volume, rows](Progress& progress) -> Edit {
    progress.update("count", 0);
    *rows = label_statistics(*volume);
    return {};
  });
  context.background->step_of_job[job] = StepOfWork::Prepare;
  context.background->after_job[job] = [counted, rows](Context& c, const JobStatus& status) {
    counted->done = status.state == JobState::Done;
    counted->rows = std::move(*rows);
    counted->problem = status.state == JobState::Done        ? ""
                       : status.state == JobState::Cancelled ? "Cancelled"
                                                             : status.message;
    c.ui->touch();
  };
  return std::make_unique<StatisticsDialog>(counted, job);
}

}  // namespace limber::editor
