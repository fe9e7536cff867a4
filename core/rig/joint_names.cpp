// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/rig/joint_names.h"

#include <algorithm>
#include <array>
#include <map>
#include <set>
#include <string_view>

namespace limber {

namespace {
using Words = std::vector<std::string>;

bool is_upper(char c) { return c >= 'A' && c <= 'Z'; }
bool is_lower(char c) { return c >= 'a' && c <= 'z'; }
bool is_digit(char c) { return c >= '0' && c <= '9'; }
char lower(char c) { return is_upper(c) ? static_cast<char>(c - 'A' + 'a') : c; }

// Splits a name into words in lower case. "LHipJoint" becomes l, hip; "finger2-1.L" becomes finger, 2, 1, l;
// "mixamorig:LeftArm" becomes left, arm.
Words words_of(std::string_view name) {
  if (const size_t colon = name.rfind(':'); colon != name.npos && colon + 1 < name.size())
    name.remove_prefix(colon + 1);
  Words words;
  for (size_t i = 0; i < name.size(); ++i) {
    const char c = name[i], before = i ? name[i - 1] : ' ', after = i + 1 < name.size() ? name[i + 1] : ' ';
    if (!is_upper(c) && !is_lower(c) && !is_digit(c)) continue;
    const bool joined = (is_upper(before) || is_lower(before)) && !is_digit(c) && !(is_upper(c) && is_lower(before)) &&
                        !(is_upper(c) && is_upper(before) && is_lower(after));
    if (joined || (is_digit(c) && is_digit(before))) words.back() += lower(c);
    else words.emplace_back(1, lower(c));
  }

  // Words that are ignored, since they name a kind of skeleton or object and not a part of the body.
  static const std::set<std::string, std::less<>> kNoise = {"mixamorig", "bip",       "biped",     "bone",    "def",
                                                            "org",       "character", "cc",        "jnt",     "joint",
                                                            "phalange",  "phalanx",   "vertebrae", "vertebra"};
  const Words all = words;
  std::erase_if(words, [&](const std::string& word) { return kNoise.contains(word); });
  if (all.size() > 2 && all[0] == "cc" && all[1] == "base") words.erase(words.begin());
  // In VRoid's names ("J_Bip_L_Hand", "J_Bip_C_Hips"), J is a prefix and C means the middle: removes both.
  if (all.size() > 2 && all[0] == "j" && all[1] == "bip")
    words.erase(words.begin(), words.begin() + (words.size() > 2 && all[2] == "c" ? 2 : 1));
  // In "Bip01" or "Character1" the number belongs to the ignored word and is removed too.
  if (all.size() > 2 && kNoise.contains(all[0]) && is_digit(all[1][0]) && !words.empty()) words.erase(words.begin());
  return words.empty() ? all : words;
}

BodySide take_side(Words& words) {
  for (size_t i = 0; i < words.size(); ++i) {
    const bool left = words[i] == "left" || words[i] == "l", right = words[i] == "right" || words[i] == "r";
    if ((left || right) && words.size() > 1) {
      words.erase(words.begin() + i);
      return left ? BodySide::Left : BodySide::Right;
    }
  }
  return BodySide::Middle;
}

// The meanings of the words in joint names. Shoulder, Hip and Leg mean different body parts in different rigs;
// part_of() decides which.
enum class Word {
  Pelvis,
  Root,
  Trunk,
  Neck,
  Head,
  Clavicle,
  Shoulder,
  UpperArm,
  Elbow,
  Hand,
  Palm,
  Fingers,
  HipLink,
  Hip,
  Thigh,
  Leg,
  Shank,
  Foot,
  Toes
};

const std::map<std::string, Word, std::less<>>& dictionary() {
  static const std::map<std::string, Word, std::less<>> kWords = {
      {"hips", Word::Pelvis},
      {"pelvis", Word::Pelvis},
      {"sacrum", Word::Pelvis},
      {"root", Word::Root},
      {"hip", Word::Hip},
      {"spine", Word::Trunk},
      {"chest", Word::Trunk},
      {"abdomen", Word::Trunk},
      {"torso", Word::Trunk},
      {"back", Word::Trunk},
      {"lowerback", Word::Trunk},
      {"upperback", Word::Trunk},
      {"lumbar", Word::Trunk},
      {"thorax", Word::Trunk},
      {"thoraxlower", Word::Trunk},
      {"thoraxupper", Word::Trunk},
      {"thoracic", Word::Trunk},
      {"ab", Word::Trunk},
      {"waist", Word::Trunk},
      {"upperchest", Word::Trunk},
      {"neck", Word::Neck},
      {"cervical", Word::Neck},
      {"lowercervical", Word::Neck},
      {"uppercervical", Word::Neck},
      {"lowerneck", Word::Neck},
      {"upperneck", Word::Neck},
      {"necklower", Word::Neck},
      {"neckupper", Word::Neck},
      {"head", Word::Head},
      {"skull", Word::Head},
      {"clavicle", Word::Clavicle},
      {"clav", Word::Clavicle},
      {"collar", Word::Clavicle},
      {"collarbone", Word::Clavicle},
      {"acromion", Word::Clavicle},
      {"shoulder", Word::Shoulder},
      {"shldr", Word::Shoulder},
      {"shldrbend", Word::UpperArm},
      {"forearmbend", Word::Elbow},
      {"thighbend", Word::Thigh},
      {"arm", Word::UpperArm},
      {"upperarm", Word::UpperArm},
      {"uparm", Word::UpperArm},
      {"humerus", Word::UpperArm},
      {"humrus", Word::UpperArm},
      {"humeurs", Word::UpperArm},
      {"forearm", Word::Elbow},
      {"elbow", Word::Elbow},
      {"lowerarm", Word::Elbow},
      {"loarm", Word::Elbow},
      {"ulna", Word::Elbow},
      {"unla", Word::Elbow},
      {"radius", Word::Elbow},
      {"hand", Word::Hand},
      {"wrist", Word::Hand},
      {"carpus", Word::Hand},
      {"fingerbase", Word::Palm},
      {"palm", Word::Palm},
      {"fingers", Word::Fingers},
      {"handfinger", Word::Fingers},
      {"hiplink", Word::HipLink},
      {"buttock", Word::HipLink},
      {"thigh", Word::Thigh},
      {"upleg", Word::Thigh},
      {"upperleg", Word::Thigh},
      {"femur", Word::Thigh},
      {"leg", Word::Leg},
      {"shank", Word::Shank},
      {"shin", Word::Shank},
      {"calf", Word::Shank},
      {"knee", Word::Shank},
      {"lowerleg", Word::Shank},
      {"loleg", Word::Shank},
      {"tibia", Word::Shank},
      {"foot", Word::Foot},
      {"ankle", Word::Foot},
      {"toe", Word::Toes},
      {"toes", Word::Toes},
      {"toebase", Word::Toes},
      {"ball", Word::Toes},
  };
  return kWords;
}

// ---- Names of fingers.

std::optional<BodyPart> finger_of(const std::string& word) {
  static const std::map<std::string, BodyPart, std::less<>> kFingers = {
      {"thumb", BodyPart::Thumb},  {"index", BodyPart::Index},   {"middle", BodyPart::Middle},
      {"mid", BodyPart::Middle},   {"ring", BodyPart::Ring},     {"little", BodyPart::Little},
      {"pinky", BodyPart::Little}, {"pinkie", BodyPart::Little}, {"small", BodyPart::Little}};
  const auto found = kFingers.find(word);
  return found == kFingers.end() ? std::nullopt : std::optional(found->second);
}

bool starts_with_any(std::string_view word, std::initializer_list<std::string_view> beginnings) {
  return std::any_of(beginnings.begin(), beginnings.end(), [&](std::string_view b) { return word.starts_with(b); });
}

// Returns the role of a finger from names such as "HandIndex2", "InHandIndex", "IndexMetacarpal",
// "MiddleMiddlePhalange", "index_01", "finger2-1" and "metacarpal1"; nothing if the name is not that of a finger.
std::optional<JointRole> finger_role(const Words& words, BodySide side) {
  for (size_t i = 0; i < words.size(); ++i) {
    auto finger = finger_of(words[i]);
    size_t next = i + 1;
    int segment = -1;
    if (!finger && words[i] == "finger" && i + 2 < words.size() && is_digit(words[i + 1][0]) &&
        is_digit(words[i + 2][0])) {
      const int number = std::atoi(words[i + 1].substr(0, 4).c_str());
      if (number >= 1 && number <= 5)
        finger = static_cast<BodyPart>(static_cast<int>(BodyPart::Thumb) + number - 1), next = i + 2;
    }
    if (!finger && words[i] == "metacarpal" && i + 1 < words.size() && is_digit(words[i + 1][0])) {
      const int number = std::atoi(words[i + 1].substr(0, 4).c_str());
      if (number >= 1 && number <= 4)
        finger = static_cast<BodyPart>(static_cast<int>(BodyPart::Thumb) + number), next = words.size(), segment = 0;
    }
    if (!finger) continue;
    for (size_t k = next; k < words.size() && segment < 0; ++k) {
      if (is_digit(words[k][0])) segment = std::atoi(words[k].substr(0, 4).c_str());
      else if (starts_with_any(words[k], {"metacarp", "metarc"})) segment = 0;
      else if (starts_with_any(words[k], {"prox"})) segment = 1;
      else if (starts_with_any(words[k], {"mid", "interm"})) segment = 2;
      else if (starts_with_any(words[k], {"dist"})) segment = 3;
      if (*finger == BodyPart::Thumb && segment >= 0 && !is_digit(words[k][0]))
        segment = segment == 0 ? 1 : segment == 1 ? 2 : 3;
    }
    if (segment < 0)
      segment = std::find(words.begin(), words.end(), "in") != words.end() && *finger != BodyPart::Thumb ? 0 : 1;
    if (segment > 3) return std::nullopt;
    return JointRole{*finger, side, segment};
  }
  return std::nullopt;
}

// ---- Names of all other parts of the body.

struct Meaning {
  BodySide side = BodySide::Middle;
  std::optional<Word> word;
  std::optional<JointRole> finger;
};

Meaning meaning_of(const std::string& name) {
  // Names with "__" have no meaning: in MakeHuman's rigs they belong to helper joints ("__UpLeg_L" before "UpLeg_L").
  if (name.starts_with("__")) return {};
  Words words = words_of(name);
  Meaning meaning;
  meaning.side = take_side(words);
  meaning.finger = finger_role(words, meaning.side);
  if (meaning.finger) return meaning;

  // Names with "end", "nub", "tip" and similar words have no meaning: such joints mark the ends of chains and have no
  // motion of their own.
  for (const char* leaf : {"end", "nub", "tip", "site", "effector", "eye", "jaw"})
    if (std::find(words.begin(), words.end(), leaf) != words.end()) return meaning;
  std::string joined;
  for (const std::string& word : words)
    if (!is_digit(word[0])) joined += word;
  auto found = dictionary().find(joined);
  // Names such as "rbuttock" or "lthigh" have no separator after the letter of the side, so the rest is looked up
  // alone.
  if (found == dictionary().end() && meaning.side == BodySide::Middle && joined.size() > 2 &&
      (joined[0] == 'l' || joined[0] == 'r')) {
    found = dictionary().find(std::string_view(joined).substr(1));
    if (found != dictionary().end()) meaning.side = joined[0] == 'l' ? BodySide::Left : BodySide::Right;
  }
  if (found == dictionary().end())
    for (const char* trunk : {"lumbar", "thoracic", "spine", "cervical"})
      if (joined.find(trunk) != joined.npos)
        meaning.word = trunk == std::string_view("cervical") ? Word::Neck : Word::Trunk;
  if (found != dictionary().end()) meaning.word = found->second;
  // CMU's "LHipJoint" is the link from the pelvis to the thigh. words_of() drops the word "joint", so `name` is
  // searched.
  if (meaning.word == Word::Hip && name.find("HipJoint") != name.npos) meaning.word = Word::HipLink;
  return meaning;
}

std::optional<BodyPart> part_of(Word word, const std::set<Word>& same_side) {
  const bool has_thigh = same_side.contains(Word::Thigh), has_arm = same_side.contains(Word::UpperArm);
  switch (word) {
    case Word::Clavicle: return BodyPart::Clavicle;
    case Word::Shoulder:
      if (!has_arm) return BodyPart::UpperArm;
      if (!same_side.contains(Word::Clavicle)) return BodyPart::Clavicle;
      return std::nullopt;  // "shoulder" is then the joint between clavicle and upper arm, which is no bone
    case Word::UpperArm: return BodyPart::UpperArm;
    case Word::Elbow: return BodyPart::Forearm;
    case Word::Hand: return BodyPart::Hand;
    case Word::Palm: return BodyPart::Palm;
    case Word::Fingers: return BodyPart::Fingers;
    case Word::HipLink: return BodyPart::HipLink;
    case Word::Hip:
      return has_thigh || (same_side.contains(Word::Leg) && same_side.contains(Word::Shank)) ? BodyPart::HipLink
                                                                                             : BodyPart::Thigh;
    case Word::Thigh: return BodyPart::Thigh;
    case Word::Leg:
      return same_side.contains(Word::Shank) && !has_thigh && !same_side.contains(Word::Hip) ? BodyPart::Thigh
                                                                                             : BodyPart::Shank;
    case Word::Shank: return BodyPart::Shank;
    case Word::Foot: return BodyPart::Foot;
    case Word::Toes: return BodyPart::Toes;
    case Word::Neck: return BodyPart::Neck;
    case Word::Head: return BodyPart::Head;
    case Word::Pelvis:
    case Word::Root: return BodyPart::Pelvis;
    case Word::Trunk: return BodyPart::Spine;
  }
  return std::nullopt;
}

class Roles {
 public:
  explicit Roles(size_t count) : roles_(count) {}

