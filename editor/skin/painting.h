// SPDX-License-Identifier: AGPL-3.0-or-later
// The brush settings of the Skin workspace and the running stroke. They are not part of the document.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/paint/stroke.h"
#include "core/skin/weight_edits.h"
#include "core/skin/weight_layers.h"
#include "editor/context/view_place.h"

namespace limber::editor {

struct PaintedRegion {
  std::weak_ptr<const LabelVolume> volume;
  std::shared_ptr<const TissueRegion> places;
  std::int64_t voxels = 0;
};

struct BrushPresets;
struct FoundProblems;
struct LabelBrush;
struct RepairedJoint;

// The tissues that a brush may change.
enum class PaintedTissue { All, Soft, Chosen, Visible };

// The position of a brush: on the body's surface in the 3D view, or in the plane of a slice.
struct BrushPlace {
  ViewId view = ViewId::Body;
  // Position in the displayed pose, world, mm; unit normal of the surface or of the slice.
  glm::dvec3 seen{0}, normal{0};
  glm::dvec3 rest{0};  // position in the rest pose, in which brushes paint, world, mm
};

struct Painting {
  static constexpr double kLeastRadius = 0.5, kMostRadius = 300;  // the brush's radius is clamped to this range, mm

  BrushKind kind = BrushKind::Add;
  double radius = 20;      // radius of the brush, mm
  double strength = 0.75;  // strength of one dab (a single touch of the brush), [0, 1]; 1: the full change
  double value = 1;        // weight that the brushes Set and Multiply use, [0, 1]
  FalloffShape falloff = FalloffShape::Smooth;
  // Points of a custom falloff curve, sorted by x. x: distance from the brush's centre, relative to the radius; y: the
  // brush's effect, [0, 1]. Empty: use `falloff`.
  std::vector<glm::dvec2> falloff_curve;
  double spacing = 0.2;  // distance between the dabs of a stroke, as a fraction of the radius
  double blend_mm = 40;  // length over which the joint capsule brush blends a bone with its parent
  bool accumulate = false;
  BrushDistance distance = BrushDistance::Geodesic;
  BrushDepth depth = BrushDepth::ToDepth;
  double depth_mm = 25;
  PaintedTissue tissue = PaintedTissue::Visible;
  // True: paints only where the active bone, its parent or one of its descendants has the largest weight.
  bool subtree = false;
  Normalize normalize = Normalize::Unlocked;  // the user's setting; strokes use normalize_of(), which may replace it
  bool relative_to_locks = false;

  std::shared_ptr<BrushPresets> presets;  // the user's brush presets (editor/skin/brush_presets.h); null: not read yet

  int dragged_point = -1;  // index of the point of `falloff_curve` that the user drags; -1: the user drags no point
  // The weight layer being painted (editor/skin/weight_layers.h).
  // Index of the painted layer; no value: the base weights below all layers are painted.
  std::optional<std::size_t> layer;
  bool mask = false;  // true: strokes paint the layer's mask instead of its weights
  struct {  // cache of the weights that a stroke on a layer changes, with the layers that they are composed of
    std::shared_ptr<const WeightLayers> of;
    std::size_t layer = 0;
    std::shared_ptr<const SkinWeights> weights;
  } canvas;

  std::shared_ptr<const FoundProblems> problems;  // result of the search for weight problems; null: not searched yet
  int problem = -1;                               // index of the problem visited last; -1: no problem was visited
  std::shared_ptr<const RepairedJoint> repaired_joint;  // outcome of the last repair of a joint; null: no repair yet

  std::optional<BrushPlace> place;  // the brush's position in the last frame; none: no tissue was under the pointer

  // State of the weight edits that change many voxels at once, without a brush (weight_edits.h)
  std::int64_t edited_at_once = 300'000;  // a body with more voxels is edited in a job (a smaller one takes some 10 ms)
  std::optional<int> edit_job;            // id of the running job of an edit; none: no edit runs
  PaintedRegion region;                   // the region that limits brushes and edits
  std::vector<std::int64_t> unmatched;    // indices of the tissue voxels for which Mirror weights found no match

  std::unique_ptr<LabelBrush> labels;  // declared in editor/labels/label_brush.h; never null

  // The running stroke; null: no stroke is being painted.
  struct Running;
  std::shared_ptr<Running> running;

  Painting();
  ~Painting();
};

Falloff falloff_of(const Painting& painting);
// Starts a custom falloff curve with the points of the current falloff shape.
void begin_falloff_curve(Painting& painting);
std::string name_of(BrushKind kind);             // returns the brush's label, such as "Add"
std::string operator_of(const BrushRule& rule);  // id of the operator that selects the brush: "skin.brush_add"
// Replaces the entry "*" of a list of operator ids by the ids of all brushes, and returns the list. Brushes that
// compute each voxel's weights without its neighbours come first; a separator "-" stands between them and the other
// brushes.
std::vector<std::string> with_brushes(std::vector<std::string> list);

}  // namespace limber::editor
