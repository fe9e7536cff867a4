// SPDX-License-Identifier: AGPL-3.0-or-later
// The table of brushes, which says what each brush does to a voxel. Strokes, the editor's operators, menus and tool
// strip use the table. A new brush needs one source file in core/paint/brushes and a line of kBrushes in
// brush_rule.cpp.
//
// A plain brush computes a voxel's new weight only from its old weight of the painted bones. A brush that looks around
// computes a target from other voxels and moves the voxel's weights towards it. A brush may also change a voxel in its
// own way. The cover of a voxel is the dab's strength at that voxel, [0, 1].
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "core/paint/brush_region.h"
#include "core/rig/mirror.h"
#include "core/skin/falloff.h"
#include "core/skin/normalize.h"
#include "core/skin/smooth_weights.h"
#include "core/skin/weighted_body.h"

namespace limber {

// Indices of brushes in the table, for brushes that other code refers to. `w` is the weight of the painted bones, and
// `cover` the dab's strength at the voxel, [0, 1].
enum class BrushKind {
  Add,           // w + cover
  Subtract,      // w - cover
  Set,           // w + (value - w) * cover
  Multiply,      // w + (w * value - w) * cover
  Smooth,        // blends to the mean around the voxel, weighted by a Gaussian 0.45 radii wide
  Sharpen,       // moves weights away from the mean that Smooth blends to
  Average,       // blends to the mean over all voxels of the dab
  Smear,         // drags weights along the stroke; its dabs always accumulate
  JointCapsule,  // divides the weight of two bones smoothly between them, over `blend_mm` at their joint
};

struct Brush {
  BrushKind kind = BrushKind::Add;
  double radius = 10;   // mm
  double strength = 1;  // [0, 1]: cover at the dab's centre
  double value = 1;     // Set: new weight, [0, 1]; Multiply: factor, 0 or more
  Falloff falloff;
  double spacing = 0.25;    // distance between successive dabs, as a share of the radius
  bool accumulate = false;  // false: a stroke changes a voxel by its largest cover of all dabs, once
  BrushDistance distance = BrushDistance::Geodesic;
  bool all_bones = true;  // brushes that look around change all bones of a voxel; false: only the painted bones
  // For JointCapsule: length, centred on the joint, over which the child bone's share rises from 0 to 1 (smoothstep).
  double blend_mm = 20;
  glm::dvec3 reference{0};  // world at rest, mm; the user sets this position, from which some brushes copy
};

// The data that a brush works on. References are valid until the stroke ends.
struct BrushView {
  const WeightedBody& body;
  const Brush& brush;
  SmoothWeights& smooth;              // shared by both sides of the body; holds the smooth weights of one dab
  std::optional<MirrorPlane> mirror;  // set for the side that mirrors the stroke; none for the stroke's own side
  std::function<InfluenceView(int brick)> weights;  // returns the weights of a brick before the dab
};

// The parameters of one dab.
struct DabView {
  const Reached& reached;
  glm::dvec3 centre;  // world, mm
  glm::dvec3 way;     // movement from the last dab's centre, mm; 0 for the first dab
  float strength;     // cover at the centre, [0, 1]
};

// A voxel that a dab touches.
struct VoxelView {
  glm::ivec3 voxel;
  int brick, cell;       // as in Reached::Brick::brick and Reached::cell
  const Influence& own;  // the voxel's influence before the dab
};

// The data that a brush keeps for one side of the body during a stroke.
class BrushSide {
 public:
  virtual ~BrushSide() = default;
  virtual void begin_dab(const DabView&) {}
  // Computes the target: the weights towards which the voxel's weights move. Only their ratios matter. Returns false
  // when the voxel stays unchanged. Called from several threads.
  virtual bool target_at(const VoxelView&, WeightSum& /*target*/) const { return false; }
  // Changes a voxel in the brush's own way. Returns nothing when the brush has none: then the voxel is moved towards
  // the target.
  virtual std::optional<WeightChange> change(const WeightRules&, Influence&, const glm::ivec3& /*voxel*/,
                                             double /*cover*/) const {
    return std::nullopt;
  }
};

struct BrushRule {
  BrushKind kind = {};      // the brush's index in the table
  std::string id;           // as in "add"; the brush's operator is then "skin.brush_add"
  std::string name;         // as in "Add"
  std::string description;  // hint for the user
  bool takes_value = false;
  bool looks_around = false;
  bool accumulates = false;  // dabs always accumulate, whatever Brush::accumulate says
  bool one_bone = false;     // paints only the active bone

  // For plain brushes, else null: both functions return a voxel's new weight under a cover. Weights are in 1/65535, and
  // `full` is the weight that counts as 1. `paint` takes the cover in [0, 1], `paint_whole` in 1/65535.
  double (*paint)(double before, double cover, double full, const Brush& brush) = nullptr;
  int (*paint_whole)(int before, int covered, const Brush& brush) = nullptr;
  // For other brushes, else null: creates the brush's data for one side of the body. Throws Error when the brush has
  // nothing to paint there.
  std::unique_ptr<BrushSide> (*side)(const BrushView& view, std::span<const int> bones) = nullptr;
};

// Returns the table, indexed by BrushKind.
std::span<const BrushRule> brush_rules();
const BrushRule& rule_of(BrushKind kind);
const BrushRule* find_brush(std::string_view id);  // null when no brush has this id

}  // namespace limber
