// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/deform/lattice.h"

#include <algorithm>
#include <atomic>
#include <bit>
#include <cmath>

#include "core/base/parallel.h"
#include "core/deform/brick_motions.h"
#include "core/deform/settled_flesh.h"
#include "core/deform/split_corners.h"
#include "core/platform/memory_pages.h"

namespace limber {

namespace {

// Upper limit on the coordinates of posed points, in output voxels from the base. Fixed point allows 32 768.
constexpr double kFurthest = 32000;
// Upper limit on the memory of stored corners, in bytes. The corners of a whole body would exceed it, so they are not
// stored.
constexpr std::int64_t kKeptBytes = std::int64_t{48} << 20;
constexpr int kSeveral = BrickMotions::kSeveral;
constexpr int kHalo = TissueVoxels::kBrick + 2;  // edge of a brick with a border one voxel wide
constexpr int kHaloCount = kHalo * kHalo * kHalo;

// The number of set bits of each byte. std::popcount is a function call where the processor's own instruction may not
// be used.
constexpr std::array<std::uint8_t, 256> kBitCount = [] {
  std::array<std::uint8_t, 256> count{};
  for (int i = 1; i < 256; ++i) count[i] = static_cast<std::uint8_t>(count[i / 2] + (i & 1));
  return count;
}();

// Sums the weights of each bone over the eight voxels around each corner of a brick.
class CornerWeights {
 public:
  //   moves_as  per bone: the first bone with the same motion, which gets the weight instead (BrickMotions)
  CornerWeights(const TissueVoxels& tissue, const SkinWeights& weights, const std::vector<int>& moves_as,
                std::int64_t brick)
      : moves_as_(moves_as),
        slot_of_(weights.bones().size(), -1) {
    const glm::ivec3 corner = tissue.bricks()[brick].corner;
    for (int k = -1; k <= 1; ++k)
      for (int j = -1; j <= 1; ++j)
        for (int i = -1; i <= 1; ++i) {
          const glm::ivec3 step(i, j, k), at = corner + step * TissueVoxels::kBrick;
          if (at.x < 0 || at.y < 0 || at.z < 0 || glm::any(glm::greaterThanEqual(at, tissue.grid_size()))) continue;
          const int neighbour = tissue.brick_at(at);
          if (neighbour >= 0) gather(tissue.bricks()[neighbour], weights.chunk(neighbour), step);
        }
    sum_over_corners();
    order_.resize(bones_.size());
    influences_.resize(bones_.size());
    for (size_t s = 0; s < order_.size(); ++s) order_[s] = static_cast<int>(s);
    std::sort(order_.begin(), order_.end(), [&](int a, int b) { return bones_[a] < bones_[b]; });
  }

  // Returns the influences of corner (i, j, k), ascending by bone; empty if there is no tissue around the corner.
  std::span<const BoneWeight> at(int i, int j, int k) {
    const int here = i + kHalo * (j + kHalo * k);
    BoneWeight* end = influences_.data();
    for (int s : order_)
      if (const std::uint32_t sum = sums_[s * kHaloCount + here]) *end++ = {bones_[s], double(sum)};
    return {influences_.data(), end};
  }

 private:
  // Return the first and the last voxel, in the neighbouring brick at the offset `step`, that touch the central brick.
  // Along each axis these are 7 and 7 for a brick below, 0 and 0 for a brick above, and 0 and 7 for the offset 0.
  static glm::ivec3 first_of(const glm::ivec3& step) { return glm::ivec3(glm::lessThan(step, glm::ivec3(0))) * 7; }
  static glm::ivec3 last_of(const glm::ivec3& step) {
    return 7 - glm::ivec3(glm::greaterThan(step, glm::ivec3(0))) * 7;
  }

