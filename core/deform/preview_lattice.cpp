// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/deform/preview_lattice.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "core/base/parallel.h"
#include "core/deform/depth.h"

namespace limber {

namespace {

constexpr std::int64_t kMostFineVoxels = 1'500'000;  // a limb at 2 mm has 650 000 tissue voxels, a body at 2 mm ten millions
constexpr double kLeastWeight = 1.0 / 1024;
constexpr double kHold = 1000;  // of tissue that follows one bone wholly over what is blended: bones stay stiff up to their border
constexpr double kStiff = 0.999;  // of a corner's weight that one bone must have for the cell to be stiff by itself
constexpr float kUnknown = std::numeric_limits<float>::infinity();
constexpr int kGrain = 16;  // bricks

// What one cell's tissue gives to one of its corners.
struct Share {
  std::int64_t place;
  int bone;
  float weight;
};
struct StiffPart {
  std::int64_t place;  // of the cell
  int bone;
  std::uint64_t parts;
};
struct Nearest {
  std::int64_t place;
  float squared_distance;  // mm2, of the tissue voxel nearest to the corner
};

glm::ivec3 corner_of(int i) { return {i & 1, i >> 1 & 1, i >> 2}; }

// body(neighbour, offset) for the 26 places around `at` inside [low, high].
template <class Body>
void around(const glm::ivec3& at, const glm::ivec3& low, const glm::ivec3& high, const Body& body) {
  for (int k = -1; k <= 1; ++k)
    for (int j = -1; j <= 1; ++j)
      for (int i = -1; i <= 1; ++i) {
        const glm::ivec3 offset(i, j, k), next = at + offset;
        if (offset == glm::ivec3(0) || glm::any(glm::lessThan(next, low)) || glm::any(glm::greaterThan(next, high))) continue;
        body(next, offset);
      }
}

// The shares and distances of one brick's cells, gathered in brick order.
class Gather {
 public:
  Gather(const PreviewLattice& lattice, const TissueVoxels& tissue, const SkinWeights& weights)
      : lattice_(lattice), tissue_(tissue), weights_(weights), slot_of_(weights.bones().size(), -1) {}

  void add(std::int64_t brick, std::vector<Share>& shares, std::vector<Nearest>& nearest, std::vector<StiffPart>& stiff) {
    const int step = lattice_.step, side = TissueVoxels::kBrick / step, cells = side * side * side;
    const glm::ivec3 corner = tissue_.bricks()[brick].corner;
    distance_.assign(size_t(cells) * 8, kUnknown);
    sums_.clear();
    bones_.clear();
    auto influence = weights_.chunk(brick).begin();
    tissue_.for_each(brick, brick + 1, [&](std::int64_t, const glm::ivec3& voxel) {
      const glm::ivec3 v = voxel - corner, c = v / step;
      const glm::dvec3 t = (glm::dvec3(v - c * step) + 0.5) / double(step);
      if (influence->weight[0] == kFullWeight) {
        const glm::ivec3 part = (v - c * step) * 4 / step;
        stiff.push_back({lattice_.place(corner / step + c), influence->bone[0], std::uint64_t{1} << (part.x + 4 * (part.y + 4 * part.z))});
      }
      add(*influence++, c.x + side * (c.y + side * c.z), t, cells);
    });
    for (int cell = 0; cell < cells; ++cell)
      for (int i = 0; i < 8; ++i) {
        const size_t at = size_t(cell) * 8 + i;
        if (distance_[at] == kUnknown) continue;
        const glm::ivec3 c(cell % side, cell / side % side, cell / (side * side));
        const std::int64_t place = lattice_.place(corner / step + c + corner_of(i));
        nearest.push_back({place, distance_[at]});
        for (size_t slot = 0; slot < bones_.size(); ++slot)
          if (const float sum = sums_[slot * cells * 8 + at]; sum > 0) shares.push_back({place, bones_[slot], sum});
      }
    for (const int bone : bones_) slot_of_[bone] = -1;
  }

 private:
  void add(const Influence& influence, int cell, const glm::dvec3& t, int cells) {
    for (int i = 0; i < 8; ++i) {
      const glm::dvec3 away = (t - glm::dvec3(corner_of(i))) * double(lattice_.step) * lattice_.grid.spacing;
      float& least = distance_[size_t(cell) * 8 + i];
      least = std::min(least, static_cast<float>(glm::dot(away, away)));
    }
    const double hold = influence.weight[0] == kFullWeight ? kHold : 1;
    for (int n = 0; n < 4 && influence.weight[n]; ++n) {
      int& slot = slot_of_[influence.bone[n]];
      if (slot < 0) {
        slot = static_cast<int>(bones_.size());
        bones_.push_back(influence.bone[n]);
        sums_.resize(sums_.size() + size_t(cells) * 8, 0);
      }
      float* sums = &sums_[(size_t(slot) * cells + cell) * 8];
      for (int i = 0; i < 8; ++i)
        sums[i] += static_cast<float>(hold * influence.weight[n] * (i & 1 ? t.x : 1 - t.x) * (i & 2 ? t.y : 1 - t.y) * (i & 4 ? t.z : 1 - t.z));
    }
  }

