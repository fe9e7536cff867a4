// SPDX-License-Identifier: AGPL-3.0-or-later
#include "render/armature_pass.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <vector>

#include <epoxy/gl.h>

namespace limber::render {

namespace {

// A triangle's corner, in pixels from the top left corner. Its colour covers where |local| < reach, with a smooth rim of a pixel.
struct Vertex {
  glm::vec2 pixel;
  float depth;
  glm::vec2 local;
  float reach;
  glm::vec4 colour;
};

const char* const kVertex = R"(
layout(location = 0) in vec2 pixel;
layout(location = 1) in float depth_in;
layout(location = 2) in vec3 local_in;   // x, y, reach
layout(location = 3) in vec4 colour_in;
uniform vec2 u_size;
out float depth;
out vec3 local;
out vec4 tint;
void main() {
  depth = depth_in;
  local = local_in;
  tint = colour_in;
  gl_Position = vec4(pixel.x / u_size.x * 2.0 - 1.0, 1.0 - pixel.y / u_size.y * 2.0, 0.0, 1.0);
}
)";

const char* const kFragment = R"(
in float depth;
in vec3 local;
in vec4 tint;
uniform sampler2D u_depth;
uniform vec2 u_size;
uniform bool u_hidden_by_body;
layout(location = 0) out vec4 colour;
void main() {
  float alpha = tint.a * clamp(local.z + 0.5 - length(local.xy), 0.0, 1.0);
  if (u_hidden_by_body && depth > textureLod(u_depth, gl_FragCoord.xy / u_size, 0.0).r) alpha *= 0.45;
  colour = vec4(tint.rgb * alpha, alpha);
}
)";

constexpr double kHalfWidth = 0.085, kWidestAt = 0.12;  // of the bone's length

const glm::vec3 kFill = glm::vec3(0xC4, 0xCA, 0xD4) / 255.0f, kEdge = glm::vec3(0x14, 0x16, 0x1A) / 255.0f;
const glm::vec3 kSelected = glm::vec3(0xFF, 0x9F, 0x2E) / 255.0f, kActive = glm::vec3(0xFF, 0xD0, 0x8A) / 255.0f;
constexpr float kBehindEdge = 0.35f;  // strength of edges on the far side

// A point of a bone in the picture.
struct Corner {
  glm::dvec3 view{0};  // of the view, mm
  glm::vec2 pixel{0};
  float depth = 0;
  bool in_front = false;
};

struct Projected {
  std::array<Corner, 6> corners;  // head, tail, four about the widest place
  BoneLook look;
  double depth = 0;  // of the middle

  bool drawable() const {
    return std::all_of(corners.begin(), corners.end(), [](const Corner& c) { return c.in_front; });
  }
};

std::vector<Projected> projected_bones(const Scene& scene, const Camera& camera, const glm::ivec2& size) {
  std::vector<Projected> result;
  const glm::dmat4 view = view_from_world(camera);
  for (size_t b = 0; b < scene.armature->bones.size(); ++b) {
    const Bone& bone = scene.armature->bones[b];
    const RigidTransform posed = b < scene.posed_from_rest.size() ? scene.posed_from_rest[b] : RigidTransform{};
    const glm::dmat3 axes = rest_axes(bone);
    const double length = glm::length(bone.tail - bone.head);
    const glm::dvec3 widest = bone.head + (bone.tail - bone.head) * kWidestAt;
    const glm::dvec3 x = axes[0] * length * kHalfWidth, z = axes[2] * length * kHalfWidth;
    const std::array<glm::dvec3, 6> points = {bone.head, bone.tail, widest + x, widest + z, widest - x, widest - z};
    Projected out;
    if (b < scene.bones.size()) out.look = scene.bones[b];
    for (int c = 0; c < 6; ++c) {
      Corner& corner = out.corners[static_cast<size_t>(c)];
      const glm::dvec3 world = posed * points[static_cast<size_t>(c)];
      corner.view = glm::dvec3(view * glm::dvec4(world, 1));
      corner.depth = static_cast<float>(-corner.view.z);
      glm::dvec2 pixel(0);
      corner.in_front = project(camera, world, size, pixel) && glm::length(pixel) < 1e6;
      corner.pixel = pixel;
    }
    out.depth = (out.corners[0].depth + out.corners[1].depth) / 2.0;
    result.push_back(out);
  }
  return result;
}

class Shapes {
 public:
  std::vector<Vertex> vertices;

