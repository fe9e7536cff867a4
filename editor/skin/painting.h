// SPDX-License-Identifier: AGPL-3.0-or-later
// How the brushes of the Skin workspace are set, and the stroke that is being painted. No part of the document.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/paint/stroke.h"
#include "core/skin/weight_edits.h"
#include "core/skin/weight_layers.h"
#include "editor/context/layout.h"

namespace limber::editor {

struct PaintedRegion {
  std::weak_ptr<const LabelVolume> volume;
  std::shared_ptr<const TissueRegion> places;
  std::int64_t voxels = 0;
};

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
  double radius = 20;      // mm
  double strength = 0.75;  // [0, 1]
  double value = 1;        // [0, 1], of Set and Multiply
  FalloffShape falloff = FalloffShape::Smooth;
  std::vector<glm::dvec2>
      falloff_curve;     // (share of the radius, cover), distances growing, in place of the shape; empty: none
  double spacing = 0.2;  // of the radius
  double blend_mm = 40;  // of the joint capsule
  bool accumulate = false;
  BrushDistance distance = BrushDistance::Geodesic;
  BrushDepth depth = BrushDepth::ToDepth;
  double depth_mm = 25;
  PaintedTissue tissue = PaintedTissue::Visible;
  bool subtree = false;  // only where the active bone, the one it hangs on or one below it has most of the weight
  Normalize normalize = Normalize::Unlocked;  // as chosen; see normalize_of
  bool relative_to_locks = false;

  int dragged_point = -1;  // of the falloff's curve
  // Of weights (editor/skin/weight_layers.h).
  std::optional<std::size_t> layer;  // that is painted; none: the base
  bool mask = false;                 // its mask is painted in place of its weights
  struct {                           // what is painted on, and what it was made of
    std::shared_ptr<const WeightLayers> of;
    std::size_t layer = 0;
    std::shared_ptr<const SkinWeights> weights;
  } canvas;

  std::shared_ptr<const FoundProblems> problems;  // of editor/skin/weight_problems.h; null: not looked for yet
  int problem = -1;                               // the one that was gone to

  std::optional<BrushPlace> place;  // under the pointer, by the last frame

  // Of edits of the whole body (weight_edits.h)
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

Falloff falloff_of(const Painting& painting);
// A curve of its own that begins as the shape is.
void begin_falloff_curve(Painting& painting);
std::string name_of(BrushKind kind);             // "Add"
std::string operator_of(const BrushRule& rule);  // "skin.brush_add"
// A list of operators with those of all brushes in place of "*", plain ones apart from the others.
std::vector<std::string> with_brushes(std::vector<std::string> list);

}  // namespace limber::editor
