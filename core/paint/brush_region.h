// SPDX-License-Identifier: AGPL-3.0-or-later
// Finds the tissue voxels that one dab of a brush touches, and the distance of each voxel from the dab's centre.
//
// With Euclidean distance, a dab touches the voxels of a ball. With geodesic distance, it touches each voxel whose
// shortest path inside tissue to the dab's centre is at most as long as the radius. So a dab never crosses air: a dab
// on one finger does not change the finger beside it, however near that finger is.
//
// A voxel is in sight (seen) when a straight line through tissue connects it to the dab's centre; its distance is the
// length of that line. Sight is computed outwards row by row, 64 voxels at a time: a voxel is seen when the voxels
// around its line of sight, one step nearer to the centre, are all seen. Where only some of them are seen, the line is
// walked voxel by voxel. To voxels out of sight, a front of shortest paths spreads from voxel to voxel through faces.
// Each voxel stores the last corner around which its path turns (as in geodesic_front.h, but here the line from that
// corner is walked, because gaps may be as thin as a voxel). Near a seam (a cut between touching tissue) the front
// finds all paths, and none crosses the seam: a dab on a hand does not reach the hip on which the hand lies.
//
// Memory is reused by the next dab. It grows with the ball and not with the volume (except four bytes per brick).
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
  Surface,  // only voxels that share a face with air may change
  ToDepth,  // surface voxels, and voxels whose centre is within `depth_mm` of an air voxel's centre
  Through,
};

// Selects the voxels that a dab may change. Geodesic paths may also lead through voxels that the dab may not change.
struct BrushFilter {
  LabelSet labels;  // labels of the tissues that may change; empty: all
  struct Box {
    // Lowest and highest corner in voxel coordinates, as in ClipBox. Only voxels whose centre is inside may change.
    glm::dvec3 low, high;
  };
  struct Plane {
    // A point of the plane and its normal, world, mm. Voxels on the side to which the normal points may not change.
    glm::dvec3 point, normal;
  };
  std::optional<Box> box;
  std::optional<Plane> plane;
  BrushDepth depth = BrushDepth::Through;
  double depth_mm = 10;
  // Returns true if a voxel may change; `place` is its index in the list of tissue voxels. It is called at most once
  // per voxel, and only for voxels near a dab. Empty: every voxel may change.
  std::function<bool(std::int64_t place, const glm::ivec3& voxel)> allows;
};

// The voxels that a dab touches, brick by brick. The arrays `at`, `cell` and `distance` have one entry for each voxel.
struct Reached {
  struct Brick {
    std::int32_t brick;       // index of the brick in TissueVoxels::bricks()
    std::int32_t begin, end;  // range of the brick's entries in the arrays: begin .. end - 1
  };
  std::vector<Brick> bricks;        // only bricks with touched voxels, sorted by index
  std::vector<std::uint16_t> at;    // the voxel's index in its brick's chunk of weights, ascending
  std::vector<std::uint16_t> cell;  // the voxel's position in its brick: x + 8 y + 64 z
  std::vector<float> distance;      // distance of the voxel from the dab's centre, mm; at most the radius

  std::int64_t size() const { return std::ssize(at); }
};

class BrushReach {
 public:
  // Keeps references to `volume` and `tissue`, which must outlive this object.
  BrushReach(const LabelVolume& volume, const TissueVoxels& tissue, BrushFilter filter = {});

  // Returns the voxels that a dab touches, or none when the dab reaches no tissue. The result is valid until the next
  // dab.
  //   centre  world, mm; geodesic paths start from the nearest tissue voxel, which must be within two voxels
  //   radius  mm, positive
  const Reached& dab(const glm::dvec3& centre, double radius, BrushDistance distance);

  std::int64_t memory_bytes() const;

 private:
  using Mask = std::array<std::uint64_t, 8>;  // one bit for each voxel of a brick, as in TissueVoxels::Brick::mask
  struct Corner {
    float before;       // length of the path from the dab's centre to this corner, mm
    glm::i16vec3 cell;  // voxel of the corner, relative to low_
  };
  struct Front {
    float distance;
    std::int32_t rank;
    glm::i16vec3 cell;
  };
  struct Span {
    std::int32_t first, last;  // first and last x of a row of voxels; no voxels when last < first
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

  // The dab in voxel coordinates. Its window is the box of size_ voxels whose lowest voxel is low_. A window voxel is
  // called a cell; its coordinates are relative to low_.
  glm::dvec3 centre_{0};
  double radius_ = 0;
  glm::ivec3 low_{0}, size_{0}, start_{0};
  std::array<std::vector<float>, 3> squared_;  // squared distance of each position from the centre along each axis, mm2
  std::vector<Span> ball_, grown_ball_;        // x range of the dab's ball, and of a slightly larger ball, in each row
  std::vector<int> bricks_;                    // indices of the bricks that have tissue in the window
  const Seams* seams_ = nullptr;               // the tissue's seams if one is near the window, else null

  // Bits of all window voxels, in rows of words_ words. Bit 0 of a row is at x = x0_, a multiple of eight. The three
  // lists mark the voxels that are tissue, in sight (seen) and out of sight (far).
  int x0_ = 0, words_ = 0;
  std::vector<std::uint64_t> tissue_rows_, seen_rows_, far_rows_;
  // Bits of the voxels in one half of the window, in rows. The bit of a voxel has the position |x - start_.x| in its
  // row.
  int half_words_ = 0;
  std::vector<std::uint64_t> half_tissue_, half_seen_, certain_, possible_;
  // Values of the voxels out of sight, in the order of their bits in far_rows_. The rank of a voxel is its index in
  // this order.
  std::vector<std::int32_t> far_rank_;  // rank of the first voxel in each word of far_rows_
  std::vector<float> far_distance_;
  std::vector<Corner> far_corner_;
  std::vector<std::vector<Front>> bucket_;
  float per_bucket_ = 0;
  std::size_t this_bucket_ = 0;

  std::vector<std::int32_t> allowed_of_;  // index of each brick in allowed_; -1: not computed yet
  std::vector<Mask> allowed_;
  Reached reached_;
};

}  // namespace limber
