// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/deform/lattice.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "core/base/parallel.h"
#include "core/deform/brick_motions.h"
#include "core/deform/flesh_shifts.h"
#include "core/deform/split_corners.h"
#include "core/platform/memory.h"

namespace limber {

namespace {

constexpr int kShareForCorners = 4;  // the stored corners of bent bricks may take at most 1/4 of the free memory
constexpr int kSeveral = BrickMotions::kSeveral;

bool is_full(const TissueVoxels::Brick& brick) {
  return std::all_of(std::begin(brick.mask), std::end(brick.mask),
                     [](std::uint64_t slice) { return slice == ~std::uint64_t{0}; });
}

// Calls body(i, j, k) for the eight corners of the whole brick.
template <class Body>
void for_each_outermost(const Body& body) {
  for (int c = 0; c < 8; ++c)
    body((c & 1) * TissueVoxels::kBrick, (c >> 1 & 1) * TissueVoxels::kBrick, (c >> 2) * TissueVoxels::kBrick);
}

// Calls body(i, j, k) for every corner of the brick's tissue voxels, x fastest.
template <class Body>
void for_each_corner(const TissueVoxels::Brick& brick, const Body& body) {
  constexpr int kSide = PosedLattice::kSide;
  std::array<unsigned, kSide * kSide> row{};  // for each row of corners along x: one bit for each corner to visit
  for (int z = 0; z < TissueVoxels::kBrick; ++z)
    for (int y = 0; y < TissueVoxels::kBrick; ++y) {
      const unsigned voxels = brick.mask[z] >> (8 * y) & 0xff, corners = voxels | voxels << 1;
      for (int step : {0, 1, kSide, kSide + 1}) row[y + kSide * z + step] |= corners;
    }
  for (int k = 0; k < kSide; ++k)
    for (int j = 0; j < kSide; ++j)
      for (unsigned bits = row[j + kSide * k]; bits; bits &= bits - 1) body(std::countr_zero(bits), j, k);
}

FourIntegers four_of(const std::uint8_t* numbers) {
  return FourIntegers{numbers[0], numbers[1], numbers[2], numbers[3]};
}
FourNumbers numbers_of(const FourIntegers& four) { return __builtin_convertvector(four, FourNumbers); }

}  // namespace

PosedLattice::PosedLattice(const LabelVolume& volume, const TissueVoxels& tissue, const SkinWeights& weights,
                           const std::vector<RigidTransform>& posed_from_rest, Blend blend, const glm::dvec3& ratio,
                           Progress& progress, const FleshShifts* shifts)
    : volume_(&volume),
      tissue_(&tissue),
      weights_(&weights),
      world_from_voxel_(world_from_voxel(volume.grid)),
      voxel_from_world_(voxel_from_world(volume.grid)),
      poser_(volume.grid, weights.bones(), posed_from_rest, blend),
      shifts_(shifts),
      output_{ratio} {
  const std::int64_t count = std::ssize(tissue.bricks());
  bounds_.resize(count);
  still_.resize(count);
  split_.resize(count);
  BrickMotions brick_motions(tissue, weights, posed_from_rest);
  moves_as_ = std::move(brick_motions.moves_as);
  rigid_ = std::move(brick_motions.around);
  for (std::int64_t brick = 0; shifts && brick < count; ++brick)
    if (shifts->bends(brick)) rigid_[brick] = kSeveral;
  kept_ = KeptCorners(rigid_, available_memory() / kShareForCorners);
  if (count == 0) return;
  output_.base = base(posed_from_rest[weights.chunk(0).front().bone[0]]);
  poser_.set_output(output_);
  for (const RigidTransform& posed : posed_from_rest) rest_from_posed_.push_back(backward(posed));
  progress.update("pose", 0);
  parallel_for(count, 16, [&](std::int64_t begin, std::int64_t end) {
    if (progress.cancelled()) throw Cancelled();
    Corners room{};
    for (auto brick = begin; brick < end; ++brick) {
      const BrickBounds posed = compute(brick, room);
      const bool bends = rigid_[brick] == kSeveral;
      bounds_[brick] = posed.box;
      still_[brick] = posed.still;
      split_[brick] = bends && tissue.seams() && tissue.seams()->is_near_brick(tissue.bricks()[brick].corner);
      if (split_[brick]) {
        bounds_[brick] = split_bounds(brick);
        still_[brick] = false;
      } else if (bends) {
        kept_.keep(brick, posed.box, room);
      }
    }
  });
  progress.update("pose", 1);
}

void PosedLattice::split_corners(std::int64_t brick, SplitBrick& corners) const {
  SplitCorners split(*tissue_, *weights_, moves_as_, brick);
  const glm::ivec3 lowest = tissue_->bricks()[brick].corner;
  tissue_->for_each(brick, brick + 1, [&](std::int64_t, const glm::ivec3& voxel) {
    const glm::ivec3 v = voxel - lowest;
    FixedPoint* own = &corners[8 * (v.x + 8 * (v.y + 8 * v.z))];
    for (int c = 0; c < 8; ++c) {
      const glm::ivec3 corner = voxel + glm::ivec3(c & 1, c >> 1 & 1, c >> 2);
      const glm::dvec3 shift = shifts_ ? shifts_->corner_shift(corner - 1, split.joined_voxels(v, c)) : glm::vec3(0);
      own[c] = poser_.posed(corner, split.at(v, c), shift);
    }
  });
}

FixedBox PosedLattice::split_bounds(std::int64_t brick) const {
  SplitBrick corners;
  split_corners(brick, corners);
  FixedBox box{FixedPoint(INT32_MAX), FixedPoint(INT32_MIN)};
  const glm::ivec3 lowest = tissue_->bricks()[brick].corner;
  tissue_->for_each(brick, brick + 1, [&](std::int64_t, const glm::ivec3& voxel) {
    const glm::ivec3 v = voxel - lowest;
    for (int c = 0; c < 8; ++c) {
      const FixedPoint& corner = corners[8 * (v.x + 8 * (v.y + 8 * v.z)) + c];
      box = {glm::min(box.low, corner), glm::max(box.high, corner)};
    }
  });
  return box;
}

const PosedLattice::Corners& PosedLattice::corners(std::int64_t brick, Corners& room) const {
  if (rigid_[brick] == kSeveral) {
    if (!kept_.read(brick, bounds_[brick], room)) compute(brick, room);
    return room;
  }
  const TissueVoxels::Brick& cells = tissue_->bricks()[brick];
  for_each_corner(cells, [&](int i, int j, int k) {
    room[place(i, j, k)] = poser_.posed_by(rigid_[brick], cells.corner + glm::ivec3(i, j, k));
  });
  return room;
}

// Returns the affine map from posed points to rest points, for tissue that follows one bone.
AffineTransform PosedLattice::backward(const RigidTransform& posed_from_rest) const {
  const RigidTransform back = inverse(posed_from_rest);
  const glm::dmat3 turn = voxel_from_world_.linear * glm::mat3_cast(back.rotation) * world_from_voxel_.linear;
  const glm::dvec3 shift = voxel_from_world_ * (back * (world_from_voxel_ * glm::dvec3(0)));
  const glm::dvec3 first = output_.to_rest(glm::dvec3(0));
  const glm::dmat3 steps(1 / output_.ratio.x, 0, 0, 0, 1 / output_.ratio.y, 0, 0, 0, 1 / output_.ratio.z);
  return {turn * steps, turn * first + shift};
}

// Returns the base of the output lattice: the posed position of the first tissue voxel.
//   posed_from_rest  motion of the first bone that the voxel follows
glm::ivec3 PosedLattice::base(const RigidTransform& posed_from_rest) const {
  glm::ivec3 voxel(0);
  bool found = false;
  tissue_->for_each(0, 1, [&](std::int64_t, const glm::ivec3& v) {
    if (!found) voxel = v;
    found = true;
  });
  const glm::dvec3 world = world_from_voxel_ * glm::dvec3(voxel), moved = posed_from_rest * world - world;
  const glm::dvec3 at = output_.from_rest(glm::dvec3(voxel) + voxel_from_world_.linear * moved);
  for (int axis = 0; axis < 3; ++axis)
    if (!(std::abs(at[axis]) < 1e9))
      throw Error("the pose moves the tissue too far away",
                  "bone " + weights_->bones()[weights_->chunk(0).front().bone[0]], "check the root translation");
  return glm::ivec3(glm::floor(at + 0.5));
}

// Collects the posed corners of a brick and their bounding box.
class PosedLattice::CollectedCorners {
 public:
  CollectedCorners(const OutputLattice& output, const glm::ivec3& brick, Corners& corners) : corners_(corners) {
    const glm::dvec3 rest = output.from_rest(glm::dvec3(brick) - 0.5);
    may_be_still_ =
        output.ratio == glm::dvec3(1) && glm::all(glm::lessThan(glm::abs(rest), glm::dvec3(kFurthestPosed)));
    if (may_be_still_) first_ = FixedPoint(rest * double(kFixedOne));
    for (int axis = 0; axis < 3; ++axis)
      low_[axis] = FourIntegers{} + INT32_MAX, high_[axis] = FourIntegers{} + INT32_MIN;
  }

