// SPDX-License-Identifier: AGPL-3.0-or-later
#include "render/textures/inverse_map_texture.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <utility>

#include <epoxy/gl.h>

#include "core/base/error.h"
#include "core/base/parallel.h"

namespace limber::render {

namespace {

constexpr Format3D kNodes = {GL_RGBA16, GL_RGBA, GL_UNSIGNED_SHORT, true};
constexpr Format3D kApart = {GL_R8_SNORM, GL_RED, GL_BYTE, true};
constexpr Format3D kCubes = {GL_R8UI, GL_RED_INTEGER, GL_UNSIGNED_BYTE, false};

// Uploads the slices (z layers) that differ from the uploaded ones. Consecutive slices are uploaded together.
//   before  the texels that are on the graphics card now, of the same size; null: the card has no such texels
template <class Texel>
void write(const gl::Texture& texture, const glm::ivec3& size, const Format3D& format, const std::vector<Texel>& texels,
           const std::vector<Texel>* before) {
  glBindTexture(GL_TEXTURE_3D, texture.name());
  glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
  const std::int64_t layer = std::int64_t{size.x} * size.y;
  const auto is_there = [&](int z) {
    return before && std::memcmp(&texels[z * layer], &(*before)[z * layer], layer * sizeof(Texel)) == 0;
  };
  for (int z = 0; z < size.z;) {
    const int first = z;
    while (z < size.z && !is_there(z)) ++z;
    if (z > first)
      glTexSubImage3D(GL_TEXTURE_3D, 0, 0, 0, first, size.x, size.y, z - first, format.pixels, format.type,
                      &texels[first * layer]);
    else ++z;
  }
}

// Returns the size to allocate for a texture. The maps grow and shrink from pose to pose, so a texture grows but never
// shrinks. Sizes that are powers of two are avoided: when an axis becomes a power of two, a software driver compiles
// its programs again, which takes as long as drawing many pictures.
glm::ivec3 roomier(glm::ivec3 room, const glm::ivec3& size, int largest_texture) {
  for (int axis = 0; axis < 3; ++axis) {
    room[axis] = std::max(room[axis], size[axis]);
    if ((room[axis] & (room[axis] - 1)) == 0 && room[axis] < largest_texture) ++room[axis];
  }
  return room;
}

Error no_room() {
  return Error("the pose cannot be shown: the graphics driver has no room for it", "its map",
               "pose less far, or resample");
}

}  // namespace

static_assert(PreviewMap::kNothing == 0 && PreviewMap::kBordered == 64 && PreviewMap::kBroken == 128 &&
              CellPart::kFarApart == 127 && CellPart::kStepApart == 63);

PosedTexture::PosedTexture()
    : nodes_(gl::Texture::create()),
      apart_(gl::Texture::create()),
      cubes_(gl::Texture::create()) {}

void PosedTexture::upload(const std::shared_ptr<const PreviewMap>& map, int largest_texture) {
  if (glm::any(glm::greaterThan(map->size, glm::ivec3(largest_texture)))) throw no_room();
  if (glm::any(glm::greaterThan(map->size, room_))) {
    const glm::ivec3 room = roomier(std::exchange(room_, glm::ivec3(0)), map->size, largest_texture);
    if (!allocate(nodes_, room, kNodes) || !allocate(apart_, room, kApart) || !allocate(cubes_, room, kCubes))
      throw no_room();
    room_ = room;
    map_ = nullptr;
  }
  const std::shared_ptr<const PreviewMap> last = std::exchange(map_, nullptr);  // stays null if the upload fails
  const PreviewMap* before = last && last->size == map->size ? last.get() : nullptr;
  size_ = map->size;
  write(nodes_, size_, kNodes, map->nodes, before ? &before->nodes : nullptr);
  write(apart_, size_, kApart, map->apart, before ? &before->apart : nullptr);
  write(cubes_, size_, kCubes, map->cubes, before ? &before->cubes : nullptr);
  gl::check_gl("the upload of a pose");
  map_ = map;
}

int PosedTexture::bind(const VolumeTexture& volume, gl::Program& program, int first) const {
  const double halving = 1 << volume.halvings(), scale = halving / map_->step;
  program.set_texture("u_map", first++, GL_TEXTURE_3D, nodes_.name());
  program.set_texture("u_apart", first++, GL_TEXTURE_3D, apart_.name());
  program.set_texture("u_cubes", first++, GL_TEXTURE_3D, cubes_.name());
  program.set("u_node_scale", static_cast<float>(scale));
  program.set("u_node_offset", glm::vec3(-glm::dvec3(kPad) * scale - 0.5 - glm::dvec3(map_->first)));
  program.set("u_rest_scale", glm::vec3(map_->extent / halving));
  program.set("u_rest_offset", glm::vec3((map_->low + 0.5) / halving + double(kPad)));
  program.set("u_map_texel", 1.0f / glm::vec3(room_));
  program.set("u_map_size", size_);
  program.set("u_steepest", static_cast<float>(map_->steepest() / halving));
  return first;
}

void PosedHull::update(const std::shared_ptr<const PreviewMap>& pointer, const VolumeTexture& volume,
                       const VisibleField& field) {
  if (map_ == pointer && revision_ == field.revision()) return;
  map_ = nullptr;  // stays null if the update fails
  const PreviewMap& map = *pointer;
  const double halving = 1 << volume.halvings();
  const glm::vec3 scale(map.extent / halving / double(PreviewMap::kFullFraction)),
      offset((map.low + 0.5) / halving + double(kPad));
  const std::array<std::int64_t, 3> stride = {1, map.size.x, std::int64_t{map.size.x} * map.size.y};
  std::vector<std::uint8_t>& holds = holds_[1];
  holds.resize(map.cubes.size());
  parallel_for(map.size.z, 4, [&](std::int64_t begin, std::int64_t end) {
    for (std::int64_t i = begin * stride[2]; i < end * stride[2]; ++i) {
      holds[i] = PreviewMap::kNothing;
      if (map.cubes[i] == PreviewMap::kNothing) continue;
      // Rest positions in a cube can lie outside the bounding box of its nodes by this margin. In a cube beside a
      // fold, they are extrapolated from the nearest node, so the margin is large. In other cubes, only the slight
      // curvature of the map adds to the error of the straight pieces of a ray.
      const float margin = map.cubes[i] >= PreviewMap::kBroken ? float(map.step / halving) : 0.25f;
      const glm::vec3 low(map.reach[i].low), high(map.reach[i].high);
      if (field.may_be_met(low * scale + offset - margin, high * scale + offset + margin)) holds[i] = map.cubes[i];
    }
  });

  Hull::Faces& faces = faces_;
  faces.corners.clear();
  faces.indices.clear();
  for (int z = 0; z < map.size.z; ++z)
    for (int y = 0; y < map.size.y; ++y) {
      const std::int64_t row = map.index({0, y, z});
      for (int x = 0; x < map.size.x; ++x) {
        if (!holds[row + x]) continue;
        const glm::ivec3 cube(x, y, z);
        for (int side = 0; side < 6; ++side) {
          const int axis = side / 2, up = side % 2;
          const int next = cube[axis] + (up ? 1 : -1);
          if (next >= 0 && next < map.size[axis] && holds[row + x + (up ? stride[axis] : -stride[axis])]) continue;
          const int u = (axis + 1) % 3, v = (axis + 2) % 3;
          std::array<glm::u16vec4, 4> c;
          c.fill(glm::u16vec4(x, y, z, 1));
          for (glm::u16vec4& each : c) each[axis] = static_cast<std::uint16_t>(each[axis] + up);
          c[up ? 1 : 3][u] += 1, c[2][u] += 1, c[2][v] += 1, c[up ? 3 : 1][v] += 1;
          const auto start = static_cast<std::uint32_t>(faces.corners.size());
          faces.corners.insert(faces.corners.end(), c.begin(), c.end());
          for (const std::uint32_t i : {0, 1, 2, 0, 2, 3}) faces.indices.push_back(start + i);
        }
      }
    }
  hull_.upload(faces, map.step / halving, (glm::dvec3(map.first) + 0.5) * (map.step / halving) + double(kPad));

  if (glm::any(glm::greaterThan(map.size, room_))) {
    const glm::ivec3 room = roomier(std::exchange(room_, glm::ivec3(0)), map.size, volume.largest_texture());
    if (!allocate(cubes_, room, kCubes)) throw no_room();
    room_ = room;
    holds_size_ = glm::ivec3(0);
  }
  write(cubes_, map.size, kCubes, holds, map.size == holds_size_ ? &holds_[0] : nullptr);
  holds_[0].swap(holds_[1]);
  holds_size_ = map.size;
  map_ = pointer;
  revision_ = field.revision();
}

}  // namespace limber::render