  const PreviewLattice& lattice_;
  const TissueVoxels& tissue_;
  const SkinWeights& weights_;
  std::vector<int> slot_of_, bones_;
  std::vector<float> sums_, distance_;
};

// Sums to one, without what is next to nothing.
void normalize(std::vector<BoneWeight>& influences) {
  double total = 0;
  for (const BoneWeight& each : influences) total += each.weight;
  std::erase_if(influences, [&](const BoneWeight& each) { return each.weight < kLeastWeight * total; });
  total = 0;
  for (const BoneWeight& each : influences) total += each.weight;
  for (BoneWeight& each : influences) each.weight /= total;
}

// One of each cell and bone, in rising order.
void merge(std::vector<StiffPart>& stiff) {
  std::sort(stiff.begin(), stiff.end(), [](const StiffPart& a, const StiffPart& b) { return a.place != b.place ? a.place < b.place : a.bone < b.bone; });
  size_t kept = 0;
  for (size_t i = 0; i < stiff.size(); ++i) {
    if (kept > 0 && stiff[kept - 1].place == stiff[i].place && stiff[kept - 1].bone == stiff[i].bone) stiff[kept - 1].parts |= stiff[i].parts;
    else stiff[kept++] = stiff[i];
  }
  stiff.resize(kept);
}

// Cells with tissue, and the ring around them.
std::vector<std::uint8_t> cells_in_use(const PreviewLattice& lattice, const TissueVoxels& tissue) {
  const glm::ivec3 size = lattice.size;
  const auto index = [&](const glm::ivec3& c) { return size_t(c.x + std::int64_t{size.x} * (c.y + std::int64_t{size.y} * c.z)); };
  std::vector<std::uint8_t> used(size_t(size.x) * size.y * size.z);
  tissue.for_each([&](std::int64_t, const glm::ivec3& v) { used[index(v / lattice.step - lattice.first)] = 1; });
  // Box by box, an axis at a time.
  for (const std::ptrdiff_t stride : {std::ptrdiff_t{1}, std::ptrdiff_t{size.x}, std::ptrdiff_t{size.x} * size.y}) {
    std::vector<std::uint8_t> grown = used;
    for (std::ptrdiff_t i = 0; i < std::ssize(used); ++i)
      if (used[i]) grown[std::max(i - stride, std::ptrdiff_t{0})] = grown[std::min(i + stride, std::ssize(used) - 1)] = 1;
    used = std::move(grown);
  }
  return used;
}

}  // namespace

int preview_step(const TissueVoxels& tissue) { return tissue.size() <= kMostFineVoxels ? 4 : 8; }

double PreviewLattice::depth_in(const glm::ivec3& cell, const glm::dvec3& rest) const {
  const glm::dvec3 t = glm::clamp(rest - glm::dvec3(cell) + 0.5, 0.0, 1.0);
  const float* at = &depth[place(cell)];
  const auto along_x = [&](std::int64_t from) { return at[from] * (1 - t.x) + at[from + 1] * t.x; };
  const auto along_y = [&](std::int64_t from) { return along_x(from) * (1 - t.y) + along_x(from + row()) * t.y; };
  return along_y(0) * (1 - t.z) + along_y(slice()) * t.z;
}

PreviewLattice preview_lattice(const Grid& grid, const TissueVoxels& tissue, const SkinWeights& weights, int step) {
  PreviewLattice lattice;
  lattice.step = step;
  lattice.grid = grid;
  lattice.first = glm::ivec3(-1);
  lattice.size = (grid.size + step - 1) / step + 2;

  // Cells and vertices.
  const std::vector<std::uint8_t> used = cells_in_use(lattice, tissue);
  std::vector<std::uint8_t> is_vertex(lattice.places());
  size_t at = 0;
  for (int z = 0; z < lattice.size.z; ++z)
    for (int y = 0; y < lattice.size.y; ++y)
      for (int x = 0; x < lattice.size.x; ++x)
        if (used[at++]) {
          const glm::ivec3 cell = lattice.first + glm::ivec3(x, y, z);
          lattice.cells.push_back(cell);
          for (int i = 0; i < 8; ++i) is_vertex[lattice.place(cell + corner_of(i))] = 1;
        }

  // What the tissue of each cell gives to its corners.
  const auto bricks = std::ssize(tissue.bricks());
  const std::int64_t blocks = (bricks + kGrain - 1) / kGrain;
  std::vector<std::vector<Share>> shares_of(blocks);
  std::vector<std::vector<Nearest>> nearest_of(blocks);
  std::vector<std::vector<StiffPart>> stiff_of(blocks);
  parallel_for(bricks, kGrain, [&](std::int64_t begin, std::int64_t end) {
    Gather gather(lattice, tissue, weights);
    for (auto brick = begin; brick < end; ++brick) gather.add(brick, shares_of[begin / kGrain], nearest_of[begin / kGrain], stiff_of[begin / kGrain]);
    merge(stiff_of[begin / kGrain]);
  });
  std::vector<Share> shares;
  lattice.depth.assign(lattice.places(), kUnknown);
  for (std::int64_t block = 0; block < blocks; ++block) {
    shares.insert(shares.end(), shares_of[block].begin(), shares_of[block].end());
    for (const Nearest& nearest : nearest_of[block]) {
      float& least = lattice.depth[nearest.place];
      least = std::min(least, nearest.squared_distance);
    }
  }
  std::stable_sort(shares.begin(), shares.end(), [](const Share& a, const Share& b) { return a.place != b.place ? a.place < b.place : a.bone < b.bone; });

  // Of the vertices with tissue around, then of those that have such neighbours, until all follow something.
  std::vector<std::vector<BoneWeight>> influences(lattice.places());
  for (const Share& share : shares) {
    auto& here = influences[share.place];
    if (here.empty() || here.back().bone != share.bone) here.push_back({share.bone, 0});
    here.back().weight += share.weight;
  }
  at = 0;
  std::vector<glm::ivec3> open;
  const glm::ivec3 last = lattice.first + lattice.size;
  for (int z = lattice.first.z; z <= last.z; ++z)
    for (int y = lattice.first.y; y <= last.y; ++y)
      for (int x = lattice.first.x; x <= last.x; ++x, ++at) {
        if (!is_vertex[at]) continue;
        lattice.vertices.emplace_back(x, y, z);
        if (influences[at].empty()) open.emplace_back(x, y, z);
        else normalize(influences[at]);
      }
  while (!open.empty()) {
    std::vector<glm::ivec3> still_open;
    std::vector<std::pair<std::int64_t, std::vector<BoneWeight>>> found;
    std::vector<std::pair<std::int64_t, float>> distances;
    for (const glm::ivec3& vertex : open) {
      std::vector<BoneWeight> sum;
      float distance = kUnknown;
      around(vertex, lattice.first, last, [&](const glm::ivec3& next, const glm::ivec3& offset) {
        const std::int64_t place = lattice.place(next);
        if (influences[place].empty()) return;
        const glm::dvec3 away = glm::dvec3(offset * step) * grid.spacing;
        for (const BoneWeight& each : influences[place]) sum.push_back({each.bone, each.weight / glm::dot(away, away)});
        const float through = std::sqrt(lattice.depth[place]) + static_cast<float>(glm::length(away));
        distance = std::min(distance, through * through);
      });
      if (sum.empty()) {
        still_open.push_back(vertex);
        continue;
      }
      std::stable_sort(sum.begin(), sum.end(), [](const BoneWeight& a, const BoneWeight& b) { return a.bone < b.bone; });
      std::vector<BoneWeight> merged;
      for (const BoneWeight& each : sum) {
        if (merged.empty() || merged.back().bone != each.bone) merged.push_back({each.bone, 0});
        merged.back().weight += each.weight;
      }
      normalize(merged);
      found.emplace_back(lattice.place(vertex), std::move(merged));
      distances.emplace_back(found.back().first, distance);
    }
    for (auto& [place, merged] : found) influences[place] = std::move(merged);
    for (const auto& [place, distance] : distances) lattice.depth[place] = distance;
    open = std::move(still_open);
  }

  const TissueDepth depth(tissue, grid.spacing);
  lattice.offsets.push_back(0);
  for (const glm::ivec3& vertex : lattice.vertices) {
    const std::int64_t place = lattice.place(vertex);
    lattice.influences.insert(lattice.influences.end(), influences[place].begin(), influences[place].end());
    lattice.offsets.push_back(std::ssize(lattice.influences));
    const double inside = depth(glm::dvec3(vertex * step) - 0.5);
    lattice.depth[place] = inside > 0 ? static_cast<float>(inside) : -std::sqrt(lattice.depth[place]);
  }

  // A cell lies in one brick.
  std::vector<StiffPart> stiff;
  for (const auto& parts : stiff_of) stiff.insert(stiff.end(), parts.begin(), parts.end());
  merge(stiff);
  auto part = stiff.begin();
  for (size_t cell = 0; cell < lattice.cells.size(); ++cell)
    for (const std::int64_t place = lattice.place(lattice.cells[cell]); part != stiff.end() && part->place == place; ++part) {
      const auto follows = [&](int corner) {
        const auto& all = influences[lattice.place(lattice.cells[cell] + corner_of(corner))];
        return std::any_of(all.begin(), all.end(), [&](const BoneWeight& each) { return each.bone == part->bone && each.weight >= kStiff; });
      };
      bool stiff_by_itself = true;
      for (int corner = 0; corner < 8; ++corner) stiff_by_itself = stiff_by_itself && follows(corner);
      if (!stiff_by_itself) lattice.stiff.push_back({static_cast<std::int32_t>(cell), part->bone, part->parts});
    }
  return lattice;
}

}  // namespace limber
