// SPDX-License-Identifier: AGPL-3.0-or-later
// Draws the outliner, a tree of the project: the volume with its tissues, the bones under their parents, the results. A
// row has a triangle that folds its children away, and an eye that shows or hides the tissues, bones or result that the
// row names. A double-click or F2 renames the row; the right button opens a menu. In the Rig workspace, the user drags
// a bone onto a row to give the bone a new parent. A search shows the rows that match and the parents of these rows.
#include <algorithm>

#include <imgui_internal.h>

#include "editor/context/context.h"
#include "editor/context/menu_state.h"
#include "editor/context/open_project.h"
#include "editor/context/operator.h"
#include "editor/context/operator_button.h"
#include "editor/context/outliner_state.h"
#include "editor/context/panels.h"
#include "editor/context/screen.h"
#include "editor/context/selection.h"
#include "editor/context/transform_settings.h"
#include "editor/context/views.h"
#include "editor/resample/results.h"
#include "editor/rig/rig_edits.h"
#include "editor/ui/fuzzy_match.h"
#include "editor/ui/icons.h"
#include "editor/ui/input_fields.h"
#include "editor/ui/list_navigation.h"
#include "editor/volume/tissue_edits.h"
#include "editor/volume/volume_edits.h"

namespace limber::editor {

namespace {

constexpr const char kList[] = "outliner";
constexpr int kManyBones = 24;  // in a rig with more bones than this, only the root bones are unfolded at first
constexpr int kDeepest = 8;  // largest indentation of a row, in levels of the tree; deeper rows are not indented more
constexpr float kRow = 24;   // height of a row, px at scale 1
// kBoneSection: height left free below the list for the active bone's numbers, px at scale 1. kFewestRows: smallest
// number of rows that the list shows, even if less height than kBoneSection is then left.
constexpr float kBoneSection = 204, kFewestRows = 4;

struct Row {
  enum class Kind { Volume, Tissues, Tissue, Armature, Bone, Results, Result } kind;
  std::string key, name, count;
  const char* icon = "";
  int depth = 0, index = 0;  // level in the tree; index in the document's list of tissues, bones or results
  bool folds = false, open = false, chosen = false;
  std::optional<bool> visible;  // state of the eye; none: the row has no eye
  std::optional<Colour> swatch;
};

class Tree {
 public:
  explicit Tree(const Context& context) : context_(context), document_(context.document()) {
    add_volume();
    add_bones();
    add_results();
    if (!context.outliner->search.empty()) keep_found();
  }
  std::vector<Row> rows;

 private:
  bool open(const std::string& key, bool at_first) const {
    if (!context_.outliner->search.empty()) return true;
    const auto found = context_.outliner->open.find(key);
    return found == context_.outliner->open.end() ? at_first : found->second;
  }

  void add_volume() {
    if (!document_.volume) return;
    const bool shown = any_visible();
    rows.push_back({Row::Kind::Volume, "volume", context_.project->name.empty() ? "Volume" : context_.project->name,
                    size_text(document_.volume->grid.size), icon::kVolume, 0, 0, true, open("volume", true)});
    rows.back().visible = shown;
    if (!rows.back().open) return;
    const auto& tissues = document_.tissues->tissues;
    rows.push_back({Row::Kind::Tissues, "tissues", "Tissues", std::to_string(tissues.size()), icon::kTissues, 1, 0,
                    !tissues.empty(), open("tissues", false)});
    rows.back().visible = shown;
    if (!rows.back().open) return;
    for (int i = 0; i < std::ssize(tissues); ++i) {
      const Tissue& tissue = tissues[i];
      rows.push_back({Row::Kind::Tissue, "tissue " + std::to_string(tissue.label), shown_name(tissue),
                      std::to_string(tissue.label), "", 2, i});
      rows.back().chosen = context_.selection->tissues.contains(tissue.label);
      rows.back().visible = look_of(document_, tissue.label).visible;
      rows.back().swatch = rgb(tissue.colour.r, tissue.colour.g, tissue.colour.b);
    }
  }

  bool any_visible() const {
    return std::any_of(document_.tissues->tissues.begin(), document_.tissues->tissues.end(),
                       [&](const Tissue& tissue) { return look_of(document_, tissue.label).visible; });
  }

