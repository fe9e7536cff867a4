// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/bones/anatomical_name.h"

#include <algorithm>
#include <array>
#include <map>
#include <string>
#include <vector>

namespace limber {

namespace {
using Words = std::vector<std::string>;

// Upper limit on the characters of a name that are read; the rest is ignored.
constexpr std::size_t kLongestName = 400;

bool is_digit(char c) { return c >= '0' && c <= '9'; }
bool is_letter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); }
char lower(char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; }

// Splits a name into lower-case words: "vertebrae_L5" gives vertebrae, l, 5; "BoneLeft" gives bone, left.
Words words_of(std::string_view name) {
  Words words;
  char before = ' ';
  for (const char c : name.substr(0, kLongestName)) {
    if (is_letter(c) || is_digit(c)) {
      const bool starts = !(is_letter(before) || is_digit(before)) || is_digit(before) != is_digit(c) ||
                          (c >= 'A' && c <= 'Z' && before >= 'a' && before <= 'z');
      if (starts) words.emplace_back();
      words.back() += lower(c);
    }
    before = c;
  }
  return words;
}

struct Meaning {
  BoneRegion region;
  bool plural = false;  // true: the word alone means several bones ("ribs")
};

// Returns the dictionary of anatomical words, with singular and plural forms.
const std::map<std::string, Meaning, std::less<>>& dictionary() {
  using enum BoneRegion;
  static const std::map<std::string, Meaning, std::less<>> kWords = [] {
    std::map<std::string, Meaning, std::less<>> words;
    const auto add = [&](BoneRegion region, bool plural, std::initializer_list<const char*> list) {
      for (const char* word : list) words[word] = {region, plural};
    };
    add(Head, false, {"skull",   "cranium",  "cranial",   "mandible",  "mandibula", "jaw",      "maxilla", "maxillae",
                      "frontal", "parietal", "occipital", "occiput",   "temporal",  "sphenoid", "ethmoid", "zygomatic",
                      "nasal",   "lacrimal", "vomer",     "palatine",  "concha",    "tooth",    "teeth",   "incisor",
                      "molar",   "premolar", "canine",    "calvarium", "calvaria",  "facial"});
    add(Neck, false, {"atlas", "axis", "hyoid"});
    add(Neck, true, {"cervical"});
    add(Thorax, false, {"rib", "sternum", "manubrium", "xiphoid", "costa", "breastbone"});
    add(Thorax, true, {"ribs", "costae", "thoracic", "thorax", "chest", "ribcage"});
    add(Lumbar, true, {"lumbar"});
    add(Spine, true, {"spine", "spinal", "backbone"});
    add(Pelvis, false,
        {"pelvis", "pelvic", "hip", "hips", "ilium", "ischium", "pubis", "pubic", "sacrum", "sacral", "coccyx",
         "innominate", "coxae", "coxa"});
    add(Shoulder, false,
        {"scapula", "scapulae", "scapulas", "clavicle", "clavicles", "clavicula", "claviculae", "collarbone",
         "collarbones"});
    add(UpperArm, false, {"humerus", "humeri", "humeral"});
    add(Forearm, false, {"ulna", "ulnae", "ulnas", "radius", "radii", "forearm", "forearms"});
    add(Hand, false,
        {"capitate", "hamate", "lunate", "scaphoid", "trapezium", "trapezoid", "triquetral", "triquetrum", "pisiform",
         "carpal", "carpals", "carpus", "wrist", "wrists"});
    add(Hand, true, {"hand", "hands"});
    add(Thigh, false, {"femur", "femora", "femurs", "femoral"});
    add(Shank, false,
        {"tibia", "tibiae", "tibias", "fibula", "fibulae", "fibulas", "patella", "patellae", "patellas", "kneecap",
         "kneecaps"});
    add(Foot, false,
        {"metatarsal", "metatarsals", "metatarsus", "calcaneus", "calcaneum", "talus", "cuboid", "cuneiform",
         "navicular", "tarsal", "tarsals", "tarsus"});
    add(Foot, true, {"foot", "feet", "ankle", "ankles"});
    add(Toes, false, {"toe", "hallux"});
    add(Toes, true, {"toes"});
    return words;
  }();
  return kWords;
}

