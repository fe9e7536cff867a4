// SPDX-License-Identifier: AGPL-3.0-or-later
// The facts about the editor that a script can check with `expect`.
#include <algorithm>
#include <cstdio>
#include <functional>

#include <imgui_internal.h>

#include "core/base/error.h"
#include "core/deform/preview_map.h"
#include "editor/app/script_player.h"
#include "editor/motion/timeline.h"
#include "editor/skin/weight_display.h"

namespace limber::editor {

namespace {

// An FNV-1a hash, 64 bits.
class Hash {
 public:
  template <class T>
  void add(const T& value) {
    add_bytes(&value, sizeof value);
  }
  void add_bytes(const void* bytes, std::size_t count) {
    for (std::size_t i = 0; i < count; ++i)
      value_ = (value_ ^ static_cast<const unsigned char*>(bytes)[i]) * 1099511628211ull;
  }
  void add(const std::string& text) {
    add(text.size());
    add_bytes(text.data(), text.size());
  }
  std::string text() const {
    char digits[17];
    std::snprintf(digits, sizeof digits, "%016llx", static_cast<unsigned long long>(value_));
    return digits;
  }

 private:
  std::uint64_t value_ = 14695981039346656037ull;
};

std::string hidden(const Editor& editor) {
  int count = 0;
  if (editor.document().visibility)
    for (const auto& [label, look] : editor.document().visibility->looks) count += !look.visible;
  return std::to_string(count);
}

// Returns the content of the text field that has the keyboard. Returns no value if no text field has it.
std::optional<std::string> typed_text(const Editor& editor) {
  ImGui::SetCurrentContext(editor.imgui);
  const ImGuiInputTextState* state = ImGui::GetInputTextState(ImGui::GetActiveID());
  if (!editor.keyboard.typed || !state) return std::nullopt;
  return std::string(state->TextA.Data);
}

std::string yes(bool is) { return is ? "yes" : "no"; }

using Fact = std::function<std::string(const Editor&)>;

const std::vector<std::pair<std::string, Fact>>& facts() {
  static const std::vector<std::pair<std::string, Fact>> all = {
      {"workspace",
       [](const Editor& e) {
         constexpr const char* kNames[] = {"rig", "skin", "pose", "resample"};
         return std::string(kNames[static_cast<int>(e.workspace)]);
       }},
      {"layout",
       [](const Editor& e) {
         constexpr const char* kNames[] = {"one", "split", "four"};
         return std::string(kNames[static_cast<int>(e.arrangement().views)]);
       }},
      {"maximized",
       [](const Editor& e) {
         return e.arrangement().maximized ? name_of(*e.arrangement().maximized) : std::string("no");
       }},
      {"display",
       [](const Editor& e) {
         constexpr const char* kNames[] = {"solid", "xray", "tissue"};
         return std::string(kNames[static_cast<int>(e.views->display)]);
       }},
      {"weights",
       [](const Editor& e) {
         constexpr const char* kNames[] = {"active", "dominant", "mixed", "count", "field"};
         return std::string(!e.views->scene.weights ? "none"
                                                    : kNames[static_cast<int>(e.views->scene.weights->display)]);
       }},
      {"bone",
       [](const Editor& e) {
         const auto bone = e.workspace == Workspace::Skin ? skin_bone(e) : e.selection.bone;
         return bone && e.document().armature && *bone < std::ssize(e.document().armature->bones)
                    ? e.document().armature->bones[static_cast<std::size_t>(*bone)].name
                    : std::string("none");
       }},
      {"locked",
       [](const Editor& e) { return std::to_string(e.document().locks ? e.document().locks->bones.size() : 0); }},
      {"slices",
       [](const Editor& e) {
         return std::string(e.views->slice_display == render::SliceDisplay::Labels ? "labels" : "outline");
       }},
      {"view", [](const Editor& e) { return e.views->body.name.empty() ? std::string("free") : e.views->body.name; }},
      {"projection",
       [](const Editor& e) {
         return std::string(e.views->body.camera.projection == render::Projection::Perspective ? "perspective"
                                                                                               : "parallel");
       }},
      {"sidebar", [](const Editor& e) { return yes(!e.layout.sidebar.empty()); }},
      {"strip", [](const Editor& e) { return yes(!e.layout.tool_strip.empty()); }},
      {"console", [](const Editor& e) { return yes(!e.layout.bottom.empty() && e.arrangement().console); }},
      {"frame", [](const Editor& e) { return std::to_string(shown_frame(e)); }},
      {"playing", [](const Editor& e) { return yes(e.timeline->play.on); }},
      {"clip", [](const Editor& e) { return shown_clip(e) ? shown_clip(e)->name : std::string("none"); }},
      {"keys",
       [](const Editor& e) { return std::to_string(shown_clip(e) ? frames_of(shown_clip(e)->keys).size() : 0); }},
      {"theme", [](const Editor& e) { return e.preferences.theme; }},
      {"tool",
       [](const Editor& e) {
         constexpr const char* kNames[] = {"select", "cross-hair", "move", "rotate", "scale", "reach", "extrude"};
         return std::string(kNames[static_cast<int>(e.tool)]);
       }},
      {"selected", [](const Editor& e) { return std::to_string(e.selection.tissues.size()); }},
      {"tissue",
       [](const Editor& e) { return e.selection.tissue ? std::to_string(*e.selection.tissue) : std::string("none"); }},
      {"hidden", hidden},
      {"volume", [](const Editor& e) { return yes(e.document().volume != nullptr); }},
      {"clip-box",
       [](const Editor& e) { return yes(e.document().visibility && e.document().visibility->clip_box.enabled); }},
      {"clip-plane",
       [](const Editor& e) { return yes(e.document().visibility && e.document().visibility->clip_plane.enabled); }},
      {"history", [](const Editor& e) { return std::to_string(e.history.steps().size()); }},
      {"position", [](const Editor& e) { return std::to_string(e.history.position()); }},
      {"edit", [](const Editor& e) { return e.history.steps()[e.history.position()].label; }},
      {"unsaved", [](const Editor& e) { return yes(e.history.unsaved()); }},
      {"document", [](const Editor& e) { return document_hash(e.document()); }},
      {"name", [](const Editor& e) { return e.name; }},
      {"posed",
       [](const Editor& e) {
         return e.views->scene.pose ? std::to_string(e.views->scene.pose->step) : std::string("no");
       }},
      {"jobs", [](const Editor& e) { return yes(e.jobs.busy()); }},
      {"toast",
       [](const Editor& e) { return e.messages.toasts.empty() ? std::string("none") : e.messages.toasts.back().line; }},
      {"error",
       [](const Editor& e) {
         return e.messages.errors.empty() ? std::string("none") : e.messages.errors.front().what;
       }},
      {"typed", [](const Editor& e) { return typed_text(e).value_or("no field"); }},
      {"dialog", [](const Editor& e) { return yes(e.dialog != nullptr); }},
      {"quit", [](const Editor& e) { return yes(e.quit); }},
  };
  return all;
}

}  // namespace

std::vector<std::string> fact_names() {
  std::vector<std::string> names;
  for (const auto& [name, value] : facts()) names.push_back(name);
  names.insert(names.end(), {"text:WORDS", "widget:NAME"});
  return names;
}

std::string fact(const Editor& editor, const std::string& name) {
  if (name.starts_with("text:")) {
    const auto& texts = editor.widgets.texts();
    const std::string wanted = name.substr(5);
    return std::any_of(texts.begin(), texts.end(),
                       [&](const std::string& text) { return text.find(wanted) != std::string::npos; })
               ? "shown"
               : "absent";
  }
  if (name.starts_with("widget:")) return editor.widgets.find(name.substr(7)) ? "shown" : "absent";
  for (const auto& [known, value] : facts())
    if (known == name) return value(editor);
  throw Error("the fact is unknown", name, "write one of those that the script's documentation lists");
}

std::string document_hash(const Document& document) {
  Hash hash;
  if (document.volume) {
    hash.add(document.volume->grid.size);
    hash.add(document.volume->grid.spacing);
    hash.add(document.volume->grid.origin);
    hash.add_bytes(document.volume->voxels.data(), document.volume->voxels.size() * sizeof(Label));
  }
  if (document.tissues)
    for (const Tissue& tissue : document.tissues->tissues) {
      hash.add(tissue.label);
      hash.add(tissue.name);
      hash.add(tissue.colour);
      hash.add(tissue.kind);
      for (const double number : {tissue.density, tissue.young_modulus, tissue.poisson_ratio}) hash.add(number);
    }
  if (document.visibility) {
    for (const auto& [label, look] : document.visibility->looks) {
      hash.add(label);
      hash.add(look.visible);
      hash.add(look.opacity);
    }
    hash.add(document.visibility->clip_box.enabled);
    hash.add(document.visibility->clip_box.low);
    hash.add(document.visibility->clip_box.high);
    hash.add(document.visibility->clip_plane.enabled);
    hash.add(document.visibility->clip_plane.point);
    hash.add(document.visibility->clip_plane.normal);
  }
  if (document.armature)
    for (const Bone& bone : document.armature->bones) {
      hash.add(bone.name);
      hash.add(bone.head);
      hash.add(bone.tail);
    }
  if (document.locks)
    for (const std::string& bone : document.locks->bones) hash.add(bone);
  return hash.text();
}

}  // namespace limber::editor
