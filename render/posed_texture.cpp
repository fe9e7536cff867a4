// SPDX-License-Identifier: AGPL-3.0-or-later
#include "render/posed_texture.h"

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

// The layers that differ from those that are there, in runs.
//   before  what is there, of the same size; null: nothing
template <class Texel>
void write(const gl::Texture& texture, const glm::ivec3& size, const Format3D& format, const std::vector<Texel>& texels, const std::vector<Texel>* before) {
  glBindTexture(GL_TEXTURE_3D, texture.name());
  glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
  const std::int64_t layer = std::int64_t{size.x} * size.y;
  const auto is_there = [&](int z) { return before && std::memcmp(&texels[z * layer], &(*before)[z * layer], layer * sizeof(Texel)) == 0; };
  for (int z = 0; z < size.z;) {
    const int first = z;
    while (z < size.z && !is_there(z)) ++z;
    if (z > first) glTexSubImage3D(GL_TEXTURE_3D, 0, 0, 0, first, size.x, size.y, z - first, format.pixels, format.type, &texels[first * layer]);
    else ++z;
  }
}

// Maps grow and shrink from pose to pose. Room is kept, and is no power of two: a software driver translates its programs
// anew when an axis becomes one, which takes as long as many pictures.
glm::ivec3 roomier(glm::ivec3 room, const glm::ivec3& size, int largest_texture) {
  for (int axis = 0; axis < 3; ++axis) {
    room[axis] = std::max(room[axis], size[axis]);
    if ((room[axis] & (room[axis] - 1)) == 0 && room[axis] < largest_texture) ++room[axis];
  }
  return room;
}

Error no_room() { return Error("the pose cannot be shown: the graphics driver has no room for it", "its map", "pose less far, or resample"); }

}  // namespace

const char* const kPosedFunctions = R"(
uniform sampler3D u_map;           // fractions of rest points at nodes
uniform sampler3D u_apart;         // of nodes, to what is beyond the border of their sheet
uniform usampler3D u_cubes;        // between node n and n + 1
uniform vec3 u_node_offset;
uniform float u_node_scale;        // nodes a padded voxel
uniform vec3 u_rest_offset, u_rest_scale;  // padded rest point of a fraction
uniform vec3 u_map_texel;
uniform ivec3 u_map_size;
uniform float u_steepest;          // padded voxels at rest that half a node of one sheet can be

const vec3 kNowhere = vec3(-1e6);
const uint kBordered = 64u, kBroken = 128u;
const float kFarApart = 127.0 / 63.0;  // steps

vec3 node_of(vec3 posed) { return posed * u_node_scale + u_node_offset; }

uint cube_in(usampler3D cubes, vec3 node) {
  ivec3 cube = ivec3(floor(node));
  if (any(lessThan(cube, ivec3(0))) || any(greaterThanEqual(cube, u_map_size - 1))) return 0u;
  return texelFetch(cubes, cube, 0).r;
}

// Beside a fold a place reads its nearest node, and what lies as far on that node's other side, mirrored through it.
// Without branches, since a software driver follows both.
struct Sheet { bool mirrored; vec3 node, rest; };
Sheet sheet_at(vec3 node, uint cube) {
  vec3 nearest = floor(node + 0.5);
  vec4 middle = texelFetch(u_map, ivec3(nearest), 0);
  return Sheet(cube >= kBroken, nearest, middle.a > 0.5 ? middle.rgb : kNowhere);
}
vec3 rest_on(Sheet sheet, vec3 node) {
  vec4 texel = textureLod(u_map, ((sheet.mirrored ? 2.0 * sheet.node - node : node) + 0.5) * u_map_texel, 0.0);
  if (texel.a < 0.5 || (sheet.mirrored && sheet.rest.x < 0.0)) return kNowhere;
  texel.rgb /= texel.a;  // nodes that are not covered do not count
  vec3 slope = (sheet.rest - texel.rgb) * u_rest_scale;
  bool one_sheet = all(lessThan(abs(slope), vec3(u_steepest)));
  vec3 rest = (sheet.mirrored ? sheet.rest : texel.rgb) * u_rest_scale + u_rest_offset;
  return sheet.mirrored && one_sheet ? rest + slope : rest;
}

// Below zero beyond the border. On a mirrored sheet it is at least as far as the way from its node leaves it.
float apart_on(Sheet sheet, vec3 node) {
  if (sheet.mirrored) {
    float apart = texelFetch(u_apart, ivec3(sheet.node), 0).r * kFarApart;
    return apart > 0.999 ? apart : apart - length(rest_on(sheet, node) - rest_on(sheet, sheet.node)) * u_node_scale;
  }
  return textureLod(u_apart, (node + 0.5) * u_map_texel, 0.0).r;
}

vec3 rest_of(vec3 posed) {
  vec3 node = node_of(posed);
  uint cube = cube_in(u_cubes, node);
  if (cube == 0u) return kNowhere;
  Sheet sheet = sheet_at(node, cube);
  if (cube >= kBordered && apart_on(sheet, node) < 0.0) return kNowhere;
  return rest_on(sheet, node);
}
)";
static_assert(PreviewMap::kNothing == 0 && PreviewMap::kBordered == 64 && PreviewMap::kBroken == 128 && CellPart::kFarApart == 127 && CellPart::kStepApart == 63);

PosedTexture::PosedTexture() : nodes_(gl::Texture::create()), apart_(gl::Texture::create()), cubes_(gl::Texture::create()) {}

void PosedTexture::upload(const std::shared_ptr<const PreviewMap>& map, int largest_texture) {
  if (glm::any(glm::greaterThan(map->size, glm::ivec3(largest_texture)))) throw no_room();
  if (glm::any(glm::greaterThan(map->size, room_))) {
    const glm::ivec3 room = roomier(std::exchange(room_, glm::ivec3(0)), map->size, largest_texture);
    if (!allocate(nodes_, room, kNodes) || !allocate(apart_, room, kApart) || !allocate(cubes_, room, kCubes)) throw no_room();
    room_ = room;
    map_ = nullptr;
  }
  const std::shared_ptr<const PreviewMap> last = std::exchange(map_, nullptr);  // until this has ended
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

void PosedHull::update(const std::shared_ptr<const PreviewMap>& pointer, const VolumeTexture& volume, const VisibleField& field) {
  if (map_ == pointer && revision_ == field.revision()) return;
  map_ = nullptr;  // until this has ended
  const PreviewMap& map = *pointer;
  const double halving = 1 << volume.halvings();
  const glm::vec3 scale(map.extent / halving / double(PreviewMap::kFullFraction)), offset((map.low + 0.5) / halving + double(kPad));
  const std::array<std::int64_t, 3> stride = {1, map.size.x, std::int64_t{map.size.x} * map.size.y};
  std::vector<std::uint8_t>& holds = holds_[1];
  holds.resize(map.cubes.size());
  parallel_for(map.size.z, 4, [&](std::int64_t begin, std::int64_t end) {
    for (std::int64_t i = begin * stride[2]; i < end * stride[2]; ++i) {
      holds[i] = PreviewMap::kNothing;
      if (map.cubes[i] == PreviewMap::kNothing) continue;
      // Beside a fold what is mirrored lies outside the nodes' box; elsewhere a piece of a ray is a little straighter than the map.
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
