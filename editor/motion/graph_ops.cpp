// SPDX-License-Identifier: AGPL-3.0-or-later
// Operators of the graph editor: its view, the selection of keys, and the interpolation between keys.
#include <algorithm>

#include "editor/context/context.h"
#include "editor/context/menu_state.h"
#include "editor/context/operator.h"
#include "editor/motion/graph_edits.h"
#include "editor/motion/graph_tool.h"
#include "editor/motion/timeline_tool.h"
#include "editor/ui/icons.h"

namespace limber::editor {

namespace {

std::string needs_graph(const Context& context) {
  if (!shown_clip(context.document())) return "Import a motion first, or insert a key";
  if (!context.document().armature) return "Import a rig first";
  return graph_is_shown(context) ? "" : "Show the graph editor first";
}
std::string needs_graph_keys(const Context& context) {
  if (const std::string why = needs_graph(context); !why.empty()) return why;
  return any_graph_key_chosen(context) ? "" : "Select keys in the graph first";
}

void choose_all(Context& context) {
  Graph& graph = graph_of(context);
  update_curves(context);
  for (const auto& [track, curve] : graph.curves.tracks)
    for (const int frame : key_frames_of(graph_keys(context), track))
      for (int axis = 0; axis < 3; ++axis)
        if (is_shown(graph, {track, axis})) graph.chosen.insert({{track, axis}, frame});
}

void fit_to_chosen(Context& context) {
  const std::set<GraphKey> keys = chosen_graph_keys(context);
  fit_graph_values(context, &keys);
  int low = keys.begin()->frame, high = low;
  for (const GraphKey& key : keys) low = std::min(low, key.frame), high = std::max(high, key.frame);
  auto& window = context.timeline->window;
  window.count = std::max(kFewestFrames, 1.3 * (high - low));
  window.low = (low + high) / 2.0 - window.count / 2;
}

// Applies `edit` to the selected keys of the shown clip and commits the result as one edit.
void change(Context& context, const std::string& label,
            const std::function<Keys(const GraphCurves&, const Keys&, const std::set<GraphKey>&)>& edit) {
  stop_playing(context);
  update_curves(context);
  const Keys next = edit(graph_of(context).curves, shown_clip(context.document())->keys, chosen_graph_keys(context));
  if (next == shown_clip(context.document())->keys) return;
  edit_clip(context, label, PoseThen::FromClip, [&](Clip& clip) { clip.keys = next; });
}

// Returns true if keys are selected and is() returns true for the shape of each selected key.
bool all_chosen(const Context& context, const std::function<bool(const KeyShape&)>& is) {
  const std::set<GraphKey> chosen = chosen_graph_keys(context);
  return !chosen.empty() && std::all_of(chosen.begin(), chosen.end(), [&](const GraphKey& key) {
    const GraphTrack& track = key.channel.track;
    const Keys& keys = graph_keys(context);
    return is(shape_at(track.is_shift ? keys.root_shapes : shapes_of(keys, track.bone), key.frame));
  });
}

Operator interpolation(const char* id, const char* label, const char* description, Interpolation which) {
  return {
      id,
      label,
      "",
      "Motion",
      description,
      [label, which](Context& c) {
        change(c, std::string("Interpolation: ") + label,
               [which](const GraphCurves&, const Keys& keys, const auto& chosen) {
                 return with_interpolation(keys, chosen, which);
               });
      },
      needs_graph_keys,
      [which](const Context& c) { return all_chosen(c, [which](const KeyShape& key) { return key.next == which; }); }};
}
Operator handles(const char* id, const char* label, const char* description, HandleKind which) {
  return {id,
          label,
          "",
          "Motion",
          description,
          [label, which](Context& c) {
            change(c, std::string("Handles: ") + label,
                   [which](const GraphCurves& curves, const Keys& keys, const auto& chosen) {
                     return with_handles(curves, keys, chosen, which);
                   });
          },
          needs_graph_keys,
          [which](const Context& c) {
            return all_chosen(c, [which](const KeyShape& key) { return key.handles == which; });
          }};
}
Operator easing(const char* id, const char* label, const char* description, Easing which) {
  return {id,
          label,
          "",
          "Motion",
          description,
          [label, which](Context& c) {
            change(c, label, [which](const GraphCurves& curves, const Keys& keys, const auto& chosen) {
              return with_easing(curves, keys, chosen, which);
            });
          },
          needs_graph_keys};
}

}  // namespace

std::vector<Operator> graph_operators() {
  return {
      {"graph.show", "Graph editor", icon::kReport, "Motion",
       "Show the clip as curves instead of the timeline's rows. Run again to show the rows.",
       [](Context& c) { show_graph(c, !graph_is_shown(c)); },
       [](const Context& c) { return shown_clip(c.document()) ? "" : "Import a motion first, or insert a key"; },
       graph_is_shown},
      {"graph.select", "Select in the graph", "", "Motion",
       "Select and drag keys and their handles. Drag in an empty area to select keys with a box.", press_graph,
       needs_graph},
      {"graph.select_all", "Select all keys in the graph", "", "Motion", "Select every key of the shown curves.",
       choose_all, needs_graph},
      {"graph.select_none", "Deselect keys in the graph", "", "Motion", "Deselect all keys of the curves.",
       [](Context& c) { graph_of(c).chosen.clear(); }, needs_graph_keys},
      {"graph.pan", "Pan the graph", "", "Motion", "Drag to scroll the curves.", pan_graph, needs_graph},
      {"graph.zoom", "Zoom the graph", "", "Motion", "Zoom time and values around the pointer.",
       [](Context& c) { zoom_graph(c, ZoomAxes::Both); }, needs_graph},
      {"graph.zoom_time", "Zoom the graph's time", "", "Motion", "Show fewer or more frames around the pointer.",
       [](Context& c) { zoom_graph(c, ZoomAxes::Time); }, needs_graph},
      {"graph.zoom_values", "Zoom the graph's values", "", "Motion",
       "Show a smaller or larger range of values around the pointer.",
       [](Context& c) { zoom_graph(c, ZoomAxes::Value); }, needs_graph},
      {"graph.view_all", "Show all curves", "", "Motion", "Fit the whole clip and all shown curves into the graph.",
       [](Context& c) {
         fit_window(c);
         fit_graph_values(c);
       },
       needs_graph},
      {"graph.view_selected", "Show selected keys in the graph", "", "Motion", "Fit the selected keys into the graph.",
       fit_to_chosen, needs_graph_keys},
      {"graph.move", "Move keys in the graph", icon::kMove, "Motion",
       "Move the selected keys in time and value with the pointer, or by a typed number.",
       [](Context& c) { begin_changing_graph_keys(c, GraphChange::Move); }, needs_graph_keys},
      {"graph.scale", "Scale keys in the graph", icon::kScale, "Motion",
       "Scale the selected keys in time about the play head, and in value about their middle.",
       [](Context& c) { begin_changing_graph_keys(c, GraphChange::Scale); }, needs_graph_keys},
      {"graph.duplicate", "Duplicate keys in the graph", icon::kDuplicate, "Motion",
       "Copy the selected keys of the curves and move the copies with the pointer, or by a typed number.",
       [](Context& c) { begin_changing_graph_keys(c, GraphChange::Duplicate); }, needs_graph_keys},
      {"graph.delete", "Delete keys in the graph", icon::kTrash, "Motion",
       "Delete the selected keys. A bone's key is deleted with all of its three channels.",
       [](Context& c) {
         change(c, "Delete keys in the graph", [](const GraphCurves&, const Keys& keys, const auto& chosen) {
           return with_keys_deleted(keys, chosen);
         });
       },
       needs_graph_keys},
      {"graph.interpolation_menu", "Interpolation menu", "", "Motion",
       "Open a menu that sets the interpolation after the selected keys.",
       [](Context& c) { c.menus->open_popup = "Interpolation"; }, needs_graph_keys},
      {"graph.handle_menu", "Handle menu", "", "Motion",
       "Open a menu that sets the kind of the selected keys' handles.",
       [](Context& c) { c.menus->open_popup = "Handles"; }, needs_graph_keys},
      interpolation("graph.constant", "Constant", "Hold the value of the selected keys until the next key.",
                    Interpolation::Constant),
      interpolation("graph.linear", "Linear", "Interpolate linearly from the selected keys to the next ones.",
                    Interpolation::Linear),
      interpolation("graph.bezier", "Bezier", "Interpolate from the selected keys to the next ones by Bezier curves.",
                    Interpolation::Bezier),
      easing("graph.ease_in", "Ease in", "Start slowly at the selected keys and gain speed up to the next ones.",
             Easing::In),
      easing("graph.ease_out", "Ease out", "Leave the selected keys fast and slow down towards the next ones.",
             Easing::Out),
      easing("graph.ease_in_out", "Ease in and out",
             "Start slowly at the selected keys and slow down towards the next ones.", Easing::InOut),
      handles("graph.handles_automatic", "Automatic", "Take the slope at the selected keys from their neighbours.",
              HandleKind::Automatic),
      handles("graph.handles_clamped", "Automatic, clamped",
              "Take the slope from the neighbours, without swinging beyond a key where the curve turns back.",
              HandleKind::Clamped),
      handles("graph.handles_aligned", "Aligned", "Set the slope by hand, the same on both sides of the key.",
              HandleKind::Aligned),
      handles("graph.handles_free", "Free", "Set the slopes on both sides of the key independently.", HandleKind::Free),
      handles("graph.handles_flat", "Flat", "Make the curve horizontal at the selected keys.", HandleKind::Flat),
  };
}

}  // namespace limber::editor
