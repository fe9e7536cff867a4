// SPDX-License-Identifier: AGPL-3.0-or-later
// Small random volumes of regions (0: air, 1: soft tissue, 2 and more: bones) on which meshing must not fail: noise,
// checkerboards, thin sheets, islands, touching corners, holes, one label, no bone, nothing but bone.
#pragma once

#include <random>
#include <string>

#include <glm/gtc/matrix_transform.hpp>

#include "core/volume/label_volume.h"

namespace limber::test {

inline constexpr const char* kBodyKinds[] = {"noise", "checkerboard", "thin sheet", "islands",  "touching corners",
                                             "holes", "one label",    "no bone",    "all bone", "one voxel"};

struct RandomBody {
  std::string kind;
  LabelVolume regions;
};

inline Grid random_grid(std::mt19937& random, int most) {
  const auto any = [&](double low, double high) { return std::uniform_real_distribution<double>(low, high)(random); };
  const auto whole = [&](int low, int high) { return std::uniform_int_distribution<int>(low, high)(random); };
  Grid grid;
  grid.size = {whole(1, most), whole(1, most), whole(1, most)};
  grid.spacing = random() % 3 ? glm::dvec3(any(0.5, 4)) : glm::dvec3(any(0.3, 4), any(0.3, 8), any(0.3, 20));
  grid.origin = {any(-500, 500), any(-500, 500), any(-500, 500)};
  if (random() % 2)
    grid.direction =
        glm::dmat3(glm::rotate(glm::dmat4(1), any(0, 6), glm::normalize(glm::dvec3(any(-1, 1), any(-1, 1), 1.1))));
  if (random() % 3 == 0) grid.direction[random() % 3] *= -1.0;
  return grid;
}

inline RandomBody random_body(unsigned seed, int most = 14) {
  std::mt19937 random(seed);
  const int kind = int(seed % std::size(kBodyKinds));
  const auto whole = [&](int low, int high) { return std::uniform_int_distribution<int>(low, high)(random); };
  RandomBody body{kBodyKinds[kind], {random_grid(random, most), {}}};
  const Grid& grid = body.regions.grid;
  body.regions.voxels = ZeroedVector<Label>(grid.voxel_count(), 0);
  const int bones = whole(0, 4), full = whole(5, 95), cell = whole(1, 4), axis = whole(0, 2), slope = whole(-2, 2);
  const glm::ivec3 sheet(whole(0, grid.size.x), whole(0, grid.size.y), whole(0, grid.size.z)),
      one(random() % grid.size.x, random() % grid.size.y, random() % grid.size.z);
  const glm::dvec3 centre[3] = {glm::dvec3(grid.size) * 0.25, glm::dvec3(grid.size) * 0.6, glm::dvec3(grid.size) * 0.9};
  glm::ivec3 v;
  for (v.z = 0; v.z < grid.size.z; ++v.z)
    for (v.y = 0; v.y < grid.size.y; ++v.y)
      for (v.x = 0; v.x < grid.size.x; ++v.x) {
        const Label any_region = Label(1 + whole(0, bones));
        const glm::ivec3 block = v / cell;
        bool tissue = false;
        Label region = 1;
        switch (kind) {
          case 0: tissue = whole(0, 99) < full, region = any_region; break;
          case 1: tissue = (block.x + block.y + block.z) % 2 == 0, region = Label(1 + block.x % (bones + 1)); break;
          case 2:
            tissue = v[axis] + slope * v[(axis + 1) % 3] / 2 == sheet[axis], region = Label(1 + v.x % (bones + 1));
            break;
          case 3:
            for (int i = 0; i < 3; ++i)
              if (glm::length(glm::dvec3(v) - centre[i]) < 1 + i) tissue = true, region = Label(1 + i % (bones + 1));
            break;
          case 4: tissue = block.x == block.y && block.y == block.z, region = Label(1 + block.x % (bones + 1)); break;
          case 5: tissue = whole(0, 99) >= full / 10, region = v[axis] < sheet[axis] ? 1 : Label(1 + bones); break;
          case 6: tissue = true, region = 1; break;
          case 7: tissue = glm::length(glm::dvec3(v) - centre[1]) < full * 0.1; break;
          case 8: tissue = whole(0, 99) < full || block.x % 2, region = Label(2 + block.y % (bones + 1)); break;
          case 9: tissue = v == one, region = Label(1 + bones); break;
        }
        if (tissue) body.regions.at(v) = region;
      }
  return body;
}

}  // namespace limber::test
