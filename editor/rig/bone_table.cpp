// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/rig/bone_table.h"

#include <algorithm>

#include "editor/context/background_task.h"
#include "editor/context/context.h"
#include "editor/context/views.h"
#include "editor/context/workspace.h"
#include "editor/seams/seam_view.h"
#include "editor/shown/mark_colours.h"
#include "editor/ui/messages.h"
#include "editor/ui/ui.h"
#include "editor/volume/tissue_edits.h"
#include "render/scene/weight_colormap.h"

namespace limber::editor {

namespace {

// Returns true if the inputs of two bone tables are the same: volume, tissues, rig and bone map. Seams (surfaces where
// limbs touch at rest) are not compared, because the bone table does not depend on them.
bool same_source(const SeamSource& a, const SeamSource& b) {
  return a.volume == b.volume && a.tissues == b.tissues && a.armature == b.armature && a.bone_map == b.bone_map;
}

BoneTable::Known found(const SeamSource& source, Progress& progress) {
  BoneTable::Known known{.source = source,
                         .rows = {},
                         .left_out = {},
                         .tissue = std::make_shared<const TissueVoxels>(*source.volume),
                         .field = nullptr};
  BoneMap map;
  if (source.bone_map) {
    FittingBoneMap fitting = fitting_bone_map(*source.bone_map, *source.tissues, *source.armature);
    map = std::move(fitting.map);
    known.left_out = std::move(fitting.left_out);
  }
  const BoneParts parts = split_bones(*source.volume, *known.tissue, *source.tissues, *source.armature, progress, map);
  known.rows = mapped_labels(parts, *source.tissues, *source.armature, map);
  const std::vector<glm::u8vec3> dull = dull_colours(*source.tissues);
  const std::vector<glm::vec3> swatches = render::bone_swatches(*source.armature);
  std::vector<glm::u8vec3> field(static_cast<std::size_t>(known.tissue->size()));
  known.tissue->for_each([&](std::int64_t place, const glm::ivec3& voxel) {
    const int part = parts.part_of[static_cast<std::size_t>(place)];
    field[static_cast<std::size_t>(place)] =
        part == 0
            ? dull[source.volume->at(voxel)]
            : glm::u8vec3(glm::round(
                  255.0f * swatches[static_cast<std::size_t>(parts.parts[static_cast<std::size_t>(part - 1)].bone)]));
  });
  known.field = std::make_shared<const std::vector<glm::u8vec3>>(std::move(field));
  return known;
}

}  // namespace

std::string why_no_bone_table(const Document& document) {
  if (!document.volume || !document.tissues) return "Open a volume first";
  if (!document.armature || document.armature->bones.empty()) return "Import a rig first";
  const auto& tissues = document.tissues->tissues;
  return std::any_of(tissues.begin(), tissues.end(), [](const Tissue& tissue) { return is_bone(tissue.kind); })
             ? ""
             : "No tissue is marked as bone: set the kind of a tissue to bone";
}

const BoneTable::Known* bone_table(Context& context) {
  if (!why_no_bone_table(context.document()).empty()) return nullptr;
  BoneTable& table = *context.bone_table;
  const SeamSource source = seam_source(context.document());
  const bool is_current = table.known && same_source(table.known->source, source);
  if (!is_current && !(table.task && context.background->tasks.contains(*table.task)))
    table.task = start_task(
        context, "",
        [source](Progress& progress) -> Finish {
          auto known = std::make_shared<BoneTable::Known>(found(source, progress));
          return [known](Context& c) {
            c.bone_table->known = std::move(*known);
            c.ui->touch();
          };
        },
        [source](Context& c, const std::string& error) {
          // After a failure the table is set to an empty one, so that the task does not start again for the same body.
          c.bone_table->known =
              BoneTable::Known{.source = source, .rows = {}, .left_out = {}, .tissue = nullptr, .field = nullptr};
          c.messages->show_error(error, "Bone map");
        });
  // The table of an earlier body or rig is not returned: its rows may name labels or bones that no longer exist.
  const bool fits = table.known && table.known->source.volume == source.volume &&
                    table.known->source.tissues == source.tissues && table.known->source.armature == source.armature;
  return fits ? &*table.known : nullptr;
}

void map_label(Context& context, Label label, std::optional<BodySide> side, std::optional<int> bone) {
  const Document& document = context.document();
  const Tissue* tissue = document.tissues->find(label);
  if (!tissue) return;
  const std::string* name = bone ? &document.armature->bones[static_cast<std::size_t>(*bone)].name : nullptr;
  BoneMap map = with_entry(document.bone_map ? *document.bone_map : BoneMap{}, *tissue, side, name);
  if (document.bone_map ? map == *document.bone_map : map.empty()) return;
  const std::string of_side = !side ? "" : *side == BodySide::Left ? ", left" : ", right";
  const std::string what = shown_name(*tissue) + of_side;
  note_weights_source(context);
  Document next = document;
  next.bone_map = map.empty() ? nullptr : std::make_shared<const BoneMap>(std::move(map));
  context.history->commit(name ? what + " follows " + *name : what + " follows the bone found automatically",
                          std::move(next));
}

void clear_bone_map(Context& context) {
  note_weights_source(context);
  Document next = context.document();
  next.bone_map.reset();
  context.history->commit("Clear bone map", std::move(next));
}

void show_bone_table(Context& context) {
  if (!context.bone_table->coloured || context.workspace() != Workspace::Rig) return;
  const BoneTable::Known* known = bone_table(context);
  render::Scene& scene = context.views->scene;
  if (!known || !known->field || scene.volume != known->source.volume || scene.pose) return;
  scene.outlined.reset();
  if (scene.display == render::Display::Solid)
    scene.display = render::Display::XRay;  // soft tissue would hide the bones
  scene.weights = render::ShownWeights{.weights = nullptr,
                                       .tissue = known->tissue,
                                       .display = render::WeightDisplay::Field,
                                       .swatches = nullptr,
                                       .region = nullptr,
                                       .field = known->field,
                                       .contours = false};
}

}  // namespace limber::editor