  // Adds corner (i, j, k) of the brick.
  void add(int i, int j, int k, const FixedPoint& posed) {
    const FourIntegers none{};
    add(none + i, none + j, none + k, {none + posed.x, none + posed.y, none + posed.z});
  }

  // Adds four corners at once.
  void add(const FourIntegers& i, const FourIntegers& j, const FourIntegers& k, const CornerPoser::FourFixed& posed) {
    const FourIntegers at = i + kSide * (j + kSide * k);
    for (int lane = 0; lane < 4; ++lane) corners_[at[lane]] = {posed.x[lane], posed.y[lane], posed.z[lane]};
    widen(0, posed.x);
    widen(1, posed.y);
    widen(2, posed.z);
    moved_ |= (posed.x != first_.x + i * kFixedOne) | (posed.y != first_.y + j * kFixedOne) |
              (posed.z != first_.z + k * kFixedOne);
  }

  BrickBounds bounds() const {
    FixedBox box{FixedPoint(INT32_MAX), FixedPoint(INT32_MIN)};
    for (int axis = 0; axis < 3; ++axis)
      for (int lane = 0; lane < 4; ++lane) {
        box.low[axis] = std::min(box.low[axis], low_[axis][lane]);
        box.high[axis] = std::max(box.high[axis], high_[axis][lane]);
      }
    return {box, may_be_still_ && (moved_[0] | moved_[1] | moved_[2] | moved_[3]) == 0};
  }

