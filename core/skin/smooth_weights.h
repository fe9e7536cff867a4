// SPDX-License-Identifier: AGPL-3.0-or-later
// Smooths the weights around a brush by spreading them through the tissue like heat. The width of the spread is in
// millimetres, so the result looks the same at any voxel spacing. Weights spread through the faces of tissue voxels,
// but not through air and not across seams (cuts between touching tissue).
//
// The tissue is divided into cells of up to 8^3 voxels, somewhat smaller than the width. A cell holds the mean weights
// of connected voxels. Explicit steps of the heat equation spread the weights from cell to cell. Weights are then
// interpolated linearly between the centres of cells. As a result, a dab costs about as much at 1 mm as at 2 mm.
#pragma once

#include <array>
#include <functional>
#include <vector>

#include "core/skin/neighbour_weights.h"

namespace limber {

class SmoothWeights {
 public:
  //   tissue   must outlive this object
  //   spacing  size of a voxel along each axis, mm
  SmoothWeights(const TissueVoxels& tissue, const glm::dvec3& spacing);

  // Spreads the weights inside the given bricks. The weights of other bricks have no effect.
  //   bricks    indices in TissueVoxels::bricks(), each at most once
  //   width     standard deviation of the Gaussian that a single weighted point becomes, mm
  //   weights   a function that returns the current weights of the brick with a given index
  void spread(const std::vector<int>& bricks, double width, const std::function<InfluenceView(int brick)>& weights);

  // Writes the spread weights of a tissue voxel to `sum`, which must be empty. Their sum is arbitrary: only their
  // proportions matter.
  //   brick  one of the bricks of the last spread()
  //   cell   the voxel's index in the brick: x + 8 y + 64 z
  void at(int brick, int cell, WeightSum& sum) const;

  // Returns true if all tissue of the last spread() follows a single bone, so that there is nothing to smooth.
  bool is_uniform() const { return bones_.size() < 2; }

 private:
  static constexpr int kBrick = TissueVoxels::kBrick, kVoxels = kBrick * kBrick * kBrick;
  static constexpr std::int32_t kNone = -1;

  struct Link {
    std::int32_t from, to;
    int direction;  // 0 towards lower x, 1 towards higher x, 2 and 3 along y, 4 and 5 along z
    int faces;      // number of voxel faces that the two cells share
  };

  void choose_cells(double width);
  void find_cells(const std::vector<int>& bricks);
  void flood(const glm::ivec3& voxel, const TissueVoxels::Brick& brick, std::int32_t* cell_of, std::int32_t cell);
  void sum_weights(const std::vector<int>& bricks, const std::function<InfluenceView(int brick)>& weights);
  void link_cells(const std::vector<int>& bricks);
  void take_steps(double width);
  std::array<std::int32_t, 8> corners_around(std::int32_t cell, const glm::ivec3& towards) const;

  bool is_cut(const glm::ivec3& voxel, int direction) const {
    return tissue_.seams() && tissue_.seams()->is_cut_towards(voxel, direction);
  }

  const TissueVoxels& tissue_;
  const glm::dvec3 spacing_;
  glm::ivec3 edge_{1};                   // edge lengths of a cell, in voxels
  std::vector<std::int32_t> slot_of_;    // index of each brick in spread_; kNone: not in the last spread()
  std::vector<int> spread_;              // the bricks of the last spread()
  std::vector<std::int32_t> cell_of_;    // cell of each voxel of the bricks in spread_; kNone: air
  std::vector<std::int32_t> voxels_in_;  // number of voxels in each cell
  // Neighbouring cell of each cell in each direction; kNone: none. If there are several, the one that shares the most
  // voxel faces.
  std::vector<std::array<std::int32_t, 6>> beside_;
  std::vector<Link> links_;               // pairs of neighbouring cells, sorted by `from`
  std::vector<std::int32_t> first_link_;  // index of each cell's first link in links_; one entry more at the end
  std::vector<int> bones_;                // bones that have weight in the bricks of the last spread()
  std::vector<float> weight_, next_;      // weights of each cell, in the order of bones_; next_: after the current step
};

}  // namespace limber
