// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/seams/cheapest_cut.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "core/base/parallel.h"
#include "core/bones/min_cut.h"

namespace limber {

namespace {

constexpr std::int64_t kNodes = 4096;  // voxels of the band per block of a parallel loop
constexpr int kCostUnit = 1024;
constexpr std::int32_t kCertain = 1 << 30;
// Cost of cutting through the border of a bridge (tissue between the skins of two limbs), relative to connective
// tissue.
constexpr double kBridge = 0.5;

// Cost of cutting through the tissues of each Layer, relative to connective tissue. Skin costs as much as connective
// tissue. Where skin is segmented only at the air, the sheet of skin between two limbs continues as connective tissue,
// and the cut should follow the middle of both.
constexpr std::array<double, kLayers> kCostOfLayer{1, 3, 6, 12};
double cost_of(TissueKind kind) { return kCostOfLayer[static_cast<int>(layer_of(kind))]; }

bool is_sheet(TissueKind kind) { return layer_of(kind) == Layer::Sheet; }

class CheapestCut {
 public:
  CheapestCut(const SeamBand& band, const LabelVolume& volume, const std::vector<TissueKind>& kinds, const Seams& seams,
              const SkinLayers& of_limb, const SkinLayers& of_other)
      : band_(band),
        volume_(volume),
        kinds_(kinds),
        seams_(seams),
        of_limb_(of_limb),
        of_other_(of_other),
        layer_(layers_of(kinds)) {
    layer_[0] = Layer::Deep;
  }

  std::vector<std::uint8_t> run() const {
    const std::vector<double> cost = costs();
    const std::vector<std::int32_t> rank = ranks();
    CutGraph<6> graph{std::vector<std::array<std::int32_t, 6>>(rank.size()),
                      std::vector<std::array<std::int32_t, 6>>(rank.size()), std::vector<std::int32_t>(rank.size())};
    const glm::dvec3 s = volume_.grid.spacing, area(s.y * s.z, s.x * s.z, s.x * s.y);
    const double smallest = std::min({area.x, area.y, area.z});
    const auto set_capacities = [&](std::int32_t n) {
      for (int e = 0; e < 6; ++e) graph.neighbour[rank[n]][e] = band_.beside[n][e] < 0 ? -1 : rank[band_.beside[n][e]];
      graph.terminal[rank[n]] = band_.side[n] == Side::Limb ? kCertain : band_.side[n] == Side::Other ? -kCertain : 0;
      for (int axis = 0; axis < 3; ++axis) {
        const int up = SeamBand::edge_up(axis), down = 5 - up;
        const std::int32_t m = band_.beside[n][up];
        if (m < 0 || (band_.side[n] != Side::Free && band_.side[m] != Side::Free))
          continue;  // no cut can change the side of either voxel
        const SurfaceCost here = cost_as_surface(cost[n], band_.nodes[n].voxel, 2 * axis);
        const SurfaceCost beyond = cost_as_surface(cost[m], band_.nodes[m].voxel, 2 * axis + 1);
        const double unit = kCostUnit * area[axis] / smallest;
        const auto capacity = [&](double surface) {
          return std::max(1, static_cast<int>(std::lround(unit * surface)));
        };
        graph.capacity[rank[n]][up] = capacity(here.of_limb + beyond.of_other);
        graph.capacity[rank[m]][down] = capacity(beyond.of_limb + here.of_other);
      }
    };
    parallel_for(std::ssize(band_.nodes), kNodes, [&](std::int64_t begin, std::int64_t end) {
      for (std::int64_t n = begin; n < end; ++n) set_capacities(static_cast<std::int32_t>(n));
    });
    const std::vector<std::uint8_t> inside = min_cut(std::move(graph));
    std::vector<std::uint8_t> result(inside.size());
    for (size_t n = 0; n < rank.size(); ++n) result[n] = inside[rank[n]];
    return result;
  }

 private:
  using Side = SeamBand::Side;

  // Returns, for each voxel of the band, its rank in the order of the list of tissue voxels. In this order most
  // neighbours are near in memory, which cuts the time of the search for the cut by a quarter.
  std::vector<std::int32_t> ranks() const {
    std::vector<std::int32_t> order(band_.nodes.size()), rank(order.size());
    std::iota(order.begin(), order.end(), 0);
    std::sort(order.begin(), order.end(),
              [&](std::int32_t a, std::int32_t b) { return band_.nodes[a].place < band_.nodes[b].place; });
    for (size_t k = 0; k < order.size(); ++k) rank[order[k]] = static_cast<std::int32_t>(k);
    return rank;
  }

