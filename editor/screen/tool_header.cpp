// SPDX-License-Identifier: AGPL-3.0-or-later
// Draws the tool header, which is the bar below the top bar. It has buttons for the display of the body, the options of
// the workspace, clipping, and the layout of the views.
#include "editor/context/context.h"
#include "editor/context/operator.h"
#include "editor/context/operator_button.h"
#include "editor/context/panels.h"
#include "editor/context/screen.h"
#include "editor/context/views.h"
#include "editor/labels/label_brush.h"
#include "editor/resample/resample_job.h"
#include "editor/screen/menus.h"
#include "editor/skin/brush_settings.h"
#include "editor/skin/painting.h"
#include "editor/skin/weight_display.h"
#include "editor/ui/icons.h"
#include "editor/ui/input_fields.h"

namespace limber::editor {

namespace {

class Header {
 public:
  // Begins to draw the buttons of the tool header from the left.
  //   drawn         false: draws nothing, and only finds which groups of buttons fit into the header
  //   short_labels  true: buttons show icons in place of labels
  //   labelled      the number of groups from the left that have labels; the others show icons
  Header(Context& context, bool drawn, bool short_labels, int labelled)
      : context_(context),
        bar_(context.screen->layout.tool_header),
        x_(context.ui->look.px(8)),
        drawn_(drawn),
        short_labels_(short_labels),
        labelled_(labelled) {}

  // Draws a row of adjacent buttons, one for each operator, of which one is active.
  //   words  true: draws labels beside icons, unless the group has room only for icons
  void segments(std::initializer_list<const char*> ids, bool words = false) {
    segments(std::vector<std::string>(ids.begin(), ids.end()), words);
  }
  void segments(const std::vector<std::string>& ids, bool words = false) {
    for (const std::string& id : ids) {
      const Operator* op = find_operator(context_.operators, id);
      ButtonLook face = face_of(*op, !words);
      const float width = *face.icon ? (face.label.empty() ? px(36) : width_of_button(context_.ui, face))
                                     : std::round(text_size(context_.ui->look.fonts.regular, face.label).x + px(20));
      place(id, face.label, width, op->checked(context_) ? ButtonStyle::Chosen : ButtonStyle::Plain);
      x_ += px(1);
    }
    x_ += px(9);
  }

  void toggle(const char* id, const char* label = "") {
    const Operator* op = find_operator(context_.operators, id);
    ButtonLook face = face_of(*op, false);
    if (*label) face.label = label;
    const float width = face.label.empty() ? px(30) : width_of_button(context_.ui, face);
    place(id, face.label, width, op->checked && op->checked(context_) ? ButtonStyle::Soft : ButtonStyle::Plain);
    x_ += px(6);
  }

  // Draws a button that shows the active one of several operators, and opens a list of all of them. The button is as
  // wide as the longest label.
  void choice(const char* name, std::initializer_list<const char*> ids) {
    // The first operator is shown if none of the list is active.
    const Operator* chosen = find_operator(context_.operators, *ids.begin());
    float width = 0;
    for (const char* id : ids) {
      const Operator* op = find_operator(context_.operators, id);
      if (op->checked(context_)) chosen = op;
      width = std::max(width, width_of_button(context_.ui, {op->icon, op->label}));
    }
    const float height = px(26), y = std::round(bar_.centre().y - height / 2), x = x_;
    x_ += width + px(6);
    if (!drawn_) return;
    if (button(context_.ui, name, {{x, y}, {x + width, y + height}}, {chosen->icon, chosen->label}))
      ImGui::OpenPopup(name);
    if (!ImGui::BeginPopup(name, ImGuiWindowFlags_NoMove)) return;
    context_.ui->place.region = Region::Popup;
    push_path(context_.ui, name);
    for (const char* id : ids) operator_menu_item(context_, id);
    pop_path(context_.ui);
    context_.ui->place.region = Region::ToolHeader;
    ImGui::EndPopup();
  }

  // Draws a button labelled `word` that opens the menu pointer_menu(name).
  void menu(const char* name, const char* word) {
    const float width = width_of_button(context_.ui, {"", word}), height = px(26),
                y = std::round(bar_.centre().y - height / 2), x = x_;
    x_ += width + px(8);
    if (!drawn_) return;
    if (button(context_.ui, name, {{x, y}, {x + width, y + height}}, {"", word})) ImGui::OpenPopup(name);
    if (!ImGui::BeginPopup(name, ImGuiWindowFlags_NoMove)) return;
    context_.ui->place.region = Region::Popup;
    push_path(context_.ui, name);
    draw_menu(context_, pointer_menu(name, ViewId::Body));
    pop_path(context_.ui);
    context_.ui->place.region = Region::ToolHeader;
    ImGui::EndPopup();
  }

