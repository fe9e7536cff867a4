// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/autorig/place_rig.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include <Eigen/LU>
#include <Eigen/SVD>
#include <glm/gtc/quaternion.hpp>

#include "core/rig/joint_names.h"

namespace limber {

namespace {

std::vector<std::optional<JointRole>> roles_of(const Armature& rig) {
  std::vector<std::string> names;
  std::vector<int> parents;
  for (const Bone& bone : rig.bones) names.push_back(bone.name), parents.push_back(bone.parent);
  return joint_roles(names, parents);
}

bool has_sides(const std::vector<std::optional<JointRole>>& roles) {
  return std::any_of(roles.begin(), roles.end(),
                     [](const auto& role) { return role && role->side != BodySide::Middle; });
}

// Returns for each rig bone the index of its counterpart in the body, -1 for none. A body that is a single limb has no
// side: it is matched with the side on which the rig has more bones.
std::vector<int> counterparts(const Armature& rig, const Armature& body) {
  const auto own = roles_of(rig), there = roles_of(body);
  const bool sided = has_sides(own), body_sided = has_sides(there);
  BodySide limb = BodySide::Left;
  if (sided && !body_sided) {
    int left = 0, right = 0;
    for (const auto& role : own)
      if (role) left += role->side == BodySide::Left, right += role->side == BodySide::Right;
    limb = right > left ? BodySide::Right : BodySide::Left;
  }
  std::map<JointRole, int> by_role;
  for (int b = 0; b < std::ssize(body.bones); ++b)
    if (there[b] && there[b]->part != BodyPart::Spine) by_role[*there[b]] = b;
  // If the spines of rig and body have different numbers of vertebrae, equal names such as "Spine" mean different
  // vertebrae.
  const auto vertebrae = [](const auto& roles) {
    return std::count_if(roles.begin(), roles.end(),
                         [](const auto& role) { return role && role->part == BodyPart::Spine; });
  };
  const bool same_spine = vertebrae(own) == vertebrae(there);
  std::vector<int> result(rig.bones.size(), -1);
  for (int b = 0; b < std::ssize(rig.bones); ++b) {
    const bool vertebra = own[b] && own[b]->part == BodyPart::Spine;
    if (const auto same = body.find(rig.bones[b].name); same && (!vertebra || same_spine)) {
      result[b] = *same;
      continue;
    }
    if (!own[b]) continue;
    JointRole role = *own[b];
    if (sided && !body_sided) {
      if (role.side != limb) continue;
      role.side = BodySide::Middle;
    }
    if (const auto found = by_role.find(role); found != by_role.end()) result[b] = found->second;
  }
  return result;
}

glm::dmat3 shortest_turn(const glm::dvec3& from, const glm::dvec3& to) {
  const glm::dvec3 a = glm::normalize(from), b = glm::normalize(to);
  const glm::dvec3 across = glm::cross(a, b);
  const double s = glm::length(across), c = glm::dot(a, b);
  if (s < 1e-12) {
    if (c > 0) return glm::dmat3(1);
    const glm::dvec3 side = std::abs(a.x) < 0.9 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0);
    return glm::mat3_cast(glm::angleAxis(3.14159265358979323846, glm::normalize(glm::cross(a, side))));
  }
  return glm::mat3_cast(glm::angleAxis(std::atan2(s, c), across / s));
}

// The rotation and scale that move a set of points as near as possible to other points [Umeyama 1991]; the identity if
// all points coincide.
struct Similarity {
  glm::dmat3 turn{1};
  double scale = 1;
};
Similarity similarity(const std::vector<glm::dvec3>& from, const std::vector<glm::dvec3>& to) {
  Similarity result;
  if (from.size() < 2) return result;
  glm::dvec3 a(0), b(0);
  for (size_t i = 0; i < from.size(); ++i) a += from[i] / double(from.size()), b += to[i] / double(from.size());
  Eigen::Matrix3d C = Eigen::Matrix3d::Zero();
  double spread = 0, spread_there = 0;
  for (size_t i = 0; i < from.size(); ++i) {
    const glm::dvec3 p = from[i] - a, q = to[i] - b;
    C += Eigen::Vector3d(q.x, q.y, q.z) * Eigen::RowVector3d(p.x, p.y, p.z);
    spread += glm::dot(p, p), spread_there += glm::dot(q, q);
  }
  if (!(spread > 0) || !(spread_there > 0)) return result;
  result.scale = std::sqrt(spread_there / spread);
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(C, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Matrix3d D = Eigen::Matrix3d::Identity();
  if ((svd.matrixU() * svd.matrixV().transpose()).determinant() < 0) D(2, 2) = -1;
  const Eigen::Matrix3d R = svd.matrixU() * D * svd.matrixV().transpose();
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) result.turn[i][j] = R(j, i);
  return result;
}

// Returns the point of a polyline at the given share of the polyline's length.
glm::dvec3 along_line(const std::vector<glm::dvec3>& line, double share) {
  double length = 0;
  for (size_t i = 1; i < line.size(); ++i) length += glm::distance(line[i - 1], line[i]);
  double left = share * length;
  for (size_t i = 1; i < line.size(); ++i) {
    const double piece = glm::distance(line[i - 1], line[i]);
    if (left <= piece && piece > 0) return glm::mix(line[i - 1], line[i], left / piece);
    left -= piece;
  }
  return line.back();
}

// Places the unmatched joints between two matched joints of the rig's trunk. They are spread along the body's trunk
// between the same two joints, in their proportions in the rig.
void spread_trunk(const Armature& rig, const Armature& there, const std::vector<glm::dvec3>& joints,
                  const std::vector<int>& match, std::vector<std::optional<glm::dvec3>>& place) {
  for (int top = 0; top < std::ssize(rig.bones); ++top) {
    if (match[top] < 0 || rig.bones[top].parent < 0 || match[rig.bones[top].parent] >= 0) continue;
    std::vector<int> chain{top};
    int b = rig.bones[top].parent;
    while (b >= 0 && match[b] < 0) chain.push_back(b), b = rig.bones[b].parent;
    if (b < 0) continue;
    chain.push_back(b);
    // Bones of the body's chain between the same two joints. There is a chain only if one joint is an ancestor of the
    // other in the body too.
    std::vector<int> line;
    int a = match[top];
    while (a >= 0 && a != match[b]) line.push_back(a), a = there.bones[a].parent;
    if (a < 0) continue;
    line.push_back(a);
    std::reverse(chain.begin(), chain.end());
    std::reverse(line.begin(), line.end());
    // Only a spine is similar enough in rig and body for its joints to be spread. If the body has no joint between the
    // two, but the rig has several, the rig's bones move with their parents instead.
    if (line.size() < 3 && chain.size() > 3) continue;
    std::vector<glm::dvec3> from, to;
    for (int c : chain) from.push_back(rig.bones[c].head);
    for (int l : line) to.push_back(joints[l]);
    double length = 0, whole = 0;
    for (size_t i = 1; i < from.size(); ++i) whole += glm::distance(from[i - 1], from[i]);
    if (!(whole > 0)) continue;
    for (size_t i = 1; i + 1 < from.size(); ++i) {
      length += glm::distance(from[i - 1], from[i]);
      if (!place[chain[i]]) place[chain[i]] = along_line(to, length / whole);
    }
  }
}

// The rotation and scale that take a bone from rest to its new position.
struct Carry {
  glm::dmat3 turn{1};
  double scale = 1;
  glm::dvec3 vector(const glm::dvec3& v) const { return scale * (turn * v); }
};

// Returns the child whose head lies at the bone's tail, or -1.
int child_at_tail(const Armature& rig, int bone) {
  const Bone& b = rig.bones[bone];
  const double near = 0.02 * glm::distance(b.head, b.tail) + 1e-9;
  for (int c = bone + 1; c < std::ssize(rig.bones); ++c)
    if (rig.bones[c].parent == bone && glm::distance(rig.bones[c].head, b.tail) <= near) return c;
  return -1;
}

void turn_limits(Bone& bone, const Bone& before, const glm::dmat3& turn) {
  bone.limits.axis = turn * before.limits.axis;
  if (const double length = glm::length(bone.limits.axis); length > 0) bone.limits.axis /= length;
  if (glm::distance(bone.head, bone.tail) > 0 && glm::distance(before.head, before.tail) > 0)
    bone.roll = roll_of(bone, turn * rest_axes(before)[0]);
}

}  // namespace

