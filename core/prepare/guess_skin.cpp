// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/prepare/guess_skin.h"

#include <algorithm>
#include <array>
#include <map>

#include "core/volume/outside_air.h"

namespace limber {

namespace {

constexpr double kCovered = 0.99;  // a skin must have at least this share of the body's surface voxels
// A skin must have at least this share of its voxels at the surface, as a sheet of 2 to 3 voxels has.
constexpr double kThin = 0.4;

// Counts, for each label, the voxels that share a face with the air around the body.
std::map<Label, std::int64_t> at_surface(const LabelVolume& volume) {
  constexpr std::array<glm::ivec3, 6> kFaces{{{-1, 0, 0}, {1, 0, 0}, {0, -1, 0}, {0, 1, 0}, {0, 0, -1}, {0, 0, 1}}};
  const std::vector<std::uint8_t> is_air = outside_air(volume);
  std::map<Label, std::int64_t> counts;
  const glm::ivec3 size = volume.grid.size;
  for (int z = 0; z < size.z; ++z)
    for (int y = 0; y < size.y; ++y)
      for (int x = 0; x < size.x; ++x) {
        const glm::ivec3 v(x, y, z);
        const Label label = volume.at(v);
        if (label == 0) continue;
        const bool is_bare = std::any_of(kFaces.begin(), kFaces.end(), [&](const glm::ivec3& face) {
          return volume.grid.contains(v + face) && is_air[volume.grid.index(v + face)];
        });
        if (is_bare) ++counts[label];
      }
  return counts;
}

}  // namespace

std::optional<SkinGuess> guess_skin(const LabelVolume& volume, const TissueTable& tissues) {
  for (const Tissue& tissue : tissues.tissues)
    if (tissue.kind == TissueKind::Skin) return std::nullopt;
  const auto is_unknown = [](const Tissue& tissue) { return tissue.label != 0 && tissue.kind == TissueKind::Unknown; };
  if (std::none_of(tissues.tissues.begin(), tissues.tissues.end(), is_unknown)) return std::nullopt;
  const auto counts = at_surface(volume);
  std::int64_t surface = 0;
  for (const auto& [_, count] : counts) surface += count;
  for (const auto& [label, count] : counts) {
    const Tissue* tissue = tissues.find(label);
    if (double(count) < kCovered * double(surface) || !tissue || tissue->kind != TissueKind::Unknown) continue;
    const std::int64_t voxels = std::count(volume.voxels.begin(), volume.voxels.end(), label);
    if (double(count) >= kThin * double(voxels)) return SkinGuess{label, double(count) / double(surface)};
  }
  return std::nullopt;
}

TissueTable with_skin(TissueTable table, Label label) {
  Tissue& skin = *table.find(label);
  const glm::vec3 colour = skin.colour;
  skin.kind = TissueKind::Skin;
  apply_kind_defaults(skin);
  skin.colour = colour;
  return table;
}

}  // namespace limber