  // Draws a field for a number of the brush, which the user drags or types.
  void number(const char* name, double& value, double low, double high, const char* format, const char* unit,
              float width) {
    label(name);
    const float height = px(24), y = std::round(bar_.centre().y - height / 2);
    bool committed = false;
    if (drawn_)
      number_field(context_.ui, name, {{x_, y}, {x_ + px(width), y + height}}, value, low, high, format, unit, true,
                   committed);
    x_ += px(width + 10);
  }

  // Draws an operator that is the main action of the workspace, as a primary (coloured) button.
  void action(const char* id) {
    const Operator* op = find_operator(context_.operators, id);
    const ButtonLook face{op->icon, op->label};
    place(id, face.label, width_of_button(context_.ui, face),
          disabled_reason(context_, *op).empty() ? ButtonStyle::Primary : ButtonStyle::Plain);
    x_ += px(6);
  }

  void plain(const char* id) {
    const Operator* op = find_operator(context_.operators, id);
    place(id, op->label, width_of_button(context_.ui, {op->icon, op->label}), ButtonStyle::Plain);
    x_ += px(6);
  }

  void label(const std::string& text) {
    const float width = text_size(context_.ui->look.fonts.regular, text).x;
    if (drawn_)
      put_text(context_.ui, context_.ui->look.fonts.regular, context_.ui->look.theme.text2,
               Rect{{x_, bar_.low.y}, {x_ + width + 1, bar_.high.y}}, text);
    x_ += width + px(8);
  }

  void line() {
    if (drawn_)
      fill({{x_, bar_.low.y + px(9)}, {x_ + context_.ui->look.line(), bar_.high.y - px(9)}},
           context_.ui->look.theme.line2);
    x_ += context_.ui->look.line() + px(10);
  }

  // Draws the buttons for the layout of the views at the right end, where they are always visible.
  void layouts() {
    x_ = bar_.high.x - px(8) - 3 * px(36) - 2 * px(1);
    right_ = x_;
    segments({"view.one", "view.split", "view.four"});
  }
  // Draws a "..." button that opens a menu of the operators that did not fit into the header.
  void more() {
    if (dropped_.empty()) return;
    const float height = px(26), y = std::round(bar_.centre().y - height / 2);
    if (button(context_.ui, "More", {{x_, y}, {x_ + px(30), y + height}}, {icon::kMore})) ImGui::OpenPopup("more");
    // The menu is below the header, so that the buttons beside it stay free.
    ImGui::SetNextWindowPos({x_ + px(30), bar_.high.y + px(2)}, ImGuiCond_Always, {1, 0});
    if (!ImGui::BeginPopup("more", ImGuiWindowFlags_NoMove)) return;
    context_.ui->place.region = Region::Popup;
    push_path(context_.ui, "more");
    for (const std::string& id : dropped_)
      if (id == kSeparator) ImGui::Separator();
      else operator_menu_item(context_, id);
    pop_path(context_.ui);
    context_.ui->place.region = Region::ToolHeader;
    ImGui::EndPopup();
  }
  bool dropped_any() const { return !dropped_.empty(); }
  int groups() const { return groups_; }  // number of groups so far, including those that did not fit
  // Returns the width of a toggle button in the next group, px at scale 1.
  //   labelled  the button's width with a label, for a group that has room for labels
  float toggle_width(float labelled) const { return is_short(groups_ + 1) ? 36 : labelled; }
  // Returns true if a group of buttons still fits into the header. If the group does not fit, adds its operators to the
  // menu of the "..." button.
  //   width  width of the group, px at scale 1
  bool fits(float width, std::initializer_list<const char*> ids) {
    return fits(width, std::vector<std::string>(ids.begin(), ids.end()));
  }
  bool fits(float width, const std::vector<std::string>& ids) {
    ++groups_;
    if (dropped_.empty() && x_ + px(width) < right_ - px(44)) return true;
    // The operators of a choice stand between separators. Neighbouring single operators stand together.
    const bool choice = ids.size() > 1;
    if (!dropped_.empty() && (choice || dropped_choice_)) dropped_.push_back(kSeparator);
    dropped_.insert(dropped_.end(), ids.begin(), ids.end());
    dropped_choice_ = choice;
    return false;
  }
  void to_left() { x_ = bar_.low.x + px(8); }

 private:
  static constexpr char kSeparator[] = "-";

