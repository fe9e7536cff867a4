// SPDX-License-Identifier: AGPL-3.0-or-later
// Draws the keymap page: every command with its keys, grouped by the context in which the keys work. After a click on
// the keys, the page waits until the user presses the new key.
#include <algorithm>
#include <set>

#include "editor/context/context.h"
#include "editor/context/keep_preferences.h"
#include "editor/context/operator_button.h"
#include "editor/context/operator_registry.h"
#include "editor/context/preferences.h"
#include "editor/screen/preferences_dialog.h"
#include "editor/ui/fuzzy_match.h"
#include "editor/ui/icons.h"
#include "editor/ui/input_fields.h"

namespace limber::editor {

namespace {

constexpr std::pair<const char*, const char*> kContexts[] = {
    {"global", "Everywhere"}, {"view3d", "3D view"},    {"slice", "Slices"}, {"sidebar", "Sidebar"},
    {"select", "Selection"},  {"rig", "Rig"},           {"skin", "Skin"},    {"pose", "Pose"},
    {"resample", "Resample"}, {"timeline", "Timeline"}, {"graph", "Graph"},  {"strips", "Strips"}};

const Clash* clash_of(const std::vector<Clash>& clashes, const std::string& key_context, const std::string& id) {
  const auto found = std::find_if(clashes.begin(), clashes.end(), [&](const Clash& clash) {
    return clash.context == key_context &&
           std::find(clash.operators.begin(), clash.operators.end(), id) != clash.operators.end();
  });
  return found == clashes.end() ? nullptr : &*found;
}

std::string label_of(const OperatorRegistry& operators, const std::string& id) {
  const Operator* op = find_operator(operators, id);
  return op ? op->label : id;
}

std::string others_of(const OperatorRegistry& operators, const Clash& clash, const std::string& id) {
  std::string others;
  for (const std::string& other : clash.operators)
    if (other != id) others += (others.empty() ? "" : ", ") + label_of(operators, other);
  return others;
}

// Returns true if two texts are equal except for upper and lower case, because users type "ctrl+z" for Ctrl+Z.
bool same_ignoring_case(const std::string& a, const std::string& b) {
  return a.size() == b.size() && contains_ignoring_case(a, b);
}

}  // namespace

std::string title_of_context(const std::string& key_context) {
  for (const auto& [id, title] : kContexts)
    if (key_context == id) return title;
  return key_context;
}

std::vector<KeymapPage::Row> KeymapPage::rows(const Context& context) const {
  std::vector<Row> rows;
  std::set<std::string> bound;
  const auto add = [&](const std::string& key_context, const std::string& id) {
    const Operator* op = find_operator(context.operators, id);
    if (!op || std::any_of(rows.begin(), rows.end(),
                           [&](const Row& row) { return row.context == key_context && row.operator_id == id; }))
      return;
    bound.insert(id);
    rows.push_back({key_context, id, op->label});
  };
  for (const auto& [key_context, title] : kContexts) {
    if (const auto bindings = context.keymap->contexts.find(key_context); bindings != context.keymap->contexts.end())
      for (const Binding& binding : bindings->second) add(key_context, binding.operator_id);
    for (const auto& [place, keys] : context.preferences->keys)  // also list commands whose keys the user has removed
      if (place.first == key_context) add(key_context, place.second);
  }
  for (const Operator& op : context.operators->all)
    if (!bound.contains(op.id)) add("global", op.id);
  std::erase_if(rows, [&](const Row& row) {
    if (fuzzy_match(search_, row.label)) return false;
    for (const Chord& chord : chords_of(context.keymap, row.context, row.operator_id))
      if (same_ignoring_case(to_text(chord), search_)) return false;
    return true;
  });
  return rows;
}

bool KeymapPage::stop_waiting() { return !std::exchange(waiting_operator_, "").empty(); }

bool KeymapPage::key(Context& context, const Chord& chord) {
  if (waiting_operator_.empty()) return false;
  // Replace all keys of the command by the new key, and keep its mouse buttons and wheel. If the new key is Delete or
  // Backspace without modifiers, only remove the command's keys.
  std::vector<Chord> chords = chords_of(context.keymap, waiting_context_, waiting_operator_);
  std::erase_if(chords, [](const Chord& old) { return old.kind == Chord::Kind::Key; });
  const bool clear = chord.modifiers == Modifiers{} && (chord.key == Key::Delete || chord.key == Key::Backspace);
  if (!clear) chords.insert(chords.begin(), chord);
  rebind(context.preferences->keys, keymap_preset(context.preferences->keymap), waiting_context_, waiting_operator_,
         chords);
  waiting_operator_.clear();
  keep_preferences(context);
  return true;
}

void KeymapPage::draw_head(Context& context, const Rect& rect) {
  const Look& look = context.ui->look;
  const float y = rect.low.y + look.px(9), bottom = y + look.px(26);
  const float right = rect.high.x - look.px(12), width = look.px(70), undo = look.px(30);
  const float presets = right - undo - look.px(6) - 3 * width;
  text_field(context.ui, "search", {{rect.low.x + look.px(12), y}, {presets - look.px(12), bottom}}, search_,
             "Search commands, or a key such as Ctrl+Z");
  Preferences& preferences = context.preferences;
  const bool custom = !preferences.keys.empty();
  const auto place = [&](int i) {
    return Rect{{presets + width * static_cast<float>(i), y},
                {presets + width * static_cast<float>(i + 1) - look.px(1), bottom}};
  };
  int i = 0;
  for (const auto& [name, label] : {std::pair("blender", "Blender"), std::pair("maya", "Maya")}) {
    const bool chosen = !custom && preferences.keymap == name;
    if (button(context.ui, label, place(i), {"", label, chosen ? ButtonStyle::Chosen : ButtonStyle::Plain}) &&
        !chosen) {
      preferences.keymap = name;
      preferences.keys.clear();
      keep_preferences(context);
    }
    if (ImGui::IsItemHovered())
      tooltip(context.ui, place(i), label,
              std::string("Use keys similar to ") + label + "'s. Discards all changes of your own.");
    ++i;
  }
  button(context.ui, "Custom", place(i), {"", "Custom", custom ? ButtonStyle::Chosen : ButtonStyle::Plain});
  if (ImGui::IsItemHovered())
    tooltip(context.ui, place(i), "Custom",
            "The keymap with your own changes. Click the keys beside a command to change them.");
  const Rect restore{{right - undo, y}, {right, bottom}};
  if (button(context.ui, "Restore all", restore, {icon::kUndo, "", ButtonStyle::Plain, custom})) {
    preferences.keys.clear();
    keep_preferences(context);
  }
  if (ImGui::IsItemHovered(ImGuiHoveredFlags_AllowWhenDisabled))
    tooltip(context.ui, restore, "Restore all",
            custom ? "Discard all your changes to the keymap." : "You have not changed any key.");
}

void KeymapPage::draw_row(Context& context, Column& column, int index, const Row& row,
                          const std::vector<Clash>& clashes) {
  const Look& look = context.ui->look;
  Rect rect;
  if (!column.list_row(rect, index, false)) return;
  const PathScope key_context(context.ui, row.context);
  const PathScope path(context.ui, row.operator_id);
  const bool waits = row.operator_id == waiting_operator_ && row.context == waiting_context_;
  const bool is_changed = context.preferences->keys.contains({row.context, row.operator_id});
  float right = rect.high.x - look.px(14);

  const Rect undo{{right - look.px(22), rect.low.y + look.px(1)}, {right, rect.high.y - look.px(1)}};
  if (is_changed) {
    if (button(context.ui, "restore", undo, {icon::kUndo, "", ButtonStyle::Flat})) {
      context.preferences->keys.erase({row.context, row.operator_id});
      keep_preferences(context);
    }
    if (ImGui::IsItemHovered()) tooltip(context.ui, undo, "Restore", "Restore this command's default keys.");
  }
  right = undo.low.x - look.px(6);

  const std::vector<Chord> chords = chords_of(context.keymap, row.context, row.operator_id);
  float width = 0;
  for (const Chord& chord : chords) width += width_of_key_caps(context.ui, key_caps(chord)) + look.px(12);
  width = std::max(width, look.px(60));
  if (waits) width = look.px(110);
  const Rect keys{{right - width, rect.low.y}, {right, rect.high.y}};
  const Pressed pressed = press_area(context.ui, "keys", keys);
  if (pressed.hovered && !waits) {
    fill(keys, look.theme.hover, look.px(4));
    tooltip(context.ui, keys, "Change", "Click here, then press the new key. Delete removes the key, Esc cancels.");
  }
  if (waits) {
    fill(keys, look.theme.accent_soft, look.px(4));
    put_text(context.ui, look.fonts.small, look.theme.accent_text, keys, "Press a key", Align::Centre);
  } else if (chords.empty()) {
    put_text(context.ui, look.fonts.small, look.theme.text3, keys, "no key", Align::Right);
  } else {
    float x = keys.high.x;
    for (auto chord = chords.rbegin(); chord != chords.rend(); ++chord) {
      const std::vector<std::string> caps = key_caps(*chord);
      x -= width_of_key_caps(context.ui, caps);
      put_key_caps(context.ui, x, rect.centre().y, caps);
      x -= look.px(12);
    }
  }
  if (pressed.clicked) {
    waiting_context_ = row.context;
    waiting_operator_ = waits ? "" : row.operator_id;
  }

  float label_right = keys.low.x - look.px(8);
  if (const Clash* clash = clash_of(clashes, row.context, row.operator_id)) {
    const std::string also = "also " + others_of(context.operators, *clash, row.operator_id);
    const float words = std::min(text_size(look.fonts.small, also).x + 1, look.px(180));
    put_text(context.ui, look.fonts.small, look.theme.warn,
             Rect{{label_right - words, rect.low.y}, {label_right, rect.high.y}}, also);
    put_icon(look.fonts.small, look.theme.warn,
             Rect{{label_right - words - look.px(20), rect.low.y}, {label_right - words, rect.high.y}}, icon::kWarning);
    label_right -= words + look.px(24);
  }
  put_text(context.ui, look.fonts.regular, look.theme.text,
           Rect{{rect.low.x + look.px(14), rect.low.y}, {label_right, rect.high.y}}, row.label);
}

void KeymapPage::draw_foot(Context& context, const Rect& rect, const std::vector<Clash>& clashes) {
  const Look& look = context.ui->look;
  fill({rect.low, {rect.high.x, rect.low.y + look.line()}}, look.theme.line2);
  const float left = rect.low.x + look.px(14), low = rect.low.y + look.px(8), high = rect.high.y - look.px(8);
  const Rect write{{rect.high.x - look.px(12 + 84), low}, {rect.high.x - look.px(12), high}},
      read{{write.low.x - look.px(8 + 84), low}, {write.low.x - look.px(8), high}};
  for (const auto& [id, label, place] :
       {std::tuple("edit.import_keymap", "Import...", read), std::tuple("edit.export_keymap", "Export...", write)}) {
    const Operator& op = *find_operator(context.operators, id);
    if (button(context.ui, label, place, {"", label})) run(context, op);
    if (ImGui::IsItemHovered()) operator_tooltip(context, op, place);
  }
  const float right = read.low.x - look.px(10);
  if (clashes.empty()) {
    put_text(context.ui, look.fonts.small, look.theme.text2, Rect{{left, rect.low.y}, {right, rect.high.y}},
             context.preferences->keys.empty()
                 ? "No key runs two commands"
                 : std::to_string(context.preferences->keys.size()) + " changed, no key runs two commands");
    return;
  }
  const Clash& first = clashes.front();
  const std::string count = clashes.size() == 1 ? "1 clash" : std::to_string(clashes.size()) + " clashes";
  const std::string words = to_text(first.chord) + " runs " + label_of(context.operators, first.operators.front()) +
                            ", not " + others_of(context.operators, first, first.operators.front());
  put_icon(look.fonts.regular, look.theme.warn, Rect{{left, rect.low.y}, {left + look.px(16), rect.high.y}},
           icon::kWarning);
  put_text(context.ui, look.fonts.regular, look.theme.warn,
           Rect{{left + look.px(22), rect.low.y}, {left + look.px(100), rect.high.y}}, count);
  put_text(context.ui, look.fonts.small, look.theme.text2,
           Rect{{left + look.px(100), rect.low.y}, {right, rect.high.y}}, words);
}

void KeymapPage::draw(Context& context, const Rect& rect) {
  const Look& look = context.ui->look;
  const std::vector<Clash> found = clashes(context.keymap);
  const Rect head{rect.low, {rect.high.x, rect.low.y + look.px(44)}},
      foot{{rect.low.x, rect.high.y - look.px(44)}, rect.high};
  draw_head(context, head);
  {
    Column column(context.ui, "keys", {{rect.low.x, head.high.y}, {rect.high.x, foot.low.y}});
    std::string last_context;
    int index = 0;
    const std::vector<Row> all = rows(context);
    for (const Row& row : all) {
      if (row.context != last_context && !(last_context.empty() && row.context.empty())) {
        const Rect title = column.row(26);
        if (ImGui::IsRectVisible(im(title.low), im(title.high)))
          put_text(context.ui, look.fonts.small, look.theme.text2,
                   Rect{{title.low.x + look.px(14), title.low.y}, title.high}, title_of_context(row.context));
        index = 0;
      }
      last_context = row.context;
      draw_row(context, column, index++, row, found);
    }
    if (all.empty() && empty_state(context.ui, column.row(72), "No command or key '" + search_ + "'", "Clear search"))
      search_.clear();
  }
  draw_foot(context, foot, found);
}

}  // namespace limber::editor
