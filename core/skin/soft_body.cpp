// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/skin/soft_body.h"

#include <algorithm>
#include <utility>

#include "core/base/parallel.h"

namespace limber {

namespace {
// Of 1 / distance^2. Beside weights painted by hand 1 to 4 do equally well; 0 (conduction alone) loses a fifth of them.
constexpr float kAttraction = 2;
}  // namespace

float conductivity(TissueKind kind) {
  // W/m/K of living tissue at 37 C over muscle's 0.49.
  switch (kind) {
    case TissueKind::Skin: return 0.76f;
    case TissueKind::Fat: return 0.43f;
    case TissueKind::Connective: return 0.80f;
    case TissueKind::Nail: return 0.50f;
    case TissueKind::Brain: return 1.10f;
    case TissueKind::Blood: return 1.06f;
    default: return 1.0f;  // muscle, tendon, cartilage, nerve, vessel, organs: 0.46 to 0.52
  }
}

namespace {
constexpr std::int64_t kGrain = 64;  // bricks a block of a parallel loop
}  // namespace

SoftBody::SoftBody(const LabelVolume& volume, const TissueVoxels& tissue, const TissueTable& tissues,
                   const std::vector<std::uint16_t>& held_by, const NearestBone& nearest, const std::map<Label, double>& stiffness)
    : volume_(volume), tissue_(tissue), held_by_(held_by), nearest_(nearest), conductivity_(1 << 16, 1.0f), attraction_(1 << 16, kAttraction) {
  for (const auto& [label, stiff] : stiffness) attraction_[label] = static_cast<float>(kAttraction * stiff * stiff);
  for (const Tissue& t : tissues.tissues) conductivity_[t.label] = conductivity(t.kind);
  const glm::dvec3 s = volume.grid.spacing;
  const glm::dvec3 area_over_distance(s.y * s.z / s.x, s.x * s.z / s.y, s.x * s.y / s.z);
  const double largest = std::max({area_over_distance.x, area_over_distance.y, area_over_distance.z});
  for (int axis = 0; axis < 3; ++axis) face_[axis] = static_cast<float>(area_over_distance[axis] / largest);
  volume_of_voxel_ = static_cast<float>(volume.grid.voxel_volume() / largest);
}

// A brick and one layer around it: places in the tissue list, -1 for air.
struct SoftBody::Window {
  static constexpr int kStep[3] = {1, 10, 100};
  std::array<std::int32_t, 1000> place;
  std::array<Label, 1000> label;
  const Seams* seams = nullptr;  // where one is near

  static int at(const glm::ivec3& v) { return (v.x + 1) + 10 * (v.y + 1) + 100 * (v.z + 1); }  // v from the corner

  bool is_cut(const glm::ivec3& voxel, int direction) const { return seams && seams->is_cut_towards(voxel, direction); }

  void look(const SoftBody& body, std::int64_t brick) {
    const auto& here = body.tissue_.bricks()[brick];
    seams = body.tissue_.seams();
    if (seams && !seams->is_near_brick(here.corner)) seams = nullptr;
    place.fill(-1);
    label.fill(0);
    body.tissue_.for_each(brick, brick + 1, [&](std::int64_t p, const glm::ivec3& v) {
      place[at(v - here.corner)] = static_cast<std::int32_t>(p);
      label[at(v - here.corner)] = body.volume_.at(v);
    });
    for (int axis = 0; axis < 3; ++axis)
      for (const int side : {-1, TissueVoxels::kBrick}) look_beside(body, here.corner, axis, side);
  }

