// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/deform/flesh_contact.h"

#include <algorithm>
#include <cmath>

#include "core/base/parallel.h"

namespace limber {

namespace {

constexpr int kGrain = 2048;
// Two points count as flesh in contact only if their distance at rest is at least this multiple of the sum of their
// depths below air. Points that are closer at rest belong to flesh that the pose only compresses or bends.
constexpr double kApart = 1.5;
constexpr double kMostlyBone = 0.2;   // a node with at least this much bone around it counts as bone; in cell volumes
constexpr double kLeastVolume = 0.1;  // cells whose posed volume is below this share of their rest volume are ignored
// A cell in which the depth's gradient is shorter than this, mm per mm, moves no node. A short gradient, as in the
// middle of a limb, does not show the direction to the surface.
constexpr double kLeastSlope = 0.3;
constexpr double kFurthest = 3;  // way_apart() shortens longer motions to this, in cell edges
constexpr std::int64_t kMostBins = 8'000'000;

glm::dvec3 middle_of(const FleshCells& cells, std::int64_t cell, const std::vector<glm::dvec3>& at) {
  glm::dvec3 sum(0);
  for (const std::int32_t n : cells.nodes[cell]) sum += at[n];
  return sum / 8.0;
}

}  // namespace

FleshContact::FleshContact(const FleshCells& cells, const TissueDepth& depth, const glm::dvec3& spacing)
    : cells_(cells) {
  depth_.resize(cells.rest.size());
  depth_slope_.resize(cells.nodes.size());
  middle_depth_.resize(cells.nodes.size());
  posed_cells_.resize(cells.nodes.size());
  parallel_for(std::ssize(depth_), kGrain, [&](std::int64_t first, std::int64_t last) {
    for (auto n = first; n < last; ++n) depth_[n] = static_cast<float>(depth(cells.rest[n] / spacing));
  });
  parallel_for(std::ssize(cells.nodes), kGrain, [&](std::int64_t first, std::int64_t last) {
    for (auto c = first; c < last; ++c) {
      glm::dvec3 slope(0);
      double sum = 0;
      for (int i = 0; i < 8; ++i) {
        const double deep = depth_[cells.nodes[c][i]];
        slope += deep * glm::dvec3(i & 1 ? 1 : -1, i & 2 ? 1 : -1, i & 4 ? 1 : -1) / (4.0 * cells.edge);
        sum += deep;
      }
      depth_slope_[c] = glm::vec3(slope);
      middle_depth_[c] = static_cast<float>(sum / 8);
    }
  });
}

void FleshContact::look(const std::vector<glm::dvec3>& posed) {
  posed_ = posed;
  std::vector<std::pair<glm::ivec3, glm::ivec3>> boxes(cells_.nodes.size());
  glm::dvec3 lowest(INFINITY), highest(-INFINITY);
  for (const glm::dvec3& at : posed) lowest = glm::min(lowest, at), highest = glm::max(highest, at);
  first_ = lowest;
  for (bin_ = std::cbrt(cells_.edge.x * cells_.edge.y * cells_.edge.z);; bin_ *= 2) {
    bins_ = glm::ivec3(glm::min(glm::floor((highest - lowest) / bin_) + 1.0, 1e6));
    if (double(bins_.x) * bins_.y * bins_.z <= double(kMostBins)) break;
  }
  parallel_for(std::ssize(cells_.nodes), kGrain, [&](std::int64_t first, std::int64_t last) {
    for (auto c = first; c < last; ++c) {
      glm::dvec3 low(INFINITY), high(-INFINITY);
      glm::dmat3 F(0);
      double bone = 0;
      for (int i = 0; i < 8; ++i) {
        const glm::dvec3& at = posed[cells_.nodes[c][i]];
        low = glm::min(low, at), high = glm::max(high, at);
        F += glm::outerProduct(at, glm::dvec3(i & 1 ? 1 : -1, i & 2 ? 1 : -1, i & 4 ? 1 : -1) / (4.0 * cells_.edge));
        bone += cells_.bone[cells_.nodes[c][i]] / 8;
      }
      Cell& cell = posed_cells_[c];
      cell.middle = middle_of(cells_, c, posed);
      cell.is_flesh = glm::determinant(F) > kLeastVolume && bone < kMostlyBone;
      if (cell.is_flesh) cell.rest_from_posed = glm::inverse(F);
      boxes[c] = cell.is_flesh ? std::pair(glm::clamp(bin_of(low), glm::ivec3(0), bins_ - 1),
                                           glm::clamp(bin_of(high), glm::ivec3(0), bins_ - 1))
                               : std::pair(glm::ivec3(0), glm::ivec3(-1));
    }
  });
  fill_bins(boxes);
}

void FleshContact::fill_bins(const std::vector<std::pair<glm::ivec3, glm::ivec3>>& boxes) {
  const auto every = [&](const auto& body) {
    for (std::size_t c = 0; c < boxes.size(); ++c)
      for (int z = boxes[c].first.z; z <= boxes[c].second.z; ++z)
        for (int y = boxes[c].first.y; y <= boxes[c].second.y; ++y)
          for (int x = boxes[c].first.x; x <= boxes[c].second.x; ++x)
            body(place({x, y, z}), static_cast<std::int32_t>(c));
  };
  begin_.assign(std::size_t(bins_.x) * bins_.y * bins_.z + 1, 0);
  every([&](std::size_t bin, std::int32_t) { ++begin_[bin + 1]; });
  for (std::size_t b = 1; b < begin_.size(); ++b) begin_[b] += begin_[b - 1];
  cells_of_bins_.resize(begin_.back());
  std::vector<std::int64_t> end(begin_.begin(), begin_.end() - 1);
  every([&](std::size_t bin, std::int32_t c) { cells_of_bins_[end[bin]++] = c; });
}

std::optional<glm::dvec3> FleshContact::way_apart(std::int32_t node) const {
  const double own = depth_[node];
  if (own <= 0 || cells_.bone[node] >= kMostlyBone) return std::nullopt;
  const glm::dvec3& at = posed_[node];
  const std::size_t bin = place(glm::clamp(bin_of(at), glm::ivec3(0), bins_ - 1));
  double deepest = 0;
  std::optional<glm::dvec3> way;
  for (auto i = begin_[bin]; i < begin_[bin + 1]; ++i) {
    const std::int32_t c = cells_of_bins_[i];
    const Cell& cell = posed_cells_[c];
    const glm::dvec3 in = cell.rest_from_posed * (at - cell.middle);
    if (glm::any(glm::greaterThan(glm::abs(in), cells_.edge * 0.5))) continue;
    const glm::dvec3 rest_middle = (cells_.rest[cells_.nodes[c][0]] + cells_.rest[cells_.nodes[c][7]]) / 2.0;
    const glm::dvec3 off = rest_middle + in - cells_.rest[node];
    const glm::dvec3 slope(depth_slope_[c]);
    const double theirs = middle_depth_[c] + glm::dot(slope, in);
    if (glm::length(off) < kApart * (own + theirs) + 2 * glm::length(cells_.edge)) continue;
    if (theirs <= deepest || glm::length(slope) < kLeastSlope) continue;
    const glm::dvec3 outward = -glm::normalize(glm::transpose(cell.rest_from_posed) * slope);
    const double most = kFurthest * std::min({cells_.edge.x, cells_.edge.y, cells_.edge.z});
    deepest = theirs;
    way = outward * std::min((own + theirs) / 2, most);
  }
  return way;
}

}  // namespace limber
