// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/motion/bvh.h"

#include <algorithm>
#include <cassert>
#include <charconv>
#include <cmath>
#include <numbers>
#include <string_view>
#include <unordered_map>

#include "core/base/error.h"

namespace limber {

namespace {
constexpr std::uint64_t kMostBytes = std::uint64_t{1} << 30;
constexpr int kMostJoints = 4096;
// A file with a number of larger magnitude (file units or degrees) is refused. No real position or angle is larger, and
// the limit's square still fits single precision.
constexpr double kLargest = 1e15;

bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\n' || c == '\f' || c == '\v'; }
bool is_line_end(char c) { return c == '\r' || c == '\n'; }
char lower(char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; }

bool same_word(std::string_view a, std::string_view lower_case) {
  return std::equal(a.begin(), a.end(), lower_case.begin(), lower_case.end(),
                    [](char x, char y) { return lower(x) == y; });
}

// Reads words and numbers from the text. Words end at blanks and braces; a brace is a word of its own.
class Reader {
 public:
  Reader(std::string_view text, std::string where) : text_(text), where_(std::move(where)) {
    if (text_.starts_with("\xEF\xBB\xBF")) place_ = 3;
  }

  [[noreturn]] void refuse(const std::string& what, const std::string& what_to_do) const {
    // Lines are counted only when an error message needs the line number, so that reading stays fast.
    int line = 1;
    for (size_t i = 0; i < std::min(word_, text_.size()); ++i)
      if (text_[i] == '\n' || (text_[i] == '\r' && (i + 1 == text_.size() || text_[i + 1] != '\n'))) ++line;
    throw Error(what, where_ + ", line " + std::to_string(line), what_to_do);
  }

  // Returns the next word, empty at the end of the text.
  std::string_view word() {
    while (place_ < text_.size() && is_blank(text_[place_])) ++place_;
    word_ = place_;
    if (place_ < text_.size() && is_brace(text_[place_])) return text_.substr(place_++, 1);
    while (place_ < text_.size() && !is_blank(text_[place_]) && !is_brace(text_[place_])) ++place_;
    return text_.substr(word_, place_ - word_);
  }

  std::string_view peek() {
    const size_t place = place_;
    const std::string_view next = word();
    place_ = place;
    return next;
  }

  // Returns the rest of this line, up to its end or a brace, without blanks on either side.
  std::string_view rest_of_line() {
    size_t end = place_;
    while (end < text_.size() && !is_line_end(text_[end]) && !is_brace(text_[end])) ++end;
    std::string_view rest = text_.substr(place_, end - place_);
    place_ = end;
    while (!rest.empty() && is_blank(rest.front())) rest.remove_prefix(1);
    while (!rest.empty() && is_blank(rest.back())) rest.remove_suffix(1);
    return rest;
  }

  double number(const char* of) {
    const std::string_view digits = word();
    if (digits.empty())
      refuse(std::string("the file ends where ") + of + " needs a number", "copy the whole file again");
    return value_of(digits, of);
  }

  // Appends the numbers of the next line that is not blank. Returns false at the end of the text.
  bool line_of_numbers(std::vector<float>& values) {
    while (place_ < text_.size() && is_blank(text_[place_])) ++place_;
    if (place_ == text_.size()) return false;
    while (place_ < text_.size() && !is_line_end(text_[place_])) {
      if (is_blank(text_[place_])) {
        ++place_;
        continue;
      }
      word_ = place_;
      while (place_ < text_.size() && !is_blank(text_[place_])) ++place_;
      values.push_back(static_cast<float>(value_of(text_.substr(word_, place_ - word_), "a frame")));
    }
    return true;
  }

 private:
  static bool is_brace(char c) { return c == '{' || c == '}'; }