bool has(const Words& words, std::string_view word) {
  return std::find(words.begin(), words.end(), word) != words.end();
}
bool has_any(const Words& words, std::initializer_list<std::string_view> wanted) {
  return std::any_of(wanted.begin(), wanted.end(), [&](std::string_view word) { return has(words, word); });
}

// Returns true if word i is the letter of a vertebra's level, such as the "L" in "L5". An "L" like this does not mean
// the left side.
bool is_level(const Words& words, std::size_t i) {
  return i + 1 < words.size() && is_digit(words[i + 1][0]) &&
         has_any(words, {"vertebra", "vertebrae", "vertebral", "spine"});
}

BodySide side_of(const Words& words) {
  bool left = false, right = false;
  for (std::size_t i = 0; i < words.size(); ++i) {
    left |= words[i] == "left" || words[i] == "lt" || words[i] == "sinister" || words[i] == "sinistra" ||
            (words[i] == "l" && !is_level(words, i));
    right |= words[i] == "right" || words[i] == "rt" || words[i] == "dexter" || words[i] == "dextra" || words[i] == "r";
  }
  return left == right ? BodySide::Middle : left ? BodySide::Left : BodySide::Right;
}

int ordinal_of(const Words& words) {
  static constexpr std::array<std::string_view, 5> kOrdinals = {"first", "second", "third", "fourth", "fifth"};
  for (const std::string& word : words) {
    for (int k = 0; k < 5; ++k)
      if (word == kOrdinals[k]) return k + 1;
    if (word.size() == 1 && word[0] >= '1' && word[0] <= '5') return word[0] - '0';
  }
  return 0;
}

// Returns the finger that a name means. The word before "finger" decides, as in "Middle phalanx of left middle finger".
BodyPart finger_of(const Words& words) {
  static const std::map<std::string, BodyPart, std::less<>> kFingers = {
      {"thumb", BodyPart::Thumb},   {"pollex", BodyPart::Thumb}, {"index", BodyPart::Index},  {"ring", BodyPart::Ring},
      {"little", BodyPart::Little}, {"pinky", BodyPart::Little}, {"middle", BodyPart::Middle}};
  for (std::size_t i = 1; i < words.size(); ++i)
    if (words[i] == "finger")
      if (const auto found = kFingers.find(words[i - 1]); found != kFingers.end()) return found->second;
  for (const std::string& word : words)
    if (const auto found = kFingers.find(word); found != kFingers.end() && word != "middle") return found->second;
  if (const int number = ordinal_of(words))
    return static_cast<BodyPart>(static_cast<int>(BodyPart::Thumb) + number - 1);
  return BodyPart::Fingers;
}

void read_finger(const Words& words, AnatomicalName& name) {
  name.regions.insert(BoneRegion::Finger);
  name.finger = finger_of(words);
  if (has_any(words, {"metacarpal", "metacarpals", "metacarpus"})) name.segment = 0;
  else if (has(words, "proximal")) name.segment = 1;
  else if (has(words, "distal")) name.segment = 3;  // "distal" is tested before "middle", which may name the finger
  else if (has_any(words, {"middle", "intermediate"}) && has_any(words, {"phalanx", "phalanges"})) name.segment = 2;
  // A thumb has no middle phalanx. Its metacarpal is segment 1, its proximal phalanx 2 and its distal phalanx 3.
  if (name.finger == BodyPart::Thumb && name.segment >= 0) name.segment = name.segment == 3 ? 3 : name.segment + 1;
  name.plural = name.finger == BodyPart::Fingers || name.segment < 0;
}
}  // namespace