int matching_bones(const Armature& rig, const Armature& body) {
  const auto match = counterparts(rig, body);
  return static_cast<int>(std::count_if(match.begin(), match.end(), [](int b) { return b >= 0; }));
}

PlacedRig place_rig(const Armature& rig, const Mannequin& body, const std::vector<glm::dvec3>& joints) {
  const std::vector<int> match = counterparts(rig, body.atlas().rig);
  const int count = static_cast<int>(rig.bones.size());
  std::vector<std::optional<glm::dvec3>> place(count);
  std::vector<glm::dvec3> from, to;
  for (int b = 0; b < count; ++b)
    if (match[b] >= 0) {
      place[b] = joints[match[b]];
      from.push_back(rig.bones[b].head), to.push_back(*place[b]);
    }
  spread_trunk(rig, body.atlas().rig, joints, match, place);
  const Similarity whole = similarity(from, to);

  PlacedRig result{rig, match};
  std::vector<Carry> carry(count);
  for (int b = 0; b < count; ++b) {
    const Bone& before = rig.bones[b];
    Bone& bone = result.armature.bones[b];
    const Carry above = before.parent >= 0 ? carry[before.parent] : Carry{whole.turn, whole.scale};
    if (place[b]) {
      bone.head = *place[b];
    } else if (before.parent >= 0) {
      bone.head = result.armature.bones[before.parent].head + above.vector(before.head - rig.bones[before.parent].head);
    } else {
      glm::dvec3 a(0), c(0);
      for (size_t i = 0; i < from.size(); ++i) a += from[i] / double(from.size()), c += to[i] / double(from.size());
      bone.head = c + above.vector(before.head - a);
    }

    // The bone's new end: the new head of the child at its tail or, without such a child, the end of the bone's
    // counterpart in the body.
    const int child = child_at_tail(rig, b);
    std::optional<glm::dvec3> end;
    if (child >= 0 && place[child]) end = place[child];
    else if (match[b] >= 0 && (child < 0 || match[child] < 0))
      end = bone.head + body.carried(match[b], body.atlas().rig.bones[match[b]].tail) - body.joint(match[b]);
    const glm::dvec3 old = above.vector(before.tail - before.head);
    carry[b] = above;
    if (end && glm::distance(*end, bone.head) > 1e-6 && glm::length(old) > 1e-9) {
      carry[b].turn = shortest_turn(old, *end - bone.head) * above.turn;
      carry[b].scale = above.scale * glm::distance(*end, bone.head) / glm::length(old);
      bone.tail = *end;
    } else {
      bone.tail = bone.head + old;
    }
    turn_limits(bone, before, carry[b].turn);
  }
  // If a bone's tail was at its child's head, moves the tail to the child's new head.
  for (int b = 0; b < count; ++b)
    if (const int child = child_at_tail(rig, b); child >= 0)
      result.armature.bones[b].tail = result.armature.bones[child].head;
  return result;
}

Armature moved_rig(const Armature& rig, const glm::dmat3& turn, double scale, const glm::dvec3& from,
                   const glm::dvec3& to) {
  Armature result = rig;
  for (size_t b = 0; b < rig.bones.size(); ++b) {
    Bone& bone = result.bones[b];
    bone.head = to + scale * (turn * (bone.head - from));
    bone.tail = to + scale * (turn * (bone.tail - from));
    turn_limits(bone, rig.bones[b], turn);
  }
  return result;
}

}  // namespace limber