  // The layer of the brick beside it.
  //   side  place of the layer along the axis, from the corner
  void look_beside(const SoftBody& body, const glm::ivec3& corner, int axis, int side) {
    glm::ivec3 first = corner;
    first[axis] += side;
    if (!body.volume_.grid.contains(first)) return;
    const int beside = body.tissue_.brick_at(first);
    if (beside < 0) return;
    const auto& there = body.tissue_.bricks()[beside];
    glm::ivec3 v;
    v[axis] = side;
    int &a = v[(axis + 1) % 3], &b = v[(axis + 2) % 3];
    for (a = 0; a < TissueVoxels::kBrick; ++a)
      for (b = 0; b < TissueVoxels::kBrick; ++b) {
        const std::int64_t found = TissueVoxels::index_in(there, v & 7);
        if (found < 0) continue;
        place[at(v)] = static_cast<std::int32_t>(found);
        label[at(v)] = body.volume_.at(corner + v);
      }
  }
};

// Between two soft voxels.
float SoftBody::face(std::int64_t axis, Label a, Label b) const {
  const float ka = conductivity_[a], kb = conductivity_[b];
  return face_[axis] * (ka == kb ? ka : 2 * ka * kb / (ka + kb));
}

float SoftBody::attraction(std::int64_t place, Label label) const {
  const float distance = nearest_.distance[place];
  return attraction_[label] * volume_of_voxel_ / (distance * distance);  // zero where no bone is reached
}

// Cells by colour, then in the order of the list. Fills `place` and `position`; the cell of each place of the list, -1 elsewhere.
std::vector<std::int32_t> SoftBody::number_cells(const std::vector<std::int32_t>& bricks, Region& region) const {
  const auto colour_of = [](const glm::ivec3& v) { return (v.x + v.y + v.z) & 1; };
  std::vector<std::array<std::int32_t, 2>> first(bricks.size());  // by colour: at first how many there are
  parallel_for(std::ssize(bricks), kGrain, [&](std::int64_t begin, std::int64_t end) {
    for (std::int64_t b = begin; b < end; ++b)
      tissue_.for_each(bricks[b], bricks[b] + 1, [&](std::int64_t place, const glm::ivec3& v) {
        if (held_by_[place] == kSoft) ++first[b][colour_of(v)];
      });
  });
  std::int32_t size = 0;
  for (int colour = 0; colour < 2; ++colour) {
    for (auto& of_brick : first) size += std::exchange(of_brick[colour], size);
    if (colour == 0) region.graph.red_count = size;
  }
  region.place.resize(size);
  region.graph.position.resize(size);
  std::vector<std::int32_t> cell_of(tissue_.size(), -1);
  parallel_for(std::ssize(bricks), kGrain, [&](std::int64_t begin, std::int64_t end) {
    for (std::int64_t b = begin; b < end; ++b)
      tissue_.for_each(bricks[b], bricks[b] + 1, [&](std::int64_t place, const glm::ivec3& v) {
        if (held_by_[place] != kSoft) return;
        const std::int32_t cell = first[b][colour_of(v)]++;
        cell_of[place] = cell;
        region.place[cell] = place;
        region.graph.position[cell] = glm::i16vec3(v);
      });
  });
  return cell_of;
}

SoftBody::Region SoftBody::region(const std::vector<std::int32_t>& bricks) const {
  Region region;
  CellGraph& graph = region.graph;
  graph.spacing = volume_.grid.spacing;
  const std::vector<std::int32_t> cell_of = number_cells(bricks, region);

  // Faces are found brick by brick, but a cell's list lies at its number: noted with room for six each, then closed up.
  const std::int64_t size = graph.size();
  graph.diagonal.assign(size, 0);
  graph.first.assign(size + 1, 0);
  graph.neighbour.resize(6 * size);
  graph.conductance.resize(6 * size);
  std::vector<std::vector<HeldFace>> held((std::ssize(bricks) + kGrain - 1) / kGrain);
  const auto look_at = [&](std::int32_t brick, Window& window, std::vector<HeldFace>& faces) {
    window.look(*this, brick);
    const glm::ivec3 corner = tissue_.bricks()[brick].corner;
    tissue_.for_each(brick, brick + 1, [&](std::int64_t place, const glm::ivec3& v) {
      const std::int32_t cell = cell_of[place];
      if (cell < 0) return;
      const int here = Window::at(v - corner);
      std::int64_t next = 6 * std::int64_t{cell};
      for (int direction = 0; direction < 6; ++direction) {
        const int axis = direction >> 1, there = here + (direction & 1 ? Window::kStep[axis] : -Window::kStep[axis]);
        const std::int32_t other = window.place[there];
        if (other < 0 || window.is_cut(v, direction)) continue;
        if (const std::uint16_t holder = held_by_[other]; holder != kSoft) {
          const float g = 2 * face_[axis] * conductivity_[window.label[here]];
          graph.diagonal[cell] += g;
          faces.push_back({cell, holder, g});
          continue;
        }
        const float g = face(axis, window.label[here], window.label[there]);
        graph.diagonal[cell] += g;
        if (cell_of[other] < 0) continue;
        graph.neighbour[next] = cell_of[other];
        graph.conductance[next++] = g;
      }
      graph.first[cell + 1] = static_cast<std::int32_t>(next - 6 * std::int64_t{cell});
      if (const float g = attraction(place, window.label[here]); g > 0) {
        graph.diagonal[cell] += g;
        faces.push_back({cell, nearest_.bone[place], g});
      }
    });
  };
  parallel_for(std::ssize(bricks), kGrain, [&](std::int64_t begin, std::int64_t end) {
    Window window;
    for (std::int64_t b = begin; b < end; ++b) look_at(bricks[b], window, held[begin / kGrain]);
  });
  for (const auto& faces : held) region.held.insert(region.held.end(), faces.begin(), faces.end());
  for (std::int64_t i = 0; i < size; ++i) {
    const std::int32_t count = graph.first[i + 1], to = graph.first[i];
    std::copy_n(graph.neighbour.begin() + 6 * i, count, graph.neighbour.begin() + to);
    std::copy_n(graph.conductance.begin() + 6 * i, count, graph.conductance.begin() + to);
    graph.first[i + 1] = to + count;
  }
  graph.neighbour.resize(graph.first[size]);
  graph.conductance.resize(graph.first[size]);
  return region;
}

// Connected soft voxels of one octant of a brick are one cell. Cells count from those that were found before.
void SoftBody::find_cells(std::int64_t brick, Window& window, std::vector<std::int32_t>& cell_of, std::vector<CoarseCell>& found) const {
  std::array<glm::ivec3, 64> open;
  const glm::ivec3 corner = tissue_.bricks()[brick].corner;
  window.look(*this, brick);
  tissue_.for_each(brick, brick + 1, [&](std::int64_t seed, const glm::ivec3& seed_voxel) {
    if (held_by_[seed] != kSoft || cell_of[seed] >= 0) return;
    const auto cell = static_cast<std::int32_t>(found.size());
    const glm::ivec3 octant = seed_voxel >> 2;
    found.push_back({glm::i16vec3(octant), static_cast<std::int32_t>(brick)});
    cell_of[seed] = cell;
    int open_count = 0;
    open[open_count++] = seed_voxel;
    while (open_count > 0) {
      const glm::ivec3 v = open[--open_count];
      for (int direction = 0; direction < 6; ++direction) {
        glm::ivec3 w = v;
        w[direction >> 1] += direction & 1 ? 1 : -1;
        if ((w >> 2) != octant) continue;
        const std::int32_t place = window.place[Window::at(w - corner)];
        if (place < 0 || held_by_[place] != kSoft || cell_of[place] >= 0 || window.is_cut(v, direction)) continue;
        cell_of[place] = cell;
        open[open_count++] = w;
      }
    }
  });
}

// One entry for each pair of cells; the way between their centres is four times as long as between voxels.
void SoftBody::link_cells(std::int64_t brick, Window& window, const std::vector<std::int32_t>& cell_of, std::vector<float>& diagonal,
                          std::vector<Link>& links, std::vector<HeldFace>& held) const {
  const glm::ivec3 corner = tissue_.bricks()[brick].corner;
  window.look(*this, brick);
  const size_t start = links.size();
  tissue_.for_each(brick, brick + 1, [&](std::int64_t place, const glm::ivec3& v) {
    const std::int32_t cell = cell_of[place];
    if (cell < 0) return;
    const int here = Window::at(v - corner);
    for (int direction = 0; direction < 6; ++direction) {
      const int axis = direction >> 1, there = here + (direction & 1 ? Window::kStep[axis] : -Window::kStep[axis]);
      const std::int32_t other = window.place[there];
      if (other < 0 || cell_of[other] == cell || window.is_cut(v, direction)) continue;
      if (held_by_[other] != kSoft) {
        const float g = 0.5f * face_[axis] * conductivity_[window.label[here]];
        diagonal[cell] += g;
        held.push_back({cell, held_by_[other], g});
      } else {
        const float g = 0.25f * face(axis, window.label[here], window.label[there]);
        diagonal[cell] += g;
        links.push_back({cell, cell_of[other], g});
      }
    }
    if (const float g = attraction(place, window.label[here]); g > 0) {
      diagonal[cell] += g;
      held.push_back({cell, nearest_.bone[place], g});
    }
  });
  std::stable_sort(links.begin() + start, links.end(), [](const Link& a, const Link& b) { return a.from != b.from ? a.from < b.from : a.to < b.to; });
  size_t kept = start;
  for (size_t i = start; i < links.size(); ++i) {
    if (kept > start && links[kept - 1].from == links[i].from && links[kept - 1].to == links[i].to)
      links[kept - 1].conductance += links[i].conductance;
    else
      links[kept++] = links[i];
  }
  links.resize(kept);
}

SoftBody::Coarse SoftBody::coarse() const {
  Coarse coarse;
  coarse.cell_of_place.assign(tissue_.size(), -1);
  std::vector<std::int32_t>& cell_of = coarse.cell_of_place;
  std::vector<glm::i16vec3> position;
  const std::int64_t bricks = std::ssize(tissue_.bricks());

  // Connected soft voxels of one octant are one cell.
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
    tissue_.for_each(block * kGrain, std::min(bricks, (block + 1) * kGrain), [&](std::int64_t place, const glm::ivec3&) {
      if (cell_of[place] >= 0) cell_of[place] += before;
    });
  }

  // Colour 0 first.
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

  // Faces between cells add up.
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