  // Returns how deep each voxel of the band lies inside a sheet of tissue: the distance to the nearest voxel of the
  // band outside the sheet, in units of the shortest voxel edge. The value is 0 outside the sheet.
  //   is_of_sheet  returns true if voxel n of the band lies in a sheet
  template <class IsOfSheet>
  std::vector<float> depth_in_sheets(const IsOfSheet& is_of_sheet) const {
    std::vector<float> depth(band_.nodes.size(), std::numeric_limits<float>::infinity());
    std::vector<std::int32_t> open;
    for (size_t n = 0; n < band_.nodes.size(); ++n)
      if (!is_of_sheet(n)) {
        depth[n] = 0;
        open.push_back(static_cast<std::int32_t>(n));
      }
    const glm::dvec3 spacing = volume_.grid.spacing;
    const glm::vec3 step(spacing / std::min({spacing.x, spacing.y, spacing.z}));
    for (size_t i = 0; i < open.size(); ++i)
      for (int edge = 0; edge < 6; ++edge) {
        const std::int32_t node = band_.beside[open[i]][edge];
        const float way = depth[open[i]] + step[SeamBand::axis_of(edge)];
        if (node < 0 || depth[node] <= way) continue;
        depth[node] = way;
        open.push_back(node);
      }
    for (float& d : depth)
      if (d == std::numeric_limits<float>::infinity()) d = 0;
    return depth;
  }

  // Returns the cost of cutting through each voxel of the band. The cost falls with the depth inside a sheet (skin and
  // connective tissue), so that the cut follows the sheet's middle. In a bridge the cost falls with the third power of
  // the depth, because a bridge is short.
  std::vector<double> costs() const {
    const std::vector<float> in_sheet = depth_in_sheets([&](std::size_t n) { return is_sheet(kind_of(n)); });
    const std::vector<float> in_bridge = depth_in_sheets([&](std::size_t n) { return band_.is_bridge[n] != 0; });
    std::vector<double> cost(band_.nodes.size());
    for (size_t n = 0; n < band_.nodes.size(); ++n) {
      cost[n] = band_.is_bridge[n] ? kBridge / std::pow(1 + in_bridge[n], 3) : cost_of(kind_of(n)) / (1 + in_sheet[n]);
    }
    return cost;
  }

  // Cost of a cut that makes a voxel part of the limb's surface (of_limb), or part of the surface of the body part that
  // the limb touches (of_other).
  struct SurfaceCost {
    double of_limb, of_other;
  };

  // Returns the cost of a cut that makes v a surface voxel; the flesh lies in the direction `inward`. If fat or muscle
  // is less deep below this surface than it usually is below skin at the air, the cost is higher than `own_cost`. The
  // depth of bone is ignored, because bone lies near the skin in a hand but deep in a thigh. Only the first voxel of
  // fat and the first of muscle count, since deeper voxels tell less about where the surface belongs.
  SurfaceCost cost_as_surface(double own_cost, glm::ivec3 v, int inward) const {
    const int axis = inward >> 1, step = inward & 1 ? 1 : -1, last = inward & 1 ? volume_.grid.size[axis] - 1 : 0;
    const int steps = std::min(std::max(of_limb_.reach(axis), of_other_.reach(axis)) - 1, step * (last - v[axis]));
    const Label* label = &volume_.voxels[volume_.grid.index(v)];
    SurfaceCost cost{own_cost, own_cost};
    Layer met = Layer::Sheet;
    for (int k = 1; k <= steps && met < Layer::Muscle; ++k, v[axis] += step) {
      if (has_seams_ && seams_.is_cut_towards(v, inward)) break;
      label += step * stride_[axis];
      const Layer deepest = layer_[*label];
      if (deepest == Layer::Deep) break;
      for (const Layer layer : {Layer::Fat, Layer::Muscle}) {
        if (layer <= met || layer > deepest) continue;
        const double most = kCostOfLayer[static_cast<int>(layer)];
        cost.of_limb = std::max(cost.of_limb, most * of_limb_.surprise(axis, layer, k));
        cost.of_other = std::max(cost.of_other, most * of_other_.surprise(axis, layer, k));
      }
      met = std::max(met, deepest);
    }
    return cost;
  }

  TissueKind kind_of(std::size_t n) const { return kinds_[volume_.at(band_.nodes[n].voxel)]; }

  const SeamBand& band_;
  const LabelVolume& volume_;
  const std::vector<TissueKind>& kinds_;
  const Seams& seams_;
  const bool has_seams_ = !seams_.empty();
  const SkinLayers &of_limb_, &of_other_;
  std::vector<Layer> layer_;  // layer of each label; air counts as Deep, so that it ends a ray
  const std::array<std::int64_t, 3> stride_{1, volume_.grid.size.x,
                                            std::int64_t{volume_.grid.size.x} * volume_.grid.size.y};
};

}  // namespace

std::vector<std::uint8_t> cheapest_cut(const SeamBand& band, const LabelVolume& volume,
                                       const std::vector<TissueKind>& kinds, const Seams& seams,
                                       const SkinLayers& of_limb, const SkinLayers& of_other) {
  return CheapestCut(band, volume, kinds, seams, of_limb, of_other).run();
}

}  // namespace limber
