// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/mesh/sample_lattice.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <unordered_map>

namespace limber {

namespace {

constexpr std::uint16_t kAir = RegionSurface::kAir;
constexpr int kBorder = 3;   // width in cells of the air border around the tissue, where samples may become tissue
constexpr int kLargest = 4;  // cells deep inside are at most this many times larger than the usual cells
constexpr std::int64_t kMostSamples = 12'000'000;

struct Box {
  glm::dvec3 low{1e300}, high{-1e300};
};

// Returns the bounding box of the tissue voxels in voxel coordinates. It includes the outermost voxels completely: it
// extends half a voxel beyond their centres.
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
  lattice.usual = settings.fine_around.empty() ? 1 : 2;
  double& spacing_mm = lattice.spacing_mm = settings.spacing_mm;
  const auto samples = [&](double spacing) {
    const glm::dvec3 count = glm::ceil((box.high - box.low) / spacing) + 2.0 * kBorder;
    return count.x * count.y * count.z * std::pow(lattice.usual, 3);
  };
  while (samples(spacing_mm) > double(kMostSamples)) spacing_mm *= 1.1;
  lattice.step = spacing_mm / lattice.usual;
  const glm::ivec3 cells = glm::ivec3(glm::ceil((box.high - box.low) / spacing_mm)) + 2 * kBorder;
  lattice.size = cells * lattice.usual + 1;
  // Centres the lattice on the tissue's bounding box.
  const glm::dvec3 first = (box.low + box.high) * 0.5 - glm::dvec3(cells) * (spacing_mm * 0.5);
  lattice.fine_from_voxel = {glm::dmat3(grid.spacing.x, 0, 0, 0, grid.spacing.y, 0, 0, 0, grid.spacing.z), -first};
  lattice.fine_from_voxel.linear /= lattice.step;
  lattice.fine_from_voxel.offset /= lattice.step;
  lattice.world_from_lattice = {grid.direction, grid.origin + grid.direction * first};
}

template <class Body>
void for_each_cell_of(const SampleLattice& lattice, int size, const Body& body) {
  glm::ivec3 corner;
  for (corner.z = 0; corner.z + size < lattice.size.z; corner.z += size)
    for (corner.y = 0; corner.y + size < lattice.size.y; corner.y += size)
      for (corner.x = 0; corner.x + size < lattice.size.x; corner.x += size) body(corner);
}

void resize_cell(SampleLattice& lattice, const glm::ivec3& corner, int extent, int size) {
  for (int z = 0; z < extent; ++z)
    for (int y = 0; y < extent; ++y)
      std::fill_n(lattice.cell_size.begin() + lattice.index(corner + glm::ivec3(0, y, z)), extent,
                  static_cast<std::uint8_t>(size));
}

void refine(SampleLattice& lattice, const LatticeNetSettings& settings) {
  lattice.cell_size.assign(std::int64_t{lattice.size.x} * lattice.size.y * lattice.size.z,
                           static_cast<std::uint8_t>(lattice.usual));
  if (lattice.usual == 1) return;
  for_each_cell_of(lattice, lattice.usual, [&](const glm::ivec3& corner) {
    const glm::dvec3 centre = lattice.world_from_lattice * ((glm::dvec3(corner) + 0.5 * lattice.usual) * lattice.step);
    for (const glm::dvec3& joint : settings.fine_around)
      if (glm::length(joint - centre) <= settings.fine_radius_mm) resize_cell(lattice, corner, lattice.usual, 1);
  });
}

// Returns true if one of the six faces of the voxel that is sample p is part of a seam.
bool is_at_seam(const SampleLattice& lattice, const glm::ivec3& p) {
  for (int axis = 0; axis < 3; ++axis) {
    glm::ivec3 lower = p;
    --lower[axis];
    if (lattice.is_cut(p, axis) || lattice.is_cut(lower, axis)) return true;
  }
  return false;
}

// Merges eight cells of one size into one cell if they are in one region, no seam touches them, and all cells that
// touch them have the same size.
void coarsen(SampleLattice& lattice, int size) {
  std::vector<glm::ivec3> deep;
  for_each_cell_of(lattice, 2 * size, [&](const glm::ivec3& corner) {
    const std::uint16_t region = lattice.at(corner);
    if (region == kAir || glm::any(glm::lessThan(corner, glm::ivec3(size))) ||
        glm::any(glm::greaterThanEqual(corner + 3 * size, lattice.size)))
      return;
    for (int z = 0; z <= 2; ++z)
      for (int y = 0; y <= 2; ++y)
        for (int x = 0; x <= 2; ++x)
          if (const glm::ivec3 p = corner + glm::ivec3(x, y, z) * size;
              lattice.at(p) != region || (lattice.seams && is_at_seam(lattice, p)))
            return;
    for (int z = -1; z <= 2; ++z)
      for (int y = -1; y <= 2; ++y)
        for (int x = -1; x <= 2; ++x)
          if (lattice.cell_size[lattice.index(corner + glm::ivec3(x, y, z) * size)] != size) return;
    deep.push_back(corner);
  });
  for (const glm::ivec3& corner : deep) resize_cell(lattice, corner, 2 * size, 2 * size);
}

// The volumes of tissue and of each bone in the cube around each sample.
struct Filling {
  std::vector<float> tissue;  // volume of all tissue around each sample, mm3
  // Volume of each bone around each sample: (sample << 16 | region, mm3), sorted by key.
  std::vector<std::pair<std::uint64_t, float>> bone;
  // [axis][i]: number of boxes (voxels, or parts of large voxels) that count for a sample at coordinate i if everything
  // is tissue. Boxes are counted whole, so a cube that is 2.6 boxes wide has two or three of them along the axis.
  std::vector<int> boxes[3];
  float box = 0;  // volume of a box, mm3

