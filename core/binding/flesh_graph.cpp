// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/binding/flesh_graph.h"

#include <algorithm>
#include <bit>
#include <utility>

#include "core/base/parallel.h"

namespace limber {

namespace {
// Strength of the heat that a soft voxel receives from its nearest bone at a distance: the conductance is this factor
// times the voxel's volume / distance^2. Factors from 1 to 4 agree equally well with weights painted by hand; with a
// factor of 0 (conduction alone) the agreement is 20 % lower.
constexpr float kAttraction = 2;
}  // namespace

float conductivity(TissueKind kind) {
  // Thermal conductivities of living tissue at 37 C, relative to muscle (0.49 W/m/K).
  switch (kind) {
    case TissueKind::Skin: return 0.76f;
    case TissueKind::Fat: return 0.43f;
    case TissueKind::Connective: return 0.80f;
    case TissueKind::Nail: return 0.50f;
    case TissueKind::Brain: return 1.10f;
    case TissueKind::Blood: return 1.06f;
    default: return 1.0f;  // muscle, tendon, cartilage, nerve, vessel, organs have 0.46 to 0.52 W/m/K
  }
}

namespace {
constexpr std::int64_t kGrain = 64;  // number of bricks in one block of a parallel loop
}  // namespace

HeatLaw::HeatLaw(const Grid& grid, const TissueTable& tissues, const std::map<Label, double>& stiffness)
    : conductivity(1 << 16, 1.0f),
      attraction(1 << 16, kAttraction) {
  for (const auto& [label, stiff] : stiffness) attraction[label] = static_cast<float>(kAttraction * stiff * stiff);
  for (const Tissue& t : tissues.tissues) conductivity[t.label] = limber::conductivity(t.kind);
  const glm::dvec3 s = grid.spacing;
  const glm::dvec3 area_over_distance(s.y * s.z / s.x, s.x * s.z / s.y, s.x * s.y / s.z);
  const double largest = std::max({area_over_distance.x, area_over_distance.y, area_over_distance.z});
  for (int axis = 0; axis < 3; ++axis) face[axis] = static_cast<float>(area_over_distance[axis] / largest);
  volume_of_voxel = static_cast<float>(grid.voxel_volume() / largest);
}

HeatGraph::HeatGraph(const LabelVolume& volume, const TissueVoxels& tissue, const TissueTable& tissues,
                     const ZeroedVector<std::uint16_t>& held_by, const NearestBone& nearest,
                     const std::map<Label, double>& stiffness)
    : volume_(volume),
      tissue_(tissue),
      held_by_(held_by),
      nearest_(nearest),
      law_(volume.grid, tissues, stiffness),
      bones_in_brick_(bones_in_bricks()) {}

// Returns the conductance of a face of a soft voxel to the voxel on the other side, which is soft or held at a fixed
// temperature by a bone. Returns 0 if the other side is air or a seam cuts the face.
float HeatGraph::conductance(const Window& window, const glm::ivec3& v, int here, int direction) const {
  const int there = here + Window::kTo[direction], axis = direction >> 1;
  if (window.place[there] < 0 || window.is_cut(v, direction)) return 0;
  return law_.conductance(axis, window.soft[here], window.soft[there]);
}

float HeatGraph::attraction(std::int64_t place, const glm::ivec3& voxel) const {
  const float distance = nearest_.distance[place];
  // The result is 0 if the voxel has no nearest bone, since the distance is then infinite.
  return law_.attraction[volume_.at(voxel)] * law_.volume_of_voxel / (distance * distance);
}

// Calls body(voxel, index in the list of tissue voxels, index in the window) for every soft voxel of a brick.
template <class Body>
void HeatGraph::for_soft(std::int64_t brick, Window& window, const Body& body) const {
  window.look(source(), brick);
  const glm::ivec3 corner = tissue_.bricks()[brick].corner;
  window.for_soft([&](const glm::ivec3& in, int here) { body(corner + in, window.place[here], here); });
}

namespace {
// Removes the links between the cells of a brick and the cells beyond one of its sides, which are not part of the
// system.
void unlink_side(std::int64_t brick, int direction, HeatSystem& system) {
  const int axis = direction >> 1;
  glm::ivec3 in;
  in[axis] = direction & 1 ? TissueVoxels::kBrick - 1 : 0;
  int &a = in[(axis + 1) % 3], &b = in[(axis + 2) % 3];
  for (a = 0; a < TissueVoxels::kBrick; ++a)
    for (b = 0; b < TissueVoxels::kBrick; ++b)
      if (const int slot = HeatSystem::slot_of(in); slot < HeatSystem::kColour)
        system.conductance_of_red(brick, direction, slot) = 0;
}
}  // namespace

void HeatGraph::fill(const std::vector<std::int32_t>& bricks, HeatSystem& system) const {
  std::vector<glm::ivec3> corners;
  std::vector<std::array<std::int32_t, 6>> beside;
  for (const std::int32_t brick : bricks) {
    corners.push_back(tissue_.bricks()[brick].corner);
    for (int direction = 0; direction < 6; ++direction) {
      glm::ivec3 there = corners.back();
      there[direction >> 1] += direction & 1 ? TissueVoxels::kBrick : -TissueVoxels::kBrick;
      const std::int32_t other = volume_.grid.contains(there) ? tissue_.brick_at(there) : -1;
      const auto found = std::lower_bound(bricks.begin(), bricks.end(), other);
      if (direction == 0) beside.emplace_back();
      beside.back()[direction] =
          found != bricks.end() && *found == other ? static_cast<std::int32_t>(found - bricks.begin()) : -1;
    }
  }
  system.reset(std::move(corners), std::move(beside), volume_.grid.spacing);
  parallel_for(std::ssize(bricks), kGrain, [&](std::int64_t begin, std::int64_t end) {
    Window window;
    for (std::int64_t b = begin; b < end; ++b) {
      float* red_conductance = &system.conductance_of_red(b, 0, 0);
      for_soft(bricks[b], window, [&](const glm::ivec3& v, std::int64_t place, int here) {
        const int slot = HeatSystem::slot_of(v - system.corners[b]);
        const bool is_red = slot < HeatSystem::kColour;
        float diagonal = 0;
#pragma GCC unroll 6
        for (int direction = 0; direction < 6; ++direction) {
          const float g = conductance(window, v, here, direction);
          diagonal += g;
          if (is_red && window.soft[here + Window::kTo[direction]] > 0)
            red_conductance[direction * HeatSystem::kColour + slot] = g;
        }
        system.add_cell(b, slot, diagonal + attraction(place, v));
      });
      for (int direction = 0; direction < 6; ++direction)
        if (system.beside[b][direction] == system.brick_count()) unlink_side(b, direction, system);
    }
  });
}

// Returns for each brick (8^3 voxels) the bones that fix the temperature of voxels in the brick or give heat to them at
// a distance. Each bone has one bit; bones whose indices differ by 64 share a bit.
std::vector<std::uint64_t> HeatGraph::bones_in_bricks() const {
  std::vector<std::uint64_t> bones(tissue_.bricks().size(), 0);
  parallel_for(std::ssize(bones), kGrain, [&](std::int64_t begin, std::int64_t end) {
    for (std::int64_t brick = begin; brick < end; ++brick)
      tissue_.for_each(brick, brick + 1, [&](std::int64_t place, const glm::ivec3&) {
        for (const std::uint16_t bone : {held_by_[place], nearest_.bone[place]})
          if (bone != kSoft) bones[brick] |= std::uint64_t{1} << (bone & 63);
      });
  });
  return bones;
}

void HeatGraph::add_sources(const std::vector<std::int32_t>& bricks, const HeatSystem& system,
                            const std::vector<int>& lane_of_bone, HeatSolver& solver) const {
  std::uint64_t wanted = 0;
  for (std::size_t bone = 0; bone < lane_of_bone.size(); ++bone)
    if (lane_of_bone[bone] >= 0) wanted |= std::uint64_t{1} << (bone & 63);
  // Returns true if some bone that is solved for can give heat to brick b: it fixes the temperature of voxels in the
  // brick or in one of its six neighbours, or gives heat to them at a distance. All other bricks are skipped.
  const auto is_near = [&](std::int64_t b) {
    std::uint64_t near = bones_in_brick_[bricks[b]];
    for (int direction = 0; direction < 6; ++direction) {
      glm::ivec3 there = system.corners[b];
      there[direction >> 1] += direction & 1 ? TissueVoxels::kBrick : -TissueVoxels::kBrick;
      if (const int other = volume_.grid.contains(there) ? tissue_.brick_at(there) : -1; other >= 0)
        near |= bones_in_brick_[other];
    }
    return (near & wanted) != 0;
  };
  parallel_for(std::ssize(bricks), kGrain, [&](std::int64_t begin, std::int64_t end) {
    Window window;
    for (std::int64_t b = begin; b < end; ++b) {
      if (!is_near(b)) continue;
      const glm::ivec3 corner = system.corners[b];
      for_soft(bricks[b], window, [&](const glm::ivec3& v, std::int64_t place, int here) {
        const int slot = HeatSystem::slot_of(v - corner);
        const auto add = [&](std::uint16_t bone, float g) {
          const int lane = bone == kSoft ? -1 : lane_of_bone[bone];
          if (lane < 0) return;
          (slot < HeatSystem::kColour ? solver.red_sources(b, lane)[slot]
                                      : solver.black_sources(b, lane)[slot - HeatSystem::kColour]) += g;
        };
        for (int direction = 0; direction < 6; ++direction)
          if (const int there = here + Window::kTo[direction]; window.place[there] >= 0 && window.soft[there] == 0)
            add(held_by_[window.place[there]], conductance(window, v, here, direction));
        add(nearest_.bone[place], attraction(place, v));
      });
    }
  });
}

void HeatGraph::add_outside(const std::vector<std::int32_t>& bricks, int lanes, const HeatSystem& system,
                            const std::function<float(std::int64_t, std::int64_t, int)>& outside,
                            HeatSolver& solver) const {
  parallel_for(std::ssize(bricks), kGrain, [&](std::int64_t begin, std::int64_t end) {
    Window window;
    for (std::int64_t b = begin; b < end; ++b) {
      const auto& beside = system.beside[b];
      if (std::find(beside.begin(), beside.end(), system.brick_count()) == beside.end()) continue;
      for_soft(bricks[b], window, [&](const glm::ivec3& v, std::int64_t, int here) {
        const glm::ivec3 in = v - system.corners[b];
        const int slot = HeatSystem::slot_of(in);
        for (int direction = 0; direction < 6; ++direction) {
          const int there = here + Window::kTo[direction], beyond = in[direction >> 1] + (direction & 1 ? 1 : -1);
          if ((beyond >= 0 && beyond <= 7) || beside[direction] != system.brick_count()) continue;
          if (window.place[there] < 0 || window.soft[there] == 0) continue;
          const float g = conductance(window, v, here, direction);
          for (int lane = 0; lane < lanes; ++lane)
            (slot < HeatSystem::kColour ? solver.red_sources(b, lane)[slot]
                                        : solver.black_sources(b, lane)[slot - HeatSystem::kColour]) +=
                g * outside(window.beside[direction], window.place[there], lane);
        }
      });
    }
  });
}

namespace {
using Slices = std::array<std::uint64_t, 8>;  // one bit per voxel of a brick, one word per z slice: bit x + 8 y

// Returns the voxels of a brick whose face towards higher x, y or z is cut by a seam, for each axis.
std::array<Slices, 3> cut_faces(const BrickWindow& window, const glm::ivec3& corner) {
  std::array<Slices, 3> cut{};
  if (!window.seams) return cut;
  window.for_soft([&](const glm::ivec3& in, int) {
    for (int axis = 0; axis < 3; ++axis)
      if (window.is_cut(corner + in, 2 * axis + 1)) cut[axis][in.z] |= std::uint64_t{1} << (in.x + 8 * in.y);
  });
  return cut;
}

// Adds to `reached` all voxels of `within` that are connected to voxels of `reached` through faces that no seam cuts.
// All voxels are in one octant, whose lowest slice is `first`.
void spread_in_octant(Slices& reached, const Slices& within, const std::array<Slices, 3>& cut, int first) {
  const int last = first + 3;
  for (bool grows = true; grows;) {
    grows = false;
    for (int z = first; z <= last; ++z) {
      const std::uint64_t before = reached[z], free_x = ~cut[0][z], free_y = ~cut[1][z];
      std::uint64_t around =
          (before & free_x) << 1 | (before >> 1 & free_x) | (before & free_y) << 8 | (before >> 8 & free_y);
      if (z > first) around |= reached[z - 1] & ~cut[2][z - 1];
      if (z < last) around |= reached[z + 1] & ~cut[2][z];
      reached[z] = before | (around & within[z]);
      grows |= reached[z] != before;
    }
  }
}
}  // namespace

// Finds the coarse cells of a brick. A coarse cell is a connected set of soft voxels in one octant (4^3 voxels) of the
// brick. The cells are appended to `found`, and `cell_of` gets the index of its cell in `found` for each soft voxel of
// the brick.
void HeatGraph::find_cells(std::int64_t brick, Window& window, std::vector<std::int32_t>& cell_of,
                           std::vector<CoarseCell>& found) const {
  const glm::ivec3 corner = tissue_.bricks()[brick].corner;
  window.look(source(), brick);
  const std::array<Slices, 3> cut = cut_faces(window, corner);
  Slices open = window.soft_bits;
  for (int seed_z = 0; seed_z < TissueVoxels::kBrick; ++seed_z)
    while (open[seed_z]) {
      const int seed = std::countr_zero(open[seed_z]), first = seed_z & 4;
      const glm::ivec3 octant(seed >> 2 & 1, seed >> 5, seed_z >> 2);
      const std::uint64_t slice_of_octant = std::uint64_t{0x0f0f0f0f} << (4 * octant.x + 32 * octant.y);
      Slices within{}, reached{};
      for (int z = first; z < first + 4; ++z) within[z] = open[z] & slice_of_octant;
      reached[seed_z] = std::uint64_t{1} << seed;
      spread_in_octant(reached, within, cut, first);
      for (int z = first; z < first + 4; ++z) {
        for (std::uint64_t bits = reached[z]; bits; bits &= bits - 1) {
          const int bit = std::countr_zero(bits);
          cell_of[window.place[Window::at({bit & 7, bit >> 3, z})]] = static_cast<std::int32_t>(found.size());
        }
        open[z] &= ~reached[z];
      }
      found.push_back({glm::i16vec3((corner >> 2) + octant), static_cast<std::int32_t>(brick)});
    }
}

namespace {
// Adds the conductance of `entry` to the equal entry (by `is_less`) at index `start` or later, or appends `entry` if
// there is none. Neighbouring voxels mostly have equal entries, so the search starts at the end.
template <class Entry, class IsLess>
void add_to(std::vector<Entry>& entries, size_t start, const Entry& entry, const IsLess& is_less) {
  for (size_t k = entries.size(); k > start; --k)
    if (!is_less(entries[k - 1], entry) && !is_less(entry, entries[k - 1])) {
      entries[k - 1].conductance += entry.conductance;
      return;
    }
  entries.push_back(entry);
}
}  // namespace

// Makes one link for each pair of adjacent coarse cells. The centres of coarse cells are four times as far apart as
// those of voxels, so each voxel face between the cells counts with a quarter of its conductance.
void HeatGraph::link_cells(std::int64_t brick, Window& window, const std::vector<std::int32_t>& cell_of,
                           std::vector<float>& diagonal, std::vector<Link>& links, std::vector<HeldFace>& held) const {
  const size_t start = links.size(), held_start = held.size();
  const auto is_less_link = [](const Link& a, const Link& b) {
    return a.from != b.from ? a.from < b.from : a.to < b.to;
  };
  const auto is_less_held = [](const HeldFace& a, const HeldFace& b) {
    return a.cell != b.cell ? a.cell < b.cell : a.bone < b.bone;
  };
  for_soft(brick, window, [&](const glm::ivec3& v, std::int64_t place, int here) {
    const std::int32_t cell = cell_of[place];
#pragma GCC unroll 6
    for (int direction = 0; direction < 6; ++direction) {
      const int there = here + Window::kTo[direction];
      const std::int32_t other = window.place[there];
      if (other < 0 || cell_of[other] == cell || window.is_cut(v, direction)) continue;
      const float conducted = 0.25f * conductance(window, v, here, direction);
      diagonal[cell] += conducted;
      if (window.soft[there] == 0) add_to(held, held_start, {cell, held_by_[other], conducted}, is_less_held);
      else add_to(links, start, {cell, cell_of[other], conducted}, is_less_link);
    }
    if (const float g = attraction(place, v); g > 0) {
      diagonal[cell] += g;
      add_to(held, held_start, {cell, nearest_.bone[place], g}, is_less_held);
    }
  });
  std::sort(links.begin() + start, links.end(), is_less_link);
  std::sort(held.begin() + held_start, held.end(), is_less_held);
}

HeatGraph::Coarse HeatGraph::coarse() const {
  Coarse coarse;
  coarse.cell_of_place.assign(tissue_.size(), -1);
  std::vector<std::int32_t>& cell_of = coarse.cell_of_place;
  std::vector<glm::i16vec3> position;
  const std::int64_t bricks = std::ssize(tissue_.bricks());

  // Finds the cells of each brick, and then numbers the cells of all bricks.
  std::vector<std::vector<CoarseCell>> found((bricks + kGrain - 1) / kGrain);
  parallel_for(bricks, kGrain, [&](std::int64_t begin, std::int64_t end) {
    Window window;
    for (std::int64_t brick = begin; brick < end; ++brick) find_cells(brick, window, cell_of, found[begin / kGrain]);
  });
  for (std::int64_t block = 0; block < std::ssize(found); ++block) {
    const auto before = static_cast<std::int32_t>(position.size());
    for (const CoarseCell& cell : found[block]) {
      position.push_back(cell.octant);
      coarse.brick.push_back(cell.brick);
    }
    tissue_.for_each(block * kGrain, std::min(bricks, (block + 1) * kGrain),
                     [&](std::int64_t place, const glm::ivec3&) {
                       if (cell_of[place] >= 0) cell_of[place] += before;
                     });
  }

  // Sorts the cells so that those of colour 0 come first.
  const auto size = std::ssize(position);
  CellGraph& graph = coarse.graph;
  graph.spacing = 4.0 * volume_.grid.spacing;
  std::vector<std::int32_t> number(size);
  std::vector<std::int32_t> brick_of(size);
  for (int colour = 0; colour < 2; ++colour) {
    for (std::int64_t c = 0; c < size; ++c)
      if (((position[c].x + position[c].y + position[c].z) & 1) == colour) {
        number[c] = static_cast<std::int32_t>(graph.position.size());
        brick_of[number[c]] = coarse.brick[c];
        graph.position.push_back(position[c]);
      }
    if (colour == 0) graph.red_count = static_cast<std::int32_t>(graph.position.size());
  }
  coarse.brick = std::move(brick_of);
  for (std::int32_t& c : cell_of)
    if (c >= 0) c = number[c];

  // Sums the conductances of the voxel faces between each pair of cells.
  graph.diagonal.assign(size, 0);
  std::vector<std::vector<Link>> links_of(found.size());
  std::vector<std::vector<HeldFace>> held_of(found.size());
  parallel_for(bricks, kGrain, [&](std::int64_t begin, std::int64_t end) {
    Window window;
    for (std::int64_t brick = begin; brick < end; ++brick)
      link_cells(brick, window, cell_of, graph.diagonal, links_of[begin / kGrain], held_of[begin / kGrain]);
  });
  std::vector<Link> links;
  for (const auto& some : links_of) links.insert(links.end(), some.begin(), some.end());
  for (const auto& some : held_of) coarse.held.insert(coarse.held.end(), some.begin(), some.end());
  graph.first.assign(size + 1, 0);
  for (const Link& link : links) ++graph.first[link.from + 1];
  for (std::int64_t i = 0; i < size; ++i) graph.first[i + 1] += graph.first[i];
  std::vector<std::int32_t> at(graph.first.begin(), graph.first.end() - 1);
  graph.neighbour.resize(links.size());
  graph.conductance.resize(links.size());
  for (const Link& link : links) {
    graph.neighbour[at[link.from]] = link.to;
    graph.conductance[at[link.from]++] = link.conductance;
  }
  return coarse;
}

}  // namespace limber