  void triangle(const Corner& a, const Corner& b, const Corner& c, const glm::vec4& colour) {
    for (const Corner* corner : {&a, &b, &c}) vertices.push_back({corner->pixel, corner->depth, {0, 0}, 1, colour});
  }
  void line(const Corner& a, const Corner& b, float width, const glm::vec4& colour) {
    const glm::vec2 along = b.pixel - a.pixel;
    const float length = glm::length(along);
    if (length < 1e-3f) return;
    const float reach = width / 2;
    const glm::vec2 across = glm::vec2(-along.y, along.x) / length * (reach + 1), more = along / length * 0.5f;
    const auto at = [&](const Corner& corner, float end, float side) {
      return Vertex{corner.pixel + more * end + across * side, corner.depth, {0, side * (reach + 1)}, reach, colour};
    };
    quad(at(a, -1, -1), at(b, 1, -1), at(b, 1, 1), at(a, -1, 1));
  }
  void disc(const Corner& middle, float radius, const glm::vec4& colour) {
    const auto at = [&](float x, float y) {
      const glm::vec2 local = glm::vec2(x, y) * (radius + 1);
      return Vertex{middle.pixel + local, middle.depth, local, radius, colour};
    };
    quad(at(-1, -1), at(1, -1), at(1, 1), at(-1, 1));
  }

 private:
  void quad(const Vertex& a, const Vertex& b, const Vertex& c, const Vertex& d) { vertices.insert(vertices.end(), {a, b, c, a, c, d}); }
};

// Corner numbers of the eight faces, counter-clockwise from outside.
constexpr int kFaces[8][3] = {{0, 2, 3}, {0, 3, 4}, {0, 4, 5}, {0, 5, 2}, {1, 3, 2}, {1, 4, 3}, {1, 5, 4}, {1, 2, 5}};

struct EdgeStyle {
  glm::vec3 colour;
  float width;
};
EdgeStyle edge_of(const BoneLook& look) {
  if (look.selected || look.active) return {kSelected, 2.0f};
  if (look.hovered) return {glm::vec3(1), 1.6f};
  return {kEdge, 1.1f};
}

void add_octahedron(Shapes& shapes, const Projected& bone, bool perspective) {
  const auto faces_eye = [&](const int* face) {
    const glm::dvec3 a = bone.corners[static_cast<size_t>(face[0])].view, b = bone.corners[static_cast<size_t>(face[1])].view,
                     c = bone.corners[static_cast<size_t>(face[2])].view;
    const glm::dvec3 normal = glm::cross(b - a, c - a);
    return std::pair(glm::dot(normal, perspective ? -a : glm::dvec3(0, 0, 1)) > 0, glm::length(normal) > 0 ? glm::normalize(normal) : normal);
  };
  // Which edges a face that looks this way has, as bits of a 6 x 6 table.
  std::array<std::array<bool, 6>, 6> in_front{};
  for (const auto& face : kFaces) {
    const auto [front, normal] = faces_eye(face);
    if (!front) continue;
    for (int i = 0; i < 3; ++i) {
      const auto a = static_cast<size_t>(face[i]), b = static_cast<size_t>(face[(i + 1) % 3]);
      in_front[a][b] = in_front[b][a] = true;
    }
    const auto light = static_cast<float>(std::clamp(0.5 + 0.5 * glm::dot(normal, glm::normalize(glm::dvec3(-0.4, 0.6, 0.7))), 0.0, 1.0));
    const glm::vec4 fill = bone.look.active ? glm::vec4(kActive, 0.55f + 0.20f * light) : glm::vec4(kFill * (0.75f + 0.25f * light), 0.42f + 0.20f * light);
    shapes.triangle(bone.corners[static_cast<size_t>(face[0])], bone.corners[static_cast<size_t>(face[1])],
                    bone.corners[static_cast<size_t>(face[2])], fill);
  }
  const EdgeStyle edge = edge_of(bone.look);
  for (size_t a = 0; a < 6; ++a)
    for (size_t b = a + 1; b < 6; ++b) {
      const bool opposite = (a == 0 && b == 1) || (a >= 2 && b == a + 2);
      if (!opposite) shapes.line(bone.corners[a], bone.corners[b], edge.width, {edge.colour, in_front[a][b] ? 1.0f : kBehindEdge});
    }
}

void add_stick(Shapes& shapes, const Projected& bone) {
  const bool chosen = bone.look.selected || bone.look.active;
  shapes.line(bone.corners[0], bone.corners[1], 4.5f, {0, 0, 0, 0.45f});
  shapes.line(bone.corners[0], bone.corners[1], 2.0f, {chosen ? kSelected : bone.look.hovered ? glm::vec3(1) : kFill, 1});
}

