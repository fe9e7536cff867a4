// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/deform/preview_lattice.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>

#include "core/base/parallel.h"
#include "core/deform/cell_pieces.h"
#include "core/deform/depth.h"

namespace limber {

namespace {

// Up to this number of tissue voxels, cells have 4^3 voxels; above it, they have 8^3 voxels. At 2 mm a limb has 0.65
// million tissue voxels, a body 10 million.
constexpr std::int64_t kMostFineVoxels = 1'500'000;
constexpr int kGrain = 256;                  // number of cells that one parallel task handles
constexpr double kLeastWeight = 1.0 / 1024;  // a bone's share of a vertex's weight that is smaller than this is dropped
// If all corners of a cell have at least this weight on one bone, the whole cell counts as moving rigidly with the
// bone, and the bone's tissue in it needs no stiff part (CellPart).
constexpr double kStiff = 0.999;
constexpr float kUnknown = std::numeric_limits<float>::infinity();
// Two unconnected pieces of tissue in a cell are posed separately only if, at some corner of the cell, at least this
// share of their weights belongs to different bones.
constexpr double kApart = 0.1;
// A vertex of a cell counts as following tissue across a gap if more than this share of its weight belongs to other
// bones than the weight of the cell's own tissue there.
constexpr double kStrays = 0.25;

using Influences = std::vector<BoneWeight>;

glm::ivec3 corner_of(int i) { return {i & 1, i >> 1 & 1, i >> 2}; }

// Calls body(neighbour, offset) for those of the 26 positions around `at` that lie in [low, high].
template <class Body>
void around(const glm::ivec3& at, const glm::ivec3& low, const glm::ivec3& high, const Body& body) {
  for (int k = -1; k <= 1; ++k)
    for (int j = -1; j <= 1; ++j)
      for (int i = -1; i <= 1; ++i) {
        const glm::ivec3 offset(i, j, k), next = at + offset;
        if (offset == glm::ivec3(0) || glm::any(glm::lessThan(next, low)) || glm::any(glm::greaterThan(next, high)))
          continue;
        body(next, offset);
      }
}

// Sums the weights of each bone, drops tiny sums, sorts by bone, and scales the total to one.
void normalize(Influences& influences) {
  std::stable_sort(influences.begin(), influences.end(),
                   [](const BoneWeight& a, const BoneWeight& b) { return a.bone < b.bone; });
  Influences sums;
  double total = 0;
  for (const BoneWeight& each : influences) {
    if (sums.empty() || sums.back().bone != each.bone) sums.push_back({each.bone, 0});
    sums.back().weight += each.weight;
    total += each.weight;
  }
  std::erase_if(sums, [&](const BoneWeight& each) { return each.weight < kLeastWeight * total; });
  total = 0;
  for (const BoneWeight& each : sums) total += each.weight;
  for (BoneWeight& each : sums) each.weight /= total;
  influences = std::move(sums);
}

// Returns how different the bone weights of two corners are: 0 if they are equal, 1 if they have no bone in common.
double apart(const Influences& a, const Influences& b) {
  double common = 0;
  for (const BoneWeight& x : a)
    for (const BoneWeight& y : b)
      if (x.bone == y.bone) common += std::min(x.weight, y.weight);
  return 1 - common;
}

// Marks the cells with tissue, and the cells next to them.
std::vector<std::uint8_t> cells_in_use(const PreviewLattice& lattice, const TissueVoxels& tissue) {
  const glm::ivec3 size = lattice.size;
  const auto index = [&](const glm::ivec3& c) {
    return size_t(c.x + std::int64_t{size.x} * (c.y + std::int64_t{size.y} * c.z));
  };
  std::vector<std::uint8_t> used(size_t(size.x) * size.y * size.z);
  tissue.for_each([&](std::int64_t, const glm::ivec3& v) { used[index(v / lattice.step - lattice.first)] = 1; });
  // Grows the marked cells by one cell, one axis at a time.
  for (const std::ptrdiff_t stride : {std::ptrdiff_t{1}, std::ptrdiff_t{size.x}, std::ptrdiff_t{size.x} * size.y}) {
    std::vector<std::uint8_t> grown = used;
    for (std::ptrdiff_t i = 0; i < std::ssize(used); ++i)
      if (used[i])
        grown[std::max(i - stride, std::ptrdiff_t{0})] = grown[std::min(i + stride, std::ssize(used) - 1)] = 1;
    used = std::move(grown);
  }
  return used;
}

// The pieces of tissue in a cell and in the 26 cells around it, grouped into sides. Pieces of different sides are not
// connected within these cells and follow different bones.
class Sides {
 public:
  Sides(const PreviewLattice& lattice, const PiecesByCell& pieces, const glm::ivec3& cell)
      : lattice_(lattice),
        cell_(cell) {
    std::array<int, 28> begin{};  // index of the first piece of each of the 27 cells
    for (int n = 0; n < 27; ++n) {
      begin[n] = static_cast<int>(pieces_.size());
      for (const CellPiece& piece : pieces.of(cell + offset_of(n))) pieces_.push_back(&piece);
    }
    begin[27] = static_cast<int>(pieces_.size());
    side_.resize(pieces_.size());
    std::iota(side_.begin(), side_.end(), 0);
    constexpr std::array<int, 3> kNext = {1, 3, 9};
    for (int n = 0; n < 27; ++n)
      for (int axis = 0; axis < 3; ++axis) {
        if (offset_of(n)[axis] == 1) continue;
        const int next = n + kNext[axis];
        for (int a = begin[n]; a < begin[n + 1]; ++a)
          for (int b = begin[next]; b < begin[next + 1]; ++b)
            if (side_[a] != side_[b] && touch(*pieces_[a], *pieces_[b], axis, lattice.step)) unite(side_[a], side_[b]);
      }
    const std::vector<int> found = sides();
    if (found.size() < 2) return;
    std::vector<std::array<Influences, 8>> corners;
    for (const int side : found) corners.push_back(influences(side));
    for (size_t a = 0; a < found.size(); ++a)
      for (size_t b = 0; b < a; ++b) {
        bool alike = true;
        for (int c = 0; c < 8; ++c) alike = alike && apart(corners[a][c], corners[b][c]) < kApart;
        if (alike) unite(side_[found[a]], side_[found[b]]);
      }
  }

