// SPDX-License-Identifier: AGPL-3.0-or-later
// The brushes of the Skin workspace: how they are set, where the pointer puts them, and the stroke that is being painted.
// A stroke shows its weights in the document's place (Views::preview_weights) and becomes one edit when the button is let
// go; Escape drops it. How brushes are set is no part of the document.
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/skin/stroke.h"
#include "editor/painted_region.h"
#include "core/skin/weight_layers.h"
#include "editor/seen_from.h"
#include "editor/test_pose.h"

namespace limber::editor {

struct Editor;
struct FoundProblems;

// Tissues that a brush may change.
enum class PaintedTissue { All, Soft, Chosen, Visible };

// Where a brush stands: on the body in 3D, in the plane of a slice.
struct BrushPlace {
  ViewId view = ViewId::Body;
  glm::dvec3 seen{0}, normal{0};  // world, mm: where it is drawn; unit
  glm::dvec3 rest{0};             // where it paints
};

struct Painting {
  static constexpr double kLeastRadius = 0.5, kMostRadius = 300;  // mm

  BrushKind kind = BrushKind::Add;
  double radius = 20;     // mm
  double strength = 0.75;  // [0, 1]
  double value = 1;       // [0, 1], of Set and Multiply
  FalloffShape falloff = FalloffShape::Smooth;
  std::vector<glm::dvec2> falloff_curve;  // (share of the radius, cover), distances growing, in place of the shape; empty: none
  double spacing = 0.2;   // of the radius
  double blend_mm = 40;   // of the joint capsule
  bool accumulate = false;
  BrushDistance distance = BrushDistance::Geodesic;
  BrushDepth depth = BrushDepth::ToDepth;
  double depth_mm = 25;
  PaintedTissue tissue = PaintedTissue::Visible;
  bool subtree = false;   // only where the active bone, the one it hangs on or one below it has most of the weight
  Normalize normalize = Normalize::Unlocked;  // as chosen; see normalize_of
  bool relative_to_locks = false;

  int dragged_point = -1;           // of the falloff's curve
  // Of weights (editor/layers.h).
  std::optional<std::size_t> layer;  // that is painted; none: the base
  bool mask = false;                 // its mask is painted in place of its weights
  struct {                           // what is painted on, and what it was made of
    std::shared_ptr<const WeightLayers> of;
    std::size_t layer = 0;
    std::shared_ptr<const SkinWeights> weights;
  } canvas;

  TestPose test;
  std::shared_ptr<const FoundProblems> problems;  // of editor/weight_problems.h; null: not looked for yet
  int problem = -1;                               // the one that was gone to

  std::optional<BrushPlace> place;  // under the pointer, by the last frame

  // Of edits of the whole body (weight_editing.h)
  std::int64_t edited_at_once = 300'000;  // voxels: some ten milliseconds; an edit of more is a job
  std::optional<int> edit_job;            // at work
  PaintedRegion region;                   // that brushes keep to as well
  std::vector<std::int64_t> unmatched;    // places of tissue that the last mirror found nothing for

  // While a button paints.
  struct Running;
  std::shared_ptr<Running> running;

  Painting();
  ~Painting();
};

// Where a brush at this pixel would paint; nothing beside the body.
std::optional<BrushPlace> brush_place(Editor& editor, const ViewPlace& view, const glm::vec2& pixel);

// Why nothing can be painted now: "There are no weights"; "" when it can.
std::string why_not_paint(const Editor& editor);
// Why a brush would reach no tissue, as it is set; "" when it would.
std::string why_brush_reaches_nothing(const Editor& editor);
// Paints with that brush from the pointer on, until the button is let go.
void begin_stroke(Editor& editor, BrushKind kind);
// Of the stroke that is being painted; 0 where none is.
int dabs_of_stroke(const Editor& editor);
// Once a frame.
void follow_brush(Editor& editor);
// Over a view: the ring of the brush, and of the one that mirrors it.
void draw_brush(Editor& editor, const ViewPlace& view);

// What the brushes may change, and the bones they paint, as set now.
StrokeSettings stroke_settings(const Editor& editor, BrushKind kind);
// The base and masks have none to leave it to: they are normalized as they are painted.
Normalize normalize_of(const Editor& editor);
Falloff falloff_of(const Painting& painting);
// A curve of its own that begins as the shape is.
void begin_falloff_curve(Painting& painting);
const char* name_of(BrushKind kind);  // "Add"

}  // namespace limber::editor
