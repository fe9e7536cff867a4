// SPDX-License-Identifier: AGPL-3.0-or-later
#include "render/passes/armature_pass.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include <epoxy/gl.h>

#include "render/passes/bone_shapes.h"

namespace limber::render {

namespace {

// A corner of a triangle to draw. `pixel` is its position in pixels from the picture's top left corner. `local` is
// interpolated over the triangle. The shader colours the points where the length of `local` is below `reach`, with a
// smooth rim one pixel wide.
struct Vertex {
  glm::vec2 pixel;
  float depth;
  glm::vec2 local;
  float reach;
  glm::vec4 colour;
};

const glm::vec3 kFill = glm::vec3(0xC4, 0xCA, 0xD4) / 255.0f, kEdge = glm::vec3(0x14, 0x16, 0x1A) / 255.0f;
const glm::vec3 kSelected = glm::vec3(0xFF, 0x9F, 0x2E) / 255.0f, kActive = glm::vec3(0xFF, 0xD0, 0x8A) / 255.0f;
constexpr float kBehindEdge = 0.35f;  // opacity of edges on the far side of the solid that shows a bone

// A point of a bone's solid, projected into the picture.
struct Corner {
  glm::dvec3 view{0};  // position in view coordinates, mm
  glm::vec2 pixel{0};
  float depth = 0;
  bool in_front = false;
};

struct Projected {
  std::vector<Corner> corners;  // corners of the bone's solid: head and tail of the bone, then the other points
  BoneLook look;
  double depth = 0;  // mean depth of the bone's head and tail, mm

  bool drawable() const {
    return std::all_of(corners.begin(), corners.end(), [](const Corner& c) { return c.in_front; });
  }
};

std::vector<Projected> projected_bones(const Scene& scene, const Camera& camera, const glm::ivec2& size) {
  std::vector<Projected> result;
  const glm::dmat4 view = view_from_world(camera);
  const BoneSolid* solid = solid_of(scene.bone_shape);
  for (size_t b = 0; b < scene.armature->bones.size(); ++b) {
    const Bone& bone = scene.armature->bones[b];
    const RigidTransform posed = b < scene.posed_from_rest.size() ? scene.posed_from_rest[b] : RigidTransform{};
    Projected out;
    if (b < scene.bones.size()) out.look = scene.bones[b];
    const auto add = [&](const glm::dvec3& point) {
      Corner& corner = out.corners.emplace_back();
      const glm::dvec3 world = posed * point;
      corner.view = glm::dvec3(view * glm::dvec4(world, 1));
      corner.depth = static_cast<float>(-corner.view.z);
      glm::dvec2 pixel(0);
      corner.in_front = project(camera, world, size, pixel) && glm::length(pixel) < 1e6;
      corner.pixel = pixel;
    };
    add(bone.head);
    add(bone.tail);
    if (solid) {
      const glm::dmat3 axes = rest_axes(bone);
      const double length = glm::length(bone.tail - bone.head);
      for (size_t i = 2; i < solid->points.size(); ++i) {
        const glm::dvec3& point = solid->points[i];
        add(bone.head + (bone.tail - bone.head) * point.y + (axes[0] * point.x + axes[2] * point.z) * length);
      }
    }
    out.depth = (out.corners[0].depth + out.corners[1].depth) / 2.0;
    result.push_back(out);
  }
  return result;
}

class Shapes {
 public:
  explicit Shapes(float scale) : scale_(scale) {}  // `scale` multiplies line widths and joint radii

  std::vector<Vertex> vertices;

  void triangle(const Corner& a, const Corner& b, const Corner& c, const glm::vec4& colour) {
    for (const Corner* corner : {&a, &b, &c}) vertices.push_back({corner->pixel, corner->depth, {0, 0}, 1, colour});
  }
  void line(const Corner& a, const Corner& b, float width, const glm::vec4& colour) {
    const glm::vec2 along = b.pixel - a.pixel;
    const float length = glm::length(along);
    if (length < 1e-3f) return;
    const float reach = scale_ * width / 2;
    const glm::vec2 across = glm::vec2(-along.y, along.x) / length * (reach + 1), more = along / length * 0.5f;
    const auto at = [&](const Corner& corner, float end, float side) {
      return Vertex{corner.pixel + more * end + across * side, corner.depth, {0, side * (reach + 1)}, reach, colour};
    };
    quad(at(a, -1, -1), at(b, 1, -1), at(b, 1, 1), at(a, -1, 1));
  }
  void disc(const Corner& middle, float radius_at_one, const glm::vec4& colour) {
    const float radius = scale_ * radius_at_one;
    const auto at = [&](float x, float y) {
      const glm::vec2 local = glm::vec2(x, y) * (radius + 1);
      return Vertex{middle.pixel + local, middle.depth, local, radius, colour};
    };
    quad(at(-1, -1), at(1, -1), at(1, 1), at(-1, 1));
  }

 private:
  void quad(const Vertex& a, const Vertex& b, const Vertex& c, const Vertex& d) {
    vertices.insert(vertices.end(), {a, b, c, a, c, d});
  }

