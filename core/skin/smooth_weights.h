// SPDX-License-Identifier: AGPL-3.0-or-later
// The weights around a brush as they would be had they spread through the tissue like heat. How far is a width in
// millimetres, so it looks the same at any spacing of voxels. Weights spread through the faces of tissue voxels, not
// through air, and not across seams.
//
// Tissue is taken in cells of up to 8^3 voxels that are somewhat smaller than the width: each holds the mean weights of
// voxels that hang together. Explicit steps of the heat equation spread them from cell to cell; between the middles of
// cells weights are linear. So a dab costs about as much at 1 mm as at 2 mm.
#pragma once

#include <array>
#include <functional>
#include <vector>

#include "core/skin/neighbour_weights.h"

namespace limber {

class SmoothWeights {
 public:
  // The reference is kept.
  //   spacing  mm of a voxel along each axis
  SmoothWeights(const TissueVoxels& tissue, const glm::dvec3& spacing);

  // Spreads the weights of some bricks; nothing comes from other bricks.
  //   bricks    as in TissueVoxels::bricks(), each once
  //   width     mm: standard deviation of the Gauss curve that a single place spreads to along each axis
  //   weights   (brick) -> its weights as they are
  void spread(const std::vector<int>& bricks, double width, const std::function<InfluenceView(int brick)>& weights);

  // Adds the weights at a voxel to `sum`, which is empty, in any unit.
  //   brick  one of the bricks that were spread last
  //   cell   of the voxel in the brick: x + 8 y + 64 z; tissue
  void at(int brick, int cell, WeightSum& sum) const;

  // Whether all tissue of the bricks follows one bone alone: then there is nothing to spread.
  bool is_uniform() const { return bones_.size() < 2; }

 private:
  static constexpr int kBrick = TissueVoxels::kBrick, kVoxels = kBrick * kBrick * kBrick;
  static constexpr std::int32_t kNone = -1;

  struct Link {
    std::int32_t from, to;
    int direction;  // 0 towards lower x, 1 towards higher x, 2 and 3 along y, 4 and 5 along z
    int faces;
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
  glm::ivec3 edge_{1};                               // of a cell, voxels
  std::vector<std::int32_t> slot_of_;                // by brick: its place among those that were spread, or kNone
  std::vector<int> spread_;                          // bricks
  std::vector<std::int32_t> cell_of_;                // by slot and voxel; kNone for air
  std::vector<std::int32_t> voxels_in_;              // by cell
  std::vector<std::array<std::int32_t, 6>> beside_;  // by cell and direction: with which it shares most faces, or kNone
  std::vector<Link> links_;                          // rising by `from`
  std::vector<std::int32_t> first_link_;             // by cell, and one more
  std::vector<int> bones_;                           // that weigh anything here
  std::vector<float> weight_, next_;                 // by cell and place in bones_
};

}  // namespace limber
