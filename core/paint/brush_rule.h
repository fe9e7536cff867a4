// SPDX-License-Identifier: AGPL-3.0-or-later
// The table of brushes, which says what each brush does to a voxel. Strokes, the editor's operators, menus and tool
// strip use the table. A new brush needs one source file in core/paint/brushes and a line of kBrushes in
// brush_rule.cpp.
//
// There are three kinds of brushes. A plain brush computes a voxel's new weight only from its old weight of the painted
// bones. A brush that looks around computes a target from other voxels and moves the voxel's weights towards the
// target. Any other brush changes a voxel by a function of its own. The cover of a voxel is the dab's strength at that
// voxel, [0, 1].
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

// The brushes to which other code refers, as indices into the table. In the formulas, `w` is the weight of the painted
// bones, and `cover` is the dab's strength at the voxel, [0, 1].
enum class BrushKind {
  Add,           // changes the weight w to w + cover
  Subtract,      // changes the weight w to w - cover
  Set,           // changes the weight w to w + (value - w) * cover
  Multiply,      // changes the weight w to w + (w * value - w) * cover
  Smooth,        // moves weights towards the mean around the voxel, weighted by a Gaussian 0.45 radii wide
  Sharpen,       // moves weights away from the mean that Smooth uses
  Average,       // moves weights towards the mean over all voxels of the dab
  Smear,         // drags weights along the stroke; dabs of one stroke always accumulate
  JointCapsule,  // divides the weight of a bone and its parent smoothly at their joint, over `blend_mm`
};

struct Brush {
  BrushKind kind = BrushKind::Add;
  double radius = 10;   // radius of the brush, mm
  double strength = 1;  // cover at the dab's centre, [0, 1]
  double value = 1;     // Set: new weight, [0, 1]; Multiply: factor, at least 0
  Falloff falloff;
  double spacing = 0.25;    // distance between successive dabs, as a share of the radius
  bool accumulate = false;  // false: a stroke changes each voxel once, by its largest cover of all dabs
  BrushDistance distance = BrushDistance::Geodesic;
  // For brushes that read other voxels. True: they change all bones; false: only the painted bones.
  bool all_bones = true;
  // For JointCapsule: length over which the child bone's share rises from 0 to 1 (smoothstep), mm. The joint is at its
  // middle.
  double blend_mm = 20;
  glm::dvec3 reference{0};  // world at rest, mm; position set by the user, from which the Clone brush copies
};

// The data that a brush reads during a stroke. References are valid until the stroke ends.
struct BrushView {
  const WeightedBody& body;
  const Brush& brush;
  SmoothWeights& smooth;              // used by both sides of the body in turn; holds the smooth weights of one dab
  std::optional<MirrorPlane> mirror;  // set for the mirrored side of the body; empty for the stroke's own side
  std::function<InfluenceView(int brick)> weights;  // returns a brick's weights as they are before the dab
};

// One dab, as a brush receives it.
struct DabView {
  const Reached& reached;
  glm::dvec3 centre;  // centre of the dab, world, mm
  glm::dvec3 way;     // vector from the last dab's centre to this one's, mm; 0 for the first dab
  float strength;     // cover at the dab's centre, [0, 1]
};

// A voxel that a dab touches.
struct VoxelView {
  glm::ivec3 voxel;
  int brick, cell;       // index of the voxel's brick; position of the voxel in it, x + 8 y + 64 z
  const Influence& own;  // the voxel's influence before the dab
};

// The data that a brush keeps for one side of the body during a stroke.
class BrushSide {
 public:
  virtual ~BrushSide() = default;
  virtual void begin_dab(const DabView&) {}
  // Computes the target towards which the voxel's weights move. Only the proportions of the target's weights matter.
  // Returns false when the voxel stays unchanged. It is called from several threads.
  virtual bool target_at(const VoxelView&, WeightSum& /*target*/) const { return false; }
  // Changes a voxel by the brush's own function. Returns nothing when the brush has no such function; the voxel is then
  // moved towards the target.
  virtual std::optional<WeightChange> change(const WeightRules&, Influence&, const glm::ivec3& /*voxel*/,
                                             double /*cover*/) const {
    return std::nullopt;
  }
};

struct BrushRule {
  BrushKind kind = {};      // the brush's index in the table
  std::string id;           // for example "add"; the brush's operator is then "skin.brush_add"
  std::string name;         // name that the user sees, for example "Add"
  std::string description;  // explanation for the user
  bool takes_value = false;
  bool looks_around = false;
  bool accumulates = false;  // true: dabs always accumulate, whatever Brush::accumulate says
  bool one_bone = false;     // true: paints only the active bone, even if several bones are selected

  // For plain brushes, else null. Both functions return a voxel's new weight for a given cover. Weights are in units
  // of 1/65535; `full` is the weight that counts as 1. `paint` takes the cover in [0, 1], `paint_whole` in units of
  // 1/65535.
  double (*paint)(double before, double cover, double full, const Brush& brush) = nullptr;
  int (*paint_whole)(int before, int covered, const Brush& brush) = nullptr;
  // For brushes that are not plain, else null. Creates the brush's data for one side of the body. Throws Error when the
  // brush has nothing to paint on that side.
  std::unique_ptr<BrushSide> (*side)(const BrushView& view, std::span<const int> bones) = nullptr;
};

// Returns the table, indexed by BrushKind.
std::span<const BrushRule> brush_rules();
const BrushRule& rule_of(BrushKind kind);
const BrushRule* find_brush(std::string_view id);  // null when no brush has this id

}  // namespace limber
