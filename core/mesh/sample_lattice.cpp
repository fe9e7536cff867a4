// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/mesh/sample_lattice.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <unordered_map>

namespace limber {

namespace {

constexpr std::uint16_t kAir = RegionSurface::kAir;
constexpr int kBorder = 3;                     // coarse steps of air around the tissue: room for samples that become tissue
constexpr std::int64_t kMostSamples = 12'000'000;

struct Box {
  glm::dvec3 low{1e300}, high{-1e300};
};

// Of the tissue, in voxels, with the voxels' own extent.
Box extent_of(const TissueVoxels& tissue) {
  Box box;
  tissue.for_each([&](std::int64_t, const glm::ivec3& v) {
    box.low = glm::min(box.low, glm::dvec3(v) - 0.5);
    box.high = glm::max(box.high, glm::dvec3(v) + 0.5);
  });
  return box;
}

void place(SampleLattice& lattice, const VoxelRegions& voxels, const LatticeNetSettings& settings) {
  const Grid& grid = voxels.grid;
  Box box = extent_of(voxels.tissue);
  box.low *= grid.spacing, box.high *= grid.spacing;
  lattice.block = settings.fine_around.empty() ? 1 : 2;
  double coarse = settings.spacing_mm;
  const auto samples = [&](double spacing) {
    const glm::dvec3 count = glm::ceil((box.high - box.low) / spacing) + 2.0 * kBorder;
    return count.x * count.y * count.z * std::pow(lattice.block, 3);
  };
  while (samples(coarse) > double(kMostSamples)) coarse *= 1.1;
  lattice.step = coarse / lattice.block;
  const glm::dvec3 count = glm::ceil((box.high - box.low) / coarse);
  lattice.blocks = glm::ivec3(count) + 2 * kBorder;
  lattice.size = lattice.blocks * lattice.block + 1;
  // The tissue in the middle.
  const glm::dvec3 first = (box.low + box.high) * 0.5 - glm::dvec3(lattice.blocks) * (coarse * 0.5);
  lattice.fine_from_voxel = {glm::dmat3(grid.spacing.x, 0, 0, 0, grid.spacing.y, 0, 0, 0, grid.spacing.z), -first};
  lattice.fine_from_voxel.linear /= lattice.step;
  lattice.fine_from_voxel.offset /= lattice.step;
  lattice.world_from_lattice = {grid.direction, grid.origin + grid.direction * first};
}

void refine(SampleLattice& lattice, const LatticeNetSettings& settings) {
  if (lattice.block == 1) return;
  lattice.is_fine.assign(std::int64_t{lattice.blocks.x} * lattice.blocks.y * lattice.blocks.z, 0);
  const double coarse = lattice.step * lattice.block;
  std::size_t at = 0;
  for (int z = 0; z < lattice.blocks.z; ++z)
    for (int y = 0; y < lattice.blocks.y; ++y)
      for (int x = 0; x < lattice.blocks.x; ++x, ++at) {
        const glm::dvec3 centre = lattice.world_from_lattice * ((glm::dvec3(x, y, z) + 0.5) * coarse);
        for (const glm::dvec3& joint : settings.fine_around)
          if (glm::length(joint - centre) <= settings.fine_radius_mm) lattice.is_fine[at] = 1;
      }
}

// How full of tissue each sample's surroundings are, and of which bones.
struct Filling {
  std::vector<float> tissue;                                 // mm3 per sample
  std::vector<std::pair<std::uint64_t, float>> bone;         // (sample << 16 | region, mm3), sorted by the first
};

void sum_up(std::vector<std::pair<std::uint64_t, float>>& parts) {
  std::stable_sort(parts.begin(), parts.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  std::size_t kept = 0;
  for (std::size_t i = 0; i < parts.size(); ++i)
    if (kept > 0 && parts[kept - 1].first == parts[i].first) parts[kept - 1].second += parts[i].second;
    else parts[kept++] = parts[i];
  parts.resize(kept);
}

// Voxels larger than half a step are counted in pieces.
Filling fill(const SampleLattice& lattice, const VoxelRegions& voxels, int stride) {
  Filling filling;
  filling.tissue.assign(lattice.label.size(), 0);
  const double spacing = lattice.step * stride;
  const glm::ivec3 pieces = glm::max(glm::ivec3(1), glm::ivec3(glm::ceil(2.0 * voxels.grid.spacing / spacing)));
  const float part = static_cast<float>(voxels.grid.voxel_volume() / (double(pieces.x) * pieces.y * pieces.z));
  voxels.tissue.for_each([&](std::int64_t place, const glm::ivec3& v) {
    const std::uint16_t region = voxels.region[place];
    for (int k = 0; k < pieces.z; ++k)
      for (int j = 0; j < pieces.y; ++j)
        for (int i = 0; i < pieces.x; ++i) {
          const glm::dvec3 inside = (glm::dvec3(i, j, k) + 0.5) / glm::dvec3(pieces) - 0.5;
          const glm::dvec3 fine = lattice.fine_from_voxel * (glm::dvec3(v) + inside);
          const glm::ivec3 p = glm::ivec3(glm::floor(fine / double(stride) + 0.5)) * stride;
          const std::int64_t at = lattice.index(p);
          filling.tissue[at] += part;
          if (region == TetMesh::kSoft) continue;
          const std::uint64_t key = std::uint64_t(at) << 16 | region;
          if (!filling.bone.empty() && filling.bone.back().first == key) filling.bone.back().second += part;
          else filling.bone.push_back({key, part});
          if (filling.bone.size() == 1 << 22) sum_up(filling.bone);
        }
  });
  sum_up(filling.bone);
  return filling;
}

bool touches_fine(const SampleLattice& lattice, const glm::ivec3& p) {
  for (const auto& cell : lattice.cells_around(p))
    if (cell.size == 1) return true;
  return false;
}

struct Candidate {
  float share;  // of the sample's surroundings that the bone fills
  float volume;
  std::int64_t at;
  std::uint16_t region;
};

// Every bone gets as many samples as it has volume, those that it fills most; samples of two bones never share a cell.
void give_bones(SampleLattice& lattice, const std::vector<Candidate>& all) {
  std::map<std::uint16_t, std::vector<Candidate>> by_bone;
  for (const Candidate& candidate : all) by_bone[candidate.region].push_back(candidate);
  const auto fuller = [](const Candidate& a, const Candidate& b) { return a.share != b.share ? a.share > b.share : a.at < b.at; };
  std::vector<Candidate> seeds, wanted;
  for (auto& [region, candidates] : by_bone) {
    std::sort(candidates.begin(), candidates.end(), fuller);
    double volume = 0, given = 0;
    for (const Candidate& candidate : candidates) volume += double{candidate.share} * candidate.volume;
    for (const Candidate& candidate : candidates) {
      if (given > 0 && given + 0.5 * candidate.volume > volume) break;
      (given > 0 ? wanted : seeds).push_back(candidate);
      given += candidate.volume;
    }
  }
  std::sort(seeds.begin(), seeds.end(), fuller);
  std::sort(wanted.begin(), wanted.end(), fuller);
  wanted.insert(wanted.begin(), seeds.begin(), seeds.end());  // no bone goes without for another's sake
  std::unordered_map<std::int64_t, std::uint16_t> bone_of_cell;
  for (const Candidate& candidate : wanted) {
    const glm::ivec3 p(candidate.at % lattice.size.x, candidate.at / lattice.size.x % lattice.size.y,
                       candidate.at / (std::int64_t{lattice.size.x} * lattice.size.y));
    const auto around = lattice.cells_around(p);
    const bool free = std::all_of(around.begin(), around.end(), [&](const auto& cell) {
      const auto known = bone_of_cell.find(lattice.index(cell.corner));
      return known == bone_of_cell.end() || known->second == candidate.region;
    });
    if (!free) continue;
    lattice.label[candidate.at] = candidate.region;
    for (const auto& cell : around) bone_of_cell[lattice.index(cell.corner)] = candidate.region;
  }
}

}  // namespace

bool SampleLattice::has_sample(const glm::ivec3& p) const {
  if (block == 1 || (p.x % block == 0 && p.y % block == 0 && p.z % block == 0)) return true;
  return touches_fine(*this, p);
}

std::array<SampleLattice::Cell, 8> SampleLattice::cells_around(const glm::ivec3& p) const {
  std::array<Cell, 8> cells;
  for (int octant = 0; octant < 8; ++octant) {
    const glm::ivec3 fine = p - 1 + glm::ivec3(octant & 1, octant >> 1 & 1, octant >> 2);
    cells[octant] = cell(glm::clamp(fine, glm::ivec3(0), size - 2));
  }
  return cells;
}

int SampleLattice::edge_length(const glm::ivec3& p, int axis) const {
  if (p[axis] + 1 >= size[axis]) return 0;
  if (block == 1) return 1;
  const auto around = cells_around_edge(p, axis);
  for (const Cell& cell : around)
    if (cell.size == 1) return 1;
  for (int i = 0; i < 3; ++i)
    if (p[i] % block != 0) return 0;
  return block;
}

std::array<SampleLattice::Cell, 4> SampleLattice::cells_around_edge(const glm::ivec3& p, int axis) const {
  const int u = (axis + 1) % 3, v = (axis + 2) % 3;
  constexpr int kSlots[4][2] = {{-1, -1}, {0, -1}, {0, 0}, {-1, 0}};
  std::array<Cell, 4> cells;
  for (int slot = 0; slot < 4; ++slot) {
    glm::ivec3 fine = p;
    fine[u] += kSlots[slot][0];
    fine[v] += kSlots[slot][1];
    cells[slot] = cell(glm::clamp(fine, glm::ivec3(0), size - 2));
  }
  return cells;
}

SampleLattice sample_regions(const VoxelRegions& voxels, const LatticeNetSettings& settings) {
  SampleLattice lattice;
  place(lattice, voxels, settings);
  refine(lattice, settings);
  lattice.label.assign(std::int64_t{lattice.size.x} * lattice.size.y * lattice.size.z, kAir);

  // Where fine cells meet coarse ones their common samples are fine.
  std::vector<Candidate> bones;
  for (const int stride : {lattice.block, 1}) {
    if (stride == 1 && lattice.block > 1 && std::count(lattice.is_fine.begin(), lattice.is_fine.end(), 1) == 0) break;
    const Filling filling = fill(lattice, voxels, stride);
    const double volume = std::pow(lattice.step * stride, 3);
    const auto is_of_stride = [&](const glm::ivec3& p) { return lattice.block == 1 || touches_fine(lattice, p) == (stride == 1); };
    std::size_t next = 0;
    glm::ivec3 p;
    for (p.z = 0; p.z < lattice.size.z; p.z += stride)
      for (p.y = 0; p.y < lattice.size.y; p.y += stride)
        for (p.x = 0; p.x < lattice.size.x; p.x += stride) {
          const std::int64_t at = lattice.index(p);
          if (filling.tissue[at] == 0 || !is_of_stride(p)) continue;
          if (filling.tissue[at] >= 0.5 * volume) lattice.label[at] = TetMesh::kSoft;
          while (next < filling.bone.size() && std::int64_t(filling.bone[next].first >> 16) < at) ++next;
          for (; next < filling.bone.size() && std::int64_t(filling.bone[next].first >> 16) == at; ++next)
            bones.push_back({static_cast<float>(filling.bone[next].second / volume), static_cast<float>(volume), at,
                             static_cast<std::uint16_t>(filling.bone[next].first & 0xffff)});
        }
    if (lattice.block == 1) break;
  }
  give_bones(lattice, bones);
  return lattice;
}

}  // namespace limber