  float scale_;
};

struct EdgeStyle {
  glm::vec3 colour;
  float width;
};
EdgeStyle edge_of(const BoneLook& look) {
  if (look.selected || look.active) return {kSelected, 2.0f};
  if (look.hovered) return {glm::vec3(1), 1.6f};
  return {kEdge, 1.1f};
}

void add_solid(Shapes& shapes, const Projected& bone, const BoneSolid& solid, bool perspective) {
  std::vector<bool> front(solid.faces.size());
  for (size_t f = 0; f < solid.faces.size(); ++f) {
    const std::vector<int>& face = solid.faces[f];
    const auto corner = [&](size_t i) -> const Corner& { return bone.corners[static_cast<size_t>(face[i])]; };
    const glm::dvec3 across = glm::cross(corner(1).view - corner(0).view, corner(2).view - corner(0).view);
    front[f] = glm::dot(across, perspective ? -corner(0).view : glm::dvec3(0, 0, 1)) > 0;
    if (!front[f]) continue;
    const glm::dvec3 normal = glm::length(across) > 0 ? glm::normalize(across) : across;
    const auto light = static_cast<float>(
        std::clamp(0.5 + 0.5 * glm::dot(normal, glm::normalize(glm::dvec3(-0.4, 0.6, 0.7))), 0.0, 1.0));
    const glm::vec4 fill = bone.look.active ? glm::vec4(kActive, 0.55f + 0.20f * light)
                                            : glm::vec4(kFill * (0.75f + 0.25f * light), 0.42f + 0.20f * light);
    for (size_t i = 2; i < face.size(); ++i) shapes.triangle(corner(0), corner(i - 1), corner(i), fill);
  }
  const EdgeStyle style = edge_of(bone.look);
  for (const BoneSolid::Edge& edge : solid.edges) {
    const bool one = front[static_cast<size_t>(edge.faces[0])], other = front[static_cast<size_t>(edge.faces[1])];
    if (edge.smooth && one == other) continue;
    shapes.line(bone.corners[static_cast<size_t>(edge.from)], bone.corners[static_cast<size_t>(edge.to)], style.width,
                {style.colour, one || other ? 1.0f : kBehindEdge});
  }
}

void add_stick(Shapes& shapes, const Projected& bone) {
  const bool chosen = bone.look.selected || bone.look.active;
  shapes.line(bone.corners[0], bone.corners[1], 4.5f, {0, 0, 0, 0.45f});
  shapes.line(bone.corners[0], bone.corners[1], 2.0f,
              {chosen              ? kSelected
               : bone.look.hovered ? glm::vec3(1)
                                   : kFill,
               1});
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

ArmaturePass::ArmaturePass()
    : program_("bones.vert", "bones.frag"),
      array_(gl::VertexArray::create()),
      vertices_(gl::Buffer::create()) {
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

void ArmaturePass::draw(const Scene& scene, const Camera& camera, const glm::ivec2& size,
                        const gl::Texture* body_depth) {
  if (!drawn(scene)) return;
  const std::vector<Projected> bones = projected_bones(scene, camera, size);
  std::vector<size_t> order(bones.size());
  std::iota(order.begin(), order.end(), size_t{0});
  // Draws the active bone last, and the selected bones before it, so that no other bones cover them. Within each group,
  // bones are drawn from far to near.
  const auto rank = [&](size_t b) {
    return std::pair(bones[b].look.active ? 2 : bones[b].look.selected ? 1 : 0, -bones[b].depth);
  };
  std::sort(order.begin(), order.end(), [&](size_t a, size_t b) { return rank(a) < rank(b); });

  Shapes shapes(scene.line_scale);
  for (const size_t b : order) {
    if (!bones[b].drawable()) continue;
    if (const BoneSolid* solid = solid_of(scene.bone_shape))
      add_solid(shapes, bones[b], *solid, camera.projection == Projection::Perspective);
    else add_stick(shapes, bones[b]);
    add_joints(shapes, bones[b], scene.bone_shape);
  }
  if (shapes.vertices.empty()) return;

  glBindBuffer(GL_ARRAY_BUFFER, vertices_.name());
  glBufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(shapes.vertices.size() * sizeof(Vertex)),
               shapes.vertices.data(), GL_STREAM_DRAW);
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

std::vector<BoneHit> bones_at(const Scene& scene, const Camera& camera, const glm::ivec2& size,
                              const glm::dvec2& pixel) {
  std::vector<BoneHit> hits;
  if (!drawn(scene)) return hits;
  const std::vector<Projected> bones = projected_bones(scene, camera, size);
  for (size_t b = 0; b < bones.size(); ++b) {
    if (!bones[b].drawable()) continue;
    const Corner &from = bones[b].corners[0], &to = bones[b].corners[1];
    const glm::dvec2 head = from.pixel, along = glm::dvec2(to.pixel) - head;
    const double squared_length = glm::dot(along, along);
    const double t = squared_length > 0 ? std::clamp(glm::dot(pixel - head, along) / squared_length, 0.0, 1.0) : 0;
    // A pixel up to this far outside a bone's outline still hits the bone, pixels at line scale 1.
    constexpr double kNear = 5;
    const double off = glm::length(pixel - head - along * t) /
                       (std::sqrt(squared_length) * half_width_at(scene.bone_shape, t) + kNear * scene.line_scale);
    if (off < 1) hits.push_back({static_cast<int>(b), off, glm::mix<double>(from.depth, to.depth, t)});
  }
  return hits;
}

std::optional<int> bone_at(const Scene& scene, const Camera& camera, const glm::ivec2& size, const glm::dvec2& pixel) {
  const std::vector<BoneHit> hits = bones_at(scene, camera, size, pixel);
  const auto best = std::min_element(hits.begin(), hits.end(), [](const BoneHit& a, const BoneHit& b) {
    return std::pair(a.off, a.depth) < std::pair(b.off, b.depth);
  });
  return best == hits.end() ? std::nullopt : std::optional(best->bone);
}

}  // namespace limber::render