  // Gives a role (body part) to a joint. Returns false if the joint has a role already or another joint has this role.
  // Callers go from parents to children, so the joint nearest to the root gets the role.
  bool give(size_t joint, const JointRole& role) {
    if (roles_[joint] || !taken_.insert(role).second) return false;
    roles_[joint] = role;
    return true;
  }
  const std::optional<JointRole>& of(size_t joint) const { return roles_[joint]; }
  std::vector<std::optional<JointRole>> all() && { return std::move(roles_); }

 private:
  std::vector<std::optional<JointRole>> roles_;
  std::set<JointRole> taken_;
};
}  // namespace

std::vector<std::optional<JointRole>> joint_roles(const std::vector<std::string>& names,
                                                  const std::vector<int>& parents) {
  const size_t count = names.size();
  std::vector<Meaning> meanings(count);
  std::map<BodySide, std::set<Word>> words;
  for (size_t j = 0; j < count; ++j) {
    meanings[j] = meaning_of(names[j]);
    if (meanings[j].word) words[meanings[j].side].insert(*meanings[j].word);
  }

  // Assigns limbs, fingers and head. A limb whose name tells no side is recognised only if no name of the rig tells a
  // side, as in the rig of a single arm.
  Roles roles(count);
  const bool has_sides = !words[BodySide::Left].empty() || !words[BodySide::Right].empty();
  std::vector<size_t> necks;
  for (size_t j = 0; j < count; ++j) {
    const auto& [side, word, finger] = meanings[j];
    if (finger) roles.give(j, *finger);
    if (!word) continue;
    if (*word == Word::Neck) necks.push_back(j);
    if (*word == Word::Head) roles.give(j, {BodyPart::Head});
    const bool is_limb = *word >= Word::Clavicle;
    const bool is_trunk_hip = *word == Word::Hip && side == BodySide::Middle;
    const auto part = part_of(*word, words[side]);
    if (part && is_limb && !is_trunk_hip && (side != BodySide::Middle || !has_sides)) roles.give(j, {*part, side});
  }
  for (size_t j : necks) {
    int index = 0;
    while (!roles.give(j, {BodyPart::Neck, BodySide::Middle, index})) ++index;
  }

  // Assigns the pelvis: the joint that is named pelvis, else one named "hip" without a side, else one named "root".
  auto give_pelvis = [&](Word word) {
    for (size_t j = 0; j < count; ++j)
      if (meanings[j].word == word && meanings[j].side == BodySide::Middle && roles.give(j, {BodyPart::Pelvis}))
        return true;
    return false;
  };
  if (!give_pelvis(Word::Pelvis) && !give_pelvis(Word::Hip)) give_pelvis(Word::Root);

  // Assigns the spine: the chain from the pelvis, or the root, up to neck, head, clavicles or upper arms.
  int top = -1;
  for (BodyPart part : {BodyPart::Neck, BodyPart::Head, BodyPart::Clavicle, BodyPart::UpperArm})
    for (size_t j = 0; j < count && top < 0; ++j)
      if (roles.of(j) && roles.of(j)->part == part && roles.of(j)->index == 0) top = static_cast<int>(j);
  std::vector<size_t> spine;
  for (int j = top < 0 ? -1 : parents[top]; j >= 0 && !roles.of(j); j = parents[j])
    if (meanings[j].word == Word::Trunk || meanings[j].word == Word::Root || !meanings[j].word) spine.push_back(j);
  // A root joint that is the parent of both spine and pelvis (Root -> Spine, Root -> Hips) does not belong to the
  // spine.
  while (!spine.empty() && meanings[spine.back()].word != Word::Trunk) spine.pop_back();
  for (size_t k = 0; k < spine.size(); ++k)
    roles.give(spine[k], {BodyPart::Spine, BodySide::Middle, static_cast<int>(spine.size() - 1 - k)});
  return std::move(roles).all();
}

std::string plain_name(const std::string& name) {
  Words words = words_of(name);
  const BodySide side = take_side(words);
  std::string plain = side == BodySide::Left ? "left" : side == BodySide::Right ? "right" : "";
  for (const std::string& word : words) plain += word;
  return plain;
}

}  // namespace limber
