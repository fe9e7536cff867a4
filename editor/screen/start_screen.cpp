// SPDX-License-Identifier: AGPL-3.0-or-later
// Draws the start screen, which is shown while nothing is open. It has buttons to begin, sample bodies, recent files,
// edits to recover after a crash, and the four steps of the work. The menus stay usable. Escape closes the start
// screen, and the key of any command closes it and runs the command.
#include <ctime>

#include "editor/context/context.h"
#include "editor/context/dialogs.h"
#include "editor/context/operator.h"
#include "editor/context/operator_button.h"
#include "editor/context/panels.h"
#include "editor/context/project_life.h"
#include "editor/context/recent_files.h"
#include "editor/context/screen.h"
#include "editor/context/start_screen_state.h"
#include "editor/context/user_folders.h"
#include "editor/file_browser/directory_listing.h"
#include "editor/file_browser/file_browser.h"
#include "editor/files/import.h"
#include "editor/ui/asset_path.h"
#include "editor/ui/icons.h"
#include "editor/ui/input_fields.h"
#include "editor/ui/texture_cache.h"

namespace limber::editor {

namespace {

constexpr float kWidth = 1100, kHeight = 716, kPadding = 32, kMargin = 8;
// In a window that is narrower or lower than this, the start screen has less space between its parts, px at scale 1.
constexpr float kSmallWidth = 1180, kSmallHeight = 800;
// Heights of sample buttons: largest and smallest in two rows, and in a single row; px at scale 1.
constexpr float kSample = 162, kLeastSample = 120, kSampleInRow = 112;
constexpr float kRecentRow = 52, kRecovery = 58;
constexpr float kSampleAspect = 504.0f / 232;

// The layout of the card, which is the panel in the middle of the start screen.
struct Plan {
  Rect card;
  bool small = false, steps = true;
  float left, right;  // x coordinates of the content's edges
  float second;       // x coordinate of the right column
};

Plan plan_of(const Context& context) {
  const Look& look = context.ui->look;
  const Rect area{{0, context.screen->layout.top_bar.high.y},
                  {context.screen->layout.window.high.x, context.screen->layout.status.low.y}};
  const glm::vec2 size = glm::min(glm::vec2(look.px(kWidth), look.px(kHeight)), area.size() - 2 * look.px(kMargin));
  Plan plan;
  plan.card.low = glm::round(area.centre() - size * 0.5f);
  plan.card.high = plan.card.low + size;
  const glm::vec2 window = context.screen->layout.window.size() / look.scale;
  plan.small = window.x < kSmallWidth || window.y < kSmallHeight;
  plan.steps = size.y / look.scale >= 520;
  const float padding = look.px(plan.small ? 22 : kPadding);
  plan.left = plan.card.low.x + padding;
  plan.right = plan.card.high.x - padding;
  plan.second = std::round(plan.left + (plan.right - plan.left) * 0.53f);
  return plan;
}

// Draws a picture that fills the rectangle.
//   picture  the picture's aspect ratio, which is its width divided by its height
void draw_picture(Ui& ui, unsigned texture, const Rect& rect, float picture, float rounding) {
  ImDrawList& canvas = *ImGui::GetWindowDrawList();
  // Draws the gradient only if there is no picture: the gradient's corners are not rounded and would show behind the
  // picture's rounded corners.
  if (!texture) {
    canvas.AddRectFilledMultiColor(im(rect.low), im(rect.high), ui.look.theme.view_top, ui.look.theme.view_top,
                                   ui.look.theme.view_bottom, ui.look.theme.view_bottom);
    return;
  }
  // Crop the picture to the rectangle's aspect ratio, so that it fills the rectangle undistorted.
  const float aspect = rect.width() / rect.height();
  const glm::vec2 cut =
      aspect > picture ? glm::vec2(0, (1 - picture / aspect) / 2) : glm::vec2((1 - aspect / picture) / 2, 0);
  canvas.AddImageRounded(reinterpret_cast<ImTextureID>(static_cast<std::uintptr_t>(texture)), im(rect.low),
                         im(rect.high), im(cut), im(glm::vec2(1) - cut), 0xFFFFFFFF, rounding,
                         ImDrawFlags_RoundCornersTop);
}

float draw_head(Context& context, const Plan& plan) {
  const Look& look = context.ui->look;
  float y = plan.card.low.y + look.px(plan.small ? 16 : 27);
  put_text(context.ui, look.fonts.title, look.theme.text, {plan.left, y}, "Limber");
  put_text(context.ui, look.fonts.mono, look.theme.text3,
           Rect{{plan.right - look.px(120), y + look.px(6)}, {plan.right, y + look.px(28)}}, LIMBER_VERSION,
           Align::Right);
  y += look.px(36);
  put_text(context.ui, look.fonts.regular, look.theme.text2, {plan.left, y},
           "Pose voxel anatomy: rig, skin, pose, resample.");
  y += look.px(plan.small ? 28 : 36);

  struct Way {
    const char* operator_id;
    std::string label, hint;
    ButtonStyle style;
  };
  float x = plan.left;
  for (const Way& way : {Way{"file.open", "Open...", "Ctrl O", ButtonStyle::Primary},
                         Way{"file.import_dicom", "Import DICOM folder...", "", ButtonStyle::Plain},
                         Way{"help.tour", "Take the tour", "2 min", ButtonStyle::Plain}}) {
    const Operator* op = find_operator(context.operators, way.operator_id);
    if (!op) continue;
    ImFont* font = way.style == ButtonStyle::Primary ? look.fonts.semibold : look.fonts.regular;
    const bool primary = way.style == ButtonStyle::Primary;
    ImFont* hint_font = primary ? look.fonts.small_mono : look.fonts.small;
    const float hint = way.hint.empty() ? 0 : text_size(hint_font, way.hint).x + look.px(8);
    const float width = std::round(look.px(16 + 24 + 18) + text_size(font, way.label).x + hint);
    const Rect rect{{x, y}, {x + width, y + look.px(34)}};
    const Pressed state = press_area(context.ui, way.label, rect);
    fill(rect, primary ? look.theme.accent : state.hovered ? look.theme.hover : look.theme.raised, look.px(4));
    const Colour colour = primary ? look.theme.on_accent : look.theme.text;
    put_icon(look.fonts.regular, colour, Rect{{x + look.px(16), rect.low.y}, {x + look.px(34), rect.high.y}}, op->icon);
    put_text(context.ui, font, colour,
             Rect{{x + look.px(42), rect.low.y}, {rect.high.x - hint - look.px(8), rect.high.y}}, way.label);
    if (hint > 0)
      put_text(context.ui, hint_font, primary ? look.theme.on_accent : look.theme.text2,
               Rect{{rect.high.x - hint - look.px(14), rect.low.y}, {rect.high.x - look.px(16), rect.high.y}}, way.hint,
               Align::Right);
    if (state.hovered) operator_tooltip(context, *op, rect);
    if (state.clicked) run(context, *op);
    x = rect.high.x + look.px(8);
  }
  return y + look.px(34);
}

// Draws the button that opens a sample body.
//   facts_too  true: also draws a line of text about the sample's content
void draw_sample(Context& context, Sample sample, const Rect& rect, bool facts_too) {
  const Look& look = context.ui->look;
  const SampleFacts& facts = facts_of(sample);
  const std::string name = std::string("sample ") + facts.name;
  const Pressed state = press_area(context.ui, name, rect);
  const float rounding = look.px(6), words = look.px(facts_too ? 46 : 28);
  fill(rect, state.hovered ? look.theme.hover : look.theme.head, rounding);
  const Rect picture{rect.low, {rect.high.x, rect.high.y - words}};
  draw_picture(
      context.ui,
      context.pictures->texture(name, [&] { return render::read_png(asset(std::string("samples/") + facts.picture)); }),
      picture, kSampleAspect, rounding);
  outline(rect, state.hovered ? look.theme.accent : look.theme.line2, rounding, look.line());
  const float left = rect.low.x + look.px(facts_too ? 12 : 8), right = rect.high.x - look.px(6);
  put_text(context.ui, look.fonts.regular, look.theme.text,
           Rect{{left, picture.high.y + look.px(5)}, {right, picture.high.y + look.px(23)}}, facts.name);
  if (facts_too)
    put_text(context.ui, look.fonts.small, look.theme.text2,
             Rect{{left, picture.high.y + look.px(23)}, {right, picture.high.y + look.px(40)}}, facts.facts);
  if (state.hovered) tooltip(context.ui, rect, facts.name, std::string("Open this sample body: ") + facts.facts + ".");
  if (state.clicked) open_sample(context, sample);
}

// Draws the buttons of the samples, in two rows if these fit above the y coordinate `bottom`, else in one row. Returns
// the y coordinate of the buttons' lower end.
float draw_samples(Context& context, const Plan& plan, float y, float bottom) {
  const Look& look = context.ui->look;
  put_text(context.ui, look.fonts.semibold, look.theme.text, {plan.left, y}, "Samples");
  y += look.px(24);
  const float gap = look.px(plan.small ? 8 : 14), all = plan.second - look.px(24) - plan.left;
  const float of_two = std::floor((bottom - y - gap) / 2);
  const bool two_rows = of_two >= look.px(kLeastSample);
  const int columns = two_rows ? 2 : 4;
  const float width = std::floor((all - gap * (columns - 1)) / columns),
              height = two_rows ? std::min(of_two, look.px(kSample)) : look.px(kSampleInRow);
  const PathScope scope(context.ui, "samples");
  for (int i = 0; i < 4; ++i) {
    const glm::vec2 corner{plan.left + (width + gap) * (i % columns), y + (height + gap) * (i / columns)};
    draw_sample(context, static_cast<Sample>(i), {corner, corner + glm::vec2(width, height)}, two_rows);
  }
  return y + (height + gap) * (4 / columns) - gap;
}

void locate(Context& context, const Path& lost) {
  browse(context, {.purpose = "open",
                   .title = "Where is " + lost.filename().string() + " now?",
                   .action = "Open",
                   .takes_dicom = true,
                   .chosen = [lost](Context& c, const Path& path) {
                     forget_recent(c.recent_files, lost);
                     open_files(c, {path});
                   }});
}

void draw_recent(Context& context, const Recent& recent, const Rect& rect, bool chosen) {
  const Look& look = context.ui->look;
  const std::string name = recent.path.stem().string();
  const auto facts = context.start_screen->facts.find(recent.path);
  const bool known = facts != context.start_screen->facts.end(), missing = known && facts->second.missing;
  const Pressed state = press_area(context.ui, "recent " + name, rect);
  if (chosen || state.hovered) fill(rect, chosen ? look.theme.accent_soft : look.theme.hover, look.px(4));
  const Rect picture{{rect.low.x + look.px(10), rect.low.y + look.px(6)},
                     {rect.low.x + look.px(70), rect.low.y + look.px(46)}};
  unsigned texture = 0;
  if (known && facts->second.picture)
    texture = context.pictures->texture("recent " + recent.path.string(), [&] { return *facts->second.picture; });
  draw_picture(context.ui, texture, picture, 1.5f, look.px(3));
  if (!texture)
    put_icon(look.fonts.regular, look.theme.view_text2, picture,
             missing                                ? icon::kMissing
             : recent.path.extension() == ".limber" ? icon::kRig
                                                    : icon::kVolume);

  const float left = picture.high.x + look.px(12), right = rect.high.x - look.px(100), middle = rect.centre().y;
  const Colour line = missing ? (chosen ? look.theme.text2 : look.theme.text3) : look.theme.text;
  put_text(context.ui, look.fonts.regular, line, Rect{{left, middle - look.px(18)}, {right, middle}}, name);
  put_text(context.ui, look.fonts.small, look.theme.text2, Rect{{left, middle}, {right, middle + look.px(17)}},
           missing ? "moved or deleted" : short_path(recent.path));
  const Rect end{{right, rect.low.y}, {rect.high.x - look.px(10), rect.high.y}};
  if (missing) put_text(context.ui, look.fonts.regular, look.theme.accent_text, end, "Locate...", Align::Right);
  else if (recent.time > 0)
    put_text(context.ui, look.fonts.small, look.theme.text2, end, time_text(recent.time, std::time(nullptr)),
             Align::Right);
  if (!state.clicked) return;
  if (missing) locate(context, recent.path);
  else open_files(context, {recent.path});
}

void dashed_outline(const Rect& rect, Colour colour, float dash, float width) {
  ImDrawList& canvas = *ImGui::GetWindowDrawList();
  const auto side = [&](const glm::vec2& from, const glm::vec2& to) {
    const float length = glm::distance(from, to);
    // Dashes and gaps alternate. Their total number is odd, so that the side of the rectangle begins and ends with a
    // dash.
    const int parts = 2 * std::max(1, static_cast<int>(length / (2 * dash))) + 1;
    for (int i = 0; i < parts; i += 2)
      canvas.AddLine(im(glm::mix(from, to, float(i) / parts)), im(glm::mix(from, to, float(i + 1) / parts)), colour,
                     width);
  };
  side(rect.low, {rect.high.x, rect.low.y});
  side({rect.high.x, rect.low.y}, rect.high);
  side(rect.high, {rect.low.x, rect.high.y});
  side({rect.low.x, rect.high.y}, rect.low);
}

// Draws a hint that explains how to open a file, in place of the list of recent files while this list is empty.
void draw_first_file(Context& context, const Rect& rect) {
  const Look& look = context.ui->look;
  const Operator* op = find_operator(context.operators, "file.open");
  const Pressed state = press_area(context.ui, "first file", rect);
  if (state.hovered) fill(rect, with_alpha(look.theme.hover, 0.5f), look.px(6));
  dashed_outline(rect, state.hovered ? look.theme.accent : look.theme.line2, look.px(5), look.line());
  const bool high = rect.height() >= look.px(110);
  float y = std::round(rect.centre().y - look.px(high ? 38 : 21));
  if (high) {
    put_icon(look.fonts.icons, state.hovered ? look.theme.accent_text : look.theme.text2,
             Rect{{rect.low.x, y}, {rect.high.x, y + look.px(24)}}, icon::kImport);
    y += look.px(32);
  }
  const float inset = look.px(16);
  put_text(context.ui, look.fonts.regular, look.theme.text,
           Rect{{rect.low.x + inset, y}, {rect.high.x - inset, y + look.px(22)}},
           "Drop a volume, a DICOM folder or a project", Align::Centre);
  put_text(context.ui, look.fonts.small, look.theme.text2,
           Rect{{rect.low.x + inset, y + look.px(23)}, {rect.high.x - inset, y + look.px(41)}},
           "Files you open are listed here next time.", Align::Centre);
  if (state.hovered && op) operator_tooltip(context, *op, rect);
  if (state.clicked && op) run(context, *op);
}

// Draws the list of recent files. If there are none, draws a hint that explains how to open a file.
//   first_end  y coordinate where the hint ends
void draw_recents(Context& context, const Plan& plan, float y, float first_end, float bottom) {
  const Look& look = context.ui->look;
  put_text(context.ui, look.fonts.semibold, look.theme.text, {plan.second, y}, "Recent");
  const auto& recents = context.recent_files->recents;
  if (recents.empty())
    return draw_first_file(context, {{plan.second, y + look.px(24)}, {plan.right, std::min(first_end, bottom)}});
  y += look.px(20);
  const PathScope scope(context.ui, "recents");
  const int rows =
      std::min<int>({5, static_cast<int>((bottom - y) / look.px(kRecentRow)), static_cast<int>(std::ssize(recents))});
  int& chosen = context.start_screen->row;
  const bool keys = !context.dialogs->shown && !ImGui::IsPopupOpen(nullptr, ImGuiPopupFlags_AnyPopupId);
  if (keys && ImGui::IsKeyPressed(static_cast<int>(Key::Down))) chosen += 1;
  if (keys && ImGui::IsKeyPressed(static_cast<int>(Key::Up))) chosen -= 1;
  chosen = std::clamp(chosen, 0, std::max(0, rows - 1));
  for (int i = 0; i < rows; ++i) {
    const Rect rect{{plan.second - look.px(10), y}, {plan.right, y + look.px(kRecentRow)}};
    draw_recent(context, recents[i], rect, i == chosen);
    y = rect.high.y;
  }
  if (keys && ImGui::IsKeyPressed(static_cast<int>(Key::Return), false) && chosen < rows) {
    const auto facts = context.start_screen->facts.find(recents[chosen].path);
    if (facts != context.start_screen->facts.end() && facts->second.missing) locate(context, recents[chosen].path);
    else open_files(context, {recents[chosen].path});
  }
}

void draw_recovery(Context& context, const Rect& rect) {
  const Look& look = context.ui->look;
  const Recoverable leftover = context.life->recoverable.front();
  const PathScope scope(context.ui, "recovery");
  fill(rect, look.theme.head, look.px(6));
  ImGui::GetWindowDrawList()->AddRectFilled(im(rect.low), {rect.low.x + look.px(3), rect.high.y}, look.theme.warn,
                                            look.px(6), ImDrawFlags_RoundCornersLeft);
  put_icon(look.fonts.regular, look.theme.warn,
           Rect{{rect.low.x + look.px(14), rect.low.y}, {rect.low.x + look.px(36), rect.high.y}}, icon::kSave);
  const float middle = rect.centre().y, high = look.px(13);
  float right = rect.high.x - look.px(14);
  const float discard_width = look.px(70), recover_width = look.px(76);
  if (button(context.ui, "Discard", {{right - discard_width, middle - high}, {right, middle + high}}, {"", "Discard"}))
    return discard_leftover(context, leftover);
  right -= discard_width + look.px(8);
  if (button(context.ui, "Recover", {{right - recover_width, middle - high}, {right, middle + high}},
             {"", "Recover", ButtonStyle::Primary}))
    return recover(context, leftover);
  right -= recover_width + look.px(10);
  const std::string name = leftover.project.empty() ? "An unsaved project" : leftover.project.stem().string();
  const auto others = context.life->recoverable.size() - 1;
  std::string line =
      (leftover.edits == 1 ? std::string("1 unsaved edit") : std::to_string(leftover.edits) + " unsaved edits") +
      ", the last one: " + leftover.label;
  if (others > 0) line = std::to_string(others) + " more; " + line;
  const float left = rect.low.x + look.px(42);
  put_text(context.ui, look.fonts.regular, look.theme.text, Rect{{left, middle - look.px(18)}, {right, middle}},
           name + " closed unexpectedly");
  put_text(context.ui, look.fonts.small, look.theme.text2, Rect{{left, middle}, {right, middle + look.px(17)}}, line);
}

void draw_steps(Context& context, const Plan& plan, float y) {
  const Look& look = context.ui->look;
  fill({{plan.left, y}, {plan.right, y + look.line()}}, look.theme.line2);
  y += look.px(plan.small ? 12 : 22);
  struct Step {
    const char *icon, *title, *line;
  };
  const float width = (plan.right - plan.left) / 4;
  int i = 0;
  for (const Step& step : {Step{icon::kRig, "1 Rig", "Fit a rig into the bones."},
                           Step{icon::kSkin, "2 Skin", "Paint how tissue follows bones."},
                           Step{icon::kPose, "3 Pose", "Turn joints or play a motion."},
                           Step{icon::kResample, "4 Resample", "Write a new label volume."}}) {
    const float x = std::round(plan.left + width * static_cast<float>(i++));
    if (i > 1) fill({{x - look.px(16), y}, {x - look.px(16) + look.line(), y + look.px(36)}}, look.theme.line2);
    put_icon(look.fonts.regular, look.theme.accent_text, Rect{{x, y}, {x + look.px(18), y + look.px(16)}}, step.icon);
    put_text(context.ui, look.fonts.semibold, look.theme.text,
             Rect{{x + look.px(24), y - look.px(2)}, {x + width - look.px(20), y + look.px(18)}}, step.title);
    put_text(context.ui, look.fonts.small, look.theme.text2,
             Rect{{x, y + look.px(19)}, {x + width - look.px(22), y + look.px(36)}}, step.line);
  }
}

void draw_foot(Context& context, const Plan& plan) {
  const Look& look = context.ui->look;
  const float middle = plan.card.high.y - look.px(plan.small ? 22 : 32), half = look.px(12);
  checkbox(context.ui, "Show at start", {{plan.left, middle - half}, {plan.left + look.px(130), middle + half}},
           "Show at start", context.recent_files->show_start);
  float right = plan.right;
  struct Link {
    const char *operator_id, *label;
  };
  for (const Link& link :
       {Link{"help.new", "What is new"}, Link{"help.keys", "Keys"}, Link{"help.guide", "User guide"}}) {
    const Operator* op = find_operator(context.operators, link.operator_id);
    if (!op) continue;
    const float width = text_size(look.fonts.regular, link.label).x;
    const Rect rect{{right - width, middle - half}, {right, middle + half}};
    const Pressed state = press_area(context.ui, link.label, rect);
    put_text(context.ui, look.fonts.regular, look.theme.accent_text, rect, link.label);
    if (state.hovered)
      fill({{rect.low.x, middle + look.px(8)}, {rect.high.x, middle + look.px(8) + look.line()}},
           look.theme.accent_text);
    if (state.clicked) run(context, *op);
    right = rect.low.x - look.px(12);
  }
}

}  // namespace

void draw_start_screen(Context& context) {
  if (!context.start_screen->shown) return;
  const Look& look = context.ui->look;
  const Rect area{{0, context.screen->layout.top_bar.high.y},
                  {context.screen->layout.window.high.x, context.screen->layout.status.low.y}};
  begin_region(context.ui, Region::Start, "start", area, 0);
  ImGui::GetWindowDrawList()->AddRectFilledMultiColor(im(area.low), im(area.high), look.theme.view_top,
                                                      look.theme.view_top, look.theme.view_bottom,
                                                      look.theme.view_bottom);
  const Plan plan = plan_of(context);
  fill(plan.card, look.theme.panel, look.px(8));
  outline(plan.card, look.theme.line2, look.px(8), look.line());
  const float below_head = draw_head(context, plan) + look.px(plan.small ? 16 : 24);
  const float foot = plan.card.high.y - look.px(plan.small ? 44 : 64);
  const float steps = plan.steps ? foot - look.px(plan.small ? 56 : 84) : foot;
  const float rows_end = steps - look.px(plan.small ? 16 : 24);
  const float samples_end = draw_samples(context, plan, below_head, rows_end);
  const bool recovery = !context.life->recoverable.empty();
  const float recents_end = steps - look.px(plan.small ? 8 : 24) - (recovery ? look.px(kRecovery + 8) : 0);
  draw_recents(context, plan, below_head, samples_end, recents_end);
  if (recovery)
    draw_recovery(context,
                  {{plan.second, recents_end + look.px(8)}, {plan.right, recents_end + look.px(8 + kRecovery)}});
  if (plan.steps) draw_steps(context, plan, steps);
  draw_foot(context, plan);
  end_region(context.ui);
}

}  // namespace limber::editor
