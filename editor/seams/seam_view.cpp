// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/seams/seam_view.h"

#include <algorithm>
#include <cmath>

#include "editor/context/background_task.h"
#include "editor/context/context.h"
#include "editor/context/view_projection.h"
#include "editor/context/views.h"
#include "editor/context/workspace.h"
#include "editor/shown/compare_wipe.h"
#include "editor/ui/draw.h"
#include "editor/ui/messages.h"
#include "editor/volume/volume_edits.h"

namespace limber::editor {

namespace {

// Colour of seams, ABGR (RGB: D6FF4B); no tissue has this colour. kUnder: colour of the wider line that is drawn under
// each line of a seam, black with an opacity of 55 %.
constexpr Colour kSeam = 0xFF4BFFD6, kUnder = 0x8C000000;
constexpr float kSheet = 0.22f;                  // opacity of a seam in the 3D view, [0, 1]
constexpr std::size_t kMostRectangles = 15'000;  // if seams have more rectangles, the 3D view draws only their rims

const SeamSheet& drawn_sheet(Context& context, const std::shared_ptr<const Seams>& seams, std::int64_t strokes) {
  auto& drawn = context.seams->drawn;
  if (drawn.of != seams || drawn.strokes != strokes)
    drawn = {seams, strokes, sheet_of(*seams, context.document().volume->grid)};
  return drawn.sheet;
}

void draw_line(const Look& look, const glm::dvec2& a, const glm::dvec2& b, float width) {
  ImDrawList& canvas = *ImGui::GetWindowDrawList();
  canvas.AddLine(im(glm::vec2(a)), im(glm::vec2(b)), kUnder, 2 * width * look.scale);
  canvas.AddLine(im(glm::vec2(a)), im(glm::vec2(b)), kSeam, width * look.scale);
}

void draw_in_body(const Look& look, const ViewProjection& seen, const SeamSheet& sheet) {
  ImDrawList& canvas = *ImGui::GetWindowDrawList();
  for (std::size_t i = 0; i < sheet.rectangles.size() && sheet.rectangles.size() <= kMostRectangles; ++i) {
    std::array<ImVec2, 4> corners;
    int in_front = 0;
    for (const glm::dvec3& corner : sheet.rectangles[i])
      if (const auto pixel = seen.pixel_of(corner))
        corners[static_cast<std::size_t>(in_front++)] = im(glm::vec2(*pixel));
    if (in_front == 4) canvas.AddQuadFilled(corners[0], corners[1], corners[2], corners[3], with_alpha(kSeam, kSheet));
  }
  for (const auto& rim : sheet.rims) {
    const auto from = seen.pixel_of(rim[0]), to = seen.pixel_of(rim[1]);
    if (from && to) draw_line(look, *from, *to, 1.2f);
  }
}

// Returns the two ends of the line segment in which a slice cuts a rectangle; nothing if the slice does not cut it.
//   point, normal  a point in the plane of the slice, and the plane's normal
std::optional<std::array<glm::dvec3, 2>> crossing(const std::array<glm::dvec3, 4>& corners, const glm::dvec3& point,
                                                  const glm::dvec3& normal) {
  std::array<glm::dvec3, 2> ends;
  std::size_t found = 0;
  for (std::size_t i = 0; i < 4 && found < 2; ++i) {
    const glm::dvec3 &a = corners[i], &b = corners[(i + 1) % 4];
    const double above = glm::dot(a - point, normal), beyond = glm::dot(b - point, normal);
    if ((above > 0) != (beyond > 0)) ends[found++] = glm::mix(a, b, above / (above - beyond));
  }
  return found == 2 ? std::optional(ends) : std::nullopt;
}

void draw_in_slice(const Context& context, const ViewProjection& seen, const SeamSheet& sheet) {
  for (const auto& rectangle : sheet.rectangles)
    if (const auto line = crossing(rectangle, context.views->cross_hair, seen.towards_eye)) {
      const auto from = seen.pixel_of((*line)[0]), to = seen.pixel_of((*line)[1]);
      if (from && to) draw_line(context.ui->look, *from, *to, 1.8f);
    }
}

}  // namespace

std::optional<std::shared_ptr<const Seams>> shown_seams(const Context& context) {
  if (context.seams->running) return context.seams->running->seams;
  const Document& document = context.document();
  if (!document.volume || !document.tissues) return nullptr;
  return body_seams().known(seam_source(document));
}

std::shared_ptr<const TissueVoxels> parted_tissue(Context& context) {
  const std::shared_ptr<const TissueVoxels>& whole = tissue_voxels(*context.views, context.document());
  const auto seams = shown_seams(context);
  if (!seams || !*seams || (*seams)->empty() || (*seams)->grid_size() != whole->grid_size()) return whole;
  auto parted = std::make_shared<TissueVoxels>(*whole);
  parted->set_seams(*seams);
  return parted;
}

void note_weights_source(Context& context) {
  auto& from = context.seams->weights_from;
  const Document& document = context.document();
  const bool same_body = from && from->volume && document.volume && from->volume->grid == document.volume->grid &&
                         from->armature == document.armature;
  if (!same_body) from = seam_source(document);
}

std::string why_weights_are_old(const Context& context) {
  const auto& from = context.seams->weights_from;
  const Document& document = context.document();
  if (!document.weights || !document.volume || !from || !from->volume) return "";
  if (from->volume != document.volume) {
    const bool same_body = from->volume->grid == document.volume->grid && from->armature == document.armature;
    return same_body ? "Weights are older than the labels" : "";
  }
  if (from->kept != document.seams) return "Weights are older than the seams";
  return from->bone_map != document.bone_map ? "Weights are older than the bone map" : "";
}

void draw_seams(Context& context, const ViewPlace& view) {
  const render::Scene& scene = scene_of(context, view);
  if (!context.seams->shown || context.workspace() != Workspace::Skin || scene.pose || !scene.volume ||
      scene.volume->grid.size != context.document().volume->grid.size)
    return;
  const auto seams = shown_seams(context);
  if (!seams || !*seams || (*seams)->empty()) return;
  const SeamSheet& sheet = drawn_sheet(context, *seams, context.seams->running ? context.seams->running->faces : -1);
  const ViewProjection seen(context, view);
  if (view.id == ViewId::Body) draw_in_body(context.ui->look, seen, sheet);
  else draw_in_slice(context, seen, sheet);
}

const std::vector<SeamPair>* counted_pairs(Context& context) {
  SeamView& view = *context.seams;
  const auto shown = shown_seams(context);
  if (view.running || !shown || !*shown) return nullptr;
  const SeamSource source = seam_source(context.document());
  if (view.counted.seams == *shown && view.counted.source == source) return &view.counted.pairs;
  if ((view.counting && context.background->tasks.contains(*view.counting)) || !source.armature) return nullptr;
  view.counting = start_task(
      context, "",
      [source, seams = *shown](Progress& progress) -> Finish {
        const TissueVoxels tissue(*source.volume);
        const BoneParts parts =
            split_bones(*source.volume, tissue, *source.tissues, *source.armature, progress, usable_bone_map(source));
        auto pairs = seam_pairs(*seams, *source.volume, tissue, *source.armature, parts, progress);
        return [counted = SeamView::Counted{source, seams, std::move(pairs)}](Context& c) {
          c.seams->counted = counted;
          c.ui->touch();
        };
      },
      [source, seams = *shown](Context& c, const std::string& error) {
        // Store an empty count for these seams. Without it, the failed task would start again in the next frame.
        c.seams->counted = {source, seams, {}};
        c.messages->show_error(error, "Counting seams");
      });
  return nullptr;
}

std::string why_no_seams(const Context& context) {
  const Document& document = context.document();
  if (!document.volume || !document.tissues) return "Open a volume first";
  if (!document.armature) return "Import a rig first: limbs are found by its bone names";
  if (!body_seams().has_limbs(document.armature))
    return "No bone of the rig is named as an arm, leg or finger: rename the bones";
  return context.seams->searching && context.background->tasks.contains(*context.seams->searching)
             ? "The search for seams is running: wait until the job ends"
             : "";
}

void find_seams_again(Context& context) {
  SeamSource source = seam_source(context.document());
  const bool was_edited = source.kept != nullptr;
  source.kept = nullptr;
  context.seams->searching = start_task(context, "Find seams", [source, was_edited](Progress& progress) -> Finish {
    const auto found = body_seams().of(source, progress);
    return [source, was_edited, faces = found ? found->size() : 0](Context& c) {
      if (was_edited && c.document().volume == source.volume && c.document().seams) {
        note_weights_source(c);
        Document next = c.document();
        next.seams.reset();
        c.history->commit("Find seams", std::move(next));
      }
      c.messages->ok("Find seams",
                     faces > 0 ? grouped(faces) + " voxel faces between limbs that touch" : "No limbs touch");
      c.ui->touch();
    };
  });
  context.ui->touch();
}

void clear_seams(Context& context) {
  note_weights_source(context);
  Document next = context.document();
  next.seams = std::make_shared<const Seams>(next.volume->grid.size);
  context.history->commit("Remove seams", std::move(next));
}

}  // namespace limber::editor
