// SPDX-License-Identifier: AGPL-3.0-or-later
// Operators that edit the weights of the whole body or of a part of it: flood, fill, mirror, smooth, limit, copy,
// transfer.
#include <algorithm>
#include <array>
#include <cmath>

#include "core/base/error.h"
#include "core/project/project_io.h"
#include "core/rig/mirror.h"
#include "editor/context/context.h"
#include "editor/context/dialogs.h"
#include "editor/context/interaction.h"
#include "editor/context/open_project.h"
#include "editor/context/operator.h"
#include "editor/context/views.h"
#include "editor/context/workspace.h"
#include "editor/dialogs/form_dialog.h"
#include "editor/file_browser/file_browser.h"
#include "editor/shown/test_pose.h"
#include "editor/skin/brush_settings.h"
#include "editor/skin/brush_tools.h"
#include "editor/skin/weight_display.h"
#include "editor/skin/weight_edits.h"
#include "editor/ui/icons.h"
#include "editor/viewport/transform_tool.h"
#include "editor/volume/tissue_edits.h"
#include "editor/volume/volume_edits.h"

namespace limber::editor {

namespace {

using Fields = std::vector<FormField>;

std::string needs_paint(const Context& context) {
  if (context.workspace() != Workspace::Skin) return "Switch to the Skin workspace first";
  return why_not_paint(context);
}

std::string needs_reach(const Context& context) {
  const std::string why = needs_paint(context);
  return why.empty() ? why_brush_reaches_nothing(context) : why;
}

std::string needs_tissue_below(const Context& context) {
  if (const std::string why = needs_paint(context); !why.empty()) return why;
  return context.views->hover.inside ? "" : "Put the pointer on the body";
}

WeightOperation flooding(const std::string& label, Flood kind, double value, double amount = 1) {
  return {.label = label, .work = [=](const WeightsToEdit& what, const EditScope& scope) -> EditedWeights {
            return {flooded(what.body(), *what.document.weights, what.settings.bones, kind, value, amount, scope), ""};
          }};
}

WeightOperation smoothing(const std::string& label, int passes, double amount) {
  return {.label = label, .work = [=](const WeightsToEdit& what, const EditScope& scope) -> EditedWeights {
            return {smoothed(what.body(), *what.document.weights, passes, amount, scope), ""};
          }};
}

// ---- Flood: apply a brush to all tissue at once

constexpr int kSmoothFlood = 4;

std::optional<int> flood_of(BrushKind kind) {
  switch (kind) {
    case BrushKind::Add: return 0;
    case BrushKind::Subtract: return 1;
    case BrushKind::Set: return 2;
    case BrushKind::Multiply: return 3;
    case BrushKind::Smooth: return kSmoothFlood;
    default: return std::nullopt;
  }
}

std::string needs_flood(const Context& context) {
  const std::string why = needs_reach(context);
  if (!why.empty() || flood_of(context.skin->painting->kind)) return why;
  return std::string(name_of(context.skin->painting->kind)) +
         " cannot flood: select the add, subtract, set, multiply or smooth brush";
}

// Applies the brush to all tissue that it may paint. Every voxel changes as if it were at the centre of a dab, which is
// a single touch of the brush.
void flood(Context& context) {
  const Painting& painting = *context.skin->painting;
  const int kind = *flood_of(painting.kind);
  const bool by_strength = kind < 2;
  edit_weights(
      context,
      {choice_of("Brush", "How the value changes the weight of the selected bones.",
                 {"Add", "Subtract", "Set", "Multiply", "Smooth"}, kind),
       number_of("Value", "The weight to add, subtract or set, or the factor to multiply by. Smooth does not use it.",
                 by_strength ? painting.strength : painting.value, 0, 1, "%.2f"),
       number_of("Amount", "How much of the change is applied. 0 = none, 1 = all.",
                 by_strength || kind == kSmoothFlood ? 1 : painting.strength, 0, 1, "%.2f")},
      [](const Context& c, const Fields& fields) {
        const double value = fields[1].value, amount = fields[2].value;
        if (fields[0].chosen == kSmoothFlood) return smoothing("Smooth all", 1, amount);
        return flooding("Flood " + painted_name(c), static_cast<Flood>(fields[0].chosen), value, amount);
      });
}

// ---- Fill connected tissue, assign a tissue to a bone

void fill_part(Context& context) {
  const glm::ivec3 voxel = context.views->hover.voxel;
  edit_weights(context,
               {choice_of("Fill within",
                          "Tissue: fill the connected piece of the tissue under the pointer. All: also fill other "
                          "tissues that are connected to it.",
                          {"Tissue", "All"}),
                number_of("Value", "The weight that the selected bones get in the filled piece.", 1, 0, 1, "%.2f")},
               [voxel](const Context& c, const Fields& fields) {
                 WeightOperation operation =
                     flooding("Fill connected tissue with weight of " + painted_name(c), Flood::Set, fields[1].value);
                 operation.reach = EditReach::AllTissues;
                 operation.edits_bone_tissue = true;
                 operation.where = [voxel, part = fields[0].chosen == 0 ? Part::Label
                                                                        : Part::Tissue](const WeightsToEdit& what) {
                   return connected_part(*what.document.volume, *what.tissue, voxel, part);
                 };
                 return operation;
               });
}

// Returns the selected tissues. If no tissue is selected, returns the tissue under the pointer.
std::set<Label> named_tissues(const Context& context) {
  if (!context.selection->tissues.empty()) return context.selection->tissues;
  return context.views->hover.inside ? std::set<Label>{context.views->hover.label} : std::set<Label>{};
}

std::string needs_named_tissue(const Context& context) {
  if (const std::string why = needs_paint(context); !why.empty()) return why;
  return named_tissues(context).empty() ? "Select a tissue, or point at one" : "";
}

void assign_tissue(Context& context) {
  const std::set<Label> labels = named_tissues(context);
  const Tissue* tissue = context.document().tissues->find(*labels.begin());
  const std::string name = labels.size() > 1 ? std::to_string(labels.size()) + " tissues"
                           : tissue          ? shown_name(*tissue)
                                             : "Label " + std::to_string(*labels.begin());
  edit_weights(
      context, {number_of("Value", "The weight that the selected bones get in all of the tissue.", 1, 0, 1, "%.2f")},
      [labels, name](const Context& c, const Fields& fields) {
        WeightOperation operation = flooding("Assign " + name + " to " + painted_name(c), Flood::Set, fields[0].value);
        operation.reach = EditReach::AllTissues;
        operation.edits_bone_tissue = true;
        operation.where = [labels](const WeightsToEdit& what) {
          const LabelVolume& volume = *what.document.volume;
          return region_where(*what.tissue,
                              [&](std::int64_t, const glm::ivec3& voxel) { return labels.contains(volume.at(voxel)); });
        };
        return operation;
      });
}

// ---- Mirror weights

// Returns a message that names the bones that have no counterpart on the other side of the body; "" if all have one. A
// bone without a counterpart gets its own mirrored weights.
std::string without_partner(const Armature& armature) {
  std::string names;
  int count = 0;
  for (const Bone& bone : armature.bones)
    if (const auto other = mirrored_name(bone.name); other && !armature.find(*other) && ++count <= 3)
      names += (count > 1 ? ", " : "") + bone.name;
  return count == 0 ? ""
                    : names +
                          (count > 3    ? " and " + std::to_string(count - 3) + " more have"
                           : count == 1 ? " has"
                                        : " have") +
                          " no bone on the other side";
}

void mirror(Context& context) {
  const Armature& armature = *context.document().armature;
  const MirrorPlane plane = mirror_plane(armature);
  // The form proposes to copy from the side of the active bone. The world's x axis points to the body's left.
  const Bone& active = armature.bones[static_cast<std::size_t>(*skin_bone(context))];
  const double left = plane.normal.x < 0 ? -1 : 1,
               side = left * glm::dot((active.head + active.tail) / 2.0 - plane.point, plane.normal);
  edit_weights(
      context,
      {choice_of("From side", "The side whose weights are copied to the other side.", {"Left", "Right"},
                 side >= 0 ? 0 : 1),
       number_of("Distance",
                 "A voxel gets the weights of the tissue nearest to its mirrored position, within this distance.", 10,
                 0.5, 100, "%.1f", "mm")},
      [left](const Context&, const Fields& fields) {
        WeightOperation operation{
            .label = fields[0].chosen == 0 ? "Mirror weights to the right" : "Mirror weights to the left",
            .edits_bone_tissue = true};
        operation.work = [to_normal = (fields[0].chosen == 0) == (left < 0), reach = fields[1].value](
                             const WeightsToEdit& what, const EditScope& scope) -> EditedWeights {
          const Armature& rig = *what.document.armature;
          MirrorSettings settings{mirror_plane(rig), reach};
          if (!to_normal) settings.plane.normal = -settings.plane.normal;
          MirrorEdit edit = mirrored(what.body(), *what.document.weights, settings, scope);
          std::string words = edit.unmatched.empty()
                                  ? ""
                                  : grouped(std::ssize(edit.unmatched)) + " voxels have no match within " +
                                        text_of_number("%.1f", reach) + " mm and stay unchanged";
          if (const std::string loose = without_partner(rig); !loose.empty())
            words += (words.empty() ? "" : "; ") + loose;
          return {static_cast<WeightEdit&>(edit), words, std::move(edit.unmatched)};
        };
        return operation;
      });
}

// ---- Edits of the weights of all bones

void smooth_all(Context& context) {
  edit_weights(
      context,
      {number_of("Steps", "Number of steps. Each step moves weights towards those of the neighbouring voxels.", 3, 1,
                 100, "%.0f"),
       number_of("Amount", "How far each step moves the weights. 1 = fully to the neighbours' mean.", 1, 0, 1, "%.2f")},
      [](const Context&, const Fields& fields) {
        return smoothing("Smooth all", static_cast<int>(std::lround(fields[0].value)), fields[1].value);
      });
}

// Returns an operation that changes the weights of each voxel independently of its neighbours. The operation may also
// change voxels of bone tissue. Bone tissue should move rigidly, so the operation must move each voxel's weights
// towards a single bone.
WeightOperation voxel_edit(
    const std::string& label,
    const std::function<WeightEdit(const WeightedBody&, const SkinWeights&, const EditScope&)>& edit) {
  return {.label = label,
          .edits_bone_tissue = true,
          .work = [edit](const WeightsToEdit& what, const EditScope& scope) -> EditedWeights {
            return {edit(what.body(), *what.document.weights, scope), ""};
          }};
}

void limit(Context& context) {
  edit_weights(context,
               {number_of("Bones", "Largest number of bones that a voxel follows. Smaller weights are removed.", 2, 1,
                          4, "%.0f")},
               [](const Context&, const Fields& fields) {
                 const int most = static_cast<int>(std::lround(fields[0].value));
                 return voxel_edit("Limit influences to " + std::to_string(most),
                                   [most](const WeightedBody& body, const SkinWeights& weights,
                                          const EditScope& scope) { return limited(body, weights, most, scope); });
               });
}

void prune(Context& context) {
  edit_weights(context,
               {number_of("Limit", "Remove weights below this limit. The voxel's other bones get the removed weight.",
                          0.02, 0, 0.5, "%.3f")},
               [](const Context&, const Fields& fields) {
                 return voxel_edit(
                     "Clean small weights",
                     [least = fields[0].value](const WeightedBody& body, const SkinWeights& weights,
                                               const EditScope& scope) { return pruned(body, weights, least, scope); });
               });
}

void quantize(Context& context) {
  edit_weights(
      context,
      {number_of("Steps", "Number of equal steps between the weights 0 and 1. Weights are rounded to the nearest step.",
                 10, 1, 1000, "%.0f")},
      [](const Context&, const Fields& fields) {
        const int steps = static_cast<int>(std::lround(fields[0].value));
        return voxel_edit("Quantize to " + std::to_string(steps) + " steps",
                          [steps](const WeightedBody& body, const SkinWeights& weights, const EditScope& scope) {
                            return in_steps(body, weights, steps, scope);
                          });
      });
}

void set_levels(Context& context) {
  edit_weights(
      context,
      {number_of("Low weight", "Weights up to this value become 0.", 0, 0, 0.99, "%.2f"),
       number_of("High weight", "Weights from this value on become 1.", 1, 0.01, 1, "%.2f"),
       number_of("Gamma", "Above 1 raises the weights between 0 and 1, below 1 lowers them.", 1.5, 0.1, 10, "%.2f")},
      [](const Context& c, const Fields& fields) {
        WeightRules::Levels levels;
        levels.in_low = fields[0].value;
        levels.in_high = std::max(fields[1].value, fields[0].value + 0.01);
        levels.gamma = fields[2].value;
        const std::vector<int> bones = painted_bones(c);
        return WeightOperation{
            .label = "Set weight levels of " + c.document().weights->bones()[static_cast<std::size_t>(bones[0])],
            .work = [levels](const WeightsToEdit& what, const EditScope& scope) -> EditedWeights {
              return {with_levels(what.body(), *what.document.weights, what.settings.bones[0], levels, scope), ""};
            }};
      });
}

void ask_copy(Context& context) {
  const std::vector<std::string> names = context.document().weights->bones();
  const std::vector<int> bones = painted_bones(context);
  const int from = bones[0], to = bones.size() > 1 ? bones[1] : from == 0 ? 1 : 0;
  const MakeWeightOperation make = [names](const Context&, const Fields& fields) {
    const int source = fields[0].chosen, target = fields[1].chosen;
    if (source == target)
      throw Error("a bone cannot be copied to itself", names[static_cast<std::size_t>(source)],
                  "select two different bones");
    constexpr const char* kVerbs[] = {"Copy", "Add", "Move", "Swap"};
    const Copy kind = static_cast<Copy>(fields[2].chosen);
    return WeightOperation{.label = std::string(kVerbs[fields[2].chosen]) + " weights of " +
                                    names[static_cast<std::size_t>(source)] + (kind == Copy::Swap ? " and " : " to ") +
                                    names[static_cast<std::size_t>(target)],
                           .edits_bone_tissue = true,
                           .work = [=](const WeightsToEdit& what, const EditScope& scope) -> EditedWeights {
                             return {copied(what.body(), *what.document.weights, source, target, kind, scope), ""};
                           }};
  };
  const auto outcome = [names](const Context&, const Fields& fields) {
    const std::string &source = names[static_cast<std::size_t>(fields[0].chosen)],
                      &target = names[static_cast<std::size_t>(fields[1].chosen)];
    if (source == target) throw Error("a bone cannot be copied to itself", source, "select two different bones");
    const std::string results[] = {target + " gets the same weight as " + source + ", taken from all unlocked bones.",
                                   target + " gets the weight that " + source + " has, in addition to its own.",
                                   target + " takes over the weight of " + source + ", which then has none.",
                                   source + " and " + target + " exchange their weights."};
    return results[fields[2].chosen];
  };
  context.dialogs->open(make_form({"Copy weights",
                                   "Give the weights of one bone to another.",
                                   "Copy",
                                   {choice_of("Bone", "The bone whose weights are copied.", names, from),
                                    choice_of("To bone", "The bone that gets the copied weights.", names, to),
                                    choice_of("Mode", "How the copied weights combine with the existing ones.",
                                              {"Replace", "Add", "Move", "Swap"}, 2)},
                                   outcome,
                                   weight_act(make)}));
}

// ---- Transfer weights from another project

EditedWeights transfer(const Path& path, const WeightsToEdit& what, const EditScope& scope) {
  const Project project = read_project(path, *scope.progress);
  const Document& from = project.document;
  const std::string name = path.filename().string();
  if (!from.volume || !from.armature || !from.weights)
    throw Error("the project has no weights", name, "select a project with a volume, a rig and weights");
  const TissueVoxels tissue(*from.volume);
  TransferEdit edit = transferred(what.body(), *what.document.weights,
                                  {*from.volume, tissue, *from.armature, *from.weights}, scope, *scope.progress);
  std::string words;
  for (std::size_t i = 0; i < edit.missing.size() && i < 3; ++i) words += (i > 0 ? ", " : "") + edit.missing[i];
  if (edit.missing.size() > 3) words += " and " + std::to_string(edit.missing.size() - 3) + " more";
  if (!words.empty())
    words +=
        std::string(edit.missing.size() == 1 ? " is" : " are") + " not in this rig: the bone's parent got the weight";
  return {static_cast<WeightEdit&>(edit), words};
}

void ask_transfer(Context& context) {
  browse(context, {.purpose = "transfer",
                   .title = "Transfer weights from a project",
                   .action = "Transfer",
                   .filters = {{"Projects", {".limber"}}},
                   .folder = context.project->path.parent_path(),
                   .chosen = [](Context& c, const Path& path) {
                     edit_weights(c, {}, [path](const Context&, const Fields&) {
                       return WeightOperation{.label = "Transfer weights from " + path.filename().string(),
                                              .edits_bone_tissue = true,
                                              .reads_file = true,
                                              .work = [path](const WeightsToEdit& what, const EditScope& scope) {
                                                return transfer(path, what, scope);
                                              }};
                     });
                   }});
}

std::string needs_two_bones(const Context& context) {
  if (const std::string why = needs_reach(context); !why.empty()) return why;
  return context.document().weights->bones().size() > 1 ? ""
                                                        : "The rig has only one bone: this command needs two bones";
}

}  // namespace

std::vector<Operator> weight_edit_operators() {
  return {
      {"skin.flood", "Flood", icon::kBrushSet, "Weights",
       "Apply the brush's effect to all tissue that the brush may paint. The tissue filter, the clip box, the clip "
       "plane, the region and the locks limit this tissue.",
       flood, needs_flood},
      {"skin.gradient", "Gradient", icon::kGradient, "Weights",
       "Draw a line along which the weight of the selected bones fades from full to none. Press R to fade it in all "
       "directions from the line's start.",
       [](Context& c) {
         c.interaction->modal = begin_gradient(c);
         c.interaction->modal_wrap = {};
       },
       [](const Context& c) {
         return needs_reach(c).empty() && c.views->scene.pose
                    ? std::string("Show the body at rest first: the line is drawn on the rest pose")
                    : needs_reach(c);
       }},
      {"skin.fill_part", "Fill connected tissue", icon::kBrushSet, "Weights",
       "Let the connected piece of tissue under the pointer follow the selected bone.", fill_part, needs_tissue_below},
      {"skin.assign_tissue", "Assign tissue to bone", icon::kTissues, "Weights",
       "Let the selected tissues, or the one under the pointer, follow the selected bone.", assign_tissue,
       needs_named_tissue},
      {"skin.mirror_weights", "Mirror weights", icon::kMirror, "Weights",
       "Copy the weights of one side of the body to the other, from each bone to its mirrored bone. Reports voxels "
       "without a match.",
       mirror, needs_reach},
      {"skin.smooth_all", "Smooth all", icon::kBrushSmooth, "Weights",
       "Smooth the weights of all bones over neighbouring voxels, in several steps.", smooth_all, needs_reach},
      {"skin.limit", "Limit influences", "", "Weights", "Limit the number of bones that each voxel follows.", limit,
       needs_reach},
      {"skin.prune", "Clean small weights", "", "Weights",
       "Remove weights below a limit, so that each voxel follows few bones.", prune, needs_reach},
      {"skin.levels", "Levels", "", "Weights",
       "Map two weights of the active bone to 0 and 1, and stretch the weights in between.", set_levels, needs_reach},
      {"skin.quantize", "Quantize", "", "Weights", "Round all weights to multiples of a step.", quantize, needs_reach},
      {"skin.copy_weights", "Copy weights...", icon::kCopy, "Weights",
       "Copy, add or move the weights of one bone to another, or swap them.", ask_copy, needs_two_bones},
      {"skin.transfer_weights", "Transfer weights...", icon::kImport, "Weights",
       "Copy weights from another project of any voxel size. Voxels are matched by position, bones by name.",
       ask_transfer, needs_reach},
  };
}

}  // namespace limber::editor