  void add_bones() {
    if (!document_.armature) return;
    const auto& bones = document_.armature->bones;
    rows.push_back({Row::Kind::Armature, "armature", "Rig", std::to_string(bones.size()), icon::kRig, 0, 0,
                    !bones.empty(), open("armature", true)});
    rows.back().visible = context_.views->bones;
    if (!rows.back().open) return;
    children_.assign(bones.size() + 1, {});
    for (int b = 0; b < std::ssize(bones); ++b) children_[bones[b].parent + 1].push_back(b);
    for (const int root : children_[0]) add_bone(root, 1);
  }

  void add_bone(int b, int depth) {
    const Bone& bone = document_.armature->bones[b];
    const std::string key = "bone " + bone.name;
    rows.push_back({Row::Kind::Bone, key, bone.name, "", "", std::min(depth, kDeepest), b, !children_[b + 1].empty(),
                    open(key, std::ssize(document_.armature->bones) <= kManyBones || depth < 2)});
    rows.back().chosen = context_.selection->bones.contains(b);
    if (!rows.back().open) return;
    for (const int child : children_[b + 1]) add_bone(child, depth + 1);
  }

  void add_results() {
    if (document_.results.empty()) return;
    rows.push_back({Row::Kind::Results, "results", "Results", std::to_string(document_.results.size()), icon::kResample,
                    0, 0, true, open("results", true)});
    if (!rows.back().open) return;
    const auto shown = shown_result(context_);
    for (int i = 0; i < std::ssize(document_.results); ++i) {
      const Result& result = *document_.results[i];
      rows.push_back(
          {Row::Kind::Result, "result " + result.name, result.name, method_name(result.method), icon::kResample, 1, i});
      rows.back().chosen = rows.back().visible.emplace(document_.results[i] == shown);
    }
  }

  // Removes all rows except those that match the search and the ancestors of these rows. The loop runs from the last
  // row to the first, so that all children of a row have been visited before the row itself.
  void keep_found() {
    std::vector<Row> kept;
    int needed = 0;  // depth of the last kept row; the next row with a smaller depth is its parent
    for (auto row = rows.rbegin(); row != rows.rend(); ++row) {
      const bool found = contains_ignoring_case(row->name, context_.outliner->search);
      if (!found && row->depth >= needed) continue;
      needed = row->depth;
      kept.push_back(*row);
    }
    rows.assign(kept.rbegin(), kept.rend());
  }

