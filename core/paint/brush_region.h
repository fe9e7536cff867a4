// SPDX-License-Identifier: AGPL-3.0-or-later
// Which tissue voxels one dab of a brush touches, and how far each lies from the dab's centre.
//
// Euclidean: the ball. Geodesic: the shortest way inside the tissue, so that a dab never crosses air: between two
// fingers nothing changes on the other side, however near it is. What is seen from the centre in a straight line of
// tissue has its straight distance; visibility spreads outwards row by row, 64 voxels at a time: a voxel is seen when
// those that surround its line of sight one step nearer are, and where these differ the line is walked. Behind corners
// a front goes on from voxel to voxel through faces, each remembering the corner its way last came round (as
// geodesic_front.h, but here the way from the corner is walked, since gaps may be as thin as a voxel). Near a seam of
// the tissue the front alone finds ways, and none crosses it: a dab on a hand does not reach the hip that it lies on.
//
// All memory is kept between dabs and follows the ball, not the volume (but for four bytes a brick).
#pragma once

#include <array>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "core/volume/tissue_voxels.h"

namespace limber {

enum class BrushDistance { Euclidean, Geodesic };

enum class BrushDepth {
  Surface,  // voxels that have air beside them
  ToDepth,  // and those whose centre lies at most `depth_mm` from the centre of an air voxel
  Through,
};

// What a dab may change. Ways lead through other tissue all the same.
struct BrushFilter {
  LabelSet labels;  // empty: every tissue
  struct Box {
    glm::dvec3 low, high;  // voxel coordinates, as in ClipBox: voxels whose centres lie inside may change
  };
  struct Plane {
    glm::dvec3 point, normal;  // world, mm: what lies on the side that the normal points to may not change
  };
  std::optional<Box> box;
  std::optional<Plane> plane;
  BrushDepth depth = BrushDepth::Through;
  double depth_mm = 10;
  // Asked at most once for each voxel that a dab comes near; empty: every voxel.
  std::function<bool(std::int64_t place, const glm::ivec3& voxel)> allows;
};

// Voxels touched, brick by brick; arrays of equal length.
struct Reached {
  struct Brick {
    std::int32_t brick;       // as in TissueVoxels::bricks()
    std::int32_t begin, end;  // of the arrays
  };
  std::vector<Brick> bricks;        // each once, in order, none empty
  std::vector<std::uint16_t> at;    // in the brick's chunk, growing
  std::vector<std::uint16_t> cell;  // in the brick: x + 8 y + 64 z
  std::vector<float> distance;      // mm, at most the radius

  std::int64_t size() const { return std::ssize(at); }
};

class BrushReach {
 public:
  // References are kept.
  BrushReach(const LabelVolume& volume, const TissueVoxels& tissue, BrushFilter filter = {});

  // Valid until the next dab. Nothing where no tissue is within reach.
  //   centre  world, mm; geodesic ways start from the tissue voxel nearest to it, which must be within two voxels
  //   radius  mm, positive
  const Reached& dab(const glm::dvec3& centre, double radius, BrushDistance distance);

  std::int64_t memory_bytes() const;

 private:
  using Mask = std::array<std::uint64_t, 8>;  // of a brick, as TissueVoxels::Brick::mask
  struct Corner {
    float before;       // mm from the centre
    glm::i16vec3 cell;  // of the window
  };
  struct Front {
    float distance;
    std::int32_t rank;
    glm::i16vec3 cell;
  };
  struct Span {
    std::int32_t first, last;  // x; none where last < first
  };

  bool find_start();
  bool place_window(double radius, bool grown);
  void place_ball(double radius, std::vector<Span>& ball) const;
  std::uint64_t ball_word(const std::vector<Span>& ball, const glm::ivec3& corner, int z) const;
  std::uint64_t window_word(const std::vector<std::uint64_t>& rows, const glm::ivec3& corner, int z) const;

  void need_allowed();
  Mask allowed_by_filter(int brick) const;
  Mask surface_of(int brick) const;
  void keep_shallow(std::span<const int> bricks);

  void gather_tissue();
  void see(int side);
  void see_row(int side, int y, int z);
  bool line_is_clear(const glm::ivec3& from, const glm::ivec3& to) const;
  const Seams* seams_near() const;
  void see_start();
  bool line_crosses_no_seam(const glm::ivec3& from, const glm::ivec3& to) const;
  bool is_joined(const glm::ivec3& cell, int axis, int step) const;
  bool find_far();
  void start_behind(const glm::ivec3& cell);
  bool is_open(const glm::ivec3& cell, const glm::ivec3& step) const;
  void offer(const glm::ivec3& cell, float distance, float before, const glm::ivec3& corner);
  void spread_behind_corners();
  bool is_set(const std::vector<std::uint64_t>& rows, const glm::ivec3& cell) const;
  std::int32_t rank_of(const glm::ivec3& cell) const;
  float from_centre(const glm::ivec3& cell) const;
  float between(const glm::ivec3& a, const glm::ivec3& b) const;

  void emit_euclidean();
  void emit_geodesic();
  void emit(int brick, const Mask& touched, const Mask* far);

  const LabelVolume& volume_;
  const TissueVoxels& tissue_;
  BrushFilter filter_;
  bool filtered_;
  AffineTransform voxel_from_world_;

  // The dab in voxel coordinates; cells count from low_.
  glm::dvec3 centre_{0};
  double radius_ = 0;
  glm::ivec3 low_{0}, size_{0}, start_{0};
  std::array<std::vector<float>, 3> squared_;  // of each coordinate, mm2 from the centre
  std::vector<Span> ball_, grown_ball_;        // a row
  std::vector<int> bricks_;                    // with tissue in the window
  const Seams* seams_ = nullptr;               // where one is near the window; ways do not cross it

  // Rows of bits of the window, word by word; bit 0 is x = x0_, a multiple of eight.
  int x0_ = 0, words_ = 0;
  std::vector<std::uint64_t> tissue_rows_, seen_rows_, far_rows_;
  // One half of the window, bit |x - start|.
  int half_words_ = 0;
  std::vector<std::uint64_t> half_tissue_, half_seen_, certain_, possible_;
  // Voxels that are not seen, in the order of far_rows_.
  std::vector<std::int32_t> far_rank_;  // of the first of each word
  std::vector<float> far_distance_;
  std::vector<Corner> far_corner_;
  std::vector<std::vector<Front>> bucket_;
  float per_bucket_ = 0;
  std::size_t this_bucket_ = 0;

  std::vector<std::int32_t> allowed_of_;  // #bricks, place in allowed_ or -1
  std::vector<Mask> allowed_;
  Reached reached_;
};

}  // namespace limber