void add_joints(Shapes& shapes, const Projected& bone, BoneShape shape) {
  const bool chosen = bone.look.selected || bone.look.active;
  const float radius = chosen ? 5.0f : shape == BoneShape::Stick ? 4.5f : 3.0f;
  for (const size_t end : {0u, 1u}) {
    shapes.disc(bone.corners[end], radius + 1.1f, {chosen ? kSelected * 0.35f : kEdge, 1});
    shapes.disc(bone.corners[end], radius, {chosen ? kSelected : bone.look.hovered ? glm::vec3(1) : kFill, 1});
  }
}

bool drawn(const Scene& scene) { return scene.armature && scene.bone_shape != BoneShape::None; }

}  // namespace

ArmaturePass::ArmaturePass() : program_("armature", kVertex, kFragment), array_(gl::VertexArray::create()), vertices_(gl::Buffer::create()) {
  glBindVertexArray(array_.name());
  glBindBuffer(GL_ARRAY_BUFFER, vertices_.name());
  const auto attribute = [](GLuint index, GLint count, size_t offset) {
    glEnableVertexAttribArray(index);
    glVertexAttribPointer(index, count, GL_FLOAT, GL_FALSE, sizeof(Vertex), reinterpret_cast<const void*>(offset));
  };
  attribute(0, 2, offsetof(Vertex, pixel));
  attribute(1, 1, offsetof(Vertex, depth));
  attribute(2, 3, offsetof(Vertex, local));
  attribute(3, 4, offsetof(Vertex, colour));
  glBindVertexArray(0);
}

void ArmaturePass::draw(const Scene& scene, const Camera& camera, const glm::ivec2& size, const gl::Texture* body_depth) {
  if (!drawn(scene)) return;
  const std::vector<Projected> bones = projected_bones(scene, camera, size);
  std::vector<size_t> order(bones.size());
  std::iota(order.begin(), order.end(), size_t{0});
  // Far to near, chosen ones last.
  const auto rank = [&](size_t b) { return std::pair(bones[b].look.active ? 2 : bones[b].look.selected ? 1 : 0, -bones[b].depth); };
  std::sort(order.begin(), order.end(), [&](size_t a, size_t b) { return rank(a) < rank(b); });

  Shapes shapes;
  for (const size_t b : order) {
    if (!bones[b].drawable()) continue;
    if (scene.bone_shape == BoneShape::Octahedron) add_octahedron(shapes, bones[b], camera.projection == Projection::Perspective);
    else add_stick(shapes, bones[b]);
    add_joints(shapes, bones[b], scene.bone_shape);
  }
  if (shapes.vertices.empty()) return;

  glBindBuffer(GL_ARRAY_BUFFER, vertices_.name());
  glBufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(shapes.vertices.size() * sizeof(Vertex)), shapes.vertices.data(), GL_STREAM_DRAW);
  glViewport(0, 0, size.x, size.y);
  glDisable(GL_DEPTH_TEST);
  glDisable(GL_SCISSOR_TEST);
  glEnable(GL_BLEND);
  glBlendFunc(GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
  program_.use();
  program_.set("u_size", glm::vec2(size));
  program_.set("u_hidden_by_body", body_depth && !scene.bones_in_front ? 1 : 0);
  program_.set_texture("u_depth", 0, GL_TEXTURE_2D, body_depth ? body_depth->name() : 0);
  glBindVertexArray(array_.name());
  glDrawArrays(GL_TRIANGLES, 0, static_cast<GLsizei>(shapes.vertices.size()));
  glBindVertexArray(0);
}

std::optional<int> bone_at(const Scene& scene, const Camera& camera, const glm::ivec2& size, const glm::dvec2& pixel) {
  if (!drawn(scene)) return std::nullopt;
  const std::vector<Projected> bones = projected_bones(scene, camera, size);
  std::optional<int> best;
  std::pair<double, double> least(1, 0);  // distance over the distance within which the bone is meant, then depth
  for (size_t b = 0; b < bones.size(); ++b) {
    if (!bones[b].drawable()) continue;
    const glm::dvec2 head = bones[b].corners[0].pixel, tail = bones[b].corners[1].pixel, along = tail - head;
    const double squared_length = glm::dot(along, along);
    const double t = squared_length > 0 ? std::clamp(glm::dot(pixel - head, along) / squared_length, 0.0, 1.0) : 0;
    const double distance = glm::length(pixel - head - along * t);
    double half_width = 0;  // of the octahedron at that place
    if (scene.bone_shape == BoneShape::Octahedron)
      half_width = std::sqrt(squared_length) * kHalfWidth * (t < kWidestAt ? t / kWidestAt : (1 - t) / (1 - kWidestAt));
    constexpr double kNear = 5;  // pixels
    const std::pair rank(distance / (half_width + kNear), bones[b].depth);
    if (rank < least) least = rank, best = static_cast<int>(b);
  }
  return best;
}

}  // namespace limber::render