  // Returns the first piece of each side. If there are two or more sides, they are posed separately.
  std::vector<int> sides() const {
    std::vector<int> found;
    for (size_t i = 0; i < side_.size(); ++i)
      if (side_[i] == static_cast<int>(i)) found.push_back(static_cast<int>(i));
    return found;
  }
  // Returns the bone weights at the cell's corners that come from the tissue of one side only. A corner without such
  // tissue gets the mean of the other corners' weights, weighted by inverse squared distance.
  std::array<Influences, 8> influences(int side) const {
    std::array<Influences, 8> corners;
    for (size_t i = 0; i < pieces_.size(); ++i) {
      if (side_[i] != side) continue;
      for (const CellPiece::Share& share : pieces_[i]->shares) {
        const glm::ivec3 corner = pieces_[i]->cell + corner_of(share.corner) - cell_;
        if (glm::any(glm::lessThan(corner, glm::ivec3(0))) || glm::any(glm::greaterThan(corner, glm::ivec3(1))))
          continue;
        corners[corner.x + 2 * corner.y + 4 * corner.z].push_back({share.bone, share.weight});
      }
    }
    std::array<Influences, 8> all;
    for (int c = 0; c < 8; ++c)
      if (!corners[c].empty()) normalize(all[c] = corners[c]), corners[c] = all[c];
    for (int c = 0; c < 8; ++c) {
      if (!all[c].empty()) continue;
      for (int other = 0; other < 8; ++other) {
        const glm::dvec3 away = glm::dvec3(corner_of(c) - corner_of(other)) * lattice_.grid.spacing;
        for (const BoneWeight& each : corners[other]) all[c].push_back({each.bone, each.weight / glm::dot(away, away)});
      }
      normalize(all[c]);
    }
    return all;
  }
  // Returns one bit for each of the cell's 4^3 subcells: 1 if it contains tissue of the side.
  std::uint64_t places(int side) const {
    std::uint64_t places = 0;
    for (size_t i = 0; i < pieces_.size(); ++i)
      if (side_[i] == side && pieces_[i]->cell == cell_) places |= pieces_[i]->places;
    return places;
  }

