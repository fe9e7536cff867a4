// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/autorig/joint_landmarks.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <string>
#include <tuple>

namespace limber {

namespace {

// --- landmarks at the narrowest cross-sections of limbs

struct Section {
  double area = 0;  // area of the section, mm2; 0: no tissue
  glm::dvec3 centre{0};
  double depth = 0;  // extent of the section along `forward`, mm: four times the standard deviation
  // true: the section reaches the edge of the examined square, because the limb touches other tissue.
  bool is_open = false;
};

// Returns the cross-section of the tissue in a plane. Only the connected region nearest to `middle` is included.
Section section_at(const Occupancy& body, const AffineTransform& to_cell, const glm::dvec3& middle,
                   const glm::dvec3& normal, const glm::dvec3& forward, double reach) {
  const double step = std::max({body.grid.spacing.x, body.grid.spacing.y, body.grid.spacing.z, reach / 40});
  const int half = static_cast<int>(reach / step), side = 2 * half + 1;
  const glm::dvec3 u = glm::normalize(forward - normal * glm::dot(forward, normal)), v = glm::cross(normal, u);
  std::vector<std::uint8_t> filled(side * side);  // 1: tissue, 2: tissue that belongs to the section
  std::pair<int, int> seed(1 << 30, -1);
  for (int j = 0; j < side; ++j)
    for (int i = 0; i < side; ++i) {
      const glm::dvec3 cell =
          glm::floor(to_cell * (middle + step * (double(i - half) * u + double(j - half) * v)) + 0.5);
      const bool within = glm::all(glm::greaterThanEqual(cell, glm::dvec3(0))) &&
                          glm::all(glm::lessThan(cell, glm::dvec3(body.grid.size)));
      if (!within || !body.filled(glm::ivec3(cell))) continue;
      filled[i + side * j] = 1;
      seed = std::min(seed, {(i - half) * (i - half) + (j - half) * (j - half), i + side * j});
    }
  Section section;
  if (seed.second < 0) return section;
  std::vector<int> front{seed.second};
  filled[seed.second] = 2;
  double count = 0, squares = 0;
  glm::dvec2 sum(0);
  while (!front.empty()) {
    const int at = front.back(), i = at % side, j = at / side;
    front.pop_back();
    count += 1, sum += glm::dvec2(i - half, j - half), squares += double(i - half) * (i - half);
    for (const auto& [di, dj] : {std::pair(1, 0), std::pair(-1, 0), std::pair(0, 1), std::pair(0, -1)}) {
      const int ni = i + di, nj = j + dj;
      if (ni < 0 || nj < 0 || ni >= side || nj >= side) section.is_open = true;
      else if (filled[ni + side * nj] == 1) {
        filled[ni + side * nj] = 2;
        front.push_back(ni + side * nj);
      }
    }
  }
  const glm::dvec2 mean = sum / count;
  section.area = count * step * step;
  section.centre = middle + step * (mean.x * u + mean.y * v);
  section.depth = 4 * step * std::sqrt(std::max(0.0, squares / count - mean.x * mean.x));
  return section;
}

// The middle line of a limb, which bends once: from `above` straight to `corner` (the joint), then straight to `below`.
// `forward` and `reach` give the orientation and half width of its cross-sections. Positions along the line are in mm
// from the corner, negative above it.
struct Bend {
  glm::dvec3 above{0}, corner{0}, below{0};
  glm::dvec3 forward{0};
  double reach = 0;

