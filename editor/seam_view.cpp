// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/seam_view.h"

#include <algorithm>
#include <cmath>

#include "core/base/error.h"
#include "core/seams/seam_edits.h"
#include "editor/dispatch.h"
#include "editor/paint.h"
#include "editor/painting.h"
#include "editor/prepare.h"
#include "editor/seen_from.h"
#include "editor/skin_display.h"
#include "editor/task.h"
#include "editor/test_pose.h"
#include "editor/views.h"
#include "editor/wipe.h"

namespace limber::editor {

namespace {

constexpr Colour kSeam = 0xFF4BFFD6, kUnder = 0x8C000000;  // D6FF4B, which no tissue has; black at 55 %
constexpr float kSheet = 0.22f;                             // its cover
constexpr std::size_t kMostRectangles = 15'000;             // in 3D; of more the rims alone
constexpr double kPixelStep = 4;                            // that a stroke is followed by, at scale 1

const SeamSheet& drawn_sheet(Editor& editor, const std::shared_ptr<const Seams>& seams, std::int64_t strokes) {
  auto& drawn = editor.seams->drawn;
  if (drawn.of != seams || drawn.strokes != strokes) drawn = {seams, strokes, sheet_of(*seams, editor.document().volume->grid)};
  return drawn.sheet;
}

void draw_line(const Look& look, const glm::dvec2& a, const glm::dvec2& b, float width) {
  ImDrawList& canvas = *ImGui::GetWindowDrawList();
  canvas.AddLine(im(glm::vec2(a)), im(glm::vec2(b)), kUnder, 2 * width * look.scale);
  canvas.AddLine(im(glm::vec2(a)), im(glm::vec2(b)), kSeam, width * look.scale);
}

void draw_in_body(const Look& look, const SeenFrom& seen, const SeamSheet& sheet) {
  ImDrawList& canvas = *ImGui::GetWindowDrawList();
  for (std::size_t i = 0; i < sheet.rectangles.size() && sheet.rectangles.size() <= kMostRectangles; ++i) {
    std::array<ImVec2, 4> corners;
    int in_front = 0;
    for (const glm::dvec3& corner : sheet.rectangles[i])
      if (const auto pixel = seen.pixel_of(corner)) corners[static_cast<std::size_t>(in_front++)] = im(glm::vec2(*pixel));
    if (in_front == 4) canvas.AddQuadFilled(corners[0], corners[1], corners[2], corners[3], with_alpha(kSeam, kSheet));
  }
  for (const auto& rim : sheet.rims) {
    const auto from = seen.pixel_of(rim[0]), to = seen.pixel_of(rim[1]);
    if (from && to) draw_line(look, *from, *to, 1.2f);
  }
}

// Where the slice's plane goes through a rectangle.
std::optional<std::array<glm::dvec3, 2>> crossing(const std::array<glm::dvec3, 4>& corners, const glm::dvec3& point, const glm::dvec3& normal) {
  std::array<glm::dvec3, 2> ends;
  std::size_t found = 0;
  for (std::size_t i = 0; i < 4 && found < 2; ++i) {
    const glm::dvec3 &a = corners[i], &b = corners[(i + 1) % 4];
    const double above = glm::dot(a - point, normal), beyond = glm::dot(b - point, normal);
    if ((above > 0) != (beyond > 0)) ends[found++] = glm::mix(a, b, above / (above - beyond));
  }
  return found == 2 ? std::optional(ends) : std::nullopt;
}

void draw_in_slice(const Editor& editor, const SeenFrom& seen, const SeamSheet& sheet) {
  for (const auto& rectangle : sheet.rectangles)
    if (const auto line = crossing(rectangle, editor.views->cross_hair, seen.towards_eye)) {
      const auto from = seen.pixel_of((*line)[0]), to = seen.pixel_of((*line)[1]);
      if (from && to) draw_line(editor.look, *from, *to, 1.8f);
    }
}

}  // namespace

struct SeamView::Running {
  std::shared_ptr<const LabelVolume> volume;
  LabelSet soft;
  std::shared_ptr<Seams> seams;
  SeamStroke stroke = SeamStroke::Cut;
  ViewPlace view;
  glm::vec2 pixel{0};
  std::optional<Blade> blade;  // where the knife was
  std::int64_t faces = 0;      // that were changed
};

std::optional<std::shared_ptr<const Seams>> shown_seams(const Editor& editor) {
  if (editor.seams->running) return editor.seams->running->seams;
  const Document& document = editor.document();
  if (!document.volume || !document.tissues) return nullptr;
  return body_seams().known(seam_source(document));
}

std::shared_ptr<const TissueVoxels> parted_tissue(Editor& editor) {
  const std::shared_ptr<const TissueVoxels>& whole = tissue_voxels(*editor.views, editor.document());
  const auto seams = shown_seams(editor);
  if (!seams || !*seams || (*seams)->empty() || (*seams)->grid_size() != whole->grid_size()) return whole;
  auto parted = std::make_shared<TissueVoxels>(*whole);
  parted->set_seams(*seams);
  return parted;
}

void note_weights_source(Editor& editor) {
  auto& from = editor.seams->weights_from;
  if (!from || from->volume != editor.document().volume) from = seam_source(editor.document());
}

std::string why_weights_are_old(const Editor& editor) {
  const auto& from = editor.seams->weights_from;
  const Document& document = editor.document();
  if (!document.weights || !from || from->volume != document.volume) return "";
  if (from->kept != document.seams) return "Older than the seams";
  return from->bone_map != document.bone_map ? "Older than the bone map" : "";
}

void draw_seams(Editor& editor, const ViewPlace& view) {
  const render::Scene& scene = scene_of(editor, view);
  if (!editor.seams->shown || editor.workspace != Workspace::Skin || scene.pose || !scene.volume || scene.volume->grid.size != editor.document().volume->grid.size) return;
  const auto seams = shown_seams(editor);
  if (!seams || !*seams || (*seams)->empty()) return;
  const SeamSheet& sheet = drawn_sheet(editor, *seams, editor.seams->running ? editor.seams->running->faces : -1);
  const SeenFrom seen(editor, view);
  if (view.id == ViewId::Body) draw_in_body(editor.look, seen, sheet);
  else draw_in_slice(editor, seen, sheet);
}

const std::vector<SeamPair>* counted_pairs(Editor& editor) {
  SeamView& view = *editor.seams;
  const auto shown = shown_seams(editor);
  if (view.running || !shown || !*shown) return nullptr;
  const SeamSource source = seam_source(editor.document());
  if (view.counted.seams == *shown && view.counted.source == source) return &view.counted.pairs;
  if ((view.counting && editor.tasks.contains(*view.counting)) || !source.armature) return nullptr;
  view.counting = start_task(editor, "", [source, seams = *shown](Progress& progress) -> Finish {
    const TissueVoxels tissue(*source.volume);
    const BoneParts parts = split_bones(*source.volume, tissue, *source.tissues, *source.armature, progress, usable_bone_map(source));
    auto pairs = seam_pairs(*seams, *source.volume, tissue, *source.armature, parts, progress);
    return [counted = SeamView::Counted{source, seams, std::move(pairs)}](Editor& e) {
      e.seams->counted = counted;
      e.touch();
    };
  },
  [source, seams = *shown](Editor& e, const std::string& error) {  // not tried again for the same ones
    e.seams->counted = {source, seams, {}};
    e.messages.show_error(error, "Counting seams");
  });
  return nullptr;
}

std::string why_no_seams(const Editor& editor) {
  const Document& document = editor.document();
  if (!document.volume || !document.tissues) return "Open a volume first";
  if (!document.armature) return "Import a rig first: its names say what the limbs are";
  if (!body_seams().has_limbs(document.armature)) return "The names of the rig's bones mean no arms, legs or fingers";
  return editor.seams->searching && editor.tasks.contains(*editor.seams->searching) ? "They are being looked for" : "";
}

std::string why_not_cut(const Editor& editor) {
  if (editor.workspace != Workspace::Skin) return "Works in the Skin workspace";
  const Document& document = editor.document();
  if (!document.volume || !document.tissues) return "Open a volume first";
  if (editor.views->scene.pose) return "Show the body at rest first";
  return shown_seams(editor) ? "" : "Find the seams first";
}

void find_seams_again(Editor& editor) {
  SeamSource source = seam_source(editor.document());
  const bool was_edited = source.kept != nullptr;
  source.kept = nullptr;
  editor.seams->searching = start_task(editor, "Find seams", [source, was_edited](Progress& progress) -> Finish {
    const auto found = body_seams().of(source, progress);
    return [source, was_edited, faces = found ? found->size() : 0](Editor& e) {
      if (was_edited && e.document().volume == source.volume && e.document().seams) {
        note_weights_source(e);
        Document next = e.document();
        next.seams.reset();
        e.history.commit("Find seams", std::move(next));
      }
      e.messages.ok("Find seams", faces > 0 ? grouped(faces) + " voxel faces between limbs that touch" : "No limbs touch");
      e.touch();
    };
  });
  editor.touch();
}

void clear_seams(Editor& editor) {
  note_weights_source(editor);
  Document next = editor.document();
  next.seams = std::make_shared<const Seams>(next.volume->grid.size);
  editor.history.commit("Remove seams", std::move(next));
}

namespace {

// The knife's edge at a place: along the line of sight into the body, to both sides of a slice.
Blade blade_at(const SeenFrom& seen, const BrushPlace& place, double radius, const Grid& grid) {
  if (place.view != ViewId::Body) return {place.rest + radius * seen.towards_eye, place.rest - radius * seen.towards_eye};
  const glm::dvec3 to_eye = seen.direction_to_eye(place.seen);
  return {place.rest + glm::length(grid.spacing) * to_eye, place.rest - radius * to_eye};
}

void change_at(SeamView::Running& running, const SeenFrom& seen, const BrushPlace& place, double radius) {
  const Grid& grid = running.volume->grid;
  if (running.stroke == SeamStroke::Join) {
    running.faces += join_within(*running.seams, grid, place.rest, radius);
    return;
  }
  const Blade blade = blade_at(seen, place, radius, grid);
  if (running.blade) running.faces += cut_between(*running.seams, *running.volume, running.soft, *running.blade, blade);
  running.blade = blade;
}

void stroke_to(Editor& editor, const glm::vec2& pixel) {
  SeamView::Running& running = *editor.seams->running;
  Painting& painting = *editor.skin->painting;
  const SeenFrom seen(editor, running.view);
  const int steps = std::max(1, static_cast<int>(std::ceil(glm::distance(pixel, running.pixel) / (kPixelStep * editor.look.scale))));
  for (int step = 1; step <= steps; ++step) {
    painting.place = brush_place(editor, running.view, glm::mix(running.pixel, pixel, float(step) / float(steps)));
    if (painting.place) change_at(running, seen, *painting.place, painting.radius);
    else running.blade.reset();
  }
  running.pixel = pixel;
  editor.touch();
}

void drop_stroke(Editor& editor) {
  editor.seams->running.reset();
  editor.touch();
}

void end_stroke(Editor& editor) {
  const auto running = editor.seams->running;
  drop_stroke(editor);
  const bool cuts = running->stroke == SeamStroke::Cut;
  if (running->faces == 0) return editor.messages.info(cuts ? "No seam was cut" : "No seam was erased", cuts ? "Draw a line over soft tissue: the brush cuts along it" : "None lies within the brush");
  Document next = editor.document();
  if (next.volume != running->volume) return;
  note_weights_source(editor);
  next.seams = running->seams;
  editor.history.commit(cuts ? "Cut seam" : "Erase seam", std::move(next));
}

}  // namespace

void begin_seam_stroke(Editor& editor, SeamStroke stroke) {
  const ViewPlace* view = hovered_view(editor);
  const auto before = shown_seams(editor);
  if (!view || !before || !why_not_cut(editor).empty()) return;
  const Document& document = editor.document();
  auto running = std::make_shared<SeamView::Running>();
  running->volume = document.volume;
  running->soft = soft_labels(*document.tissues);
  running->seams = *before ? std::make_shared<Seams>(**before) : std::make_shared<Seams>(document.volume->grid.size);
  running->stroke = stroke;
  running->view = *view;
  running->pixel = editor.input.pointer;
  editor.seams->running = running;
  stroke_to(editor, editor.input.pointer);
  editor.drag = Drag{MouseButton::Left, [](Editor& e, const glm::vec2&) { stroke_to(e, e.input.pointer); }, end_stroke, drop_stroke};
}

}  // namespace limber::editor
