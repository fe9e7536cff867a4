// SPDX-License-Identifier: AGPL-3.0-or-later
// What each brush does with a voxel, as one table: strokes, the editor's operators, menus and tool strip read it. A new
// brush is one source in core/paint/brushes and its line of kBrushes in brush_rule.cpp.
//
// A plain brush looks at nothing but the painted bones' weight. A brush that looks around draws weights to a target of
// its own making. A brush may also change a voxel in a way of its own.
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

// Places in the table. A brush that nothing but the table knows needs no name here.
enum class BrushKind {
  Add,           // w + cover
  Subtract,      // w - cover
  Set,           // w to `value` by cover
  Multiply,      // w to w * value by cover
  Smooth,        // to the mean around, by a Gauss curve as wide as 0.45 radii
  Sharpen,       // away from it
  Average,       // to the mean over the dab
  Smear,         // weights are dragged along the stroke; always accumulates
  JointCapsule,  // what two bones share at their joint blends over `blend_mm` along them
};

struct Brush {
  BrushKind kind = BrushKind::Add;
  double radius = 10;   // mm
  double strength = 1;  // [0, 1]: cover at the centre
  double value = 1;     // Set: [0, 1]; Multiply: 0 and more
  Falloff falloff;
  double spacing = 0.25;    // between dabs, as a share of the radius
  bool accumulate = false;  // else a stroke never goes beyond what one dab at its full cover does
  BrushDistance distance = BrushDistance::Geodesic;
  bool all_bones = true;  // brushes that look around: all bones of a voxel, not only the painted
  double blend_mm = 20;   // JointCapsule: where the child's weight goes from 0 to 1 (smoothstep), centred on the joint
  glm::dvec3 reference{0};  // world at rest, mm: a place of the user's, for brushes that take something from there
};

// What a brush works on. References stay as long as the stroke.
struct BrushView {
  const WeightedBody& body;
  const Brush& brush;
  SmoothWeights& smooth;              // shared by both sides of the body; spread for one dab after the other
  std::optional<MirrorPlane> mirror;  // of the side that mirrors the stroke; none on the stroke's own
  std::function<InfluenceView(int brick)> weights;  // that a dab starts from
};

// One dab.
struct DabView {
  const Reached& reached;
  glm::dvec3 centre;  // world, mm
  glm::dvec3 way;     // from the last dab; 0 for the first
  float strength;     // [0, 1]
};

// A voxel that a dab covers.
struct VoxelView {
  glm::ivec3 voxel;
  int brick, cell;       // as in Reached
  const Influence& own;  // that it starts from
};

// What a brush keeps of one side of the body while a stroke goes on.
class BrushSide {
 public:
  virtual ~BrushSide() = default;
  virtual void begin_dab(const DabView&) {}
  // What the voxel's weights are drawn to, in any unit. False: nothing changes. Called from several threads.
  virtual bool target_at(const VoxelView&, WeightSum& /*target*/) const { return false; }
  // Changes a voxel in a way of its own; nothing: it is drawn to the target.
  virtual std::optional<WeightChange> change(const WeightRules&, Influence&, const glm::ivec3& /*voxel*/,
                                             double /*cover*/) const {
    return std::nullopt;
  }
};

struct BrushRule {
  BrushKind kind = {};      // its place in the table
  std::string id;           // "add": its operator is "skin.brush_add"
  std::string name;         // "Add"
  std::string description;  // what it does
  bool takes_value = false;
  bool looks_around = false;
  bool accumulates = false;  // always
  bool one_bone = false;     // paints the active bone alone

  // Plain brushes, else null: the weight that comes out of one under a cover of [0, 1], where `full` is the whole; and
  // the same of whole numbers, in 1/65535.
  double (*paint)(double before, double cover, double full, const Brush& brush) = nullptr;
  int (*paint_whole)(int before, int covered, const Brush& brush) = nullptr;
  // The others. Throws Error where the brush has nothing to paint there.
  std::unique_ptr<BrushSide> (*side)(const BrushView& view, std::span<const int> bones) = nullptr;
};

// By BrushKind.
std::span<const BrushRule> brush_rules();
const BrushRule& rule_of(BrushKind kind);
const BrushRule* find_brush(std::string_view id);  // null for none

}  // namespace limber
