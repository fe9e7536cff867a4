// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/deform/depth.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/base/parallel.h"

namespace limber {

namespace {

constexpr int kBrick = TissueVoxels::kBrick;

// One run of tissue along a line, with air (height zero) just before and just after it. Replaces every height f[i] by the
// least of f[j] + (i - j)^2 spacing^2.
class LowerEnvelope {
 public:
  explicit LowerEnvelope(double spacing) : squared_spacing_(spacing * spacing) {}

  void apply(float* f, int count) {
    prepare(count + 2);
    push(-1, 0);
    for (int i = 0; i < count; ++i)
      if (f[i] < std::numeric_limits<float>::max()) push(i, f[i]);
    push(count, 0);
    const Parabola* at = envelope_.data();
    const Parabola* last = at + size_ - 1;
    for (int i = 0; i < count; ++i) {
      while (at < last && at[1].from <= i) ++at;
      const double away = i - at->place;
      f[i] = static_cast<float>(at->height + squared_spacing_ * away * away);
    }
  }

 private:
  struct Parabola {
    double place, height, from;  // it is the lowest from there on, until the next is
  };

  void prepare(int count) {
    size_ = 0;
    if (std::ssize(envelope_) < count) envelope_.resize(count);
    for (int steps = static_cast<int>(slope_.size()); steps <= count; ++steps) slope_.push_back(1 / (2 * squared_spacing_ * steps));
  }

  // A parabola at `place`, right of all others; those it lies below everywhere from their own start on go.
  void push(int place, double height) {
    double from = -std::numeric_limits<double>::infinity();
    while (size_ > 0) {
      const Parabola& last = envelope_[size_ - 1];
      const int steps = place - static_cast<int>(last.place);
      from = (height - last.height) * slope_[steps] + (last.place + 0.5 * steps);
      if (from > last.from) break;
      --size_;
    }
    envelope_[size_++] = {double(place), height, from};
  }

  double squared_spacing_;
  int size_ = 0;
  std::vector<Parabola> envelope_;
  std::vector<double> slope_;  // by steps between two places
};

// The same where nothing is known yet but the run itself: the nearer end is nearest.
void distances_from_ends(float* f, int count, double squared_spacing) {
  for (int i = 0; i < count; ++i) {
    const double steps = std::min(i + 1, count - i);
    f[i] = static_cast<float>(squared_spacing * steps * steps);
  }
}

}  // namespace

TissueDepth::TissueDepth(const TissueVoxels& tissue, const glm::dvec3& spacing)
    : tissue_(&tissue), depth_(tissue.bricks().size() * kBrickVoxels) {
  for (size_t b = 0; b < tissue.bricks().size(); ++b)
    for (int i = 0; i < kBrickVoxels; ++i)
      depth_[b * kBrickVoxels + i] = tissue.bricks()[b].mask[i >> 6] >> (i & 63) & 1 ? std::numeric_limits<float>::max() : 0;
  for (int axis = 0; axis < 3; ++axis) pass(axis, spacing[axis]);
  for (float& d : depth_) d = std::sqrt(d);
}

// Columns of bricks along the axis, cut where a brick has no tissue; 64 lines in each.
void TissueDepth::pass(int axis, double spacing) {
  const int u = (axis + 1) % 3, v = (axis + 2) % 3;
  const glm::ivec3 bricks = tissue_->brick_grid();
  const int strides[] = {1, kBrick, kBrick * kBrick};
  parallel_for(std::int64_t{bricks[u]} * bricks[v], 4, [&](std::int64_t begin, std::int64_t end) {
    LowerEnvelope envelope(spacing);
    std::vector<int> column;
    std::vector<float> line;
    auto lines = [&] {
      line.resize(column.size() * kBrick);
      for (int l = 0; l < kBrick * kBrick && !column.empty(); ++l) {
        const int place = (l % kBrick) * strides[u] + (l / kBrick) * strides[v];
        copy_line(column, place, strides[axis], line, Gather);
        for (size_t i = 0; i < line.size();) {
          size_t stop = i;
          while (stop < line.size() && line[stop] > 0) ++stop;
          const int run = static_cast<int>(stop - i);
          if (run > 0 && axis == 0) distances_from_ends(&line[i], run, spacing * spacing);
          if (run > 0 && axis != 0) envelope.apply(&line[i], run);
          i = stop + 1;
        }
        copy_line(column, place, strides[axis], line, Scatter);
      }
      column.clear();
    };
    for (auto c = begin; c < end; ++c) {
      glm::ivec3 at(0);
      at[u] = static_cast<int>(c % bricks[u]);
      at[v] = static_cast<int>(c / bricks[u]);
      for (; at[axis] < bricks[axis]; ++at[axis]) {
        const int brick = tissue_->brick_at(at * kBrick);
        if (brick >= 0)
          column.push_back(brick);
        else
          lines();
      }
      lines();
    }
  });
}

// Line `place` of a column of bricks, out of the bricks or back into them.
void TissueDepth::copy_line(const std::vector<int>& column, int place, int stride, std::vector<float>& line, Direction direction) {
  float* at = line.data();
  for (const int brick : column) {
    float* in_brick = &depth_[std::int64_t{brick} * kBrickVoxels + place];
    for (int i = 0; i < kBrick; ++i, ++at, in_brick += stride) (direction == Gather ? *at : *in_brick) = direction == Gather ? *in_brick : *at;
  }
}

double TissueDepth::operator()(const glm::dvec3& rest) const {
  const glm::dvec3 low = glm::floor(rest), f = rest - low;
  const glm::ivec3 v(low);
  double depth = 0;
  for (int k = 0; k < 8; ++k) {
    const glm::ivec3 corner(k & 1, k >> 1 & 1, k >> 2);
    const double share = (corner.x ? f.x : 1 - f.x) * (corner.y ? f.y : 1 - f.y) * (corner.z ? f.z : 1 - f.z);
    if (share > 0) depth += share * at_voxel(v + corner);
  }
  return depth;
}

}  // namespace limber