  const Context& context_;
  const Document& document_;
  std::vector<std::vector<int>> children_;  // indices of the children of each bone, at [bone + 1]; [0]: the root bones
};

// ---- Actions on a row

void toggle_eye(Context& context, const Row& row, bool alone) {
  std::set<Label> all;
  if (context.document().tissues)
    for (const Tissue& tissue : context.document().tissues->tissues) all.insert(tissue.label);
  switch (row.kind) {
    case Row::Kind::Volume:
    case Row::Kind::Tissues: return show_tissues(context, all, !*row.visible);
    case Row::Kind::Tissue: {
      const Label label = context.document().tissues->tissues[row.index].label;
      return alone ? solo_tissues(context, {label}) : show_tissues(context, {label}, !*row.visible);
    }
    case Row::Kind::Armature: context.views->bones = !context.views->bones; return context.ui->touch();
    case Row::Kind::Result: show_result(context, *row.visible ? "" : row.name); return context.ui->touch();
    default: return;
  }
}

void choose(Context& context, const Row& row, bool extended) {
  Selection& selection = context.selection;
  if (row.kind == Row::Kind::Tissue)
    return select_tissue(context, context.document().tissues->tissues[row.index].label, extended);
  if (row.kind != Row::Kind::Bone) return;
  if (!extended) selection.bones.clear();
  if (extended && selection.bones.erase(row.index) > 0) {
    if (selection.bone == row.index)
      selection.bone = selection.bones.empty() ? std::nullopt : std::optional(*selection.bones.begin());
    return;
  }
  selection.bone = row.index;
  selection.bones.insert(row.index);
}

bool can_rename(const Row& row) {
  return row.kind == Row::Kind::Tissue || row.kind == Row::Kind::Result || row.kind == Row::Kind::Bone;
}

void rename(Context& context, const Row& row, const std::string& name) {
  if (row.kind == Row::Kind::Tissue) rename_tissue(context, context.document().tissues->tissues[row.index].label, name);
  if (row.kind == Row::Kind::Bone) rename_bone(context, row.index, name);
  if (row.kind == Row::Kind::Result) rename_result(context, context.document().results[row.index], name);
}

void open_menu(Context& context, const Row& row) {
  switch (row.kind) {
    case Row::Kind::Volume:
    case Row::Kind::Tissues: context.menus->open_popup = "Volume"; return;
    case Row::Kind::Armature: context.menus->open_popup = "Rig"; return;
    case Row::Kind::Bone:
      context.menus->open_popup = context.workspace() == Workspace::Rig    ? "Bone"
                                  : context.workspace() == Workspace::Pose ? "Posed bone"
                                                                           : "Rig";
      return;
    case Row::Kind::Tissue: context.menus->open_popup = "Tissue"; return;
    case Row::Kind::Results: return;
    case Row::Kind::Result:
      show_result(context, row.name);
      context.menus->open_popup = "Result";
      return;
  }
}

// ---- Drawing the rows

void draw_fold(Context& context, const Row& row, const Rect& rect) {
  if (!row.folds) return;
  if (press_area(context.ui, "fold", rect).clicked) {
    context.outliner->open[row.key] = !row.open;
    context.ui->touch();
  }
  put_icon(context.ui->look.fonts.regular, context.ui->look.theme.text2, rect,
           row.open ? icon::kOpened : icon::kClosed);
}

void draw_eye(Context& context, const Row& row, const Rect& rect) {
  if (!row.visible) return;
  const Look& look = context.ui->look;
  const Pressed eye = press_area(context.ui, "eye", rect);
  put_icon(look.fonts.regular, *row.visible || eye.hovered ? look.theme.text2 : look.theme.text3, rect,
           *row.visible ? icon::kVisible : icon::kHidden);
  if (eye.hovered)
    tooltip(context.ui, rect, *row.visible ? "Hide" : "Show",
            row.kind == Row::Kind::Tissue ? "Ctrl+click shows only this tissue." : "");
  if (eye.clicked) toggle_eye(context, row, context.ui->input.down(Key::Ctrl));
}

// Returns the bones that get a new parent when the user drags a bone's row: all selected bones if the dragged bone is
// selected, otherwise only the dragged bone. The row on which the user drops them becomes their parent; on the
// armature's row, they lose their parent. Escape cancels the drag.
std::vector<int> dragged_bones(const Context& context) {
  const auto bone = context.document().armature->find(context.transform_settings->row_drag.bone);
  if (!bone) return {};
  const std::set<int>& chosen = context.selection->bones;
  return chosen.contains(*bone) ? std::vector<int>(chosen.begin(), chosen.end()) : std::vector<int>{*bone};
}

void take_drag(Context& context, const Row& row, const Pressed& pressed) {
  auto& drag = context.transform_settings->row_drag;
  if (row.kind != Row::Kind::Bone || context.workspace() != Workspace::Rig) return;
  if (pressed.activated) drag = {row.name, context.ui->input.pointer, false};
  if (drag.bone == row.name && pressed.held)
    drag.moved |= glm::distance(context.ui->input.pointer, drag.begin) > context.ui->look.px(6);
}

// Draws a text beside the pointer that says what happens if the user drops the dragged row here.
void draw_dragged(Context& context, const std::string& words) {
  const Look& look = context.ui->look;
  const glm::vec2 size = text_size(look.fonts.regular, words) + glm::vec2(look.px(16), look.px(8));
  glm::vec2 low = context.ui->input.pointer + glm::vec2(look.px(14), look.px(10));
  low.x = std::min(low.x, context.screen->layout.window.high.x - size.x - look.px(4));
  ImDrawList& canvas = *ImGui::GetForegroundDrawList();
  canvas.AddRectFilled(im(low), im(low + size), look.theme.raised, look.px(4));
  canvas.AddRect(im(low), im(low + size), look.theme.line2, look.px(4), 0, look.line());
  canvas.AddText(look.fonts.regular, look.fonts.regular->FontSize, im(low + glm::vec2(look.px(8), look.px(4))),
                 look.theme.text, words.c_str());
}

void draw_drag(Context& context, const Row& row, const Rect& rect) {
  const auto& drag = context.transform_settings->row_drag;
  if (!drag.moved || !rect.contains(context.ui->input.pointer) ||
      (row.kind != Row::Kind::Bone && row.kind != Row::Kind::Armature))
    return;
  const std::vector<int> bones = dragged_bones(context);
  if (row.kind == Row::Kind::Bone && std::find(bones.begin(), bones.end(), row.index) != bones.end()) return;
  const int parent = row.kind == Row::Kind::Bone ? row.index : -1;
  outline(rect, context.ui->look.theme.select, 0, 2 * context.ui->look.line());
  const std::string what = bones.size() == 1 ? drag.bone : std::to_string(bones.size()) + " bones";
  draw_dragged(context, parent < 0 ? "Clear parent of " + what : "Parent " + what + " to " + row.name);
  if (context.ui->input.down(MouseButton::Left) || bones.empty()) return;
  attempt(context, "Make parent", [&](Context& c) {
    hang_on(c, bones, parent);
    c.outliner->open[row.key] = true;  // unfold the new parent, so that the bones stay visible
  });
}

void draw_row(Context& context, Column& column, int index, const Row& row) {
  const Look& look = context.ui->look;
  Rect rect;
  const std::string renamed = kList + row.key;
  if (is_renaming(context.ui, renamed) && !context.ui->renaming->shown) focus_list(context.ui, kList, index);
  if (!column.list_row(rect, index, row.chosen, kList)) return;
  const PathScope path(context.ui, row.key);
  const float x = rect.low.x + look.px(8 + 14 * static_cast<float>(row.depth)), end = rect.high.x - look.px(30);
  draw_fold(context, row, {{x, rect.low.y}, {x + look.px(16), rect.high.y}});
  draw_eye(context, row, {{end, rect.low.y}, {rect.high.x - look.px(6), rect.high.y}});

  const Rect icon{{x + look.px(18), rect.low.y}, {x + look.px(36), rect.high.y}};
  const bool active_bone = row.kind == Row::Kind::Bone && context.selection->bone == row.index;
  if (row.swatch) {
    const glm::vec2 side(look.px(7));
    const Rect swatch{glm::round(icon.centre() - side), glm::round(icon.centre() + side)};
    fill(swatch, *row.swatch, look.px(3));
    outline(swatch, look.theme.line2, look.px(3), look.line());
  } else if (row.kind == Row::Kind::Bone) {
    put_bone_icon(look, icon, active_bone ? look.theme.select : row.chosen ? look.theme.accent_text : look.theme.text2);
  } else {
    put_icon(look.fonts.regular, row.chosen ? look.theme.accent_text : look.theme.text2, icon, row.icon);
  }

  const float count = row.count.empty() ? 0 : text_size(look.fonts.small, row.count).x + look.px(8);
  const Rect name{{icon.high.x, rect.low.y}, {end, rect.high.y}},
      words{{name.low.x + look.px(4), rect.low.y}, {end - count, rect.high.y}};
  if (is_renaming(context.ui, renamed)) {
    std::string accepted = row.name;
    if (rename_field(context.ui, {words.low + glm::vec2(0, look.px(1)), words.high - glm::vec2(0, look.px(1))},
                     accepted))
      rename(context, row, accepted);
    return;
  }
  const Pressed pressed = press_area(context.ui, "name", name);
  const bool faint = row.visible == false && row.kind != Row::Kind::Result;
  put_text(context.ui, look.fonts.regular, faint ? (row.chosen ? look.theme.text2 : look.theme.text3) : look.theme.text,
           words, row.name);
  put_text(context.ui, look.fonts.small, row.chosen ? look.theme.text2 : look.theme.text3,
           Rect{{end - count, rect.low.y}, {end - look.px(4), rect.high.y}}, row.count, Align::Right);
  take_drag(context, row, pressed);
  draw_drag(context, row, rect);
  if (pressed.clicked && !context.transform_settings->row_drag.moved) {
    focus_list(context.ui, kList, index);
    choose(context, row, context.ui->input.down(Key::Ctrl) || context.ui->input.down(Key::Shift));
  }
  if (pressed.double_clicked)
    can_rename(row) ? begin_renaming(context.ui, renamed, row.name) : void(context.outliner->open[row.key] = !row.open);
  if (pressed.right_clicked) {
    if (!row.chosen) choose(context, row, false);
    open_menu(context, row);
  }
}

void take_key(Context& context, const std::vector<Row>& rows) {
  const ListKey key = list_key(context.ui, kList, static_cast<int>(rows.size()));
  if (key == ListKey::None || rows.empty()) return;
  const Row& row = rows[context.ui->list_focus.row];
  switch (key) {
    case ListKey::Moved: return choose(context, row, false);
    case ListKey::Activate:
      return row.folds                       ? void(context.outliner->open[row.key] = !row.open)
             : row.kind == Row::Kind::Result ? toggle_eye(context, row, false)
                                             : choose(context, row, false);
    case ListKey::Toggle: return row.visible ? toggle_eye(context, row, false) : void();
    case ListKey::Rename: return can_rename(row) ? begin_renaming(context.ui, kList + row.key, row.name) : void();
    case ListKey::Unfold:
      if (row.folds) context.outliner->open[row.key] = true;
      return;
    case ListKey::Fold: {
      if (row.folds && row.open) return void(context.outliner->open[row.key] = false);
      for (int i = context.ui->list_focus.row; i >= 0; --i)
        if (rows[i].depth < row.depth) return focus_list(context.ui, kList, i);
      return;
    }
    case ListKey::None: return;
  }
}

// Returns the index of the first row to select for the search: the first tissue, bone or result whose name matches,
// otherwise the first other row whose name matches, otherwise 0. Rows of parents are also shown, but their own names
// need not match.
int first_found(const OutlinerState& outliner, const std::vector<Row>& rows) {
  const auto matches = [&](const Row& row) { return contains_ignoring_case(row.name, outliner.search); };
  auto found = std::find_if(rows.begin(), rows.end(), [&](const Row& row) { return can_rename(row) && matches(row); });
  if (found == rows.end()) found = std::find_if(rows.begin(), rows.end(), matches);
  return found == rows.end() ? 0 : static_cast<int>(found - rows.begin());
}

// Returns true if the user has changed the search.
bool draw_search(Context& context, Column& column) {
  if (!context.outliner->searching) return false;
  const std::string before = context.outliner->search;
  const Look& look = context.ui->look;
  const Rect row = column.row(32);
  const bool focus = std::exchange(context.outliner->focus_search, false);
  text_field(context.ui, "search",
             {row.low + glm::vec2(look.px(10), look.px(4)), row.high - glm::vec2(look.px(10), look.px(4))},
             context.outliner->search, "Search the project", focus);
  if ((ImGui::IsItemActive() || ImGui::IsItemDeactivated()) &&
      (ImGui::IsKeyPressed(static_cast<int>(Key::Down)) || ImGui::IsKeyPressed(static_cast<int>(Key::Return)))) {
    ImGui::ClearActiveID();
    const std::vector<Row> rows = Tree(context).rows;
    const int found = first_found(context.outliner, rows);
    focus_list(context.ui, kList, found);
    if (!rows.empty() && !context.outliner->search.empty())
      choose(context, rows[static_cast<std::size_t>(found)], false);
  }
  return context.outliner->search != before && !context.outliner->search.empty();
}

// Unfolds the armature and all ancestors of a bone.
void unfold_to(Context& context, int bone) {
  const auto& bones = context.document().armature->bones;
  context.outliner->open["armature"] = true;
  for (int above = bones[bone].parent; above >= 0; above = bones[above].parent)
    context.outliner->open["bone " + bones[above].name] = true;
}

// Returns the active bone if another bone was active in the last frame, so that the list scrolls to it. Otherwise
// returns nothing.
std::optional<int> newly_chosen(const Context& context) {
  const auto bone = context.selection->bone;
  const std::shared_ptr<const Armature> rig = context.document().armature;
  const bool known = bone && rig && *bone < std::ssize(rig->bones);
  const int now = known ? static_cast<int>(ImGui::GetID(rig->bones[*bone].name.c_str())) : 0;
  int& last = *ImGui::GetStateStorage()->GetIntRef(ImGui::GetID("chosen bone"), 0);
  return std::exchange(last, now) != now && known ? bone : std::nullopt;
}

// Returns the height of the list, px at scale 1. This is the height of all rows (`whole`). In the Rig workspace the
// list may be lower, so that the numbers of the active bone fit below it.
float height_of_list(const Context& context, const Column& column, float whole) {
  const Look& look = context.ui->look;
  if (context.workspace() != Workspace::Rig || !context.document().armature) return whole;
  const float top = column.head().high.y + ImGui::GetScrollY() - context.screen->layout.sidebar.low.y +
                    (context.outliner->searching ? look.px(32) : 0);
  const float room = std::floor((context.screen->layout.sidebar.height() - top) / look.scale - kBoneSection);
  // While the pointer is over the sidebar, the list keeps its height, so that nothing moves under the pointer.
  float& rows = *ImGui::GetStateStorage()->GetFloatRef(ImGui::GetID("rows"), -1);
  float& height = *ImGui::GetStateStorage()->GetFloatRef(ImGui::GetID("height"), -1);
  if (rows == whole &&
      (context.screen->layout.sidebar.contains(context.ui->input.pointer) || context.ui->input.down(MouseButton::Left)))
    return height;
  rows = whole;
  return height = std::min(whole, std::max(kRow * kFewestRows, room));
}

// Scrolls the current ImGui window so that a row of the list is in the middle. Does nothing if the row is already
// visible.
//   above  height of the window's content above the list's first row, pixels
void scroll_to_row(const Look& look, int row, float height, float above = 0) {
  const float top = above + look.px(kRow) * static_cast<float>(row), scroll = ImGui::GetScrollY();
  if (top < scroll || top + look.px(kRow) > scroll + height)
    ImGui::SetScrollY(std::max(0.0f, top - (height - look.px(kRow)) / 2));
}

}  // namespace

void draw_outliner(Context& context, Column& column) {
  const Look& look = context.ui->look;
  const bool open = column.begin_section("Outliner");
  const Rect head = column.head(), place{{head.high.x - look.px(34), head.low.y + look.px(2)},
                                         {head.high.x - look.px(6), head.high.y - look.px(2)}};
  const Operator& search = *find_operator(context.operators, "view.find");
  if (button(context.ui, "Search outliner", place,
             {icon::kSearch, "", context.outliner->searching ? ButtonStyle::Soft : ButtonStyle::Flat})) {
    if (context.outliner->searching) context.outliner->searching = false, context.outliner->search.clear();
    else run(context, search);
  }
  if (ImGui::IsItemHovered()) operator_tooltip(context, search, place);
  if (open) {
    const bool is_new_search = draw_search(context, column);
    const auto revealed = newly_chosen(context);
    if (revealed) unfold_to(context, *revealed);
    const std::vector<Row> rows = Tree(context).rows;
    take_key(context, rows);
    auto& drag = context.transform_settings->row_drag;
    if (context.ui->input.down(Key::Escape)) drag = {};
    const float whole = kRow * static_cast<float>(rows.size()), height = height_of_list(context, column, whole);
    if (height >= whole) {
      const Rect& sidebar = context.screen->layout.sidebar;
      const float above = column.row(0).low.y + ImGui::GetScrollY() - sidebar.low.y;
      if (is_new_search && !rows.empty())
        scroll_to_row(look, first_found(context.outliner, rows), sidebar.height(), above);
      for (int i = 0; i < std::ssize(rows); ++i) draw_row(context, column, i, rows[i]);
    } else {
      const Rect place = column.row(height);
      Column list(context.ui, "", place);
      const auto is_revealed = [&](const Row& row) { return row.kind == Row::Kind::Bone && row.index == *revealed; };
      if (revealed)
        if (const auto row = std::find_if(rows.begin(), rows.end(), is_revealed); row != rows.end())
          scroll_to_row(look, static_cast<int>(row - rows.begin()), place.height());
      if (is_new_search) scroll_to_row(look, first_found(context.outliner, rows), place.height());
      for (int i = 0; i < std::ssize(rows); ++i) draw_row(context, list, i, rows[i]);
    }
    if (!context.ui->input.down(MouseButton::Left)) drag = {};
    if (rows.empty() && context.outliner->search.empty()) {
      const Rect row = column.row(30);
      put_text(context.ui, look.fonts.regular, look.theme.text2, Rect{{row.low.x + look.px(10), row.low.y}, row.high},
               "No project is open");
    } else if (rows.empty() &&
               empty_state(context.ui, column.row(72),
                           "Nothing in the project is named '" + context.outliner->search + "'", "Clear search")) {
      context.outliner->search.clear();
    }
  }
  column.end_section();
}

}  // namespace limber::editor
