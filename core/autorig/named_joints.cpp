// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/autorig/named_joints.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <string>

#include <glm/gtc/quaternion.hpp>

#include "core/autorig/joint_landmarks.h"
#include "core/bones/anatomical_name.h"
#include "core/mesh/surface_points.h"
#include "core/motion/body_frame.h"

namespace limber {

namespace {

constexpr std::int64_t kFewest = 4;  // smallest number of surface voxels; a bone with fewer is ignored

// --- which bone a label's name means

std::string finger_key(const AnatomicalName& name) {
  static const std::map<BodyPart, std::string> kFingers = {{BodyPart::Thumb, "Thumb"},
                                                           {BodyPart::Index, "Index"},
                                                           {BodyPart::Middle, "Middle"},
                                                           {BodyPart::Ring, "Ring"},
                                                           {BodyPart::Little, "Little"}};
  static const char* const kSegments[] = {"Metacarpal", "Proximal", "Middle", "Distal"};
  const auto finger = kFingers.find(name.finger);
  if (finger == kFingers.end() || name.segment < 0 || name.segment > 3) return "";
  // A thumb's metacarpal has segment number 1 in its anatomical name, since a thumb has no middle phalanx.
  const int segment = name.finger == BodyPart::Thumb && name.segment < 3 ? name.segment - 1 : name.segment;
  return segment < 0 ? "" : finger->second + kSegments[segment];
}

// Returns true if a text contains a word, regardless of case. The word must be given in lower case.
bool says_word(const std::string& text, const char* word) {
  return std::search(text.begin(), text.end(), word, word + std::char_traits<char>::length(word),
                     [](char a, char b) { return std::tolower(static_cast<unsigned char>(a)) == b; }) != text.end();
}

// Returns the name of the part of the skeleton that a label's name means: the name of the atlas's bone, if the atlas
// has this bone. Returns "" for other labels.
std::string piece_of(const std::string& label_name) {
  const AnatomicalName name = anatomical_name(label_name);
  std::set<BoneRegion> regions = name.regions;
  if (regions.contains(BoneRegion::Hand)) regions.erase(BoneRegion::Finger);
  if (regions.contains(BoneRegion::Foot)) regions.erase(BoneRegion::Toes);
  if (regions.size() != 1) return "";
  const auto says = [&](const char* word) { return says_word(label_name, word); };
  switch (*regions.begin()) {
    case BoneRegion::Head: return says("mandib") || says("jaw") ? "Jaw" : "Head";
    case BoneRegion::Neck: return says("hyoid") ? "" : "Neck";
    case BoneRegion::Thorax:
      return says("stern") || says("manubrium") || says("xiphoid") || says("breastbone") ? "Sternum"
             : says("rib") || says("cost") || says("chest") || says("thorax")            ? ""
                                                                                         : "Chest";
    case BoneRegion::Lumbar: return "Spine";
    case BoneRegion::Pelvis: return "Hips";
    case BoneRegion::Shoulder: return says("clav") || says("collar") ? "Clavicle" : "Scapula";
    case BoneRegion::UpperArm: return "UpperArm";
    case BoneRegion::Forearm: return "Forearm";
    case BoneRegion::Hand: return "Hand";
    case BoneRegion::Finger: return finger_key(name);
    case BoneRegion::Thigh: return "Thigh";
    case BoneRegion::Shank: return says("patella") && !says("tibia") ? "" : "Shank";
    case BoneRegion::Foot: return "Foot";
    case BoneRegion::Toes: return "Toes";
    case BoneRegion::Spine: return "";
  }
  return "";
}

// Returns "Ulna" for a label that contains the ulna without the radius, "Tibia" for one that contains only the tibia,
// and "" otherwise. These bones form the hinges of their limbs: the ulna with the humerus, the tibia with femur and
// talus.
std::string hinged_bone_of(const std::string& label_name, const std::string& piece) {
  const auto says = [&](std::initializer_list<const char*> words) {
    return std::any_of(words.begin(), words.end(), [&](const char* word) { return says_word(label_name, word); });
  };
  if (piece == "Forearm" && says({"ulna"}) && !says({"radi"})) return "Ulna";
  if (piece == "Shank" && says({"tibia"}) && !says({"fibula", "patella"})) return "Tibia";
  return "";
}

// A joint at the head of one of the atlas's bones, and the two parts of the skeleton that meet in it.
struct Meeting {
  const char* bone;  // name of the atlas's bone, without side
  // Names of two parts of the skeleton; "Ulna" and "Tibia" mean the whole forearm or shank if these bones have no
  // label.
  const char *above, *below;
  // true: only surfaces that face along the limb are used, because the kneecap is in front of the knee
  bool along = false;
  bool ball = false;  // true: the bone below begins with a ball (a spherical head)
  double aside = 0;   // distance between the positions that different rig authors choose for this joint, mm
};
constexpr Meeting kMeetings[] = {
    {"Spine", "Hips", "Spine"},
    {"Chest", "Spine", "Chest"},
    {"Neck", "Chest", "Neck"},
    {"Head", "Neck", "Head"},
    {"Clavicle", "Sternum", "Clavicle"},
    {"UpperArm", "Scapula", "UpperArm", false, true},
    {"Forearm", "UpperArm", "Ulna", true, false, 5},
    {"Hand", "Forearm", "Hand", true, false, 2},
    {"Thigh", "Hips", "Thigh", false, true},
    {"Shank", "Thigh", "Tibia", true},
    {"Foot", "Tibia", "Foot", true, false, 2},
    {"Toes", "Foot", "Toes", false, false, 5},
};

// Returns the two parts of the skeleton that meet at the head of a finger's bone; none for other bones.
//   above  out: the name of the upper part, to which the returned `above` points, so it must live as long as the result
std::optional<Meeting> finger_meeting(const std::string& bone, std::string& above) {
  for (const char* finger : {"Thumb", "Index", "Middle", "Ring", "Little"}) {
    const std::string f = finger;
    if (!bone.starts_with(f)) continue;
    const std::string segment = bone.substr(f.size());
    above = segment == "Metacarpal" ? "Hand"
            : segment == "Proximal" ? f + "Metacarpal"
            : segment == "Middle"   ? f + "Proximal"
                                    : f + (f == "Thumb" ? "Proximal" : "Middle");
    return Meeting{bone.c_str(), above.c_str(), bone.c_str()};
  }
  return std::nullopt;
}

// --- parts of the anatomical skeleton that have their own labels in the volume

struct Piece {
  std::vector<SurfacePoint> points;  // surface voxels of the part, without normals
  LabelSet labels;
  double length = 0;  // diagonal of the part's bounding box, mm
  glm::dvec3 middle{0};
};

using Pieces = std::map<std::pair<std::string, BodySide>, Piece>;

BodySide side_named(const std::string& bone) {
  return bone.starts_with("Left") ? BodySide::Left : bone.starts_with("Right") ? BodySide::Right : BodySide::Middle;
}

std::string without_side(const std::string& bone) {
  return bone.starts_with("Left") ? bone.substr(4) : bone.starts_with("Right") ? bone.substr(5) : bone;
}

// Returns the side of the body on which a point is: that of the nearer one of the mannequin's left and right bones that
// belong to `piece`, a part of the skeleton.
BodySide nearer_side(const Mannequin& m, const std::string& piece, const glm::dvec3& place) {
  double least = 1e300;
  BodySide side = BodySide::Middle;
  const std::string like = piece == "Scapula" ? "Clavicle" : piece;
  for (int b = 0; b < m.bone_count(); ++b) {
    const Bone& bone = m.atlas().rig.bones[b];
    if (side_named(bone.name) == BodySide::Middle || without_side(bone.name) != like) continue;
    const double d =
        distance_to_bone({.name = "", .parent = -1, .head = m.joint(b), .tail = m.carried(b, bone.tail)}, place);
    if (d < least) least = d, side = side_named(bone.name);
  }
  return side;
}

void finish(Piece& piece) {
  glm::dvec3 low(1e300), high(-1e300);
  for (const SurfacePoint& p : piece.points)
    low = glm::min(low, p.place), high = glm::max(high, p.place), piece.middle += p.place / double(piece.points.size());
  const glm::dvec3 sides = high - low;
  piece.length = glm::length(sides);
}

Pieces pieces_of(const LabelVolume& volume, const TissueTable& tissues, const Mannequin& m) {
  const Grid& grid = volume.grid;
  std::vector<int> kind(65536, -1);
  std::vector<std::string> hinged(65536);
  std::vector<std::string> names;
  std::vector<BodySide> sides;
  std::map<std::pair<std::string, BodySide>, int> numbers;
  for (const Tissue& tissue : tissues.tissues) {
    if (!is_bone(tissue.kind)) continue;
    const std::string piece = piece_of(tissue.name);
    if (piece.empty()) continue;
    const auto [at, added] =
        numbers.insert({{piece, anatomical_name(tissue.name).side}, static_cast<int>(names.size())});
    if (added) names.push_back(piece), sides.push_back(at->first.second);
    kind[tissue.label] = at->second;
    hinged[tissue.label] = hinged_bone_of(tissue.name, piece);
  }
  Pieces pieces;
  if (names.empty()) return pieces;
  const bool sided = std::any_of(m.atlas().rig.bones.begin(), m.atlas().rig.bones.end(),
                                 [](const Bone& bone) { return side_named(bone.name) != BodySide::Middle; });
  const AffineTransform to_world = world_from_voxel(grid);
  for (int z = 0; z < grid.size.z; ++z)
    for (int y = 0; y < grid.size.y; ++y)
      for (int x = 0; x < grid.size.x; ++x) {
        const Label label = volume.at({x, y, z});
        const int own = kind[label];
        if (own < 0) continue;
        bool on_surface = false;
        for (int axis = 0; axis < 3 && !on_surface; ++axis)
          for (int way : {-1, 1}) {
            glm::ivec3 beside(x, y, z);
            beside[axis] += way;
            on_surface |= kind[volume.at_or_air(beside)] != own;
          }
        if (!on_surface) continue;
        const glm::dvec3 place = to_world * glm::dvec3(x, y, z);
        const BodySide side = !sided                           ? BodySide::Middle
                              : sides[own] == BodySide::Middle ? nearer_side(m, names[own], place)
                                                               : sides[own];
        for (const std::string& name : {names[own], hinged[label]}) {
          if (name.empty()) continue;
          Piece& piece = pieces[{name, side}];
          piece.points.push_back({place, glm::dvec3(0)});
          if (piece.labels.empty()) piece.labels.assign(65536, 0);
          piece.labels[label] = 1;
        }
      }
  std::erase_if(pieces, [](const auto& entry) { return std::ssize(entry.second.points) < kFewest; });
  for (auto& [key, piece] : pieces) finish(piece);
  return pieces;
}

// --- joints between two parts of the skeleton

struct Contact {
  glm::dvec3 place{0};
  double gap = 0;  // smallest distance between the bones, mm
};

// Returns the middle of the contact between two bones: the mean of the surface points at which the bones are nearest to
// each other.
//   along   unit vector: the line between the points of a pair may deviate from it by 60 degrees; zero: any direction
//   within  pairs count if they are at most this much farther apart than the nearest pair, mm
//   reach   pairs that are farther apart than this do not count, mm
std::optional<Contact> contact_of(const Piece& above, const Piece& below, const glm::dvec3& along, double within,
                                  double reach) {
  const PointTree tree(below.points);
  struct Pair {
    double apart;
    glm::dvec3 middle;
  };
  std::vector<Pair> pairs;
  double least = reach;
  for (const SurfacePoint& p : above.points) {
    const int n = tree.nearest(p.place, glm::dvec3(0), reach);
    if (n < 0) continue;
    const glm::dvec3 way = below.points[n].place - p.place;
    const double apart = glm::length(way);
    if (along != glm::dvec3(0) && apart > 0 && std::abs(glm::dot(way, along)) < 0.5 * apart) continue;
    pairs.push_back({apart, (p.place + below.points[n].place) / 2.0});
    least = std::min(least, apart);
  }
  Contact contact{glm::dvec3(0), least};
  double count = 0;
  for (const Pair& pair : pairs)
    if (pair.apart <= least + within) contact.place += pair.middle, count += 1;
  if (count == 0) return std::nullopt;
  contact.place /= count;
  return contact;
}

// Returns the centre of the ball (spherical head) of a femur or humerus. The ball is searched near the bone's contact
// with the bone above.
std::optional<glm::dvec3> ball_of(const LabelVolume& volume, const Piece& bone, const glm::dvec3& near, double scale) {
  constexpr double kAround = 75;  // search radius around the contact for an adult, mm
  std::vector<SurfacePoint> points = surface_points(occupancy_of(volume, bone.labels, 0));
  std::erase_if(points, [&](const SurfacePoint& p) { return glm::distance(p.place, near) > kAround * scale; });
  return ball_near(points, near, scale);
}

bool is_of_trunk(const std::string& bone) {
  return bone == "Spine" || bone == "Chest" || bone == "Neck" || bone == "Head";
}

struct Finder {
  const LabelVolume& volume;
  const Pieces& pieces;
  double voxel;  // largest side of a voxel, mm