AnatomicalName anatomical_name(std::string_view label_name) {
  const Words words = words_of(label_name);
  AnatomicalName name;
  name.side = side_of(words);

  const bool is_vertebra = has_any(words, {"vertebra", "vertebrae", "vertebral"});
  int levels = 0;
  for (std::size_t i = 0; i < words.size(); ++i) {
    const std::string& word = words[i];
    if (is_level(words, i) && (word == "c" || word == "t" || word == "th" || word == "l" || word == "s")) {
      name.regions.insert(word == "c"   ? BoneRegion::Neck
                          : word == "l" ? BoneRegion::Lumbar
                          : word == "s" ? BoneRegion::Pelvis
                                        : BoneRegion::Thorax);
      ++levels;
      continue;
    }
    if (const auto found = dictionary().find(word); found != dictionary().end()) {
      name.regions.insert(found->second.region);
      name.plural |= found->second.plural;
    }
  }
  // A name such as "Lower leg bones" means all bones of half a limb and names no single bone.
  if (name.regions.empty() && has_any(words, {"bone", "bones"}) && has(words, "upper") != has(words, "lower")) {
    const bool upper = has(words, "upper");
    if (has_any(words, {"arm", "arms"})) name.regions.insert(upper ? BoneRegion::UpperArm : BoneRegion::Forearm);
    if (has_any(words, {"leg", "legs"})) name.regions.insert(upper ? BoneRegion::Thigh : BoneRegion::Shank);
  }
  // "Fifth lumbar vertebra", "vertebrae_L5" and "Spine T4" mean one bone. "Lumbar spine" and "Thoracic vertebrae" mean
  // several bones.
  if (levels == 1 || has(words, "vertebra")) name.plural = false;
  if (is_vertebra && name.regions.empty()) name.regions.insert(BoneRegion::Spine), name.plural = true;
  // In "Lumbar spine" and "scapular spine" the word beside "spine" gives the region.
  if (name.regions.size() > 1) name.regions.erase(BoneRegion::Spine);

  const bool is_foot = name.regions.contains(BoneRegion::Toes) || name.regions.contains(BoneRegion::Foot);
  const bool is_phalanx = has_any(words, {"phalanx", "phalanges", "metacarpal", "metacarpals", "metacarpus", "thumb",
                                          "thumbs", "finger", "fingers"});
  if (is_foot && has_any(words, {"phalanx", "phalanges"})) {
    name.regions = {BoneRegion::Toes};
  } else if (is_foot) {
    name.regions.erase(BoneRegion::Hand);
    // "Navicular bone of left foot" means one bone. "Ankles and foot bones" means all bones of the foot including the
    // toes.
    const bool is_one = std::any_of(words.begin(), words.end(), [](const std::string& word) {
      const auto found = dictionary().find(word);
      return word == "sesamoid" ||
             (found != dictionary().end() && found->second.region == BoneRegion::Foot && !found->second.plural);
    });
    name.plural = !is_one;
    if (name.plural) name.regions.insert(BoneRegion::Toes);
  } else if (is_phalanx) {
    const bool with_hand = name.regions.contains(BoneRegion::Hand) && !has_any(words, {"phalanx", "metacarpal"});
    name.regions.erase(BoneRegion::Hand);
    read_finger(words, name);
    if (with_hand) name.regions.insert(BoneRegion::Hand), name.plural = true;
  } else if (name.regions.contains(BoneRegion::Hand) && name.plural) {
    name.regions.insert(BoneRegion::Finger);
  }
  name.plural |= name.regions.size() > 1;
  return name;
}

std::string_view to_string(BoneRegion region) {
  switch (region) {
    case BoneRegion::Head: return "head";
    case BoneRegion::Neck: return "neck";
    case BoneRegion::Thorax: return "thorax";
    case BoneRegion::Lumbar: return "lumbar spine";
    case BoneRegion::Spine: return "spine";
    case BoneRegion::Pelvis: return "pelvis";
    case BoneRegion::Shoulder: return "shoulder";
    case BoneRegion::UpperArm: return "upper arm";
    case BoneRegion::Forearm: return "forearm";
    case BoneRegion::Hand: return "hand";
    case BoneRegion::Finger: return "fingers";
    case BoneRegion::Thigh: return "thigh";
    case BoneRegion::Shank: return "shank";
    case BoneRegion::Foot: return "foot";
    case BoneRegion::Toes: return "toes";
  }
  return "";
}

}  // namespace limber