 private:
  void widen(int axis, const FourIntegers& to) {
    low_[axis] = to < low_[axis] ? to : low_[axis];
    high_[axis] = to > high_[axis] ? to : high_[axis];
  }

  Corners& corners_;
  FixedPoint first_{0};  // rest position of corner (0, 0, 0)
  bool may_be_still_;
  FourIntegers moved_{};  // nonzero if a corner is not at its rest position
  FourIntegers low_[3], high_[3];
};

// Computes the posed corners of a brick and their bounds. If the brick is full and moves as one rigid body, computes
// only its eight outermost corners.
PosedLattice::BrickBounds PosedLattice::compute(std::int64_t brick, Corners& corners) const {
  const TissueVoxels::Brick& cells = tissue_->bricks()[brick];
  const int bone = rigid_[brick];
  CollectedCorners collected(output_, cells.corner, corners);
  if (bone == kSeveral) {
    pose_bent(brick, collected);
    return collected.bounds();
  }
  const auto by_bone = [&](int i, int j, int k) {
    collected.add(i, j, k, poser_.posed_by(bone, cells.corner + glm::ivec3(i, j, k)));
  };
  if (is_full(cells)) for_each_outermost(by_bone);
  else for_each_corner(cells, by_bone);
  return collected.bounds();
}

// Computes the posed corners of a brick that follows several bones, four at a time.
void PosedLattice::pose_bent(std::int64_t brick, CollectedCorners& corners) const {
  const TissueVoxels::Brick& cells = tissue_->bricks()[brick];
  CornerWeights weights(*tissue_, *weights_, moves_as_, brick);
  FleshShifts::CornerShifts shifts;
  const bool shifted = shifts_ && shifts_->corner_shifts(brick, shifts);

  constexpr int kCorners = kSide * kSide * kSide + 3;
  std::array<std::uint8_t, kCorners> x, y, z;
  int count = 0;
  for_each_corner(cells, [&](int i, int j, int k) {
    x[count] = static_cast<std::uint8_t>(i);
    y[count] = static_cast<std::uint8_t>(j);
    z[count] = static_cast<std::uint8_t>(k);
    ++count;
  });
  for (; count % 4 != 0; ++count) x[count] = x[count - 1], y[count] = y[count - 1], z[count] = z[count - 1];

  const glm::dvec3 first = glm::dvec3(cells.corner) - 0.5;
  for (int n = 0; n < count; n += 4) {
    const FourIntegers i = four_of(&x[n]), j = four_of(&y[n]), k = four_of(&z[n]);
    const FourIntegers at = i + kSide * (j + kSide * k);
    const FourPoints rest{numbers_of(i) + first.x, numbers_of(j) + first.y, numbers_of(k) + first.z};
    FourPoints shift;
    for (int l = 0; shifted && l < 4; ++l)
      shift.x[l] = shifts[at[l]].x, shift.y[l] = shifts[at[l]].y, shift.z[l] = shifts[at[l]].z;
    corners.add(i, j, k, poser_.posed(rest, weights.at(i, j, k), shifted ? &shift : nullptr));
  }
}

}  // namespace limber
