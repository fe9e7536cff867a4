// SPDX-License-Identifier: AGPL-3.0-or-later
// The heat that bones give to cells: through the sides that touch them, and at a distance.
#include <algorithm>

#include "core/base/parallel.h"
#include "core/binding/cell_heat.h"

namespace limber {

namespace {
constexpr std::int64_t kGrain = 64;  // number of bricks in one block of a parallel loop

struct BoneSource {
  std::uint16_t bone;
  CellSource source;
};

struct CellWork {
  std::vector<CellPath> paths;
  std::vector<BoneSource> sources;
};

void add_source(std::vector<BoneSource>& of_cell, std::uint16_t bone, const CellSource& source) {
  for (BoneSource& known : of_cell)
    if (known.bone == bone) {
      known.source.conductance += source.conductance;
      known.source.on_scout += source.on_scout;
      return;
    }
  of_cell.push_back({bone, source});
}

// Returns, for each axis, the conductance from a bone's face to the scout cell (the coarser cell that contains a cell),
// relative to the conductance from the face to the cell itself. A scout cell's centre is further from the bone, except
// along axes that are not coarsened.
glm::vec3 scout_shares(const CellGraph& graph) {
  glm::dvec3 spacing = graph.spacing;
  for (int level = 0; level < kScoutCoarsenings; ++level)
    spacing *= glm::dvec3(coarsened_axes(spacing) + glm::i16vec3(1));
  return glm::vec3(graph.spacing / spacing);
}

class SourceFinder {
 public:
  SourceFinder(const BrickWindow::Source& source, const HeatLaw& law, const Armature& armature,
               const std::vector<CellPath>& paths, const std::vector<BoneReach>& reaches, HeatCells& cells)
      : source_(source),
        law_(law),
        paths_(source.volume.grid, cells, paths, armature, reaches),
        cells_(cells),
        share_(scout_shares(cells.graph)) {}

  // Appends the sources of a brick's cells.
  //   work  working memory for each cell, reused from brick to brick
  void find(std::int64_t brick, std::vector<CellWork>& work, std::vector<BoneSource>& found) const {
    const std::int32_t count = cells_.cell_count(brick);
    if (std::ssize(work) < count) work.resize(count);
    for (std::int32_t number = 0; number < count; ++number) {
      const std::int32_t cell = cells_.cell(brick, number);
      work[number].sources.clear();
      paths_.list(cell, work[number].paths);
      for (std::int32_t s = cells_.side_from[cell]; s < cells_.side_from[cell + 1]; ++s) {
        const HeldSide& side = cells_.sides[s];
        add_source(work[number].sources, side.bone,
                   {cell, side.conductance, side.conductance * share_[side.direction >> 1]});
      }
    }
    source_.tissue.for_each(brick, brick + 1, [&](std::int64_t place, const glm::ivec3& v) {
      const std::uint16_t number = cells_.number_in_brick[place];
      if (number == HeatCells::kNoCell) return;
      const std::int32_t cell = cells_.cell(brick, number);
      if (work[number].paths.empty()) return;
      const auto [bone, distance] = paths_.nearest(work[number].paths, v);
      const float g = law_.attraction[source_.volume.at(v)] * law_.volume_of_voxel / (distance * distance);
      cells_.graph.diagonal[cell] += g;
      add_source(work[number].sources, bone, {cell, g, g});
    });
    for (std::int32_t number = 0; number < count; ++number)
      found.insert(found.end(), work[number].sources.begin(), work[number].sources.end());
  }

 private:
  const BrickWindow::Source source_;
  const HeatLaw& law_;
  const PathsToVoxels paths_;
  HeatCells& cells_;
  const glm::vec3 share_;
};
}  // namespace

std::vector<std::vector<CellSource>> sources_of_bones(const BrickWindow::Source& source, const HeatLaw& law,
                                                      const Armature& armature, const std::vector<CellPath>& paths,
                                                      const std::vector<BoneReach>& reaches, HeatCells& cells) {
  const SourceFinder finder(source, law, armature, paths, reaches, cells);
  const auto bricks = std::ssize(source.tissue.bricks());
  std::vector<std::vector<BoneSource>> found((bricks + kGrain - 1) / kGrain);
  parallel_for(bricks, kGrain, [&](std::int64_t begin, std::int64_t end) {
    std::vector<CellWork> work;
    for (std::int64_t brick = begin; brick < end; ++brick) finder.find(brick, work, found[begin / kGrain]);
  });
  std::vector<std::vector<CellSource>> sources(armature.bones.size());
  for (std::vector<BoneSource>& some : found) {
    for (const BoneSource& one : some) sources[one.bone].push_back(one.source);
    some = {};
  }
  return sources;
}

}  // namespace limber