  void gather(const TissueVoxels::Brick& brick, const SkinWeights::Chunk& chunk, const glm::ivec3& step) {
    const glm::ivec3 first = first_of(step), last = last_of(step);
    const unsigned columns = (0xffu >> (7 - last.x)) & (0xffu << first.x);
    int place = 0;  // index in the chunk of the first voxel of the current row
    for (int z = 0; z <= last.z; ++z) {
      if (z < first.z) {
        place += std::popcount(brick.mask[z]);
        continue;
      }
      for (int y = 0; y < TissueVoxels::kBrick; ++y) {
        const unsigned row = brick.mask[z] >> (8 * y) & 0xff;
        for (unsigned bits = y >= first.y && y <= last.y ? row & columns : 0; bits; bits &= bits - 1) {
          const glm::ivec3 v = glm::ivec3(std::countr_zero(bits), y, z) + step * TissueVoxels::kBrick + 1;
          add(chunk[place + kBitCount[row & ((bits & -bits) - 1)]], v.x + kHalo * (v.y + kHalo * v.z));
        }
        place += kBitCount[row];
      }
    }
  }

  void add(const Influence& influence, int here) {
    for (int i = 0; i < 4 && influence.weight[i]; ++i) {
      const int bone = moves_as_[influence.bone[i]];
      int& slot = slot_of_[bone];
      if (slot < 0) {
        slot = static_cast<int>(bones_.size());
        bones_.push_back(bone);
        sums_.resize(sums_.size() + kHaloCount, 0);
      }
      sums_[slot * kHaloCount + here] += influence.weight[i];
    }
  }

  // Computes sums over 2 x 2 x 2 voxels in place, axis by axis. The last column, row and slice become meaningless and
  // are never read.
  void sum_over_corners() {
    for (size_t slot = 0; slot < bones_.size(); ++slot) {
      std::uint32_t* sum = &sums_[slot * kHaloCount];
      for (int stride : {1, kHalo, kHalo * kHalo})
        for (int i = 0; i + stride < kHaloCount; ++i) sum[i] += sum[i + stride];
    }
  }