  glm::dvec3 at(double along) const {
    const glm::dvec3 way = along < 0 ? corner - above : below - corner;
    return corner + along * glm::normalize(way);
  }
  glm::dvec3 tangent(double along) const {
    const double upper = glm::distance(above, corner), lower = glm::distance(corner, below);
    const double t = std::clamp(0.5 + 0.5 * along / (0.3 * std::min(upper, lower)), 0.0, 1.0);
    return glm::normalize(glm::mix(glm::normalize(corner - above), glm::normalize(below - corner), t));
  }
};

struct Profile {
  double from = 0, step = 0;
  std::vector<Section> sections;
  std::vector<double> area;  // smoothed areas of the sections, mm^2
};

Profile profile_of(const Occupancy& body, const Bend& bend, double from, double to, int count) {
  Profile profile{from, (to - from) / (count - 1), {}, {}};
  const AffineTransform to_cell = voxel_from_world(body.grid);
  for (int k = 0; k < count; ++k) {
    const double along = from + k * profile.step;
    profile.sections.push_back(
        section_at(body, to_cell, bend.at(along), bend.tangent(along), bend.forward, bend.reach));
  }
  for (int k = 0; k < count; ++k) {
    const auto area = [&](int i) { return profile.sections[std::clamp(i, 0, count - 1)].area; };
    profile.area.push_back((area(k - 2) + 2 * area(k - 1) + 3 * area(k) + 2 * area(k + 1) + area(k + 2)) / 9);
  }
  return profile;
}

// Returns the position of a limb's waist (its smallest cross-section): the middle of all sections that are hardly
// larger than the smallest. Returns none unless on both sides of the waist the sections become larger before the limb
// touches other tissue.
std::optional<double> waist(const Profile& profile, double least_bulge) {
  constexpr double kHardly = 1.03;
  const auto& area = profile.area;
  const int count = static_cast<int>(area.size());
  int least = -1;
  for (int k = 0; k < count; ++k)
    if (!profile.sections[k].is_open && (least < 0 || area[k] < area[least])) least = k;
  if (least < 0 || area[least] <= 0) return std::nullopt;
  int free_from = least, free_to = least;
  while (free_from > 0 && !profile.sections[free_from - 1].is_open) --free_from;
  while (free_to + 1 < count && !profile.sections[free_to + 1].is_open) ++free_to;
  const double before = *std::max_element(area.begin() + free_from, area.begin() + least + 1),
               after = *std::max_element(area.begin() + least, area.begin() + free_to + 1);
  if (std::min(before, after) < least_bulge * area[least]) return std::nullopt;
  int first = least, last = least;
  while (first > free_from && area[first - 1] <= kHardly * area[least]) --first;
  while (last < free_to && area[last + 1] <= kHardly * area[least]) ++last;
  if (first == free_from || last == free_to) return std::nullopt;
  return profile.from + profile.step * (first + last) / 2.0;
}

// Position of a joint relative to the waist of the limb (the smallest cross-section near the joint).
struct Waist {
  const char* bone;  // name, without side, of the bone whose head is the joint
  // Range of the search for the waist, as shares of the lengths of the bones above and below the joint.
  double above, below;
  double beyond;  // distance along the limb from the waist to the joint, as a share of the bone above
  // Distance of the joint in front of the middle of its cross-section, as a share of the section's depth.
  double forward;
};
constexpr Waist kWaists[] = {
    {"Forearm", 0.35, 0.30, 0.07, 0},
    // The knee is in front of its section's middle, since the muscles of calf and hamstrings are behind it.
    {"Shank", 0.28, 0.32, 0.01, 0.12},
    {"Hand", 0.35, 0.6, 0.04, 0},
};

bool is_named(const std::string& name, const std::string& part) {
  return name == part || name == "Left" + part || name == "Right" + part;
}

int child_named(const Armature& rig, int bone, const std::string& part) {
  for (int c = bone + 1; c < std::ssize(rig.bones); ++c)
    if (rig.bones[c].parent == bone && rig.bones[c].name.ends_with(part)) return c;
  return -1;
}

struct Limb {
  int bone = 0, child = -1;
  Bend bend;
  Profile profile;
  std::optional<double> along;  // position of the waist along the middle line, mm from the joint
};

std::optional<Limb> limb_at(const Mannequin& m, const Occupancy& body, int bone, const Waist& known) {
  const Armature& rig = m.atlas().rig;
  const int upper = rig.bones[bone].parent;
  if (upper < 0) return std::nullopt;
  const std::string below = std::string(known.bone) == "Forearm" ? "Hand"
                            : std::string(known.bone) == "Shank" ? "Foot"
                                                                 : "MiddleProximal";
  int child = child_named(rig, bone, below);
  if (child < 0)
    if (const int metacarpal = child_named(rig, bone, "MiddleMetacarpal"); metacarpal >= 0)
      child = child_named(rig, metacarpal, below);
  if (child < 0) return std::nullopt;
  Limb limb{.bone = bone, .child = child};
  limb.bend = {m.joint(upper), m.joint(bone), m.joint(child), m.turn[bone] * glm::dvec3(0, -1, 0), 0};
  const double upper_length = glm::distance(limb.bend.above, limb.bend.corner),
               lower_length = glm::distance(limb.bend.corner, limb.bend.below);
  if (!(upper_length > 0) || !(lower_length > 0)) return std::nullopt;
  // If a limb bends by more than 60 degrees (cosine 0.5), the joint has no clear cross-section.
  constexpr double kMostBent = 0.5;
  if (glm::dot(limb.bend.corner - limb.bend.above, limb.bend.below - limb.bend.corner) <
      kMostBent * upper_length * lower_length)
    return std::nullopt;
  if (std::abs(glm::dot(limb.bend.forward, glm::normalize(limb.bend.corner - limb.bend.above))) > 0.9)
    limb.bend.forward = m.turn[bone] * glm::dvec3(1, 0, 0);
  limb.bend.reach = 0.34 * upper_length;
  limb.profile = profile_of(body, limb.bend, -known.above * upper_length, known.below * lower_length, 41);
  constexpr double kLeastBulge = 1.06;
  limb.along = waist(limb.profile, kLeastBulge);
  return limb;
}

void add_waists(const Mannequin& m, const Occupancy& body, const Waist& known, std::vector<JointLandmark>& found) {
  std::vector<Limb> limbs;
  for (int b = 0; b < m.bone_count(); ++b)
    if (is_named(m.atlas().rig.bones[b].name, known.bone))
      if (auto limb = limb_at(m, body, b, known); limb && limb->along) limbs.push_back(std::move(*limb));
  double mean = 0;
  for (const Limb& limb : limbs) mean += *limb.along / double(limbs.size());
  for (const Limb& limb : limbs) {
    // Upper limit on the difference between the waist's position in one limb and the mean of left and right, as a share
    // of the length of the bone above. A limb with a larger difference uses its own waist instead of the mean.
    constexpr double kUnlike = 0.15;
    const double upper = glm::distance(limb.bend.above, limb.bend.corner);
    const double along = (std::abs(*limb.along - mean) < kUnlike * upper ? mean : *limb.along) + known.beyond * upper;
    const auto at = std::clamp<std::ptrdiff_t>(std::lround((along - limb.profile.from) / limb.profile.step), 0,
                                               std::ssize(limb.profile.sections) - 1);
    const Section& section = limb.profile.sections[at];
    if (section.area <= 0) continue;
    const glm::dvec3 tangent = limb.bend.tangent(along),
                     forward = glm::normalize(limb.bend.forward - tangent * glm::dot(limb.bend.forward, tangent));
    const double straight = glm::dot(glm::normalize(limb.bend.corner - limb.bend.above),
                                     glm::normalize(limb.bend.below - limb.bend.corner));
    found.push_back({limb.bone, section.centre + known.forward * section.depth * forward,
                     std::acos(std::clamp(straight, -1.0, 1.0))});
  }
}

void add_neck(const Mannequin& m, const Occupancy& body, std::vector<JointLandmark>& found) {
  const auto neck = m.atlas().rig.find("Neck"), head = m.atlas().rig.find("Head");
  if (!neck || !head) return;
  const glm::dvec3 base = m.joint(*neck), skull = m.joint(*head),
                   crown = m.carried(*head, m.atlas().rig.bones[*head].tail);
  const double whole = glm::distance(base, skull) + glm::distance(skull, crown);
  if (!(whole > 0)) return;
  const glm::dvec3 up = glm::normalize(crown - base);
  const Bend line{crown, skull, skull - up * whole, m.turn[*neck] * glm::dvec3(0, -1, 0), 0.8 * whole};
  const Bend straight{skull + up, skull, skull - up, line.forward, line.reach};
  const Profile profile = profile_of(body, straight, -0.2 * whole, 0.75 * whole, 48);
  const auto& area = profile.area;
  const auto least = std::min_element(area.begin(), area.end());
  if (*least <= 0 || least == area.begin()) return;
  constexpr double kGrown = 2;
  const auto grown = std::find_if(least, area.end(), [&](double a) { return a > kGrown * *least; });
  if (grown == area.end()) return;
  // Distance from the section whose area is kGrown times the smallest up to the neck joint, as a share of the length of
  // neck and head.
  constexpr double kAbove = 0.05;
  const auto k = std::max<std::ptrdiff_t>(0, (grown - area.begin()) - std::lround(kAbove * whole / profile.step));
  found.push_back({*neck, profile.sections[k].centre});
}

}  // namespace

std::vector<JointLandmark> girth_landmarks(const Mannequin& mannequin, const Occupancy& body) {
  std::vector<JointLandmark> found;
  for (const Waist& known : kWaists) add_waists(mannequin, body, known, found);
  add_neck(mannequin, body, found);
  return found;
}

// --- landmarks at the spherical heads of humerus and femur

namespace {

// Radii of the spherical heads of an adult's humerus and femur, mm; they are scaled with the body.
constexpr double kSmallest = 17, kLargest = 29;

struct Ball {
  glm::dvec3 centre{0};
  double radius = 0;
};

// Returns the sphere that fits the points best: least squares of (squared distance - squared radius).
std::optional<Ball> sphere_through(const std::vector<glm::dvec3>& points, const glm::dvec3& near) {
  glm::dmat4 A(0);
  glm::dvec4 b(0);
  for (const glm::dvec3& point : points) {
    const glm::dvec3 p = point - near;
    const glm::dvec4 row(2.0 * p, 1);
    A += glm::outerProduct(row, row);
    b += glm::dot(p, p) * row;
  }
  if (!(std::abs(glm::determinant(A)) > 1e-9)) return std::nullopt;
  const glm::dvec4 x = glm::inverse(A) * b;
  const double squared = x.w + glm::dot(glm::dvec3(x), glm::dvec3(x));
  if (!(squared > 0)) return std::nullopt;
  return Ball{near + glm::dvec3(x), std::sqrt(squared)};
}

// Returns the sphere near `start` that gets the most votes. For each radius, every surface point votes for one centre:
// the point at this distance behind the surface, along the normal. The votes for a sphere are divided by its squared
// radius, so that the visible share of its surface decides.
std::optional<Ball> voted(const std::vector<SurfacePoint>& points, const glm::dvec3& start, double scale) {
  const double cell = 3 * scale, reach = 30 * scale;
  double most = 0;
  std::optional<Ball> best;
  for (double radius = kSmallest * scale; radius <= kLargest * scale; radius += 2 * scale) {
    std::map<std::tuple<int, int, int>, std::pair<double, glm::dvec3>> votes;
    for (const SurfacePoint& p : points) {
      const glm::dvec3 centre = p.place - radius * p.normal;
      if (glm::distance(centre, start) > reach) continue;
      const glm::ivec3 at(glm::floor((centre - start) / cell));
      auto& [count, sum] = votes[{at.x, at.y, at.z}];
      count += 1, sum += centre;
    }
    for (const auto& [at, own] : votes) {
      double count = 0;
      glm::dvec3 sum(0);
      for (int n = 0; n < 27; ++n) {
        const auto& [x, y, z] = at;
        const auto found = votes.find({x + n % 3 - 1, y + n / 3 % 3 - 1, z + n / 9 - 1});
        if (found != votes.end()) count += found->second.first, sum += found->second.second;
      }
      const glm::dvec3 centre = sum / count;
      const double away = glm::distance(centre, start) / reach,
                   share = count / (radius * radius) * std::exp(-away * away);
      if (share > most) most = share, best = Ball{centre, radius};
    }
  }
  return best;
}

std::optional<Ball> ball_at(const std::vector<SurfacePoint>& points, const glm::dvec3& start, double scale) {
  std::optional<Ball> ball = voted(points, start, scale);
  if (!ball) return std::nullopt;
  size_t seen = 0;
  for (int k = 0; k < 12; ++k) {
    std::vector<glm::dvec3> on;
    for (const SurfacePoint& p : points) {
      const glm::dvec3 out = p.place - ball->centre;
      const double d = glm::length(out);
      // The votes give the centre more exactly than the radius, so the first rounds accept points farther from the
      // sphere.
      if (std::abs(d - ball->radius) < std::max(0.12, 0.3 - 0.03 * k) * ball->radius &&
          glm::dot(out, p.normal) > 0.85 * d)
        on.push_back(p.place);
    }
    if (on.size() < 40) return std::nullopt;
    seen = on.size();
    const auto next = sphere_through(on, ball->centre);
    if (!next) return std::nullopt;
    ball = next;
  }
  const bool plausible = ball->radius > 0.8 * kSmallest * scale && ball->radius < 1.15 * kLargest * scale &&
                         glm::distance(ball->centre, start) < 35 * scale;
  if (!plausible || seen == 0) return std::nullopt;
  return ball;
}

}  // namespace

std::optional<glm::dvec3> ball_near(const std::vector<SurfacePoint>& points, const glm::dvec3& start, double scale) {
  const auto ball = ball_at(points, start, scale);
  return ball ? std::optional(ball->centre) : std::nullopt;
}

std::vector<JointLandmark> ball_landmarks(const Mannequin& m, const FitSurface& bone) {
  std::vector<JointLandmark> found;
  for (int b = 0; b < m.bone_count(); ++b) {
    const std::string& name = m.atlas().rig.bones[b].name;
    if (!is_named(name, "UpperArm") && !is_named(name, "Thigh")) continue;
    const glm::dvec3 start = m.joint(b);
    const double scale = std::exp((m.across[m.group_of(b)] + m.along[m.group_of(b)]) / 2);
    std::vector<SurfacePoint> near;
    for (const SurfacePoint& p : bone.points)
      if (glm::distance(p.place, start) < 65 * scale) near.push_back(p);
    if (const auto ball = ball_at(near, start, scale)) found.push_back({b, ball->centre});
  }
  return found;
}

}  // namespace limber
