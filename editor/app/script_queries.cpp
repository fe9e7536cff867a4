// SPDX-License-Identifier: AGPL-3.0-or-later
// The facts about the editor that a script can check with `expect`.
#include <algorithm>
#include <cstdio>
#include <functional>

#include <imgui_internal.h>

#include "core/base/error.h"
#include "core/deform/preview_map.h"
#include "core/project/job.h"
#include "editor/app/script_player.h"
#include "editor/context/dialogs.h"
#include "editor/context/interaction.h"
#include "editor/context/open_project.h"
#include "editor/context/screen.h"
#include "editor/context/selection.h"
#include "editor/context/views.h"
#include "editor/context/window_state.h"
#include "editor/motion/timeline.h"
#include "editor/shown/test_pose.h"
#include "editor/skin/weight_display.h"
#include "editor/ui/ui.h"

namespace limber::editor {

namespace {

// Computes the 64-bit FNV-1a hash of the values that are added.
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

std::string hidden(const Context& context) {
  int count = 0;
  if (context.document().visibility)
    for (const auto& [label, look] : context.document().visibility->looks) count += !look.visible;
  return std::to_string(count);
}

// Returns the content of the text field that has the keyboard. Returns no value if no text field has it.
std::optional<std::string> typed_text(const Context& context) {
  ImGui::SetCurrentContext(context.window->imgui);
  const ImGuiInputTextState* state = ImGui::GetInputTextState(ImGui::GetActiveID());
  if (!context.ui->keyboard.typed || !state) return std::nullopt;
  return std::string(state->TextA.Data);
}

std::string yes(bool is) { return is ? "yes" : "no"; }

using Fact = std::function<std::string(const Context&)>;

const std::vector<std::pair<std::string, Fact>>& facts() {
  static const std::vector<std::pair<std::string, Fact>> all = {
      {"workspace",
       [](const Context& c) {
         constexpr const char* kNames[] = {"rig", "skin", "pose", "resample"};
         return std::string(kNames[static_cast<int>(c.workspace())]);
       }},
      {"layout",
       [](const Context& c) {
         constexpr const char* kNames[] = {"one", "split", "four"};
         return std::string(kNames[static_cast<int>(c.screen->arrangement().views)]);
       }},
      {"maximized",
       [](const Context& c) {
         return c.screen->arrangement().maximized ? name_of(*c.screen->arrangement().maximized) : std::string("no");
       }},
      {"display",
       [](const Context& c) {
         constexpr const char* kNames[] = {"solid", "xray", "tissue"};
         return std::string(kNames[static_cast<int>(c.views->display)]);
       }},
      {"weights",
       [](const Context& c) {
         constexpr const char* kNames[] = {"active", "dominant", "mixed", "count", "field"};
         return std::string(!c.views->scene.weights ? "none"
                                                    : kNames[static_cast<int>(c.views->scene.weights->display)]);
       }},
      {"bone",
       [](const Context& c) {
         const auto bone = c.workspace() == Workspace::Skin ? skin_bone(c) : c.selection->bone;
         return bone && c.document().armature && *bone < std::ssize(c.document().armature->bones)
                    ? c.document().armature->bones[static_cast<std::size_t>(*bone)].name
                    : std::string("none");
       }},
      {"locked",
       [](const Context& c) { return std::to_string(c.document().locks ? c.document().locks->bones.size() : 0); }},
      {"slices",
       [](const Context& c) {
         return std::string(c.views->slice_display == render::SliceDisplay::Labels ? "labels" : "outline");
       }},
      {"view", [](const Context& c) { return c.views->body.name.empty() ? std::string("free") : c.views->body.name; }},
      {"projection",
       [](const Context& c) {
         return std::string(c.views->body.camera.projection == render::Projection::Perspective ? "perspective"
                                                                                               : "parallel");
       }},
      {"sidebar", [](const Context& c) { return yes(!c.screen->layout.sidebar.empty()); }},
      {"strip", [](const Context& c) { return yes(!c.screen->layout.tool_strip.empty()); }},
      {"console",
       [](const Context& c) { return yes(!c.screen->layout.bottom.empty() && c.screen->arrangement().console); }},
      {"frame", [](const Context& c) { return std::to_string(shown_frame(c)); }},
      {"playing", [](const Context& c) { return yes(c.timeline->play.on); }},
      {"clip",
       [](const Context& c) {
         return shown_clip(c.document()) ? shown_clip(c.document())->name : std::string("none");
       }},
      {"keys",
       [](const Context& c) {
         return std::to_string(shown_clip(c.document()) ? frames_of(shown_clip(c.document())->keys).size() : 0);
       }},
      {"theme", [](const Context& c) { return c.preferences->theme; }},
      {"tool",
       [](const Context& c) {
         constexpr const char* kNames[] = {"select", "cross-hair", "move", "rotate", "scale", "reach", "extrude"};
         return std::string(kNames[static_cast<int>(c.interaction->tool)]);
       }},
      {"selected", [](const Context& c) { return std::to_string(c.selection->tissues.size()); }},
      {"tissue",
       [](const Context& c) {
         return c.selection->tissue ? std::to_string(*c.selection->tissue) : std::string("none");
       }},
      {"hidden", hidden},
      {"volume", [](const Context& c) { return yes(c.document().volume != nullptr); }},
      {"clip-box",
       [](const Context& c) { return yes(c.document().visibility && c.document().visibility->clip_box.enabled); }},
      {"clip-plane",
       [](const Context& c) { return yes(c.document().visibility && c.document().visibility->clip_plane.enabled); }},
      {"history", [](const Context& c) { return std::to_string(c.history->steps().size()); }},
      {"position", [](const Context& c) { return std::to_string(c.history->position()); }},
      {"edit", [](const Context& c) { return c.history->steps()[c.history->position()].label; }},
      {"unsaved", [](const Context& c) { return yes(c.history->unsaved()); }},
      {"document", [](const Context& c) { return document_hash(c.document()); }},
      {"name", [](const Context& c) { return c.project->name; }},
      {"posed",
       [](const Context& c) {
         return c.views->scene.pose ? std::to_string(c.views->scene.pose->step) : std::string("no");
       }},
      {"refined", [](const Context& c) { return yes(c.views->body.shows_refined); }},
      {"jobs", [](const Context& c) { return yes(c.jobs->busy()); }},
      {"toast",
       [](const Context& c) {
         return c.messages->toasts.empty() ? std::string("none") : c.messages->toasts.back().line;
       }},
      {"error",
       [](const Context& c) {
         return c.messages->errors.empty() ? std::string("none") : c.messages->errors.front().what;
       }},
      {"typed", [](const Context& c) { return typed_text(c).value_or("no field"); }},
      {"dialog", [](const Context& c) { return yes(c.dialogs->shown != nullptr); }},
      {"quit", [](const Context& c) { return yes(c.window->quit); }},
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

std::string fact(const Context& context, const std::string& name) {
  if (name.starts_with("text:")) {
    const auto& texts = context.ui->widgets.texts();
    const std::string wanted = name.substr(5);
    return std::any_of(texts.begin(), texts.end(),
                       [&](const std::string& text) { return text.find(wanted) != std::string::npos; })
               ? "shown"
               : "absent";
  }
  if (name.starts_with("widget:")) return context.ui->widgets.find(name.substr(7)) ? "shown" : "absent";
  for (const auto& [known, value] : facts())
    if (known == name) return value(context);
  throw Error("the fact is unknown", name, "use a fact listed at the top of editor/app/script_player.h");
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