  const std::vector<int>& moves_as_;
  std::vector<int> slot_of_, bones_, order_;
  std::vector<std::uint32_t> sums_;
  std::vector<BoneWeight> influences_;
};

bool is_full(const TissueVoxels::Brick& brick) {
  return std::all_of(std::begin(brick.mask), std::end(brick.mask),
                     [](std::uint64_t slice) { return slice == ~std::uint64_t{0}; });
}

// Calls body(i, j, k) for the eight corners of the whole brick, as opposed to the corners of its voxels.
template <class Body>
void for_each_outermost(const Body& body) {
  for (int c = 0; c < 8; ++c)
    body((c & 1) * TissueVoxels::kBrick, (c >> 1 & 1) * TissueVoxels::kBrick, (c >> 2) * TissueVoxels::kBrick);
}

// Calls body(i, j, k) for every corner of the brick's tissue voxels, x fastest.
template <class Body>
void for_each_corner(const TissueVoxels::Brick& brick, const Body& body) {
  constexpr int kSide = PosedLattice::kSide;
  std::array<unsigned, kSide * kSide> row{};  // per row of corners along x: a bit for each corner to visit
  for (int z = 0; z < TissueVoxels::kBrick; ++z)
    for (int y = 0; y < TissueVoxels::kBrick; ++y) {
      const unsigned voxels = brick.mask[z] >> (8 * y) & 0xff, corners = voxels | voxels << 1;
      for (int step : {0, 1, kSide, kSide + 1}) row[y + kSide * z + step] |= corners;
    }
  for (int k = 0; k < kSide; ++k)
    for (int j = 0; j < kSide; ++j)
      for (unsigned bits = row[j + kSide * k]; bits; bits &= bits - 1) body(std::countr_zero(bits), j, k);
}

}  // namespace

PosedLattice::PosedLattice(const LabelVolume& volume, const TissueVoxels& tissue, const SkinWeights& weights,
                           const std::vector<RigidTransform>& posed_from_rest, Blend blend, const glm::dvec3& ratio,
                           Progress& progress, const SettledFlesh* settled)
    : volume_(&volume),
      tissue_(&tissue),
      weights_(&weights),
      world_from_voxel_(world_from_voxel(volume.grid)),
      voxel_from_world_(voxel_from_world(volume.grid)),
      bones_(skin_transforms(posed_from_rest)),
      blend_(blend),
      settled_(settled),
      output_{ratio} {
  const std::int64_t count = std::ssize(tissue.bricks());
  bounds_.resize(count);
  still_.resize(count);
  split_.resize(count);
  BrickMotions brick_motions(tissue, weights, posed_from_rest);
  moves_as_ = std::move(brick_motions.moves_as);
  rigid_ = std::move(brick_motions.around);
  for (const RigidTransform& posed : posed_from_rest) {
    const glm::dmat3 turn = voxel_from_world_.linear * (glm::mat3_cast(posed.rotation) - glm::dmat3(1));
    shift_.push_back({turn * world_from_voxel_.linear,
                      turn * world_from_voxel_.offset + voxel_from_world_.linear * posed.translation});
  }
  const bool keeps = count * std::int64_t{sizeof(Corners)} <= kKeptBytes;
  if (keeps) {
    kept_ = std::make_unique_for_overwrite<Corners[]>(count);
    kept_at_.resize(count);
    want_large_pages(kept_.get(), count * std::int64_t{sizeof(Corners)});
  }
  if (count == 0) return;
  choose_base();
  for (const RigidTransform& posed : posed_from_rest) rest_from_posed_.push_back(backward(posed));
  progress.update("pose", 0);
  std::atomic<std::int32_t> kept = 0;
  parallel_for(count, 16, [&](std::int64_t begin, std::int64_t end) {
    if (progress.cancelled()) throw Cancelled();
    Corners room;
    for (auto brick = begin; brick < end; ++brick) {
      const BrickBounds posed = compute(brick, room);
      bounds_[brick] = posed.box;
      still_[brick] = posed.still;
      split_[brick] =
          tissue.seams() && rigid_[brick] == kSeveral && tissue.seams()->is_near_brick(tissue.bricks()[brick].corner);
      if (split_[brick]) {
        bounds_[brick] = split_bounds(brick);
        still_[brick] = false;
      }
      if (keeps && rigid_[brick] == kSeveral) kept_[kept_at_[brick] = kept++] = room;
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
      const glm::dvec3 shift = settled_ ? settled_->corner_shift(corner - 1, split.joined_voxels(v, c)) : glm::vec3(0);
      own[c] = posed(corner, split.at(v, c), shift);
    }
  });
}

PosedLattice::FixedBox PosedLattice::split_bounds(std::int64_t brick) const {
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
  if (rigid_[brick] == kSeveral && kept_) return kept_[kept_at_[brick]];
  if (rigid_[brick] == kSeveral) {
    compute(brick, room);
    return room;
  }
  const TissueVoxels::Brick& cells = tissue_->bricks()[brick];
  for_each_corner(cells, [&](int i, int j, int k) {
    room[place(i, j, k)] = posed_by(rigid_[brick], cells.corner + glm::ivec3(i, j, k));
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

// Sets the base of the output lattice to the posed position of the first tissue voxel.
void PosedLattice::choose_base() {
  glm::ivec3 voxel(0);
  bool found = false;
  tissue_->for_each(0, 1, [&](std::int64_t, const glm::ivec3& v) {
    if (!found) voxel = v;
    found = true;
  });
  const BoneWeight influence{weights_->chunk(0).front().bone[0], 1};
  const glm::dvec3 world = world_from_voxel_ * glm::dvec3(voxel);
  const glm::dvec3 moved = blend_point(blend_, bones_, {&influence, 1}, world) - world;
  const glm::dvec3 at = output_.from_rest(glm::dvec3(voxel) + voxel_from_world_.linear * moved);
  for (int axis = 0; axis < 3; ++axis)
    if (!(std::abs(at[axis]) < 1e9))
      throw Error("the pose carries the tissue too far away", "bone " + weights_->bones()[influence.bone],
                  "check the root translation");
  output_.base = glm::ivec3(glm::floor(at + 0.5));
}

// Returns the posed position of a corner.
//   shift  correction that is added to the blended position, voxels
FixedPoint PosedLattice::posed(const glm::ivec3& corner, std::span<const BoneWeight> influences,
                               const glm::dvec3& shift) const {
  const glm::dvec3 rest = glm::dvec3(corner) - 0.5;
  const int bone = influences.front().bone;
  if (influences.size() == 1) return fixed(rest, shift_[bone] * rest + shift, bone);
  if (blend_ == Blend::Linear) {
    glm::dvec3 moved(0);
    double total = 0;
    for (const BoneWeight& influence : influences) {
      moved += influence.weight * (shift_[influence.bone] * rest);
      total += influence.weight;
    }
    return fixed(rest, moved / total + shift, bone);
  }
  const glm::dvec3 world = world_from_voxel_ * rest;
  return fixed(rest, voxel_from_world_.linear * (blend_point(blend_, bones_, influences, world) - world) + shift, bone);
}

void PosedLattice::throw_torn(int bone) const {
  throw Error("the pose tears the tissue too far apart", "bone " + weights_->bones()[bone],
              "check the pose and the rig, or use a coarser spacing");
}

// Rounds a posed point to fixed point. Throws Error if it is too far away.
//   moved  posed - rest, in voxel coordinates
//   bone   named in the error's message
FixedPoint PosedLattice::fixed(const glm::dvec3& rest, const glm::dvec3& moved, int bone) const {
  const glm::dvec3 at = output_.from_rest(rest + moved);
  if (!(std::abs(at.x) < kFurthest && std::abs(at.y) < kFurthest && std::abs(at.z) < kFurthest)) throw_torn(bone);
  // std::lrint is one instruction; std::floor would be a function call.
  return {std::lrint(at.x * kFixedOne), std::lrint(at.y * kFixedOne), std::lrint(at.z * kFixedOne)};
}

FixedPoint PosedLattice::posed_by(int bone, const glm::ivec3& corner) const {
  const glm::dvec3 rest = glm::dvec3(corner) - 0.5;
  return fixed(rest, shift_[bone] * rest, bone);
}

// Computes the posed corners of a brick and their bounds. If the brick is full and moves as one rigid body, computes
// only its eight outermost corners.
PosedLattice::BrickBounds PosedLattice::compute(std::int64_t brick, Corners& corners) const {
  const TissueVoxels::Brick& cells = tissue_->bricks()[brick];
  const auto every = [&](const auto& body) { for_each_corner(cells, body); };
  if (const int bone = rigid_[brick]; bone != kSeveral) {
    const auto by_bone = [&](int i, int j, int k) { return posed_by(bone, cells.corner + glm::ivec3(i, j, k)); };
    const auto outermost = [](const auto& body) { for_each_outermost(body); };
    return is_full(cells) ? compute_by(brick, outermost, by_bone, corners) : compute_by(brick, every, by_bone, corners);
  }
  CornerWeights weights(*tissue_, *weights_, moves_as_, brick);
  SettledFlesh::CornerShifts shifts;
  const bool shifted = settled_ && settled_->corner_shifts(brick, shifts);
  return compute_by(
      brick, every,
      [&](int i, int j, int k) {
        return posed(cells.corner + glm::ivec3(i, j, k), weights.at(i, j, k),
                     shifted ? glm::dvec3(shifts[place(i, j, k)]) : glm::dvec3(0));
      },
      corners);
}

// Computes posed corners, and their bounding box.
//   visit           calls its argument for each corner to pose
//   posed(i, j, k)  returns the posed position of a corner
template <class Visit, class Posed>
PosedLattice::BrickBounds PosedLattice::compute_by(std::int64_t brick, const Visit& visit, const Posed& posed,
                                                   Corners& corners) const {
  const glm::dvec3 rest = output_.from_rest(glm::dvec3(tissue_->bricks()[brick].corner) - 0.5);
  const bool may_be_still =
      output_.ratio == glm::dvec3(1) && glm::all(glm::lessThan(glm::abs(rest), glm::dvec3(kFurthest)));
  const FixedPoint first(may_be_still ? rest * double(kFixedOne) : glm::dvec3(0));
  BrickBounds result{{FixedPoint(INT32_MAX), FixedPoint(INT32_MIN)}, may_be_still};
  visit([&](int i, int j, int k) {
    const FixedPoint corner = corners[place(i, j, k)] = posed(i, j, k);
    result.box = {glm::min(result.box.low, corner), glm::max(result.box.high, corner)};
    result.still = result.still && corner == first + glm::ivec3(i, j, k) * kFixedOne;
  });
  return result;
}

}  // namespace limber