  const Piece* find(const std::string& name, BodySide side) const {
    for (BodySide s : {side, BodySide::Middle})
      if (const auto found = pieces.find({name, s}); found != pieces.end()) return &found->second;
    return name == "Ulna" ? find("Forearm", side) : name == "Tibia" ? find("Shank", side) : nullptr;
  }

  std::optional<NamedJoint> joint(const Meeting& meeting, BodySide side) const {
    // kFacing: pairs of surface points form the joint if they are at most this much farther apart than the nearest
    // pair. kApart: bones farther apart than this do not meet. Both are shares of the bones' length. The other numbers
    // are parts of the joint's error, in mm (kLeastError) or as shares of a length.
    constexpr double kFacing = 0.028, kApart = 0.09, kLeastError = 3, kOfLength = 0.02, kOfVoxel = 0.7, kOfGap = 0.3,
                     kSpine = 0.03;
    constexpr double kAdultFemur = 470, kAdultHumerus = 320;  // diagonal of the bone's bounding box, mm
    const Piece *above = find(meeting.above, side), *below = find(meeting.below, side);
    if (!above || !below) return std::nullopt;
    const double length =
        std::max(std::min(above->length, below->length), 0.25 * std::max(above->length, below->length));
    const glm::dvec3 way = below->middle - above->middle;
    const glm::dvec3 along = meeting.along && glm::length(way) > 0 ? glm::normalize(way) : glm::dvec3(0);
    const auto contact =
        contact_of(*above, *below, along, std::max(voxel, kFacing * length), std::max(2.5 * voxel, kApart * length));
    if (!contact) return std::nullopt;
    NamedJoint joint{
        .bone = 0,
        .place = contact->place,
        .error = kLeastError + kOfLength * length + kOfVoxel * voxel + kOfGap * contact->gap + meeting.aside};
    // In the trunk the error is larger, because vertebrae meet along their whole discs and processes, and rig authors
    // choose different positions for the joint.
    if (side == BodySide::Middle && is_of_trunk(meeting.bone)) joint.error += kSpine * above->length;
    if (meeting.ball) {
      const bool is_hip = std::string(meeting.bone) == "Thigh";
      const double scale = below->length / (is_hip ? kAdultFemur : kAdultHumerus);
      // kBallAway: a ball whose centre is farther than this from the contact of the bones is not used. kBallError,
      // kShoulderError: error of the joint at the hip and at the shoulder. All in mm, for an adult.
      constexpr double kBallAway = 40, kBallError = 5, kShoulderError = 13;
      // The ball's expected size is proportional to the bone's length. A bone that is cut off looks short, so its ball
      // would look too large. Therefore the scale is limited.
      const auto ball = ball_of(volume, *below, contact->place, std::clamp(scale, 0.4, 1.3));
      if (ball && glm::distance(*ball, contact->place) < kBallAway * scale)
        joint.place = *ball,
        joint.error = (is_hip ? kBallError : kShoulderError) * std::clamp(scale, 0.6, 1.3) + 0.4 * voxel;
      else joint.error += 0.05 * below->length;
    }
    return joint;
  }
};

// Adds the joint at the head of the pelvis bone, between the hips. Its offset from the hips' midpoint is half of the
// mannequin's offset, because some rigs place the joint exactly in the midpoint. Its error is that of the hips, plus
// kError mm, plus kOfWidth of the distance between the hips.
void add_hips(const Mannequin& m, std::vector<NamedJoint>& joints) {
  constexpr double kError = 4, kOfWidth = 0.07;
  const auto at = [&](const char* name) {
    const auto bone = m.atlas().rig.find(name);
    return std::find_if(joints.begin(), joints.end(),
                        [&](const NamedJoint& joint) { return bone && joint.bone == *bone; });
  };
  const auto left = at("LeftThigh"), right = at("RightThigh");
  if (left == joints.end() || right == joints.end() || m.atlas().rig.bones[0].name != "Hips") return;
  const glm::dvec3 middle = (left->place + right->place) / 2.0,
                   own = (m.joint(left->bone) + m.joint(right->bone)) / 2.0;
  const double error =
      std::max(left->error, right->error) + kError + kOfWidth * glm::distance(left->place, right->place);
  joints.insert(joints.begin(), {.bone = 0, .place = middle + 0.5 * (m.joint(0) - own), .error = error});
}

}  // namespace

std::vector<NamedJoint> named_joints(const LabelVolume& volume, const TissueTable& tissues, const Mannequin& m) {
  const Pieces pieces = pieces_of(volume, tissues, m);
  std::vector<NamedJoint> joints;
  if (pieces.empty()) return joints;
  const Finder finder{volume, pieces, std::max({volume.grid.spacing.x, volume.grid.spacing.y, volume.grid.spacing.z})};
  for (int b = 0; b < m.bone_count(); ++b) {
    const std::string bone = without_side(m.atlas().rig.bones[b].name);
    const BodySide side = side_named(m.atlas().rig.bones[b].name);
    std::string above;
    std::optional<Meeting> meeting = finger_meeting(bone, above);
    for (const Meeting& known : kMeetings)
      if (bone == known.bone) meeting = known;
    if (!meeting) continue;
    if (auto joint = finder.joint(*meeting, side)) joint->bone = b, joints.push_back(*joint);
  }
  add_hips(m, joints);
  return joints;
}

bool same_sides(const Mannequin& m, const std::vector<NamedJoint>& joints) {
  std::map<std::string, glm::dvec3> place, there;
  for (const NamedJoint& joint : joints)
    place[m.atlas().rig.bones[joint.bone].name] = joint.place,
    there[m.atlas().rig.bones[joint.bone].name] = m.joint(joint.bone);
  double agree = 0;
  for (const auto& [name, left] : place)
    if (const auto right = place.find("Right" + without_side(name));
        side_named(name) == BodySide::Left && right != place.end())
      agree += glm::dot(left - right->second, there[name] - there[right->first]);
  return agree >= 0;
}

void lay_along(Mannequin& m, const std::vector<NamedJoint>& joints) {
  const Armature& rig = m.atlas().rig;
  std::map<int, glm::dvec3> place;
  for (const NamedJoint& joint : joints) place[joint.bone] = joint.place;
  // Returns the child that continues bone `b` and has a known joint: for a hand the middle finger, otherwise the first
  // child.
  const auto next_of = [&](int b) {
    int next = -1;
    for (int c = b + 1; c < std::ssize(rig.bones); ++c)
      if (rig.bones[c].parent == b && place.contains(c) &&
          (next < 0 || rig.bones[c].name.find("Middle") != std::string::npos))
        next = c;
    return next;
  };
  std::map<int, std::pair<double, int>> stretch;  // for each group of bones: sum and number of the log stretches
  std::vector<std::pair<int, int>> spans;
  for (const auto& [b, here] : place)
    if (const int next = next_of(b); next >= 0 && glm::distance(here, place[next]) > 0) {
      const double rest = glm::distance(rig.bones[b].head, rig.bones[next].head);
      if (!(rest > 0)) continue;
      spans.push_back({b, next});
      auto& [sum, count] = stretch[m.group_of(b)];
      sum += std::log(glm::distance(here, place[next]) / rest), ++count;
    }
  // A group of bones keeps its length if the natural logarithm of its change against the atlas exceeds this: such a
  // change is not plausible.
  constexpr double kMost = 1.2;
  for (const auto& [group, mean] : stretch)
    if (const double s = mean.first / mean.second; std::abs(s) < kMost)
      m.across[group] += 0.5 * (s - m.along[group]), m.along[group] = s;
  m.settle();
  // Bones of the trunk are not rotated here, because limbs are attached to them on both sides; the fit of the surface
  // rotates them later.
  for (const auto& [b, next] : spans)
    if (side_named(rig.bones[b].name) != BodySide::Middle || rig.bones[b].parent < 0 || place.size() < 2 ||
        rig.bones[0].name != "Hips") {
      const glm::dvec3 from = m.joint(next) - m.joint(b), to = place[next] - place[b];
      if (glm::length(from) > 0 && glm::length(to) > 0) m.turn_branch(b, glm::mat3_cast(shortest_turn(from, to)));
    }
  // Shifts the whole body so that the mean offset between its joints and the named joints is zero.
  glm::dvec3 shift(0);
  for (const auto& [b, here] : place) shift += (here - m.joint(b)) / double(place.size());
  if (!place.empty()) m.root += shift, m.settle();
}

}  // namespace limber