  // Returns CellPart::apart for a side: the distance of each subcell from the tissue of other sides.
  std::array<std::int8_t, 64> to_others(int side) const {
    std::vector<glm::vec3> others;
    for (size_t i = 0; i < pieces_.size(); ++i) {
      if (side_[i] == side) continue;
      const glm::ivec3 low = (pieces_[i]->cell - cell_) * 4;
      for (std::uint64_t bits = pieces_[i]->places; bits; bits &= bits - 1)
        others.emplace_back(low + place_at(std::countr_zero(bits)));
    }
    std::array<std::int8_t, 64> steps;
    for (int place = 0; place < 64; ++place) {
      float least = kUnknown;
      for (const glm::vec3& other : others) {
        const glm::vec3 away = other - glm::vec3(place_at(place));
        least = std::min(least, glm::dot(away, away));
      }
      steps[place] = static_cast<std::int8_t>(
          std::min(CellPart::kStepApart * (std::sqrt(least) - 1) / 4, float(CellPart::kFarApart)));
    }
    return steps;
  }

 private:
  static glm::ivec3 place_at(int place) { return {place & 3, place >> 2 & 3, place >> 4}; }
  static glm::ivec3 offset_of(int n) { return glm::ivec3(n % 3, n / 3 % 3, n / 9) - 1; }
  void unite(int a, int b) {
    const int first = std::min(a, b), second = std::max(a, b);
    std::replace(side_.begin(), side_.end(), second, first);
  }

