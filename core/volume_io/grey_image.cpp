// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/volume_io/grey_image.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>

#include "core/base/error.h"
#include "core/base/parallel.h"
#include "core/volume/neighbour_changes.h"

namespace limber {

namespace {

constexpr float kOutside = std::numeric_limits<float>::quiet_NaN();

bool is_mostly_named(const TissueTable& tissues) {
  const auto named = std::count_if(tissues.tissues.begin(), tissues.tissues.end(),
                                   [](const Tissue& tissue) { return !tissue.name.empty(); });
  return 2 * named > std::ssize(tissues.tissues);
}

float nearest(const GreyVolume& volume, const glm::dvec3& place) {
  const glm::ivec3 voxel(glm::floor(place + 0.5));
  return volume.grid.contains(voxel) ? volume.voxels[static_cast<std::size_t>(volume.grid.index(voxel))] : kOutside;
}

// The part of the line start + t * step that lies inside the volume: t in [from, to]. It is empty when `from` exceeds
// `to`.
struct Stretch {
  double from, to;
};
Stretch inside(const Grid& grid, const glm::dvec3& start, const glm::dvec3& step, double steps) {
  Stretch part{0, steps};
  for (int axis = 0; axis < 3; ++axis) {
    const double low = -0.5 - start[axis], high = grid.size[axis] - 0.5 - start[axis];
    if (std::abs(step[axis]) < 1e-12) {
      if (low > 0 || high < 0) return {1, 0};
      continue;
    }
    const double a = low / step[axis], b = high / step[axis];
    part.from = std::max(part.from, std::min(a, b));
    part.to = std::min(part.to, std::max(a, b));
  }
  return part;
}

// Returns a picture. Each pixel is value(p), where p is the pixel's centre in voxel coordinates.
template <class Value>
std::vector<float> picture(const GreyVolume& volume, const GreyFrame& frame, const Value& value) {
  std::vector<float> pixels(static_cast<std::size_t>(frame.size.x) * static_cast<std::size_t>(frame.size.y));
  const AffineTransform to_voxel = voxel_from_world(volume.grid);
  parallel_for(frame.size.y, 4, [&](std::int64_t first, std::int64_t last) {
    for (std::int64_t y = first; y < last; ++y)
      for (int x = 0; x < frame.size.x; ++x) {
        const double right = (x + 0.5 - 0.5 * frame.size.x) * frame.millimetres_per_pixel;
        const double down = (double(y) + 0.5 - 0.5 * frame.size.y) * frame.millimetres_per_pixel;
        pixels[static_cast<std::size_t>(y * frame.size.x + x)] =
            value(to_voxel * (frame.middle + frame.right * right + frame.down * down));
      }
  });
  return pixels;
}

}  // namespace

std::optional<std::string> grey_image_doubt(const LabelVolume& volume, const TissueTable& tissues) {
  const std::size_t labels = tissues.tissues.size();
  if (!NeighbourChanges::may_be_grey(labels) || is_mostly_named(tissues)) return std::nullopt;
  NeighbourChanges changes(volume.grid.size.x);
  changes.add(volume.voxels.data(), volume.voxels.size());
  if (!changes.looks_grey(labels)) return std::nullopt;
  char text[120];
  std::snprintf(text, sizeof text, "it has %zu values, and %.0f %% of neighbouring voxels differ", labels,
                100 * changes.share());
  return text;
}

void require_labels(const LabelVolume& volume, const TissueTable& tissues, const Path& path) {
  if (const auto doubt = grey_image_doubt(volume, tissues))
    throw Error("this looks like a grey image, not a label volume (" + *doubt + ")", path.string(),
                "use a label volume; `limber resample --with` also poses the grey image");
}

GreyWindow usual_window(const GreyVolume& volume) {
  constexpr std::size_t kAsked = 200'000;  // voxels to sample; enough to estimate the 1 % and 99 % quantiles
  std::vector<float> values;
  const std::size_t step = std::max<std::size_t>(1, volume.voxels.size() / kAsked);
  for (std::size_t i = 0; i < volume.voxels.size(); i += step)
    if (std::isfinite(volume.voxels[i])) values.push_back(volume.voxels[i]);
  if (values.empty()) return {};
  std::sort(values.begin(), values.end());
  const double last = double(values.size() - 1);
  const auto at = [&](double share) { return double(values[static_cast<std::size_t>(share * last)]); };
  const double low = at(0.01), high = at(0.99);
  return {0.5 * (low + high), high > low ? high - low : 1};
}

std::vector<float> grey_slice(const GreyVolume& volume, const GreyFrame& frame) {
  return picture(volume, frame, [&](const glm::dvec3& place) { return nearest(volume, place); });
}

std::vector<float> grey_projection(const GreyVolume& volume, const GreyFrame& frame) {
  const Grid& grid = volume.grid;
  // The rays start before the volume and end behind it. Half a ray's length is half the volume's diagonal plus the
  // distance from the picture's centre to the volume's centre.
  const glm::dvec3 middle = world_from_voxel(grid) * (0.5 * (glm::dvec3(grid.size) - 1.0));
  const double reach = 0.5 * glm::length(glm::dvec3(grid.size) * grid.spacing) + glm::distance(middle, frame.middle);
  const double length = std::min({grid.spacing.x, grid.spacing.y, grid.spacing.z});
  const double steps = std::ceil(2 * reach / length);
  const glm::dvec3 sight = voxel_from_world(grid).linear * glm::cross(frame.right, frame.down);
  return picture(volume, frame, [&](const glm::dvec3& place) {
    const glm::dvec3 start = place - sight * reach, step = sight * length;
    const Stretch part = inside(grid, start, step, steps);
    float most = kOutside;
    for (double s = std::ceil(part.from); s <= part.to; ++s) {
      const float value = nearest(volume, start + step * s);
      if (!std::isnan(value) && !(value <= most)) most = value;
    }
    return most;
  });
}

std::uint8_t grey_of(float value, const GreyWindow& window) {
  if (std::isnan(value)) return 0;
  const double share = (value - window.level) / std::max(window.width, 1e-9) + 0.5;
  return static_cast<std::uint8_t>(std::lround(255 * std::clamp(share, 0.0, 1.0)));
}

}  // namespace limber
