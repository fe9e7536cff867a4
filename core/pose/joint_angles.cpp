// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/pose/joint_angles.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <iterator>

#include "core/base/error.h"

namespace limber {

namespace {

using enum BodyJoint;

// A name of a joint in requests. A plural name ("knees") means the joint on both sides.
struct JointName {
  std::string_view name;
  BodyJoint joint;
  bool plural = false;
};

// The names of the joints. A joint may have several names; messages use the first one.
constexpr JointName kNames[] = {
    {"spine", Spine},
    {"trunk", Spine},
    {"back", Spine},
    {"neck", Neck},
    {"head", Neck},
    {"shoulder girdle", Girdle},
    {"shoulder girdles", Girdle, true},
    {"girdle", Girdle},
    {"girdles", Girdle, true},
    {"clavicle", Girdle},
    {"clavicles", Girdle, true},
    {"scapula", Girdle},
    {"scapulae", Girdle, true},
    {"shoulder", Shoulder},
    {"shoulders", Shoulder, true},
    {"elbow", Elbow},
    {"elbows", Elbow, true},
    {"forearm", Forearm},
    {"forearms", Forearm, true},
    {"wrist", Wrist},
    {"wrists", Wrist, true},
    {"hip", Hip},
    {"hips", Hip, true},
    {"knee", Knee},
    {"knees", Knee, true},
    {"ankle", Ankle},
    {"ankles", Ankle, true},
    {"toes", Toes},
    {"toe", Toes},
    {"thumb", Thumb},
    {"thumbs", Thumb, true},
    {"index", Index},
    {"index finger", Index},
    {"index fingers", Index, true},
    {"middle", Middle},
    {"middle finger", Middle},
    {"middle fingers", Middle, true},
    {"ring", Ring},
    {"ring finger", Ring},
    {"ring fingers", Ring, true},
    {"little", Little},
    {"little finger", Little},
    {"little fingers", Little, true},
};

// The word for a motion of a joint ("flexion"), the index of this motion in JointMotions, and the sign of its angle.
struct MotionWord {
  BodyJoint joint;
  std::string_view word;
  std::size_t motion;
  double sign = 1;
};

// The words for the motions of each joint, except for fingers (see finger_motions()). A motion may have several words;
// messages use the first one.
constexpr MotionWord kMotions[] = {
    {Spine, "flexion", 0},
    {Spine, "extension", 0, -1},
    {Spine, "lateral bending", 1},
    {Spine, "right bending", 1},
    {Spine, "left bending", 1, -1},
    {Spine, "axial rotation", 2},
    {Spine, "left rotation", 2},
    {Spine, "right rotation", 2, -1},
    {Neck, "flexion", 0},
    {Neck, "extension", 0, -1},
    {Neck, "lateral bending", 1},
    {Neck, "right bending", 1},
    {Neck, "left bending", 1, -1},
    {Neck, "axial rotation", 2},
    {Neck, "left rotation", 2},
    {Neck, "right rotation", 2, -1},
    {Girdle, "elevation", 0},
    {Girdle, "depression", 0, -1},
    {Girdle, "protraction", 1},
    {Girdle, "retraction", 1, -1},
    {Girdle, "upward rotation", 2},
    {Girdle, "downward rotation", 2, -1},
    {Shoulder, "flexion", 0},
    {Shoulder, "extension", 0, -1},
    {Shoulder, "abduction", 1},
    {Shoulder, "adduction", 1, -1},
    {Shoulder, "internal rotation", 2},
    {Shoulder, "external rotation", 2, -1},
    {Shoulder, "medial rotation", 2},
    {Shoulder, "lateral rotation", 2, -1},
    {Elbow, "flexion", 0},
    {Elbow, "extension", 0, -1},
    {Elbow, "valgus", 1},
    {Elbow, "varus", 1, -1},
    {Forearm, "pronation", 0},
    {Forearm, "supination", 0, -1},
    {Wrist, "flexion", 0},
    {Wrist, "extension", 0, -1},
    {Wrist, "ulnar deviation", 1},
    {Wrist, "radial deviation", 1, -1},
    {Hip, "flexion", 0},
    {Hip, "extension", 0, -1},
    {Hip, "abduction", 1},
    {Hip, "adduction", 1, -1},
    {Hip, "internal rotation", 2},
    {Hip, "external rotation", 2, -1},
    {Hip, "medial rotation", 2},
    {Hip, "lateral rotation", 2, -1},
    {Knee, "flexion", 0},
    {Knee, "extension", 0, -1},
    {Knee, "varus", 1},
    {Knee, "valgus", 1, -1},
    {Knee, "internal rotation", 2},
    {Knee, "external rotation", 2, -1},
    {Ankle, "dorsiflexion", 0},
    {Ankle, "plantarflexion", 0, -1},
    {Ankle, "plantar flexion", 0, -1},
    {Ankle, "inversion", 1},
    {Ankle, "eversion", 1, -1},
    {Ankle, "internal rotation", 2},
    {Ankle, "external rotation", 2, -1},
    {Toes, "extension", 0},
    {Toes, "flexion", 0, -1},
};

struct UsualRange {
  BodyJoint joint;
  std::size_t motion;
  AngleRange range;
};

constexpr UsualRange kUsual[] = {
    {Spine, 0, {-35, 90}},  {Spine, 1, {-40, 40}},     {Spine, 2, {-50, 50}},     {Neck, 0, {-60, 60}},
    {Neck, 1, {-45, 45}},   {Neck, 2, {-80, 80}},      {Girdle, 0, {-10, 40}},    {Girdle, 1, {-20, 30}},
    {Girdle, 2, {-10, 60}}, {Shoulder, 0, {-60, 180}}, {Shoulder, 1, {-50, 180}}, {Shoulder, 2, {-90, 90}},
    {Elbow, 0, {-10, 150}}, {Elbow, 1, {-5, 20}},      {Forearm, 0, {-10, 175}},  {Wrist, 0, {-75, 80}},
    {Wrist, 1, {-20, 35}},  {Hip, 0, {-30, 125}},      {Hip, 1, {-30, 50}},       {Hip, 2, {-45, 45}},
    {Knee, 0, {-10, 150}},  {Knee, 1, {-10, 10}},      {Knee, 2, {-40, 30}},      {Ankle, 0, {-50, 30}},
    {Ankle, 1, {-20, 35}},  {Ankle, 2, {-20, 20}},     {Toes, 0, {-45, 70}},
};
constexpr AngleRange kUsualThumb[] = {{-10, 60}, {-15, 80}, {-15, 80}, {-10, 70}};
constexpr AngleRange kUsualFinger[] = {{-45, 95}, {-10, 110}, {-10, 90}, {-20, 30}};

constexpr double kMostDegrees = 360;
// Bend of a finger's last joint relative to the bend of its middle joint, since one tendon bends both joints.
constexpr double kLastJointShare = 2.0 / 3;
// Bend of the thumb relative to the bend of the fingers when a request curls the whole hand.
constexpr double kThumbShare = 0.5;

std::vector<std::string> words_of(std::string_view text) {
  std::vector<std::string> words;
  bool within = false;
  for (char c : text) {
    const bool upper = c >= 'A' && c <= 'Z',
               part = upper || (static_cast<unsigned char>(c) > ' ' && c != '-' && c != '_');
    if (part && !within) words.emplace_back();
    if (part) words.back() += upper ? static_cast<char>(c - 'A' + 'a') : c;
    within = part;
  }
  return words;
}

std::string joined(const std::vector<std::string>& words, std::size_t begin, std::size_t end) {
  std::string text;
  for (std::size_t i = begin; i < end; ++i) text += (i > begin ? " " : "") + words[i];
  return text;
}

enum class Sides { NotSaid, Left, Right, Both };

std::vector<BodySide> sides_of(Sides sides) {
  switch (sides) {
    case Sides::NotSaid: return {BodySide::Middle};
    case Sides::Left: return {BodySide::Left};
    case Sides::Right: return {BodySide::Right};
    case Sides::Both: break;
  }
  return {BodySide::Left, BodySide::Right};
}

std::string request_of(const std::string& request) {
  std::string quoted = "\"";
  quoted.append(request, 0, 80);
  for (char& c : quoted)
    if (static_cast<unsigned char>(c) < ' ') c = ' ';
  return quoted += '"';
}

double degrees_of(const std::string& request, std::size_t equals) {
  double degrees = 0;
  const char* end = request.data() + request.size();
  const char* begin = equals == request.npos ? end : request.data() + equals + 1;
  while (begin != end && (*begin == ' ' || *begin == '+')) ++begin;
  while (begin != end && (end[-1] == ' ')) --end;
  const auto [stop, error] = std::from_chars(begin, end, degrees);
  return begin == end || error != std::errc() || stop != end ? std::nan("") : degrees;
}

void merge(JointMotions& into, const JointMotions& from) {
  for (std::size_t i = 0; i < from.size(); ++i)
    if (from[i]) into[i] = from[i];
}

void set_fingers(JointAngles& angles, Sides sides, double degrees, bool with_thumb) {
  for (const BodySide side : sides_of(sides)) {
    for (const BodyJoint finger : {Index, Middle, Ring, Little})
      merge(angles[{finger, side}], {degrees, degrees, kLastJointShare * degrees});
    if (with_thumb) merge(angles[{Thumb, side}], {std::nullopt, kThumbShare * degrees, kThumbShare * degrees});
  }
}

// Spreads the fingers away from the middle finger, which stays in line with its metacarpal.
void spread_fingers(JointAngles& angles, Sides sides, double degrees) {
  for (const BodySide side : sides_of(sides)) {
    for (const BodyJoint finger : {Index, Ring, Little}) angles[{finger, side}][kSpread] = degrees;
    angles[{Middle, side}][kSpread] = 0;
  }
}

// Reads a request that sets several finger joints at once ("left hand curl", "hands spread", "fingers flexion") and
// adds the angles. Returns false if the request is not of this kind.
bool add_hand_request(JointAngles& angles, const std::vector<std::string>& words, std::size_t first, Sides sides,
                      double degrees) {
  if (words.size() != first + 2) return false;
  const std::string& hand = words[first];
  const bool of_hand = hand == "hand" || hand == "hands";
  const bool curl = words[first + 1] == "curl" && of_hand, spread = words[first + 1] == "spread" && of_hand;
  const bool fingers = hand == "fingers" && (words[first + 1] == "flexion" || words[first + 1] == "extension");
  if (!curl && !fingers && !spread) return false;
  if (sides == Sides::NotSaid && (hand == "hands" || fingers)) sides = Sides::Both;
  if (spread) return spread_fingers(angles, sides, degrees), true;
  set_fingers(angles, sides, words[first + 1] == "extension" ? -degrees : degrees, curl);
  return true;
}

// Returns the angles of a finger's joints for a requested motion. "flexion" bends all joints of the finger, a motion
// with the name of a joint ("knuckle flexion") only this joint. Returns nothing for an unknown motion.
std::optional<JointMotions> finger_motions(BodyJoint finger, const std::string& motion, double degrees) {
  if (motion == "flexion" || motion.empty()) {
    if (finger == Thumb) return JointMotions{std::nullopt, degrees, degrees};
    return JointMotions{degrees, degrees, kLastJointShare * degrees};
  }
  if (motion == "extension") return finger_motions(finger, "flexion", -degrees);
  constexpr std::string_view kFinger[][2] = {{"mcp flexion", "knuckle flexion"},
                                             {"pip flexion", "middle joint flexion"},
                                             {"dip flexion", "last joint flexion"},
                                             {"mcp abduction", "spread"}};
  constexpr std::string_view kThumb[][2] = {{"cmc flexion", "saddle joint flexion"},
                                            {"mcp flexion", "knuckle flexion"},
                                            {"ip flexion", "last joint flexion"},
                                            {"cmc abduction", "abduction"}};
  for (std::size_t i = 0; i < kMotionsOfJoint; ++i)
    for (const std::string_view word : finger == Thumb ? kThumb[i] : kFinger[i])
      if (motion == word) {
        JointMotions motions;
        motions[i] = degrees;
        return motions;
      }
  return std::nullopt;
}

std::optional<JointMotions> motions_of(BodyJoint joint, const std::string& motion, double degrees) {
  if (is_finger(joint)) return finger_motions(joint, motion, degrees);
  for (const MotionWord& word : kMotions) {
    // Requests for elbows and knees may omit the word for the motion, since these joints only flex: "left elbow=30".
    const bool only = motion.empty() && (joint == Elbow || joint == Knee);
    if (word.joint != joint || (word.word != motion && !only)) continue;
    JointMotions motions;
    motions[word.motion] = word.sign * degrees;
    return motions;
  }
  return std::nullopt;
}

struct FoundJoint {
  BodyJoint joint;
  bool plural = false;
  std::size_t next = 0;  // index of the word after the joint's name
};

// Returns the longest joint name that begins at the word with index `first`; nothing if none begins there.
std::optional<FoundJoint> joint_at(const std::vector<std::string>& words, std::size_t first) {
  for (std::size_t count = 2; count >= 1; --count) {
    if (first + count > words.size()) continue;
    const std::string name = joined(words, first, first + count);
    for (const JointName& known : kNames)
      if (known.name == name) return FoundJoint{known.joint, known.plural, first + count};
  }
  return std::nullopt;
}

}  // namespace

void add_joint_request(JointAngles& angles, const std::string& request, const std::string& where) {
  const std::size_t equals = request.rfind('=');
  add_joint_angle(angles, request.substr(0, equals), degrees_of(request, equals), where + " " + request_of(request));
}

void add_joint_angle(JointAngles& angles, const std::string& asked, double degrees, const std::string& where) {
  if (!(std::abs(degrees) <= kMostDegrees))
    throw Error("this is not the angle of a joint", where,
                "write JOINT MOTION=DEGREES, from -360 to 360, as in \"left hip flexion=90\"");
  const std::vector<std::string> words = words_of(asked);

  Sides sides = Sides::NotSaid;
  std::size_t first = 0;
  if (words.size() > 1 && (words[0] == "left" || words[0] == "l")) sides = Sides::Left, first = 1;
  else if (words.size() > 1 && (words[0] == "right" || words[0] == "r")) sides = Sides::Right, first = 1;
  else if (words.size() > 1 && words[0] == "both") sides = Sides::Both, first = 1;
  if (add_hand_request(angles, words, first, sides, degrees)) return;

  const auto found = joint_at(words, first);
  if (!found) throw Error("there is no joint of this name", where, "write one of: " + known_joints());
  const auto& [joint, plural, next] = *found;
  const std::string motion = joined(words, next, words.size());
  const auto motions = motions_of(joint, motion, degrees);
  const std::string name = name_of(SidedJoint{joint});
  if (!motions)
    throw Error(
        "the " + name + (motion.empty() ? " has several motions" : " has no motion \"" + motion.substr(0, 40) + "\""),
        where, "write one of: " + known_motions(joint));
  if (!is_paired(joint) && sides != Sides::NotSaid)
    throw Error("the body has one " + name + " only", where,
                "leave out the side; write \"" + name + " left bending\" for a motion to one side");
  if (plural && sides == Sides::NotSaid) sides = Sides::Both;
  for (const BodySide side : sides_of(sides)) merge(angles[{joint, side}], *motions);
}

std::string name_of(const SidedJoint& joint) {
  const auto found = std::find_if(std::begin(kNames), std::end(kNames),
                                  [&](const JointName& known) { return known.joint == joint.joint; });
  const std::string side = joint.side == BodySide::Left ? "left " : joint.side == BodySide::Right ? "right " : "";
  return side + std::string(found->name);
}

std::string_view motion_name(BodyJoint joint, std::size_t motion) {
  constexpr std::string_view kFinger[] = {"knuckle flexion", "middle joint flexion", "last joint flexion", "spread"};
  constexpr std::string_view kThumb[] = {"saddle joint flexion", "knuckle flexion", "last joint flexion", "abduction"};
  if (is_finger(joint)) return joint == Thumb ? kThumb[motion] : kFinger[motion];
  for (const MotionWord& word : kMotions)
    if (word.joint == joint && word.motion == motion) return word.word;
  return "";
}

std::string_view opposite_name(BodyJoint joint, std::size_t motion) {
  for (const MotionWord& word : kMotions)
    if (word.joint == joint && word.motion == motion && word.sign < 0) return word.word;
  return "";
}

std::optional<AngleRange> usual_range(BodyJoint joint, std::size_t motion) {
  if (motion >= kMotionsOfJoint) return std::nullopt;
  if (is_finger(joint)) return joint == Thumb ? kUsualThumb[motion] : kUsualFinger[motion];
  for (const UsualRange& usual : kUsual)
    if (usual.joint == joint && usual.motion == motion) return usual.range;
  return std::nullopt;
}

std::string known_joints() {
  std::string names;
  std::optional<BodyJoint> last;
  for (const JointName& known : kNames) {
    if (known.joint == last) continue;
    last = known.joint;
    names += std::string(names.empty() ? "" : ", ") + std::string(known.name);
  }
  return names + ", hand (curl, spread)";
}

std::string known_motions(BodyJoint joint) {
  if (joint == Thumb) return "flexion, saddle joint flexion, knuckle flexion, last joint flexion, abduction";
  if (is_finger(joint)) return "flexion, knuckle flexion, middle joint flexion, last joint flexion, spread";
  std::string names;
  for (const MotionWord& word : kMotions)
    if (word.joint == joint) names += std::string(names.empty() ? "" : ", ") + std::string(word.word);
  return names;
}

BodyPart part_of(BodyJoint joint) {
  switch (joint) {
    case Spine: return BodyPart::Spine;
    case Neck: return BodyPart::Neck;
    case Girdle: return BodyPart::Clavicle;
    case Shoulder: return BodyPart::UpperArm;
    case Elbow:
    case Forearm: return BodyPart::Forearm;
    case Wrist: return BodyPart::Hand;
    case Hip: return BodyPart::Thigh;
    case Knee: return BodyPart::Shank;
    case Ankle: return BodyPart::Foot;
    case Toes: return BodyPart::Toes;
    case Thumb: return BodyPart::Thumb;
    case Index: return BodyPart::Index;
    case Middle: return BodyPart::Middle;
    case Ring: return BodyPart::Ring;
    case Little: break;
  }
  return BodyPart::Little;
}

bool is_paired(BodyJoint joint) { return joint != Spine && joint != Neck; }

std::vector<std::string> beyond_usual(const JointAngles& angles) {
  std::vector<std::string> lines;
  for (const auto& [joint, motions] : angles)
    for (std::size_t i = 0; i < motions.size(); ++i) {
      const std::optional<AngleRange> range = motions[i] ? usual_range(joint.joint, i) : std::nullopt;
      if (!range || (*motions[i] >= range->low && *motions[i] <= range->high)) continue;
      char text[200];
      std::snprintf(text, sizeof text, "%s %s of %g degrees is beyond the %g to %g that adults usually reach",
                    name_of(joint).c_str(), std::string(motion_name(joint.joint, i)).c_str(), *motions[i], range->low,
                    range->high);
      lines.emplace_back(text);
    }
  return lines;
}

}  // namespace limber
