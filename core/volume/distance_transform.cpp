// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/volume/distance_transform.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>

#include "core/base/parallel.h"
#include "core/volume/float_lanes.h"

namespace limber {

namespace {
constexpr float kInfinity = std::numeric_limits<float>::infinity();
// Number of neighbouring lines along y or z that are processed together, so that memory is read in whole cache lines.
constexpr int kLines = 16;
// Up to this distance to seeds, in voxels along a line, trying all nearer positions of the line takes less time than
// computing the envelope of parabolas. Beyond it, the envelope is computed.
constexpr int kNear = 48;

// Computes the squared distance, mm2, from each voxel of a row to the nearest seed in the row. It takes two sweeps,
// forwards and backwards, that count the voxels since the last seed. `step` is the spacing, mm.
void distance_along_x(const std::uint8_t* seed, float* squared, int count, double step) {
  const int far = std::numeric_limits<int>::max();
  int steps = far;
  for (int x = 0; x < count; ++x) {
    steps = seed[x] ? 0 : steps == far ? far : steps + 1;
    squared[x] = steps == far ? kInfinity : static_cast<float>(steps * step * (steps * step));
  }
  steps = far;
  for (int x = count - 1; x >= 0; --x) {
    steps = seed[x] ? 0 : steps == far ? far : steps + 1;
    if (steps != far) squared[x] = std::min(squared[x], static_cast<float>(steps * step * (steps * step)));
  }
}

// Computes the lower envelope of parabolas, one for each voxel of a line. The members are working memory, which is
// reused from line to line.
struct Envelope {
  std::vector<int> vertex;     // positions in the line of the vertices of the parabolas that form the envelope, rising
  std::vector<double> border;  // position in the line from which parabola k is lower than parabola k - 1

  explicit Envelope(int count) : vertex(count), border(count + 1) {}