  double value_of(std::string_view digits, const char* of) const {
    const char* begin = digits.data();
    const char* end = begin + digits.size();
    if (*begin == '+') ++begin;
    double value = 0;
    const auto [stop, error] = std::from_chars(begin, end, value);
    // A number too small for a double reads as zero.
    const size_t exponent = digits.find_first_of("eE");
    if (error == std::errc::result_out_of_range && stop == end && exponent != digits.npos &&
        digits[exponent + 1] == '-')
      return 0;
    if (error != std::errc() || stop != end || !(std::abs(value) <= kLargest))
      refuse("\"" + printable(digits) + "\" was found where " + of + " needs a finite number", "correct the file");
    return value;
  }

 public:
  static std::string printable(std::string_view word) {
    std::string plain(word.substr(0, 40));
    for (char& c : plain)
      if (static_cast<unsigned char>(c) < 32 || static_cast<unsigned char>(c) > 126) c = '?';
    return plain;
  }

 private:
  std::string_view text_;
  std::string where_;
  size_t place_ = 0, word_ = 0;
};

// ---- reading the HIERARCHY section

BvhChannel channel_of(Reader& in) {
  static constexpr std::array<std::string_view, 6> kNames = {"xposition", "yposition", "zposition",
                                                             "xrotation", "yrotation", "zrotation"};
  const std::string_view word = in.word();
  for (size_t i = 0; i < kNames.size(); ++i)
    if (same_word(word, kNames[i])) return static_cast<BvhChannel>(i);
  in.refuse("\"" + Reader::printable(word) + "\" is not a channel",
            "use Xposition ... Zrotation, as many as the count says");
}

glm::dvec3 offset_of(Reader& in) {
  const double x = in.number("OFFSET"), y = in.number("OFFSET"), z = in.number("OFFSET");
  return {x, y, z};
}

void read_channels(Reader& in, BvhJoint& joint, Motion& motion) {
  const double count = in.number("CHANNELS");
  if (count != std::floor(count) || count < 0 || count > 6)
    in.refuse("the number of a joint's channels is not 0 to 6",
              "give each joint at most three positions and three rotations");
  if (!joint.channels.empty()) in.refuse("a joint has two lists of channels", "keep one list");
  for (int i = 0; i < static_cast<int>(count); ++i) joint.channels.push_back(channel_of(in));
  joint.first_channel = motion.channel_count;
  motion.channel_count += static_cast<int>(count);
}

void expect_open(Reader& in, const char* after) {
  if (in.word() != "{") in.refuse(std::string("a \"{\" is missing after ") + after, "correct the braces");
}

void read_end_site(Reader& in, BvhJoint& joint) {
  in.rest_of_line();
  expect_open(in, "End Site");
  for (;;) {
    const std::string_view word = in.word();
    if (word == "}") return;
    if (same_word(word, "offset")) {
      const glm::dvec3 offset = offset_of(in);
      if (!joint.end_site) joint.end_site = offset;
    } else if (!same_word(word, "channels") || in.number("CHANNELS") != 0) {
      in.refuse("an End Site holds more than an OFFSET", "correct the file");
    }
  }
}

// Makes joint names unique. Adds one warning to the motion, which counts the renamed joints.
void make_names_unique(Motion& motion) {
  std::unordered_map<std::string, int> used;
  for (const BvhJoint& joint : motion.joints) used.emplace(joint.name, 1);
  std::unordered_map<std::string, bool> seen;
  int renamed = 0;
  std::string example;
  for (BvhJoint& joint : motion.joints) {
    if (!joint.name.empty() && seen.emplace(joint.name, true).second) continue;
    const std::string base = joint.name.empty() ? "joint" : joint.name;
    int& number = used.emplace(base, 0).first->second;
    std::string name;
    do name = base + "." + std::to_string(++number);
    while (used.contains(name));
    used.emplace(name, 1);
    seen.emplace(name, true);
    if (++renamed == 1) example = base + " became " + name;
    joint.name = name;
  }
  if (renamed)
    motion.warnings.push_back(std::to_string(renamed) + " joints without a name of their own were renamed (" + example +
                              ")");
}

// Reads everything up to the word MOTION or the end of the text; returns true when MOTION follows.
bool read_hierarchy(Reader& in, Motion& motion) {
  if (!same_word(in.word(), "hierarchy")) in.refuse("the file does not begin with HIERARCHY", "use a BVH file");
  std::vector<int> open;
  for (;;) {
    const std::string_view word = in.word();
    const bool inside = !open.empty();
    if (word.empty() || (!inside && same_word(word, "motion"))) {
      if (inside)
        in.refuse("the file ends inside joint " + motion.joints[open.back()].name, "copy the whole file again");
      if (motion.joints.empty()) in.refuse("there are no joints", "use a BVH file with a ROOT");
      return !word.empty();
    }
    if (same_word(word, inside ? "joint" : "root")) {
      if (motion.joints.size() == kMostJoints)
        in.refuse("there are more than " + std::to_string(kMostJoints) + " joints", "use a file with fewer joints");
      BvhJoint joint;
      joint.name = in.rest_of_line();
      joint.parent = inside ? open.back() : -1;
      joint.first_channel = motion.channel_count;
      expect_open(in, "a joint's name");
      open.push_back(static_cast<int>(motion.joints.size()));
      motion.joints.push_back(std::move(joint));
    } else if (inside && word == "}") {
      open.pop_back();
    } else if (inside && same_word(word, "offset")) {
      motion.joints[open.back()].offset = offset_of(in);
    } else if (inside && same_word(word, "channels")) {
      read_channels(in, motion.joints[open.back()], motion);
    } else if (inside && same_word(word, "end")) {
      read_end_site(in, motion.joints[open.back()]);
    } else {
      in.refuse("\"" + Reader::printable(word) + "\" was found where a joint" +
                    (inside ? " is described" : " or MOTION should begin"),
                word == "}" || same_word(word, "motion") ? "correct the braces" : "correct the file");
    }
  }
}

// ---- reading the MOTION section

// Reads and returns the number after "Frames:" or "Frame Time:", with or without blanks before the colon.
double headed_number(Reader& in, std::string_view first, std::string_view second, const char* title) {
  std::string heading;
  while (heading.size() < 20 && !heading.ends_with(':')) {
    const std::string_view word = in.peek();
    if (word.empty() || word[0] == '{' || word[0] == '}') break;
    const size_t colon = word.find(':');
    if (colon != word.npos && colon + 1 < word.size())
      in.refuse(std::string("a blank is missing after ") + title, "correct the file");
    in.word();
    for (char c : word) heading += lower(c);
  }
  if (heading != std::string(first) + std::string(second) + ":")
    in.refuse(std::string("the line \"") + title + "\" is missing", "correct the file");
  return in.number(title);
}

void read_motion(Reader& in, Motion& motion) {
  const double promised = headed_number(in, "frames", "", "Frames:");
  if (promised < 0 || promised != std::floor(promised))
    in.refuse("the number of frames is not a whole number", "correct the file");
  motion.frame_time = headed_number(in, "frame", "time", "Frame Time:");
  if (motion.frame_time < 0) in.refuse("the frame time is negative", "correct the file");
  if (motion.frame_time == 0) {
    motion.frame_time = 1.0 / 30;
    motion.warnings.push_back("the frame time is 0; 30 frames per second are used");
  }
  if (motion.channel_count == 0) return;

  const size_t row = static_cast<size_t>(motion.channel_count);
  size_t whole = 0;
  while (in.line_of_numbers(motion.values)) {
    const size_t more = motion.values.size() - whole;
    if (more % row == 0) whole = motion.values.size();
    else if (more > row)
      in.refuse("a frame does not have " + std::to_string(row) + " values",
                "let every row hold one value for each channel");
  }

  const bool cut = motion.values.size() != whole;
  motion.values.resize(whole);
  motion.values.shrink_to_fit();
  motion.frame_count = static_cast<int>(whole / row);
  if (cut || promised != motion.frame_count) {
    char count[32];
    *std::to_chars(count, count + sizeof count - 1, promised, std::chars_format::fixed).ptr = 0;
    motion.warnings.push_back("the file promises " + std::string(count) + " frames and holds " +
                              std::to_string(motion.frame_count) +
                              (cut ? " complete frames and a part of another" : "") + "; the complete frames are used");
  }
}
}  // namespace

Motion parse_bvh(const std::string& text, const std::string& where) {
  Reader in(text, where);
  Motion motion;
  const bool moves = read_hierarchy(in, motion);
  make_names_unique(motion);
  if (moves) read_motion(in, motion);
  return motion;
}

Motion read_bvh(const Path& path) { return parse_bvh(read_file(path, kMostBytes), path.string()); }

// ---- writing

namespace {
std::string digits(double value) {
  char text[32];
  return std::string(text, std::to_chars(text, text + sizeof text, value).ptr);
}
std::string digits(float value) {
  char text[32];
  return std::string(text, std::to_chars(text, text + sizeof text, value).ptr);
}

std::string clean(std::string name) {
  for (char& c : name)
    if (is_line_end(c) || c == '{' || c == '}') c = '_';
  return name;
}

std::string vector_text(const glm::dvec3& v) { return digits(v.x) + " " + digits(v.y) + " " + digits(v.z); }

std::string joint_heading(const BvhJoint& joint, const std::string& indent) {
  static constexpr std::array<const char*, 6> kNames = {"Xposition", "Yposition", "Zposition",
                                                        "Xrotation", "Yrotation", "Zrotation"};
  std::string text = indent + (joint.parent < 0 ? "ROOT " : "JOINT ") + clean(joint.name) + "\n" + indent + "{\n";
  text += indent + "  OFFSET " + vector_text(joint.offset) + "\n" + indent + "  CHANNELS " +
          std::to_string(joint.channels.size());
  for (BvhChannel channel : joint.channels) text += std::string(" ") + kNames[static_cast<int>(channel)];
  return text + "\n";
}

// Returns the indices of the items in depth-first order: each item is followed by all its descendants, and siblings
// keep their order.
template <class Items>
std::vector<int> depth_first(const Items& items) {
  const int count = static_cast<int>(items.size());
  std::vector<std::vector<int>> below(items.size());
  std::vector<int> ready, order;
  for (int i = count; i-- > 0;) (items[i].parent < 0 ? ready : below[items[i].parent]).push_back(i);
  while (!ready.empty()) {
    const int i = ready.back();
    ready.pop_back();
    ready.insert(ready.end(), below[i].begin(), below[i].end());
    order.push_back(i);
  }
  return order;
}
}  // namespace

std::string bvh_text(const Motion& motion) {
  const std::vector<int> order = depth_first(motion.joints);
  std::string text = "HIERARCHY\n";
  std::vector<int> open;
  // The indentation stops at 32 levels, since otherwise the file of a chain of thousands of joints would consist mostly
  // of blanks.
  auto indentation = [&] { return std::string(2 * std::min<size_t>(open.size(), 32), ' '); };
  auto close_until = [&](int parent) {
    while (!open.empty() && open.back() != parent) {
      open.pop_back();
      text += indentation() + "}\n";
    }
  };
  for (int j : order) {
    const BvhJoint& joint = motion.joints[j];
    close_until(joint.parent);
    const std::string indent = indentation();
    text += joint_heading(joint, indent);
    if (joint.end_site)
      text += indent + "  End Site\n" + indent + "  {\n" + indent + "    OFFSET " + vector_text(*joint.end_site) +
              "\n" + indent + "  }\n";
    open.push_back(j);
  }
  close_until(-1);

  text += "MOTION\nFrames: " + std::to_string(motion.frame_count) + "\nFrame Time: " + digits(motion.frame_time) + "\n";
  for (int frame = 0; frame < motion.frame_count; ++frame) {
    const float* row = motion.values.data() + std::int64_t{frame} * motion.channel_count;
    int written = 0;
    for (int j : order)
      for (size_t c = 0; c < motion.joints[j].channels.size(); ++c) {
        text += digits(row[motion.joints[j].first_channel + c]);
        text += ++written < motion.channel_count ? ' ' : '\n';
      }
  }
  return text;
}

void write_bvh(const Motion& motion, const Path& path) { write_file_atomically(path, bvh_text(motion)); }

// ---- kinematics

void place_joint(std::vector<RigidTransform>& world, const Motion& motion, int frame, int j) {
  const float* row = frame < 0 ? nullptr : motion.values.data() + static_cast<size_t>(frame) * motion.channel_count;
  const BvhJoint& joint = motion.joints[j];
  RigidTransform local{glm::dquat(1, 0, 0, 0), joint.offset};
  for (size_t c = 0; row && c < joint.channels.size(); ++c) {
    const int channel = static_cast<int>(joint.channels[c]);
    const double value = row[joint.first_channel + c];
    if (channel < 3) {
      local.translation[channel] = value;
    } else {
      const double half = value * (std::numbers::pi / 360);
      glm::dquat turn(std::cos(half), 0, 0, 0);
      (channel == 3 ? turn.x : channel == 4 ? turn.y : turn.z) = std::sin(half);
      local.rotation = local.rotation * turn;
    }
  }
  world[j] = joint.parent < 0 ? RigidTransform{glm::normalize(local.rotation), local.translation}
                              : world[joint.parent] * local;
}

std::vector<RigidTransform> forward_kinematics(const Motion& motion, int frame) {
  assert(frame >= -1 && frame < motion.frame_count);
  std::vector<RigidTransform> world(motion.joints.size());
  for (int j = 0; j < std::ssize(world); ++j) place_joint(world, motion, frame, j);
  return world;
}

// ---- conversion to and from rigs

Armature armature_of(const Motion& motion) {
  const std::vector<RigidTransform> rest = forward_kinematics(motion, -1);
  const size_t count = rest.size();
  std::vector<glm::dvec3> sum(count, glm::dvec3(0));
  std::vector<int> children(count, 0);
  for (size_t j = 0; j < count; ++j)
    if (const int parent = motion.joints[j].parent; parent >= 0) sum[parent] += rest[j].translation, ++children[parent];

  Armature armature;
  for (size_t j = 0; j < count; ++j) {
    const BvhJoint& joint = motion.joints[j];
    const glm::dvec3 head = rest[j].translation;
    glm::dvec3 tail = children[j] ? sum[j] / double(children[j]) : head + joint.end_site.value_or(glm::dvec3(0));
    // A bone that has neither children nor an End Site continues in its parent's direction, at a third of the length.
    if (tail == head && joint.parent >= 0) tail = head + joint.offset / 3.0;
    if (tail == head) tail = head + glm::dvec3(0, 1, 0);
    armature.bones.push_back({joint.name, joint.parent, lps_from_bvh(head), lps_from_bvh(tail)});
  }
  return armature;
}

Motion motion_of(const Armature& armature) {
  Motion motion;
  std::vector<int> children(armature.bones.size(), 0);
  for (const Bone& bone : armature.bones)
    if (bone.parent >= 0) ++children[bone.parent];

  std::vector<int> place(armature.bones.size());
  for (int i : depth_first(armature.bones)) {
    const Bone& bone = armature.bones[i];
    BvhJoint joint;
    joint.name = bone.name;
    joint.parent = bone.parent < 0 ? -1 : place[bone.parent];
    joint.offset = bvh_from_lps(bone.parent < 0 ? bone.head : bone.head - armature.bones[bone.parent].head);
    if (bone.parent < 0) joint.channels = {BvhChannel::Xposition, BvhChannel::Yposition, BvhChannel::Zposition};
    joint.channels.insert(joint.channels.end(), {BvhChannel::Zrotation, BvhChannel::Xrotation, BvhChannel::Yrotation});
    joint.first_channel = motion.channel_count;
    motion.channel_count += static_cast<int>(joint.channels.size());
    if (!children[i]) joint.end_site = bvh_from_lps(bone.tail - bone.head);
    place[i] = static_cast<int>(motion.joints.size());
    motion.joints.push_back(std::move(joint));
  }
  return motion;
}

}  // namespace limber
