// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/viewport/silhouette.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

namespace limber::editor {

namespace {

constexpr std::size_t kShortest = 10;  // outlines with fewer corners are specks and are dropped
constexpr int kSmoothings = 4;         // smoothing passes over an outline; each averages three adjacent corners

// A grid of cells over the picture, surrounded by one row of empty cells. `filled` is 1 for cells that triangles cover.
struct Mask {
  Mask(const Rect& picture, float cell)
      : size(glm::ivec2(glm::ceil(picture.size() / cell)) + 2),
        filled(static_cast<std::size_t>(size.x) * size.y, 0) {}
  std::uint8_t& at(int x, int y) { return filled[static_cast<std::size_t>(y) * size.x + x]; }

  glm::ivec2 size;
  std::vector<std::uint8_t> filled;
};

// Fills all cells whose middle lies in the triangle, and the three cells in which the triangle's corners lie. Without
// the cells of the corners, thin parts of the silhouette would break apart.
void fill(Mask& mask, const std::array<glm::vec2, 3>& p) {
  const glm::vec2 low = glm::min(glm::min(p[0], p[1]), p[2]), high = glm::max(glm::max(p[0], p[1]), p[2]);
  const glm::vec2 last(mask.size - 2);
  if (high.x < 1 || high.y < 1 || low.x > last.x + 1 || low.y > last.y + 1) return;
  for (const glm::vec2& corner : p)
    if (corner.x >= 1 && corner.y >= 1 && corner.x < last.x + 1 && corner.y < last.y + 1)
      mask.at(static_cast<int>(corner.x), static_cast<int>(corner.y)) = 1;
  const auto cross = [](const glm::vec2& a, const glm::vec2& b) { return a.x * b.y - a.y * b.x; };
  const float area = cross(p[1] - p[0], p[2] - p[0]);
  if (area == 0) return;
  const glm::ivec2 first(glm::clamp(glm::floor(low), glm::vec2(1), last)),
      end(glm::clamp(glm::floor(high), glm::vec2(1), last));
  for (int y = first.y; y <= end.y; ++y)
    for (int x = first.x; x <= end.x; ++x) {
      const glm::vec2 middle(x + 0.5f, y + 0.5f);
      const float a = cross(p[1] - p[0], middle - p[0]) / area, b = cross(p[2] - p[1], middle - p[1]) / area,
                  c = cross(p[0] - p[2], middle - p[2]) / area;
      if (a >= 0 && b >= 0 && c >= 0) mask.at(x, y) = 1;
    }
}

// The border lines of the filled cells. A line is stored as steps from one cell corner to the next. Where two filled
// cells touch only in a corner, the line of each cell continues along the same cell.
class Borders {
 public:
  explicit Borders(Mask& mask)
      : width_(mask.size.x + 1),
        next_(static_cast<std::size_t>(width_) * (mask.size.y + 1), {-1, -1}) {
    for (int y = 1; y + 1 < mask.size.y; ++y)
      for (int x = 1; x + 1 < mask.size.x; ++x) {
        if (!mask.at(x, y)) continue;
        if (!mask.at(x, y - 1)) add({x, y}, {x + 1, y});
        if (!mask.at(x + 1, y)) add({x + 1, y}, {x + 1, y + 1});
        if (!mask.at(x, y + 1)) add({x + 1, y + 1}, {x, y + 1});
        if (!mask.at(x - 1, y)) add({x, y + 1}, {x, y});
      }
  }

  std::vector<std::vector<glm::vec2>> lines() {
    std::vector<std::vector<glm::vec2>> lines;
    for (int begin = 0; begin < std::ssize(next_); ++begin)
      while (next_[begin][0] >= 0) {
        std::vector<glm::vec2> line;
        int before = begin;
        for (int at = begin; next_[at][0] >= 0;) {
          line.emplace_back(at % width_, at / width_);
          const int onward = take(at, before);
          before = at;
          at = onward;
        }
        lines.push_back(std::move(line));
      }
    return lines;
  }

 private:
  int place(const glm::ivec2& corner) const { return corner.y * width_ + corner.x; }
  void add(const glm::ivec2& from, const glm::ivec2& to) {
    auto& next = next_[place(from)];
    (next[0] < 0 ? next[0] : next[1]) = place(to);
  }
  int take(int at, int before) {
    auto& next = next_[at];
    // At a corner where two filled cells touch, two steps are possible. Takes the step that turns towards the cell
    // whose border was followed so far, so that the two cells get separate outlines.
    const auto turns_inwards = [&](int to) {
      const glm::ivec2 in(at % width_ - before % width_, at / width_ - before / width_),
          out(to % width_ - at % width_, to / width_ - at / width_);
      return in.x * out.y - in.y * out.x > 0;
    };
    if (next[1] >= 0 && !turns_inwards(next[0])) std::swap(next[0], next[1]);
    const int to = next[0];
    next = {next[1], -1};
    return to;
  }

  int width_;
  std::vector<std::array<int, 2>> next_;
};

std::vector<glm::vec2> smoothed(std::vector<glm::vec2> line) {
  const std::size_t count = line.size();
  for (int pass = 0; pass < kSmoothings; ++pass) {
    std::vector<glm::vec2> mean(count);
    for (std::size_t i = 0; i < count; ++i)
      mean[i] = 0.25f * line[(i + count - 1) % count] + 0.5f * line[i] + 0.25f * line[(i + 1) % count];
    line = std::move(mean);
  }
  return line;
}

}  // namespace

std::vector<std::vector<glm::vec2>> silhouette(const std::vector<glm::vec2>& points,
                                               const std::vector<glm::u32vec3>& corners, const Rect& picture,
                                               float cell) {
  Mask mask(picture, cell);
  std::vector<glm::vec2> in_cells;
  for (const glm::vec2& p : points) in_cells.push_back((p - picture.low) / cell + 1.0f);
  for (const glm::u32vec3& f : corners) {
    const std::array<glm::vec2, 3> triangle{in_cells[f.x], in_cells[f.y], in_cells[f.z]};
    if (std::all_of(triangle.begin(), triangle.end(), [](const glm::vec2& p) { return std::isfinite(p.x + p.y); }))
      fill(mask, triangle);
  }
  std::vector<std::vector<glm::vec2>> lines;
  for (const auto& line : Borders(mask).lines()) {
    if (line.size() < kShortest) continue;
    const std::vector<glm::vec2> smooth = smoothed(line);
    std::vector<glm::vec2> pixels;
    for (std::size_t i = 0; i < smooth.size(); i += 2) pixels.push_back(picture.low + (smooth[i] - 1.0f) * cell);
    lines.push_back(std::move(pixels));
  }
  return lines;
}

}  // namespace limber::editor
