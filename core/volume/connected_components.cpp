// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/volume/connected_components.h"

#include <algorithm>
#include <bit>
#include <cstring>
#include <numeric>
#include <utility>

#include "core/base/error.h"
#include "core/base/parallel.h"
#include "core/volume/label_runs.h"

namespace limber {

namespace {
using Run = Components::Run;

// Returns the first position in the row after `begin` whose label differs from that at `begin`. Compares four voxels at
// a time.
int end_of_run(const Label* row, int begin, int size) {
  const std::uint64_t four = row[begin] * std::uint64_t{0x0001000100010001};
  int x = begin;
  for (std::uint64_t word; x + 4 <= size; x += 4) {
    std::memcpy(&word, row + x, sizeof word);
    if (word != four) return x + std::countr_zero(word ^ four) / 16;
  }
  while (x < size && row[x] == row[begin]) ++x;
  return x;
}

// Returns the runs (stretches of one label along x) of slice z. Writes the number of runs of each row to `runs_in_row`.
//   expected  approximate number of runs in the slice, for which memory is reserved
std::vector<Run> runs_of_slice(const LabelView& volume, const RowSet* in_rows, const LabelSet* of_labels, int z,
                               std::size_t expected, std::int64_t* runs_in_row) {
  std::vector<Run> runs;
  runs.reserve(expected);
  const glm::ivec3 size = volume.grid.size;
  std::vector<Label> room;
  for (int y = 0; y < size.y; ++y) {
    if (in_rows && !(*in_rows)[y + std::int64_t{size.y} * z]) continue;
    const Label* row = volume.row(y, z, room);
    const std::size_t before = runs.size();
    for (int x = end_of_air(row, 0, size.x); x < size.x;) {
      const int begin = x;
      x = end_of_run(row, begin, size.x);
      if (!of_labels || (*of_labels)[row[begin]]) runs.push_back({begin, x, row[begin], 0});
      if (x < size.x && row[x] == 0) x = end_of_air(row, x, size.x);
    }
    runs_in_row[y] = static_cast<std::int64_t>(runs.size() - before);
  }
  return runs;
}

// Returns the root of a run in the union-find forest. While components are sought, Run::component is the run's parent:
// an earlier run, or, for a root, the run itself.
std::int32_t root_of(std::vector<Run>& runs, std::int32_t run) {
  while (runs[run].component != run) run = runs[run].component = runs[runs[run].component].component;
  return run;
}

// Joins the union-find trees that contain runs a and b. The root with the lower index stays the root, so that the root
// of a connected component is its first run.
void join(std::vector<Run>& runs, std::int32_t a, std::int32_t b) {
  if (runs[a].component == runs[b].component) return;
  a = root_of(runs, a);
  b = root_of(runs, b);
  if (a != b) runs[std::max(a, b)].component = std::min(a, b);
}
}  // namespace

Components connected_components(const LabelView& volume, const RowSet* in_rows, const LabelSet* of_labels) {
  const glm::ivec3 size = volume.grid.size;
  const std::int64_t rows = std::int64_t{size.y} * size.z;
  Components result;
  result.first_run.assign(rows + 1, 0);
  std::vector<std::vector<Run>> of_slice(size.z);
  parallel_for(size.z, 4, [&](std::int64_t begin, std::int64_t end) {
    std::size_t expected = 0;
    for (std::int64_t z = begin; z < end; ++z) {
      of_slice[z] =
          runs_of_slice(volume, in_rows, of_labels, static_cast<int>(z), expected, &result.first_run[1 + z * size.y]);
      // For the next slice, expects a quarter more runs than this slice has, to be on the safe side.
      expected = of_slice[z].size() + of_slice[z].size() / 4;
    }
  });
  std::partial_sum(result.first_run.begin(), result.first_run.end(), result.first_run.begin());
  if (result.first_run.back() > INT32_MAX)
    throw Error("the volume is too complex to find its connected components",
                std::to_string(result.first_run.back()) + " runs", "use a coarser spacing");
  result.runs.reserve(result.first_run.back());
  for (auto& runs : of_slice) {
    result.runs.insert(result.runs.end(), runs.begin(), runs.end());
    std::vector<Run>().swap(runs);
  }

  for (std::size_t i = 0; i < result.runs.size(); ++i) result.runs[i].component = static_cast<std::int32_t>(i);
  const auto join_rows = [&](std::int64_t row, std::int64_t other) {
    std::int64_t a = result.first_run[row], b = result.first_run[other];
    const std::int64_t a_end = result.first_run[row + 1], b_end = result.first_run[other + 1];
    const auto join_touching = [&](std::int64_t i, std::int64_t k) {
      const Run &first = result.runs[i], &second = result.runs[k];
      // The comparisons are <= because runs that meet only at a corner touch too: one begins where the other ends.
      if (first.label == second.label && first.begin <= second.end && second.begin <= first.end)
        join(result.runs, static_cast<std::int32_t>(i), static_cast<std::int32_t>(k));
    };
    while (a < a_end && b < b_end) {
      join_touching(a, b);
      const std::int32_t a_stops = result.runs[a].end, b_stops = result.runs[b].end;
      // If the two runs end at the same x, each of them may also touch the next run of the other row, at a corner.
      if (a_stops == b_stops && a + 1 < a_end) join_touching(a + 1, b);
      if (a_stops < b_stops) ++a;
      else ++b;
    }
  };
  for (int z = 0; z < size.z; ++z)
    for (int y = 0; y < size.y; ++y) {
      const std::int64_t row = y + std::int64_t{size.y} * z;
      if (result.first_run[row] == result.first_run[row + 1]) continue;
      if (y > 0) join_rows(row, row - 1);
      if (z > 0)
        for (int k = -1; k <= 1; ++k)
          if (y + k >= 0 && y + k < size.y) join_rows(row, row - size.y + k);
    }

  // A run's parent comes before the run, so its component is known already.
  for (std::size_t i = 0; i < result.runs.size(); ++i) {
    Run& run = result.runs[i];
    if (run.component == static_cast<std::int32_t>(i)) {
      run.component = static_cast<std::int32_t>(result.voxels.size());
      result.voxels.push_back(0);
    } else {
      run.component = result.runs[run.component].component;
    }
    result.voxels[run.component] += run.end - run.begin;
  }
  return result;
}

}  // namespace limber
