// SPDX-License-Identifier: AGPL-3.0-or-later
// Edits of the weights of a whole body, or of a part of it, at once.
#include <algorithm>
#include <array>
#include <cmath>

#include "core/base/error.h"
#include "core/project/project_io.h"
#include "core/rig/mirror.h"
#include "editor/context/operator.h"
#include "editor/file_browser/file_browser.h"
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

std::string needs_paint(const Editor& editor) {
  if (editor.workspace != Workspace::Skin) return "Works in the Skin workspace";
  return why_not_paint(editor);
}

std::string needs_reach(const Editor& editor) {
  const std::string why = needs_paint(editor);
  return why.empty() ? why_brush_reaches_nothing(editor) : why;
}

std::string needs_tissue_below(const Editor& editor) {
  if (const std::string why = needs_paint(editor); !why.empty()) return why;
  return editor.views->hover.inside ? "" : "Put the pointer on the body";
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

// Flood

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

std::string needs_flood(const Editor& editor) {
  const std::string why = needs_reach(editor);
  if (!why.empty() || flood_of(editor.skin->painting->kind)) return why;
  return std::string(name_of(editor.skin->painting->kind)) +
         " is a brush alone: flood with add, subtract, set, multiply or smooth";
}

// What one dab of the brush does in its middle, everywhere.
void flood(Editor& editor) {
  const Painting& painting = *editor.skin->painting;
  const int kind = *flood_of(painting.kind);
  const bool by_strength = kind < 2;
  edit_weights(editor,
               {choice_of("Brush", "What is done with the weight of the chosen bones.",
                          {"Add", "Subtract", "Set", "Multiply", "Smooth"}, kind),
                number_of("Value", "What is added or taken, set, or multiplied by.",
                          by_strength ? painting.strength : painting.value, 0, 1, "%.2f"),
                number_of("Amount", "How much of it is done; smooth goes on for as many steps.",
                          by_strength || kind == kSmoothFlood ? 1 : painting.strength, 0, 1, "%.2f")},
               [](const Editor& e, const Fields& fields) {
                 const double value = fields[1].value, amount = fields[2].value;
                 if (fields[0].chosen == kSmoothFlood) return smoothing("Smooth all", 1, amount);
                 return flooding("Flood " + painted_name(e), static_cast<Flood>(fields[0].chosen), value, amount);
               });
}

// A part, a tissue

void fill_part(Editor& editor) {
  const glm::ivec3 voxel = editor.views->hover.voxel;
  edit_weights(editor,
               {choice_of("Part", "Of the tissue under the pointer, or of all tissue: what hangs together with it.",
                          {"Tissue", "All"}),
                number_of("Value", "The weight that the chosen bones get there.", 1, 0, 1, "%.2f")},
               [voxel](const Editor& e, const Fields& fields) {
                 WeightOperation operation = flooding("Fill part with " + painted_name(e), Flood::Set, fields[1].value);
                 operation.reach = EditReach::AllTissues;
                 operation.edits_bone_tissue = true;
                 operation.where = [voxel, part = fields[0].chosen == 0 ? Part::Label
                                                                        : Part::Tissue](const WeightsToEdit& what) {
                   return connected_part(*what.document.volume, *what.tissue, voxel, part);
                 };
                 return operation;
               });
}

// The chosen tissues, else the one under the pointer.
std::set<Label> named_tissues(const Editor& editor) {
  if (!editor.selection.tissues.empty()) return editor.selection.tissues;
  return editor.views->hover.inside ? std::set<Label>{editor.views->hover.label} : std::set<Label>{};
}

std::string needs_named_tissue(const Editor& editor) {
  if (const std::string why = needs_paint(editor); !why.empty()) return why;
  return named_tissues(editor).empty() ? "Choose a tissue, or point at one" : "";
}

void assign_tissue(Editor& editor) {
  const std::set<Label> labels = named_tissues(editor);
  const Tissue* tissue = editor.document().tissues->find(*labels.begin());
  const std::string name = labels.size() > 1 ? std::to_string(labels.size()) + " tissues"
                           : tissue          ? shown_name(*tissue)
                                             : "Label " + std::to_string(*labels.begin());
  edit_weights(
      editor, {number_of("Value", "The weight that the chosen bones get in all of the tissue.", 1, 0, 1, "%.2f")},
      [labels, name](const Editor& e, const Fields& fields) {
        WeightOperation operation = flooding("Assign " + name + " to " + painted_name(e), Flood::Set, fields[0].value);
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

// Mirror

// Named "Left", but without a partner: their weights come from and go to themselves.
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

void mirror(Editor& editor) {
  const Armature& armature = *editor.document().armature;
  const MirrorPlane plane = mirror_plane(armature);
  // From the side of the active bone; x grows to the left.
  const Bone& active = armature.bones[static_cast<std::size_t>(*skin_bone(editor))];
  const double left = plane.normal.x < 0 ? -1 : 1,
               side = left * glm::dot((active.head + active.tail) / 2.0 - plane.point, plane.normal);
  edit_weights(
      editor,
      {choice_of("From", "The side whose weights the other one takes over.", {"Left", "Right"}, side >= 0 ? 0 : 1),
       number_of("Within", "Each voxel takes the weights nearest to its mirror image, at most so far away.", 10, 0.5,
                 100, "%.1f", "mm")},
      [left](const Editor&, const Fields& fields) {
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
                                        text_of_number("%.1f", reach) + " mm and stay";
          if (const std::string loose = without_partner(rig); !loose.empty())
            words += (words.empty() ? "" : "; ") + loose;
          return {static_cast<WeightEdit&>(edit), words, std::move(edit.unmatched)};
        };
        return operation;
      });
}

// All bones at once

void smooth_all(Editor& editor) {
  edit_weights(editor,
               {number_of("Steps", "How often; each step draws weights to those of the neighbours.", 3, 1, 100, "%.0f"),
                number_of("Amount", "How far each step goes.", 1, 0, 1, "%.2f")},
               [](const Editor&, const Fields& fields) {
                 return smoothing("Smooth all", static_cast<int>(std::lround(fields[0].value)), fields[1].value);
               });
}

// Changes that are made voxel by voxel, of all bones; each leaves a voxel nearer to one bone alone, so bone tissue may
// have it.
WeightOperation voxel_edit(
    const std::string& label,
    const std::function<WeightEdit(const WeightedBody&, const SkinWeights&, const EditScope&)>& edit) {
  return {.label = label,
          .edits_bone_tissue = true,
          .work = [edit](const WeightsToEdit& what, const EditScope& scope) -> EditedWeights {
            return {edit(what.body(), *what.document.weights, scope), ""};
          }};
}

void limit(Editor& editor) {
  edit_weights(editor,
               {number_of("Bones", "A voxel follows at most so many; the smallest weights go.", 2, 1, 4, "%.0f")},
               [](const Editor&, const Fields& fields) {
                 const int most = static_cast<int>(std::lround(fields[0].value));
                 return voxel_edit("Limit influences to " + std::to_string(most),
                                   [most](const WeightedBody& body, const SkinWeights& weights,
                                          const EditScope& scope) { return limited(body, weights, most, scope); });
               });
}

void prune(Editor& editor) {
  edit_weights(editor,
               {number_of("Below", "Smaller weights go; the voxel's other bones take them.", 0.02, 0, 0.5, "%.3f")},
               [](const Editor&, const Fields& fields) {
                 return voxel_edit(
                     "Clean small weights",
                     [least = fields[0].value](const WeightedBody& body, const SkinWeights& weights,
                                               const EditScope& scope) { return pruned(body, weights, least, scope); });
               });
}

void quantize(Editor& editor) {
  edit_weights(editor, {number_of("Steps", "Every weight becomes a whole number of such parts.", 10, 1, 1000, "%.0f")},
               [](const Editor&, const Fields& fields) {
                 const int steps = static_cast<int>(std::lround(fields[0].value));
                 return voxel_edit("Quantize to " + std::to_string(steps) + " steps",
                                   [steps](const WeightedBody& body, const SkinWeights& weights,
                                           const EditScope& scope) { return in_steps(body, weights, steps, scope); });
               });
}

void set_levels(Editor& editor) {
  edit_weights(
      editor,
      {number_of("Low", "What becomes 0.", 0, 0, 0.99, "%.2f"),
       number_of("High", "What becomes 1.", 1, 0.01, 1, "%.2f"),
       number_of("Gamma", "Over 1 lifts what is between, under 1 lowers it.", 1.5, 0.1, 10, "%.2f")},
      [](const Editor& e, const Fields& fields) {
        WeightRules::Levels levels;
        levels.in_low = fields[0].value;
        levels.in_high = std::max(fields[1].value, fields[0].value + 0.01);
        levels.gamma = fields[2].value;
        const std::vector<int> bones = painted_bones(e);
        return WeightOperation{
            .label = "Levels of " + e.document().weights->bones()[static_cast<std::size_t>(bones[0])],
            .work = [levels](const WeightsToEdit& what, const EditScope& scope) -> EditedWeights {
              return {with_levels(what.body(), *what.document.weights, what.settings.bones[0], levels, scope), ""};
            }};
      });
}

void ask_copy(Editor& editor) {
  const std::vector<std::string> names = editor.document().weights->bones();
  const std::vector<int> bones = painted_bones(editor);
  const int from = bones[0], to = bones.size() > 1 ? bones[1] : from == 0 ? 1 : 0;
  const MakeWeightOperation make = [names](const Editor&, const Fields& fields) {
    const int source = fields[0].chosen, target = fields[1].chosen;
    if (source == target)
      throw Error("a bone cannot be copied to itself", names[static_cast<std::size_t>(source)], "choose another one");
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
  const auto outcome = [names](const Editor&, const Fields& fields) {
    const std::string &source = names[static_cast<std::size_t>(fields[0].chosen)],
                      &target = names[static_cast<std::size_t>(fields[1].chosen)];
    if (source == target) throw Error("a bone cannot be copied to itself", source, "choose another one");
    const std::string results[] = {target + " gets the weight that " + source + " has, from all unlocked bones.",
                                   target + " gets the weight that " + source + " has on top of its own.",
                                   target + " takes over the weight of " + source + ", which has none then.",
                                   source + " and " + target + " change places."};
    return results[fields[2].chosen];
  };
  editor.open_dialog(make_form(
      {"Copy weights",
       "Weights of one bone for another.",
       "Copy",
       {choice_of("Bone", "Whose weights are taken.", names, from),
        choice_of("to", "The bone that gets them.", names, to),
        choice_of("How", "What becomes of the weights that are there.", {"Replace", "Add", "Move", "Swap"}, 2)},
       outcome,
       weight_act(make)}));
}

// From another project

EditedWeights transfer(const Path& path, const WeightsToEdit& what, const EditScope& scope) {
  const Project project = read_project(path, *scope.progress);
  const Document& from = project.document;
  const std::string name = path.filename().string();
  if (!from.volume || !from.armature || !from.weights)
    throw Error("the project has no weights", name, "choose one with a volume, a rig and weights");
  const TissueVoxels tissue(*from.volume);
  TransferEdit edit = transferred(what.body(), *what.document.weights,
                                  {*from.volume, tissue, *from.armature, *from.weights}, scope, *scope.progress);
  std::string words;
  for (std::size_t i = 0; i < edit.missing.size() && i < 3; ++i) words += (i > 0 ? ", " : "") + edit.missing[i];
  if (edit.missing.size() > 3) words += " and " + std::to_string(edit.missing.size() - 3) + " more";
  if (!words.empty())
    words +=
        std::string(edit.missing.size() == 1 ? " is" : " are") + " not in this rig: what the bone hangs on took over";
  return {static_cast<WeightEdit&>(edit), words};
}

void ask_transfer(Editor& editor) {
  browse(editor, {.purpose = "transfer",
                  .title = "Transfer weights from a project",
                  .action = "Transfer",
                  .filters = {{"Projects", {".limber"}}},
                  .folder = editor.project_path.parent_path(),
                  .chosen = [](Editor& e, const Path& path) {
                    edit_weights(e, {}, [path](const Editor&, const Fields&) {
                      return WeightOperation{.label = "Transfer weights from " + path.filename().string(),
                                             .edits_bone_tissue = true,
                                             .reads_file = true,
                                             .work = [path](const WeightsToEdit& what, const EditScope& scope) {
                                               return transfer(path, what, scope);
                                             }};
                    });
                  }});
}

std::string needs_two_bones(const Editor& editor) {
  if (const std::string why = needs_reach(editor); !why.empty()) return why;
  return editor.document().weights->bones().size() > 1 ? "" : "The rig has one bone alone";
}

}  // namespace

std::vector<Operator> weight_edit_operators() {
  return {
      {"skin.flood", "Flood", icon::kBrushSet, "Weights",
       "Does what the brush does, with its value and strength, in all that it may reach: tissues, clip, region and "
       "locks hold.",
       flood, needs_flood},
      {"skin.gradient", "Gradient", icon::kGradient, "Weights",
       "The chosen bones' weight goes from full to none along a line that is drawn, or around its beginning.",
       [](Editor& e) {
         e.modal = begin_gradient(e);
         e.modal_wrap = {};
       },
       [](const Editor& e) {
         return needs_reach(e).empty() && e.views->scene.pose
                    ? std::string("Bring the body to rest first: the line is drawn on it there")
                    : needs_reach(e);
       }},
      {"skin.fill_part", "Fill part", icon::kBrushSet, "Weights",
       "The piece of tissue under the pointer follows the chosen bone, as far as it hangs together.", fill_part,
       needs_tissue_below},
      {"skin.assign_tissue", "Assign tissue to bone", icon::kTissues, "Weights",
       "All of the chosen tissues, or of the one under the pointer, follows the chosen bone.", assign_tissue,
       needs_named_tissue},
      {"skin.mirror_weights", "Mirror weights", icon::kMirror, "Weights",
       "One side takes over the weights of the other, each bone those of the bone on the other side; voxels without a "
       "match are told.",
       mirror, needs_reach},
      {"skin.smooth_all", "Smooth all", icon::kBrushSmooth, "Weights",
       "Draws the weights of all bones to those of the neighbours, step by step.", smooth_all, needs_reach},
      {"skin.limit", "Limit influences", "", "Weights", "Each voxel follows at most so many bones.", limit,
       needs_reach},
      {"skin.prune", "Clean small weights", "", "Weights",
       "Weights below a share go, so that few bones are left at a voxel.", prune, needs_reach},
      {"skin.levels", "Levels", "", "Weights",
       "Stretches the active bone's weights between two values, and lifts or lowers what lies between.", set_levels,
       needs_reach},
      {"skin.quantize", "Quantize", "", "Weights", "Weights become whole numbers of equal steps.", quantize,
       needs_reach},
      {"skin.copy_weights", "Copy weights...", icon::kCopy, "Weights",
       "A bone gets the weights of another, adds them, takes them over, or changes with it.", ask_copy,
       needs_two_bones},
      {"skin.transfer_weights", "Transfer weights...", icon::kImport, "Weights",
       "Takes the weights of another project where its body lies, whatever its voxels; bones go by their names.",
       ask_transfer, needs_reach},
  };
}

}  // namespace limber::editor