  // Computes out[i] = min over j of line[j] + (step (i - j))^2. This adds one dimension to the squared distances
  // `line`.
  void lower(float* line, float* out, int count, double step) {
    const double squared_step = step * step;
    int top = -1;
    for (int j = 0; j < count; ++j) {
      if (line[j] == kInfinity) continue;
      double takes_over = -std::numeric_limits<double>::infinity();
      while (top >= 0) {
        const int i = vertex[top];
        takes_over = 0.5 * (i + j) + (double{line[j]} - line[i]) / (2 * squared_step * (j - i));
        if (takes_over > border[top]) break;
        --top;
      }
      if (top < 0) takes_over = -std::numeric_limits<double>::infinity();
      vertex[++top] = j;
      border[top] = takes_over;
    }
    if (top < 0) {
      std::fill_n(out, count, kInfinity);
      return;
    }
    for (int i = 0, k = 0; i < count; ++i) {
      while (k < top && border[k + 1] < i) ++k;
      const double away = step * (i - vertex[k]);
      out[i] = static_cast<float>(line[vertex[k]] + away * away);
    }
  }
};

using Across = FloatLanes<kLines / 4>;  // the values that kLines lines have at one position

// Computes out[i] = min over j of lines[j] + (step (i - j))^2, by trying all positions j from i outwards until none can
// give less. Returns false, with `out` undefined, if positions more than kNear voxels away would have to be tried.
bool lower_by_trying(const std::vector<Across>& lines, std::vector<Across>& out, int count, double step) {
  for (int i = 0; i < count; ++i) {
    Across lowest = lines[i];
    for (int k = 1; k <= i || k < count - i; ++k) {
      const auto rise = static_cast<float>(step * k * (step * k));
      if (!any_above(lowest, rise)) break;
      if (k > kNear) return false;
      if (k <= i) lower(lowest, lines[i - k], rise);
      if (k < count - i) lower(lowest, lines[i + k], rise);
    }
    out[i] = lowest;
  }
  return true;
}

void lower_by_envelope(const std::vector<Across>& lines, std::vector<Across>& out, int count, double step) {
  Envelope envelope(count);
  std::vector<float> line(count), lowered(count);
  for (int l = 0; l < kLines; ++l) {
    for (int i = 0; i < count; ++i) line[i] = lines[i][l / 4][l % 4];
    envelope.lower(line.data(), lowered.data(), count, step);
    for (int i = 0; i < count; ++i) out[i][l / 4][l % 4] = lowered[i];
  }
}

// Adds the distances along one more axis to the squared distances, in place. There are `width` lines along this axis,
// which start at adjacent values from `first` on. Each line has `count` values, which are `stride` apart in memory.
void distance_along(float* first, int width, std::int64_t stride, int count, double step, std::vector<Across>& lines,
                    std::vector<Across>& out) {
  for (int begin = 0; begin < width; begin += kLines) {
    const int used = std::min(kLines, width - begin);
    bool are_constant = true;
    for (int i = 0; i < count; ++i) {
      const float* from = first + begin + i * stride;
      lines[i].fill(FourFloats{} + from[0]);
      std::memcpy(&lines[i], from, used * sizeof(float));
      are_constant = are_constant && std::memcmp(&lines[i], &lines[0], sizeof(Across)) == 0;
    }
    if (are_constant) continue;
    if (!lower_by_trying(lines, out, count, step)) lower_by_envelope(lines, out, count, step);
    for (int i = 0; i < count; ++i) std::memcpy(first + begin + i * stride, &out[i], used * sizeof(float));
  }
}
}  // namespace

VoxelBox tissue_box(const LabelVolume& volume, int margin) {
  const glm::ivec3 size = volume.grid.size;
  glm::ivec3 low = size, high(-1);
  for (int z = 0; z < size.z; ++z)
    for (int y = 0; y < size.y; ++y) {
      const Label* row = volume.voxels.data() + volume.grid.index({0, y, z});
      int first = 0, last = size.x - 1;
      while (first < size.x && !row[first]) ++first;
      if (first == size.x) continue;
      while (!row[last]) --last;
      low = glm::min(low, glm::ivec3(first, y, z));
      high = glm::max(high, glm::ivec3(last, y, z));
    }
  if (high.x < 0) return {};
  low = glm::max(low - margin, glm::ivec3(0));
  high = glm::min(high + margin, size - 1);
  return {low, high - low + 1};
}

std::vector<float> squared_distance(const VoxelBox& box, const std::vector<std::uint8_t>& seed,
                                    const glm::dvec3& spacing, Progress& progress) {
  const auto [nx, ny, nz] = std::array{box.size.x, box.size.y, box.size.z};
  const std::int64_t slice = std::int64_t{nx} * ny;
  std::vector<float> squared(box.voxel_count());
  if (squared.empty()) return squared;

  // The passes along x and y work slice by slice.
  parallel_for(nz, 1, [&](std::int64_t begin, std::int64_t end) {
    std::vector<Across> lines(ny), out(ny);
    for (std::int64_t z = begin; z < end && !progress.cancelled(); ++z) {
      for (int y = 0; y < ny; ++y)
        distance_along_x(&seed[z * slice + std::int64_t{y} * nx], &squared[z * slice + std::int64_t{y} * nx], nx,
                         spacing.x);
      distance_along(&squared[z * slice], nx, nx, ny, spacing.y, lines, out);
    }
  });
  progress.update("distances", 0.6);

  // The pass along z works row by row.
  parallel_for(ny, 1, [&](std::int64_t begin, std::int64_t end) {
    std::vector<Across> lines(nz), out(nz);
    for (std::int64_t y = begin; y < end && !progress.cancelled(); ++y)
      distance_along(&squared[y * nx], nx, slice, nz, spacing.z, lines, out);
  });
  progress.update("distances", 1);
  return squared;
}

std::vector<float> signed_distance(const VoxelBox& box, const std::vector<std::uint8_t>& body,
                                   const glm::dvec3& spacing, Progress& progress) {
  std::vector<float> distance = squared_distance(box, body, spacing, progress);
  std::vector<std::uint8_t> outside(body.size());
  for (size_t i = 0; i < body.size(); ++i) outside[i] = !body[i];
  const std::vector<float> inward = squared_distance(box, outside, spacing, progress);
  for (size_t i = 0; i < distance.size(); ++i) distance[i] = body[i] ? -std::sqrt(inward[i]) : std::sqrt(distance[i]);
  return distance;
}

}  // namespace limber