  const PreviewLattice& lattice_;
  glm::ivec3 cell_;
  std::vector<const CellPiece*> pieces_;
  std::vector<int> side_;  // #pieces: index of the first piece on the same side, which names the side
};

// Returns true if the vertices of the cell and of the 26 cells around it do not all follow the same bone, so that a
// pose may move tissue in the cell apart.
bool may_part(const PreviewLattice& lattice, const std::vector<Influences>& influences, const glm::ivec3& cell) {
  const Influences& first = influences[lattice.place(cell)];
  const glm::ivec3 low = glm::max(cell - 1, lattice.first), high = glm::min(cell + 2, lattice.first + lattice.size);
  for (int z = low.z; z <= high.z; ++z)
    for (int y = low.y; y <= high.y; ++y)
      for (int x = low.x; x <= high.x; ++x) {
        const Influences& here = influences[lattice.place({x, y, z})];
        if (here.empty()) continue;
        if (apart(first, here) > kApart ||
            std::none_of(here.begin(), here.end(), [](const BoneWeight& each) { return each.weight > 1 - kApart; }))
          return true;
      }
  return false;
}

// Returns the parts of a cell that have their own posed corners: first the cell's sides (unconnected tissue that
// follows different bones), then its stiff parts (tissue that follows one bone with full weight), ascending by bone.
std::vector<CellPart> parts_of(const PreviewLattice& lattice, const PiecesByCell& pieces,
                               const std::vector<Influences>& influences, std::int32_t index) {
  const glm::ivec3 cell = lattice.cells[index];
  std::vector<CellPart> parts;
  std::vector<std::uint64_t> tissue;  // for each side, one bit per subcell: 1 if it contains the side's tissue
  if (may_part(lattice, influences, cell)) {
    const Sides sides(lattice, pieces, cell);
    const std::vector<int> found = sides.sides();
    bool differs = found.size() > 1;
    if (found.size() == 1) {  // with one side, the cell's vertices may still follow tissue across a gap
      const std::array<Influences, 8> alone = sides.influences(found[0]);
      for (int c = 0; c < 8; ++c)
        differs = differs || apart(alone[c], influences[lattice.place(cell + corner_of(c))]) > kStrays;
    }
    if (differs) {
      std::uint64_t all = 0;
      for (const int side : found) {
        parts.push_back({index, false, sides.places(side), sides.influences(side), sides.to_others(side)});
        tissue.push_back(parts.back().places);
        all |= tissue.back();
      }
      for (CellPart& part : parts) part.places |= ~all;
    }
  }
  const auto follows = [](const Influences& all, int bone) {
    return std::any_of(all.begin(), all.end(),
                       [&](const BoneWeight& each) { return each.bone == bone && each.weight >= kStiff; });
  };
  std::map<int, std::uint64_t> stiff;
  for (const CellPiece& piece : pieces.of(cell))
    for (const CellPiece::Stiff& each : piece.stiff) stiff[each.bone] |= each.places;
  for (const auto& [bone, places] : stiff) {
    bool by_itself = parts.empty();
    for (int corner = 0; corner < 8; ++corner)
      by_itself = by_itself && follows(influences[lattice.place(cell + corner_of(corner))], bone);
    if (by_itself) continue;
    CellPart part{index, true, places, {}, {}};
    part.influences.fill({{bone, 1}});
    part.apart.fill(CellPart::kFarApart);
    for (size_t side = 0; side < tissue.size(); ++side)
      if (tissue[side] & places) part.apart = parts[side].apart;
    parts.push_back(std::move(part));
  }
  return parts;
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

  // Lists the cells and their vertices.
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

  // Collects the bone weights that each cell gives to its corners, and the distances of the corners from tissue.
  const std::vector<CellPiece> pieces = cell_pieces(tissue, weights, step, grid.spacing);
  std::vector<Influences> influences(lattice.places());
  lattice.depth.assign(lattice.places(), kUnknown);
  for (const CellPiece& piece : pieces) {
    for (const CellPiece::Share& share : piece.shares)
      influences[lattice.place(piece.cell + corner_of(share.corner))].push_back({share.bone, share.weight});
    for (int corner = 0; corner < 8; ++corner) {
      float& least = lattice.depth[lattice.place(piece.cell + corner_of(corner))];
      least = std::min(least, piece.away[corner]);
    }
  }

  // Normalizes the influences of vertices that have tissue around them. Vertices without tissue then take the mean
  // influences of their neighbours, ring by ring, until all vertices have influences.
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
    std::vector<std::pair<std::int64_t, Influences>> found;
    std::vector<std::pair<std::int64_t, float>> distances;
    for (const glm::ivec3& vertex : open) {
      Influences sum;
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
      normalize(sum);
      found.emplace_back(lattice.place(vertex), std::move(sum));
      distances.emplace_back(found.back().first, distance);
    }
    for (auto& [place, sum] : found) influences[place] = std::move(sum);
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

  const PiecesByCell pieces_by_cell(pieces, lattice.first, lattice.size);
  std::vector<std::vector<CellPart>> parts((lattice.cells.size() + kGrain - 1) / kGrain);
  lattice.has_sides.resize(lattice.cells.size());
  parallel_for(std::ssize(lattice.cells), kGrain, [&](std::int64_t begin, std::int64_t end) {
    for (auto cell = begin; cell < end; ++cell) {
      for (CellPart& part : parts_of(lattice, pieces_by_cell, influences, static_cast<std::int32_t>(cell))) {
        if (!part.is_stiff) lattice.has_sides[cell] = 1;
        parts[begin / kGrain].push_back(std::move(part));
      }
    }
  });
  for (auto& each : parts)
    lattice.parts.insert(lattice.parts.end(), std::make_move_iterator(each.begin()),
                         std::make_move_iterator(each.end()));
  return lattice;
}

}  // namespace limber
