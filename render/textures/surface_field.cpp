// SPDX-License-Identifier: AGPL-3.0-or-later
#include "render/textures/surface_field.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "core/base/parallel.h"

namespace limber::render {

namespace {

constexpr int kReach = 2;  // farthest neighbour that the blur of a voxel reads, voxels
// Edge length of the region on which the field of a slot (stored block) depends, voxels.
constexpr int kRead = kSlot + 2 * kReach;
// Field value (in 1/255) that is given to a voxel which the blur would make vanish, so that the voxel keeps its size.
constexpr int kRaised = 230;
constexpr int kFarthest = kFirstFieldValue - 1;  // largest distance that a texel can store, bricks
constexpr int kHalf = kBrick / 2;
constexpr size_t kSlotTexels = size_t{kSlot} * kSlot * kSlot;

using Slot = std::vector<std::uint8_t>;

// Sets `member` to 1 for the voxels whose label is in the set. `member` covers the block's slot (the voxels that the
// atlas stores for it) and the voxels around the slot that the blur reads. Returns the number of voxels set. If
// `labels` is not null, it receives all labels of this region.
int gather(const LabelVolume& volume, const glm::ivec3& block, const LabelSet& set, Slot& member,
           std::vector<Label>* labels) {
  const glm::ivec3 low = block * kBlock - kApron - kReach - kPad, size = volume.grid.size;
  member.assign(size_t{kRead} * kRead * kRead, 0);
  const int from = std::max(low.x, 0), to = std::min(low.x + kRead, size.x);
  int count = 0;
  Label last = 0;
  for (int z = std::max(low.z, 0); z < std::min(low.z + kRead, size.z); ++z)
    for (int y = std::max(low.y, 0); y < std::min(low.y + kRead, size.y); ++y) {
      const Label* row = volume.voxels.data() + volume.grid.index({0, y, z});
      std::uint8_t* out = member.data() + ((z - low.z) * kRead + (y - low.y)) * kRead - low.x;
      for (int x = from; x < to; ++x) count += out[x] = set[row[x]];
      if (labels)
        for (int x = from; x < to; ++x)
          if (row[x] != last) labels->push_back(last = row[x]);
    }
  if (labels) {
    std::sort(labels->begin(), labels->end());
    labels->erase(std::unique(labels->begin(), labels->end()), labels->end());
  }
  return count;
}

// Blurs a line by [1 4 6 4 1], which is [1 2 1]/4 applied twice, times 16. The sums stay whole numbers, and blur()
// divides them only after the last axis, so that nothing is rounded before.
template <class In, class Out>
void blur_line(const In* in, std::ptrdiff_t stride, Out* out, int count) {
  for (int i = 0; i < count; ++i) {
    const In* at = in + i;
    out[i] = static_cast<Out>(at[0] + at[4 * stride] + 4 * (at[stride] + at[3 * stride]) + 6 * at[2 * stride]);
  }
}

void blur(const Slot& member, Slot& field, std::vector<std::uint8_t>& along_x, std::vector<std::uint16_t>& along_y) {
  along_x.resize(size_t{kSlot} * kRead * kRead);
  along_y.resize(size_t{kSlot} * kSlot * kRead);
  field.resize(kSlotTexels);
  for (int row = 0; row < kRead * kRead; ++row)
    blur_line(member.data() + row * kRead, 1, along_x.data() + row * kSlot, kSlot);
  for (int z = 0; z < kRead; ++z)
    for (int y = 0; y < kSlot; ++y)
      blur_line(along_x.data() + (z * kRead + y) * kSlot, kSlot, along_y.data() + (z * kSlot + y) * kSlot, kSlot);
  std::array<std::uint16_t, kSlot> sum;
  std::vector<int> swallowed;
  for (int z = 0; z < kSlot; ++z)
    for (int y = 0; y < kSlot; ++y) {
      blur_line(along_y.data() + (z * kSlot + y) * kSlot, kSlot * kSlot, sum.data(), kSlot);
      const int row = (z * kSlot + y) * kSlot;
      const std::uint8_t* in = member.data() + ((z + kReach) * kRead + y + kReach) * kRead + kReach;
      for (int x = 0; x < kSlot; ++x) {
        const int value = (sum[x] * 255 + 2048) >> 12;
        field[static_cast<size_t>(row + x)] = static_cast<std::uint8_t>(value < kFirstFieldValue ? 0 : value);
        if (in[x] && value < kSurface) swallowed.push_back(row + x);
      }
    }

  // Returns true if no neighbour of a voxel that the blur made vanish is inside the surface. Such a voxel gets the
  // value kRaised: a bump on a thick body may vanish, but a thin sheet or thread may not.
  const auto stands_alone = [&](int at) {
    for (const int step : {1, kSlot, kSlot * kSlot})
      for (const int next : {at - step, at + step})
        if (next >= 0 && next < static_cast<int>(kSlotTexels) && field[static_cast<size_t>(next)] >= kSurface)
          return false;
    return true;
  };
  std::erase_if(swallowed, [&](int at) { return !stands_alone(at); });
  for (const int at : swallowed) field[static_cast<size_t>(at)] = kRaised;
}

// What rays need to know of a brick (4^3 voxels): whether any of its voxels has a blurred value above 0, whether the
// brick belongs to the hull, and the mean of its blurred values.
struct BrickFacts {
  bool touched, hull;
  std::uint8_t mean;
  // For each of the brick's eight octants, x fastest: 1 if a filtered read in the octant can reach the surface.
  std::array<std::uint8_t, 8> met;
};
BrickFacts facts_of(const Slot& field, const glm::ivec3& brick) {
  const glm::ivec3 low = brick * kBrick + kApron;
  int most = 0, sum = 0, most_around = 0;
  for (int z = -1; z <= kBrick; ++z)
    for (int y = -1; y <= kBrick; ++y) {
      const std::uint8_t* row = field.data() + ((low.z + z) * kSlot + low.y + y) * kSlot + low.x;
      const int inner = std::max({int{row[0]}, int{row[1]}, int{row[2]}, int{row[3]}});
      most_around = std::max({most_around, inner, int{row[-1]}, int{row[kBrick]}});
      if (z < 0 || y < 0 || z == kBrick || y == kBrick) continue;
      most = std::max(most, inner);
      sum += row[0] + row[1] + row[2] + row[3];
    }
  BrickFacts facts{most > 0, most_around >= kSurface, static_cast<std::uint8_t>(sum / (kBrick * kBrick * kBrick)), {}};
  for (int half = 0; half < 8 && facts.hull; ++half) {
    const glm::ivec3 from = low + glm::ivec3(half & 1, half >> 1 & 1, half >> 2) * kHalf - 1;
    for (int z = 0; z < kHalf + 2; ++z)
      for (int y = 0; y < kHalf + 2; ++y) {
        const std::uint8_t* row = field.data() + ((from.z + z) * kSlot + from.y + y) * kSlot + from.x;
        facts.met[half] |= std::any_of(row, row + kHalf + 2, [](std::uint8_t value) { return value >= kSurface; });
      }
  }
  return facts;
}

// Replaces the value of each brick by the Chebyshev distance to the nearest brick with value 0, in bricks, at most
// kFarthest. A forward and a backward sweep each compare a brick with the 13 neighbours visited before.
void spread_distance(std::vector<std::uint8_t>& distance, const glm::ivec3& size) {
  const std::ptrdiff_t row = size.x, layer = row * size.y;
  const auto sweep = [&](int sign) {
    for (int k = 0; k < size.z; ++k)
      for (int j = 0; j < size.y; ++j)
        for (int i = 0; i < size.x; ++i) {
          const int x = sign > 0 ? i : size.x - 1 - i, y = sign > 0 ? j : size.y - 1 - j,
                    z = sign > 0 ? k : size.z - 1 - k;
          std::uint8_t& here = distance[static_cast<size_t>(x + y * row + z * layer)];
          if (here == 0) continue;
          int least = here - 1;
          const auto see = [&](int dx, int dy, int dz) {
            const int a = x + dx * sign, b = y + dy * sign, c = z + dz * sign;
            if (a >= 0 && b >= 0 && c >= 0 && a < size.x && b < size.y && c < size.z)
              least = std::min(least, int{distance[static_cast<size_t>(a + b * row + c * layer)]});
          };
          see(-1, 0, 0);
          for (int dx = -1; dx <= 1; ++dx) {
            see(dx, -1, 0);
            for (int dy = -1; dy <= 1; ++dy) see(dx, dy, -1);
          }
          here = static_cast<std::uint8_t>(least + 1);
        }
  };
  sweep(+1);
  sweep(-1);
}

// For each brick of the block whose distance is not 0, writes the distance into the brick's texels. The texels around
// the block (its apron) keep their values, since rays do not step there.
void write_distances(Slot& field, const BlockLayout& layout, const glm::ivec3& block,
                     const std::vector<std::uint8_t>& distance) {
  for (int z = 0; z < kBlock; ++z)
    for (int y = 0; y < kBlock; ++y)
      for (int b = 0; b < kBricksPerBlock; ++b) {
        const glm::ivec3 brick = block * kBricksPerBlock + glm::ivec3(b, y / kBrick, z / kBrick);
        const std::uint8_t bricks = distance[static_cast<size_t>(layout.brick_index(brick))];
        if (bricks == 0) continue;
        std::uint8_t* row = field.data() + ((z + kApron) * kSlot + y + kApron) * kSlot + b * kBrick + kApron;
        std::fill(row, row + kBrick, bricks);
      }
}

// Marks the bricks outside the hull that are connected to the rim of the volume. The hull's faces lie between these
// bricks and the bricks of the hull. Hollows inside the body get no faces.
std::vector<std::uint8_t> outside_of(const std::vector<std::uint8_t>& hull, const glm::ivec3& size) {
  std::vector<std::uint8_t> outside(hull.size());
  std::vector<glm::ivec3> open;
  const auto index = [&](const glm::ivec3& b) {
    return static_cast<size_t>(b.x + std::int64_t{size.x} * (b.y + std::int64_t{size.y} * b.z));
  };
  const auto visit = [&](const glm::ivec3& b) {
    if (glm::any(glm::lessThan(b, glm::ivec3(0))) || glm::any(glm::greaterThanEqual(b, size))) return;
    std::uint8_t& mark = outside[index(b)];
    if (mark || hull[index(b)]) return;
    mark = 1;
    open.push_back(b);
  };
  for (int z = 0; z < size.z; ++z)
    for (int y = 0; y < size.y; ++y) {
      const bool rim = z == 0 || y == 0 || z == size.z - 1 || y == size.y - 1;
      for (int x = 0; x < size.x; x += rim ? 1 : std::max(size.x - 1, 1)) visit({x, y, z});
    }
  while (!open.empty()) {
    const glm::ivec3 b = open.back();
    open.pop_back();
    for (int axis = 0; axis < 3; ++axis)
      for (const int step : {-1, 1}) {
        glm::ivec3 next = b;
        next[axis] += step;
        visit(next);
      }
  }
  return outside;
}

// Returns true if the distance of a brick of this block is smaller than before.
bool any_nearer(const BlockLayout& layout, const glm::ivec3& block, const std::vector<std::uint8_t>& distance,
                const std::vector<std::uint8_t>& before) {
  const glm::ivec3 low = block * kBricksPerBlock;
  for (int z = 0; z < kBricksPerBlock; ++z)
    for (int y = 0; y < kBricksPerBlock; ++y)
      for (int x = 0; x < kBricksPerBlock; ++x) {
        const auto at = static_cast<size_t>(layout.brick_index(low + glm::ivec3(x, y, z)));
        if (distance[at] < before[at]) return true;
      }
  return false;
}

bool changes_any(const std::vector<Label>& labels, const LabelSet& before, const LabelSet& after) {
  return std::any_of(labels.begin(), labels.end(), [&](Label label) { return before[label] != after[label]; });
}

}  // namespace

SurfaceField::Texels SurfaceField::update(const LabelVolume& drawn, const BlockLayout& layout, const LabelSet& set,
                                          const std::vector<std::uint8_t>& changed) {
  const size_t slots = layout.block_of_slot.size();
  const glm::ivec3 bricks = layout.bricks();
  const auto brick_count = static_cast<size_t>(bricks.x) * bricks.y * bricks.z;
  const bool first = distance_.empty();
  const auto is_new = [&](size_t s) { return first || (s < changed.size() && changed[s]); };
  bricks_ = bricks;
  if (slots == 0) {  // an empty volume, as for a grey image without labels
    set_ = set;
    return {};
  }
  if (first) {
    distance_.assign(brick_count, 1);
    in_hull_.assign(brick_count, 0);
    occupancy_.assign(brick_count, 0);
    met_.assign(brick_count * 8, 0);
  }

  labels_of_slot_.resize(slots);
  slot_present_.resize(slots, 0);

  // Computes the fields again in the slots (stored blocks) that depend on an added or removed label. In `touched`, a
  // brick has 1 if any of its voxels has a blurred value above 0.
  std::vector<Slot> fields(slots);
  std::vector<std::uint8_t> touched(brick_count);
  for (size_t b = 0; b < brick_count; ++b) touched[b] = distance_[b] == 0;
  const std::vector<std::uint8_t> touched_before = touched, hull_before = in_hull_, occupancy_before = occupancy_,
                                  met_before = met_;
  const auto compute = [&](size_t s, bool facts) {
    Slot member;
    std::vector<std::uint8_t> along_x;
    std::vector<std::uint16_t> along_y;
    const glm::ivec3 block = layout.block_of_slot[s];
    if (is_new(s)) labels_of_slot_[s].clear();
    const int members = gather(drawn, block, set, member, is_new(s) ? &labels_of_slot_[s] : nullptr);
    if (members == 0) fields[s].assign(kSlotTexels, 0);
    else if (members == kRead * kRead * kRead) fields[s].assign(kSlotTexels, 255);
    else blur(member, fields[s], along_x, along_y);
    if (!facts) return;
    slot_present_[s] = members > 0;
    for (int i = 0; i < kBricksPerBlock * kBricksPerBlock * kBricksPerBlock; ++i) {
      const glm::ivec3 brick(i % kBricksPerBlock, i / kBricksPerBlock % kBricksPerBlock,
                             i / (kBricksPerBlock * kBricksPerBlock));
      const BrickFacts facts_here = facts_of(fields[s], brick);
      const auto at = static_cast<size_t>(layout.brick_index(block * kBricksPerBlock + brick));
      touched[at] = facts_here.touched;
      in_hull_[at] = facts_here.hull;
      occupancy_[at] = facts_here.mean;
      for (int half = 0; half < 8; ++half) {
        const glm::ivec3 place = (block * kBricksPerBlock + brick) * 2 + glm::ivec3(half & 1, half >> 1 & 1, half >> 2);
        met_[static_cast<size_t>(place.x + 2 * bricks.x * (place.y + std::int64_t{2 * bricks.y} * place.z))] =
            facts_here.met[half];
      }
    }
  };
  parallel_for(static_cast<std::int64_t>(slots), 1, [&](std::int64_t begin, std::int64_t end) {
    for (auto s = static_cast<size_t>(begin); s < static_cast<size_t>(end); ++s)
      if (is_new(s) || changes_any(labels_of_slot_[s], set_, set)) compute(s, true);
  });

  hull_changed_ = first || in_hull_ != hull_before;
  occupancy_changed_ = first || occupancy_ != occupancy_before;
  // If no brick became empty or stopped being empty, no distance changes. Otherwise a changed label can change
  // distances in any slot. A slot in which a distance became shorter must be written again, because rays would skip
  // too far. If distances only became longer, the old ones remain valid.
  if (first || touched != touched_before) {
    std::vector<std::uint8_t> distance(brick_count);
    for (size_t b = 0; b < brick_count; ++b) distance[b] = touched[b] ? 0 : kFarthest;
    spread_distance(distance, bricks);
    parallel_for(static_cast<std::int64_t>(slots), 1, [&](std::int64_t begin, std::int64_t end) {
      for (auto s = static_cast<size_t>(begin); s < static_cast<size_t>(end); ++s)
        if (fields[s].empty() && any_nearer(layout, layout.block_of_slot[s], distance, distance_)) compute(s, false);
    });
    distance_ = std::move(distance);
  }
  set_ = set;

  parallel_for(static_cast<std::int64_t>(slots), 1, [&](std::int64_t begin, std::int64_t end) {
    for (auto s = static_cast<size_t>(begin); s < static_cast<size_t>(end); ++s)
      if (!fields[s].empty()) write_distances(fields[s], layout, layout.block_of_slot[s], distance_);
  });
  if (first || met_ != met_before) find_upward();
  return fields;
}

Hull::Faces SurfaceField::hull() const {
  const glm::ivec3& size = bricks_;
  const auto index = [&](const glm::ivec3& b) {
    return static_cast<size_t>(b.x + std::int64_t{size.x} * (b.y + std::int64_t{size.y} * b.z));
  };
  Hull::Faces faces;
  if (std::find(in_hull_.begin(), in_hull_.end(), 1) == in_hull_.end()) return faces;
  const std::vector<std::uint8_t> outside = outside_of(in_hull_, size);
  const auto is_outside = [&](const glm::ivec3& b) {
    if (glm::any(glm::lessThan(b, glm::ivec3(0))) || glm::any(glm::greaterThanEqual(b, size))) return true;
    return outside[index(b)] != 0;
  };

  // Neighbouring faces share their corners, so that no gaps open between them. To find shared corners, only two layers
  // of the lattice of corners are kept in memory.
  const auto lattice_layer = static_cast<size_t>(size.x + 1) * (size.y + 1);
  constexpr std::uint32_t kNone = ~0u;
  std::vector<std::uint32_t> below(lattice_layer, kNone), above(lattice_layer, kNone);

  for (int z = 0; z < size.z; ++z) {
    const auto corner = [&](const glm::ivec3& c) {
      std::uint32_t& vertex = (c.z == z ? below : above)[static_cast<size_t>(c.x + c.y * (size.x + 1))];
      if (vertex == kNone) {
        vertex = static_cast<std::uint32_t>(faces.corners.size());
        faces.corners.push_back(glm::u16vec4(c, 1));
      }
      return vertex;
    };
    for (int y = 0; y < size.y; ++y)
      for (int x = 0; x < size.x; ++x) {
        const glm::ivec3 brick(x, y, z);
        if (!in_hull_[index(brick)]) continue;
        for (int side = 0; side < 6; ++side) {
          const int axis = side / 2, up = side % 2;
          glm::ivec3 neighbour = brick;
          neighbour[axis] += up ? 1 : -1;
          if (!is_outside(neighbour)) continue;
          const int u = (axis + 1) % 3, v = (axis + 2) % 3;
          glm::ivec3 c[4] = {brick, brick, brick, brick};
          for (glm::ivec3& each : c) each[axis] += up;
          // The corners are in counter-clockwise order when seen from outside.
          c[up ? 1 : 3][u] += 1, c[2][u] += 1, c[2][v] += 1, c[up ? 3 : 1][v] += 1;
          const std::uint32_t ids[4] = {corner(c[0]), corner(c[1]), corner(c[2]), corner(c[3])};
          for (const int i : {0, 1, 2, 0, 2, 3}) faces.indices.push_back(ids[i]);
        }
      }
    std::swap(below, above);
    std::fill(above.begin(), above.end(), kNone);
  }
  return faces;
}

std::vector<std::uint8_t> SurfaceField::occupancy() const {
  const glm::ivec3& size = bricks_;
  if (occupancy_.empty()) return std::vector<std::uint8_t>(static_cast<size_t>(size.x) * size.y * size.z);
  std::vector<std::uint8_t> blurred = occupancy_, line(static_cast<size_t>(std::max({size.x, size.y, size.z})));
  const std::array<std::ptrdiff_t, 3> stride = {1, size.x, std::ptrdiff_t{size.x} * size.y};
  for (int axis = 0; axis < 3; ++axis) {
    const int u = (axis + 1) % 3, v = (axis + 2) % 3;
    for (int b = 0; b < size[v]; ++b)
      for (int a = 0; a < size[u]; ++a) {
        std::uint8_t* row = blurred.data() + a * stride[u] + b * stride[v];
        for (int i = 0; i < size[axis]; ++i) line[static_cast<size_t>(i)] = row[i * stride[axis]];
        for (int i = 0; i < size[axis]; ++i) {
          const int before = i > 0 ? line[static_cast<size_t>(i - 1)] : 0,
                    after = i + 1 < size[axis] ? line[static_cast<size_t>(i + 1)] : 0;
          row[i * stride[axis]] =
              static_cast<std::uint8_t>((before + 2 * line[static_cast<size_t>(i)] + after + 2) / 4);
        }
      }
  }
  return blurred;
}

void SurfaceField::find_upward() {
  const glm::ivec3 size = bricks_ * 2;
  upward_.clear();
  if (std::find(met_.begin(), met_.end(), 1) == met_.end()) return;
  const std::int64_t row = size.x, layer = row * size.y;
  upward_.resize(met_.size());
  for (std::int64_t at = std::ssize(met_) - 1; at >= 0; --at) {
    const bool x = at % row + 1 < row, y = at / row % size.y + 1 < size.y, z = at / layer + 1 < size.z;
    int least = met_[at] ? 0 : 255;
    for (int i = 1; i < 8 && least > 0; ++i)
      if ((!(i & 1) || x) && (!(i & 2) || y) && (!(i & 4) || z))
        least = std::min(least, upward_[at + (i & 1) + (i >> 1 & 1) * row + (i >> 2) * layer] + 1);
    upward_[at] = static_cast<std::uint8_t>(least);
  }
}

bool SurfaceField::may_be_met(const glm::vec3& low, const glm::vec3& high) const {
  if (upward_.empty()) return false;
  const glm::ivec3 size = bricks_ * 2,
                   first = glm::clamp(glm::ivec3(glm::floor(low / float(kHalf))), glm::ivec3(0), size - 1);
  const glm::ivec3 wide = glm::ivec3(glm::floor(high / float(kHalf))) - first;
  return upward_[static_cast<size_t>(first.x + size.x * (first.y + std::int64_t{size.y} * first.z))] <=
         std::max({wide.x, wide.y, wide.z, 0});
}

}  // namespace limber::render