  // Returns the volume that counts for sample p if everything around it is tissue, mm3.
  float full(const glm::ivec3& p) const {
    return box * static_cast<float>(boxes[0][p.x] * boxes[1][p.y] * boxes[2][p.z]);
  }
};

void sum_up(std::vector<std::pair<std::uint64_t, float>>& parts) {
  std::stable_sort(parts.begin(), parts.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  std::size_t kept = 0;
  for (std::size_t i = 0; i < parts.size(); ++i)
    if (kept > 0 && parts[kept - 1].first == parts[i].first) parts[kept - 1].second += parts[i].second;
    else parts[kept++] = parts[i];
  parts.resize(kept);
}

// Returns the coordinate of the sample, a multiple of `stride`, to which a box (a voxel, or a part of a large voxel)
// with this centre belongs.
int nearest_sample(double fine, int stride) {
  return static_cast<int>(std::floor(fine / double(stride) + 0.5)) * stride;
}

// Returns the offset of the centre of piece i of `pieces` from the voxel's centre along one axis, as a share of the
// voxel.
double centre_of_piece(int i, int pieces) { return (i + 0.5) / pieces - 0.5; }

// Returns Filling::boxes for one axis, as if the grid continued beyond its border.
std::vector<int> count_boxes(const SampleLattice& lattice, const Grid& grid, int axis, int pieces, int stride) {
  std::vector<int> boxes(lattice.size[axis], 0);
  const double voxel = lattice.fine_from_voxel.linear[axis][axis], offset = lattice.fine_from_voxel.offset[axis];
  const int beyond = static_cast<int>(std::ceil(lattice.size[axis] / std::abs(voxel))) + 1;
  for (int v = -beyond; v < grid.size[axis] + beyond; ++v)
    for (int i = 0; i < pieces; ++i) {
      const int at = nearest_sample(voxel * (v + centre_of_piece(i, pieces)) + offset, stride);
      if (at >= 0 && at < lattice.size[axis]) ++boxes[at];
    }
  return boxes;
}

// Sums up the volumes of tissue around the samples whose coordinates are multiples of `stride`. Splits voxels larger
// than half the distance between these samples into smaller boxes, each of which is counted at its own centre.
Filling fill(const SampleLattice& lattice, const VoxelRegions& voxels, int stride) {
  Filling filling;
  filling.tissue.assign(lattice.label.size(), 0);
  const double spacing = lattice.step * stride;
  const glm::ivec3 pieces = glm::max(glm::ivec3(1), glm::ivec3(glm::ceil(2.0 * voxels.grid.spacing / spacing)));
  const float part = static_cast<float>(voxels.grid.voxel_volume() / (double(pieces.x) * pieces.y * pieces.z));
  filling.box = part;
  for (int axis = 0; axis < 3; ++axis)
    filling.boxes[axis] = count_boxes(lattice, voxels.grid, axis, pieces[axis], stride);
  voxels.tissue.for_each([&](std::int64_t place, const glm::ivec3& v) {
    const std::uint16_t region = voxels.region[place];
    for (int k = 0; k < pieces.z; ++k)
      for (int j = 0; j < pieces.y; ++j)
        for (int i = 0; i < pieces.x; ++i) {
          const glm::dvec3 inside(centre_of_piece(i, pieces.x), centre_of_piece(j, pieces.y),
                                  centre_of_piece(k, pieces.z));
          const glm::dvec3 fine = lattice.fine_from_voxel * (glm::dvec3(v) + inside);
          const glm::ivec3 p(nearest_sample(fine.x, stride), nearest_sample(fine.y, stride),
                             nearest_sample(fine.z, stride));
          const std::int64_t at = lattice.index(p);
          filling.tissue[at] += part;
          if (is_soft_region(region)) continue;
          const std::uint64_t key = std::uint64_t(at) << 16 | region;
          if (!filling.bone.empty() && filling.bone.back().first == key) filling.bone.back().second += part;
          else filling.bone.push_back({key, part});
          if (filling.bone.size() == 1 << 22) sum_up(filling.bone);
        }
  });
  sum_up(filling.bone);
  return filling;
}

// Returns SampleLattice::soft. A sample without tissue around it takes the side of a sample beside it.
std::vector<std::uint16_t> find_sides(const SampleLattice& lattice, const VoxelRegions& voxels) {
  constexpr int kBeside = 3;  // number of samples over which a side spreads
  std::vector<std::pair<std::uint64_t, float>> parts;
  voxels.tissue.for_each([&](std::int64_t place, const glm::ivec3& v) {
    const glm::dvec3 fine = lattice.fine_from_voxel * glm::dvec3(v);
    const std::int64_t at =
        lattice.index({nearest_sample(fine.x, 1), nearest_sample(fine.y, 1), nearest_sample(fine.z, 1)});
    const std::uint64_t key = std::uint64_t(at) << 16 | voxels.side_of(voxels.region[place]);
    if (!parts.empty() && parts.back().first == key) parts.back().second += 1;
    else parts.push_back({key, 1});
  });
  sum_up(parts);
  constexpr std::uint16_t kUnknown = kAir;
  std::vector<std::uint16_t> soft(lattice.label.size(), kUnknown);
  std::vector<float> most(lattice.label.size(), 0);
  for (const auto& [key, count] : parts)
    if (const std::uint64_t at = key >> 16; count > most[at])
      most[at] = count, soft[at] = soft_region(static_cast<std::uint16_t>(key & 0xffff));
  const std::int64_t strides[3] = {1, lattice.size.x, std::int64_t{lattice.size.x} * lattice.size.y};
  for (int round = 0; round < kBeside; ++round) {
    const std::vector<std::uint16_t> before = soft;
    for (std::int64_t at = 0; at < std::ssize(soft); ++at)
      for (const std::int64_t stride : strides)
        for (const std::int64_t beside : {at - stride, at + stride})
          if (soft[at] == kUnknown && beside >= 0 && beside < std::ssize(soft)) soft[at] = before[beside];
  }
  std::replace(soft.begin(), soft.end(), kUnknown, TetMesh::kSoft);
  return soft;
}

int smallest_around(const SampleLattice& lattice, const glm::ivec3& p) {
  int smallest = 255;
  for (const auto& cell : lattice.cells_around(p)) smallest = std::min(smallest, cell.size);
  return smallest;
}

bool is_multiple(const glm::ivec3& p, int size) { return ((p.x | p.y | p.z) & (size - 1)) == 0; }

struct Candidate {
  float share;   // share of the cube around the sample that the bone fills, [0, 1]
  float mm3;     // volume of the bone in this cube, mm3
  float volume;  // volume of the cube, mm3
  std::int64_t at;
  std::uint16_t region;
};

// Returns true if a sample is near a place where bones are to be covered (LatticeNetSettings::Covered), and one of the
// cells around the sample has a sample of air.
bool shows_at_air(const SampleLattice& lattice, const glm::ivec3& p, const LatticeNetSettings& settings) {
  const glm::dvec3 place = lattice.world_from_lattice * (glm::dvec3(p) * lattice.step);
  if (std::none_of(settings.covered.begin(), settings.covered.end(),
                   [&](const auto& covered) { return glm::length(covered.place - place) < covered.mm; }))
    return false;
  for (const auto& cell : lattice.cells_around(p))
    for (int corner = 0; corner < 8; ++corner)
      if (lattice.at(cell.corner + cell.size * glm::ivec3(corner & 1, corner >> 1 & 1, corner >> 2)) == kAir)
        return true;
  return false;
}

// Assigns to each bone the samples of which the bone fills the largest share, until their volume matches the bone's.
// Samples of two bones never share a cell.
void give_bones(SampleLattice& lattice, const std::vector<Candidate>& all, const LatticeNetSettings& settings) {
  std::map<std::uint16_t, std::vector<Candidate>> by_bone;
  for (const Candidate& candidate : all) by_bone[candidate.region].push_back(candidate);
  const auto fuller = [](const Candidate& a, const Candidate& b) {
    return a.share != b.share ? a.share > b.share : a.at < b.at;
  };
  std::vector<Candidate> seeds, wanted;
  for (auto& [region, candidates] : by_bone) {
    std::sort(candidates.begin(), candidates.end(), fuller);
    double volume = 0, given = 0;
    for (const Candidate& candidate : candidates) volume += candidate.mm3;
    for (const Candidate& candidate : candidates) {
      if (given > 0 && given + 0.5 * candidate.volume > volume) break;
      (given > 0 ? wanted : seeds).push_back(candidate);
      given += candidate.volume;
    }
  }
  std::sort(seeds.begin(), seeds.end(), fuller);
  std::sort(wanted.begin(), wanted.end(), fuller);
  wanted.insert(wanted.begin(), seeds.begin(),
                seeds.end());  // every bone first gets one sample, so that no bone is left out
  std::unordered_map<std::int64_t, std::uint16_t> bone_of_cell;
  for (std::size_t i = 0; i < wanted.size(); ++i) {
    const Candidate& candidate = wanted[i];
    const glm::ivec3 p(candidate.at % lattice.size.x, candidate.at / lattice.size.x % lattice.size.y,
                       candidate.at / (std::int64_t{lattice.size.x} * lattice.size.y));
    const auto around = lattice.cells_around(p);
    const bool free = std::all_of(around.begin(), around.end(), [&](const auto& cell) {
      const auto known = bone_of_cell.find(lattice.index(cell.corner));
      return known == bone_of_cell.end() || known->second == candidate.region;
    });
    if (!free || (i >= seeds.size() && shows_at_air(lattice, p, settings))) continue;
    lattice.label[candidate.at] = candidate.region;
    for (const auto& cell : around) bone_of_cell[lattice.index(cell.corner)] = candidate.region;
  }
}

}  // namespace

bool SampleLattice::is_cut(const glm::ivec3& p, int axis) const {
  if (!seams) return false;
  const glm::ivec3 lower = p + first_voxel;
  glm::ivec3 upper = lower;
  ++upper[axis];
  return glm::all(glm::greaterThanEqual(lower, glm::ivec3(0))) && glm::all(glm::lessThan(upper, seams->grid_size())) &&
         seams->is_cut(lower, axis);
}

bool SampleLattice::has_sample(const glm::ivec3& p) const { return is_multiple(p, smallest_around(*this, p)); }

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
  const int u = (axis + 1) % 3, v = (axis + 2) % 3;
  const std::int64_t strides[3] = {1, size.x, std::int64_t{size.x} * size.y};
  // Index steps to the cells on either side of the edge along the other two axes; both are the same cell at the
  // lattice's border.
  const std::int64_t here = index(p), u_low = p[u] > 0 ? strides[u] : 0, v_low = p[v] > 0 ? strides[v] : 0;
  const std::int64_t u_high = p[u] + 1 < size[u] ? 0 : strides[u], v_high = p[v] + 1 < size[v] ? 0 : strides[v];
  const int smallest = std::min({cell_size[here - u_low - v_low], cell_size[here - u_low - v_high],
                                 cell_size[here - u_high - v_low], cell_size[here - u_high - v_high]});
  return is_multiple(p, smallest) ? smallest : 0;
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

SmallestCells::SmallestCells(const SampleLattice& lattice, const Grid& grid) {
  const std::int64_t strides[3] = {1, lattice.size.x, std::int64_t{lattice.size.x} * lattice.size.y};
  for (int axis = 0; axis < 3; ++axis)
    for (int v = 0; v < grid.size[axis]; ++v) {
      const double fine = lattice.fine_from_voxel.linear[axis][axis] * v + lattice.fine_from_voxel.offset[axis];
      along_[axis].push_back(strides[axis] * std::clamp(int(std::floor(fine)), 0, lattice.size[axis] - 2));
    }
}

SampleLattice sample_regions(const VoxelRegions& voxels, const LatticeNetSettings& settings) {
  SampleLattice lattice;
  place(lattice, voxels, settings);
  refine(lattice, settings);
  lattice.label.assign(std::int64_t{lattice.size.x} * lattice.size.y * lattice.size.z, kAir);

  // Computes the volumes around samples: first with the usual spacing, then with half of it near joints. Samples
  // between cells of both sizes use the half spacing.
  std::vector<Candidate> bones;
  for (const int stride : {lattice.usual, 1}) {
    if (stride < lattice.usual && std::count(lattice.cell_size.begin(), lattice.cell_size.end(), stride) == 0) break;
    const Filling filling = fill(lattice, voxels, stride);
    const double volume = std::pow(lattice.step * stride, 3);
    const auto is_of_stride = [&](const glm::ivec3& p) {
      return lattice.usual == 1 || smallest_around(lattice, p) == stride;
    };
    std::size_t next = 0;
    glm::ivec3 p;
    for (p.z = 0; p.z < lattice.size.z; p.z += stride)
      for (p.y = 0; p.y < lattice.size.y; p.y += stride)
        for (p.x = 0; p.x < lattice.size.x; p.x += stride) {
          const std::int64_t at = lattice.index(p);
          if (filling.tissue[at] == 0 || !is_of_stride(p)) continue;
          const float full = filling.full(p);
          if (filling.tissue[at] >= 0.5F * full) lattice.label[at] = TetMesh::kSoft;
          while (next < filling.bone.size() && std::int64_t(filling.bone[next].first >> 16) < at) ++next;
          for (; next < filling.bone.size() && std::int64_t(filling.bone[next].first >> 16) == at; ++next)
            bones.push_back({filling.bone[next].second / full, filling.bone[next].second, static_cast<float>(volume),
                             at, static_cast<std::uint16_t>(filling.bone[next].first & 0xffff)});
        }
    if (lattice.usual == 1) break;
  }
  give_bones(lattice, bones, settings);
  if (voxels.sides) {
    lattice.soft = find_sides(lattice, voxels);
    for (std::size_t at = 0; at < lattice.label.size(); ++at)
      if (lattice.label[at] == TetMesh::kSoft) lattice.label[at] = lattice.soft[at];
  }
  for (int size = lattice.usual; size < kLargest * lattice.usual; size *= 2) coarsen(lattice, size);
  return lattice;
}

SampleLattice sample_voxels(const VoxelRegions& voxels) {
  const Box box = extent_of(voxels.tissue);
  SampleLattice lattice;
  lattice.step = lattice.spacing_mm = 1;
  lattice.seams = voxels.tissue.seams();
  lattice.first_voxel = glm::ivec3(glm::round(box.low + 0.5)) - kBorder;
  lattice.size = glm::ivec3(glm::round(box.high - box.low)) + 2 * kBorder;
  lattice.fine_from_voxel = {glm::dmat3(1), -glm::dvec3(lattice.first_voxel)};
  lattice.world_from_lattice = {glm::dmat3(1), glm::dvec3(0)};
  const auto count = static_cast<std::size_t>(std::int64_t{lattice.size.x} * lattice.size.y * lattice.size.z);
  lattice.cell_size.assign(count, 1);
  lattice.label.assign(count, kAir);
  voxels.tissue.for_each([&](std::int64_t place, const glm::ivec3& v) {
    lattice.label[lattice.index(v - lattice.first_voxel)] = voxels.region[place];
  });
  for (int size = 1; size < kDeepest; size *= 2) coarsen(lattice, size);
  return lattice;
}

}  // namespace limber