  float px(float size) const { return context_.ui->look.px(size); }
  bool is_short(int group) const { return short_labels_ || group > labelled_; }
  ButtonLook face_of(const Operator& op, bool segment) const {
    const bool layout = segment && *op.icon;
    const bool icon_alone = layout || (is_short(groups_) && *op.icon);
    return {op.icon, icon_alone ? "" : op.label};
  }
  void place(const std::string& id, const std::string& label, float width, ButtonStyle style) {
    const float height = px(26), y = std::round(bar_.centre().y - height / 2);
    if (drawn_) operator_button(context_, id, {{x_, y}, {x_ + width, y + height}}, label, style);
    x_ += width;
  }

  Context& context_;
  Rect bar_;
  float x_, right_ = 1e9f;
  bool drawn_, short_labels_;
  int labelled_, groups_ = 0;
  std::vector<std::string> dropped_;  // operators in the menu of the "..." button, with separators
  bool dropped_choice_ = false;       // true: the operators that were dropped last belong together
};

// Draws the settings of the label brush.
void put_label_brush(Context& context, Header& header) {
  header.menu("Edit labels", "Labels");
  if (header.fits(140, {"skin.radius"}))
    header.number("Radius", context.skin->painting->radius, Painting::kLeastRadius, Painting::kMostRadius, "%.1f", "mm",
                  80);
  const auto kOver = {"labels.over_all", "labels.over_air", "labels.over_tissue", "labels.over_underneath"};
  if (header.fits(150, kOver)) header.choice("Paint over", kOver);
  const auto kErased = {"labels.erase_to_surroundings", "labels.erase_to_air"};
  if (header.fits(190, kErased)) header.choice("Erase to", kErased);
  if (header.fits(90, {"labels.flat"})) header.toggle("labels.flat");
  if (context.views->image && header.fits(160, {"labels.in_range"})) header.toggle("labels.in_range");
  header.line();
}

// Draws the buttons for the display of the body and for the options of the workspace.
void put_options(Context& context, Header& header) {
  header.layouts();
  header.to_left();
  const bool labels = context.workspace() == Workspace::Skin && context.skin->painting->labels->on;
  const bool paints = context.workspace() == Workspace::Skin && context.document().weights && !labels;
  if (!paints) {
    if (context.views->image) header.segments({"view.solid", "view.xray_display", "view.tissue", "view.image_display"});
    else header.segments({"view.solid", "view.xray_display", "view.tissue"});
    header.line();
  }
  if (context.workspace() == Workspace::Rig) {
    header.action("rig.auto_fit");
    if (header.fits(110, {"rig.templates"})) header.plain("rig.templates");
    header.line();
  }
  // These groups stand there before there is a rig, too, so that no button moves when one is fitted.
  if (context.workspace() == Workspace::Rig) {
    if (header.fits(140, {"snap.steps", "snap.voxel", "snap.joint", "snap.bone_middle"}))
      header.choice("Snap", {"snap.steps", "snap.voxel", "snap.joint", "snap.bone_middle"});
    if (header.fits(header.toggle_width(110), {"edit.x_mirror"})) header.toggle("edit.x_mirror");
    if (header.fits(140, {"space.global", "space.local", "space.parent", "space.view"}))
      header.choice("Axes", {"space.global", "space.local", "space.parent", "space.view"});
    header.line();
  }
  if (context.workspace() == Workspace::Skin && context.document().armature && !paints && !labels) {
    header.action("skin.heat");
    if (header.fits(150, {"skin.compute"})) header.plain("skin.compute");
    header.line();
  }
  if (labels) put_label_brush(context, header);
  if (paints) {
    Painting& painting = *context.skin->painting;
    header.menu("Edit weights", "Weights");
    if (header.fits(140, {"skin.radius"}))
      header.number("Radius", painting.radius, Painting::kLeastRadius, Painting::kMostRadius, "%.1f", "mm", 80);
    if (header.fits(140, {"skin.strength"})) header.number("Strength", painting.strength, 0, 1, "%.2f", "", 64);
    const bool takes_value = rule_of(painting.kind).takes_value;
    if (takes_value && header.fits(130, {"skin.value"})) header.number("Value", painting.value, 0, 1, "%.2f", "", 64);
    header.line();
    const auto kDisplays = {"skin.show_active", "skin.show_dominant", "skin.show_mixed", "skin.show_count",
                            "skin.show_tissues"};
    if (header.fits(140, kDisplays)) header.choice("Weight display", kDisplays);
    if (header.fits(130, {"skin.reach_surface", "skin.reach_depth", "skin.reach_through"}))
      header.choice("Reach", {"skin.reach_surface", "skin.reach_depth", "skin.reach_through"});
    if (header.fits(90, {"skin.along_tissue"})) header.toggle("skin.along_tissue");
    if (header.fits(140, {"skin.paint_all", "skin.paint_soft", "skin.paint_chosen", "skin.paint_visible"}))
      header.choice("Painted tissue", {"skin.paint_all", "skin.paint_soft", "skin.paint_chosen", "skin.paint_visible"});
    if (header.fits(180, {"skin.normalize_unlocked", "skin.normalize_all", "skin.normalize_off"}))
      header.choice("Normalize", {"skin.normalize_unlocked", "skin.normalize_all", "skin.normalize_off"});
    if (header.fits(header.toggle_width(90), {"skin.posed"})) header.toggle("skin.posed");
    if (header.fits(header.toggle_width(110), {"edit.x_mirror"})) header.toggle("edit.x_mirror");
    if (header.fits(90, {"skin.contours"})) header.toggle("skin.contours");
    const auto kBodies = {"view.solid", "view.xray_display", "view.tissue"};
    if (header.fits(200, kBodies)) header.segments(kBodies);
    header.line();
  }
  if (context.workspace() == Workspace::Resample) {
    const auto kCompared = {"compare.side_by_side", "compare.wipe", "compare.difference"};
    if (header.fits(3 * header.toggle_width(112), kCompared)) header.segments(kCompared, true);
    const auto kColours = {"fem.show_tissues", "fem.show_volume_ratio", "fem.show_energy", "fem.show_gap"};
    if (header.fits(150, kColours)) header.choice("Colours", kColours);
    if (header.fits(header.toggle_width(90), {"result.overlap"})) header.toggle("result.overlap");
    if (header.fits(header.toggle_width(120), {"fem.tets"})) header.toggle("fem.tets");
    header.line();
    for (const char* id : {"report.open", "file.export"})
      if (header.fits(header.toggle_width(100), {id})) header.toggle(id);
    header.line();
  }
  if (context.workspace() == Workspace::Pose) {
    if (const std::vector<std::string> blends = method_operators(Methods::Blends); header.fits(230, blends)) {
      header.label("Preview");
      header.segments(blends);
    }
    if (header.fits(140, {"space.global", "space.local", "space.parent", "space.view"}))
      header.choice("Axes", {"space.global", "space.local", "space.parent", "space.view"});
    if (header.fits(90, {"pose.limits"})) header.toggle("pose.limits", "Limits");
    for (const char* id : {"pose.auto_ik", "edit.x_mirror", "motion.onion_skin"})
      if (header.fits(header.toggle_width(110), {id})) header.toggle(id);
    header.line();
  }
}

// Draws all buttons of the header except the "..." button.
void put_buttons(Context& context, Header& header) {
  put_options(context, header);
  if (context.screen->layout.several()) {
    if (header.fits(210, {"slice.show_labels", "slice.show_outlines"})) {
      header.label("Slices");
      header.segments({"slice.show_labels", "slice.show_outlines"});
    }
    if (header.fits(100, {"view.cross_hair"})) header.toggle("view.cross_hair");
  }
  for (const char* id : {"view.clip_box", "view.clip_plane"})
    if (header.fits(header.toggle_width(120), {id})) header.toggle(id);
}

// Returns how many groups of buttons, counted from the left, have labels: all groups if they fit into the header,
// otherwise as many as still leave room for all groups.
int labelled_groups(Context& context) {
  Header all(context, false, false, 1000);
  put_buttons(context, all);
  if (!all.dropped_any()) return 1000;
  int fits = 0, drops = all.groups();
  while (drops - fits > 1) {
    const int middle = (fits + drops) / 2;
    Header measured(context, false, false, middle);
    put_buttons(context, measured);
    (measured.dropped_any() ? drops : fits) = middle;
  }
  return fits;
}

}  // namespace

void draw_tool_header(Context& context) {
  const Look& look = context.ui->look;
  const Rect& rect = context.screen->layout.tool_header;
  begin_region(context.ui, Region::ToolHeader, "header", rect, look.theme.head);
  fill({rect.low, {rect.high.x, rect.low.y + look.line()}}, look.theme.void_);
  fill({{rect.low.x, rect.high.y - look.line()}, rect.high}, look.theme.void_);
  // Groups that do not fit even without labels go into the menu of the "..." button.
  const bool short_labels = context.screen->layout.short_labels;
  Header header(context, true, short_labels, short_labels ? 0 : labelled_groups(context));
  put_buttons(context, header);
  header.more();
  end_region(context.ui);
}

}  // namespace limber::editor
