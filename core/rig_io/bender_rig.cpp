// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/rig_io/bender_rig.h"

#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <memory>
#include <new>
#include <optional>
#include <string_view>
#include <type_traits>
#include <vector>

#include <expat.h>

#include "core/base/error.h"
#include "core/base/rigid_transform.h"

namespace limber {

namespace {
constexpr int kMostBones = 4096;

glm::dvec3 lps_from_ras(const glm::dvec3& p) { return {-p.x, -p.y, p.z}; }

// Reads a legacy VTK file word by word. Where names may contain spaces, whole lines are read.
class VtkText {
 public:
  VtkText(std::string_view text, std::string where) : text_(text), where_(std::move(where)) {}

  [[noreturn]] void refuse(const std::string& what, const std::string& what_to_do) const {
    throw Error(what, where_ + ", line " + std::to_string(line_), what_to_do);
  }

  // Returns the next word; empty at the end of the text.
  std::string_view word() {
    skip_space();
    const size_t begin = place_;
    while (place_ < text_.size() && !std::isspace(static_cast<unsigned char>(text_[place_]))) ++place_;
    return text_.substr(begin, place_ - begin);
  }

  // Returns the next line that is not blank, without spaces at its ends.
  std::string_view line() {
    skip_space();
    size_t end = text_.find_first_of("\r\n", place_);
    if (end == text_.npos) end = text_.size();
    std::string_view line = text_.substr(place_, end - place_);
    place_ = end;
    while (!line.empty() && std::isspace(static_cast<unsigned char>(line.back()))) line.remove_suffix(1);
    return line;
  }

  double number(const char* of) {
    const std::string_view digits = word();
    double value = 0;
    const auto [end, error] =
        std::from_chars(digits.data() + (digits.starts_with('+') ? 1 : 0), digits.data() + digits.size(), value);
    if (digits.empty()) refuse(std::string("the file ends inside ") + of, "copy the whole file again");
    if (error != std::errc() || end != digits.data() + digits.size() || !std::isfinite(value))
      refuse("\"" + std::string(digits.substr(0, 40)) + "\" was found instead of a number of " + of,
             "correct the file");
    return value;
  }

  int count(const char* of, int largest) {
    const double value = number(of);
    if (value != std::floor(value) || value < -1 || value > largest)
      refuse(std::string("a number of ") + of + " is not between -1 and " + std::to_string(largest),
             "correct the file");
    return static_cast<int>(value);
  }

 private:
  void skip_space() {
    for (; place_ < text_.size() && std::isspace(static_cast<unsigned char>(text_[place_])); ++place_)
      if (text_[place_] == '\n') ++line_;
  }

  std::string_view text_;
  std::string where_;
  size_t place_ = 0;
  int line_ = 1;
};

// Decodes a name in a VTK file. In names, VTK writes bytes that would end a line as %XX.
std::string decoded(std::string_view name) {
  std::string plain;
  for (size_t i = 0; i < name.size(); ++i) {
    unsigned byte = 0;
    if (name[i] == '%' && i + 2 < name.size() &&
        std::from_chars(name.data() + i + 1, name.data() + i + 3, byte, 16).ptr == name.data() + i + 3) {
      plain += static_cast<char>(byte);
      i += 2;
    } else {
      plain += name[i];
    }
  }
  return plain;
}

std::string encoded(const std::string& name) {
  std::string code;
  for (unsigned char c : name) {
    if (c > ' ' && c < 127 && c != '%' && c != '"') {
      code += static_cast<char>(c);
    } else {
      code += '%';
      code += "0123456789ABCDEF"[c >> 4];
      code += "0123456789ABCDEF"[c & 15];
    }
  }
  return code;
}

struct VtkArmature {
  std::vector<glm::dvec3> points;
  std::vector<std::pair<int, int>> lines;
  std::optional<std::vector<int>> parents;
  std::optional<std::vector<std::string>> names;
};

void read_points(VtkText& in, VtkArmature& read) {
  const int count = in.count("points", 2 * kMostBones);
  in.word();  // skips the numbers' type
  for (int i = 0; i < count; ++i) {
    const double x = in.number("POINTS"), y = in.number("POINTS"), z = in.number("POINTS");
    read.points.push_back(lps_from_ras({x, y, z}));
  }
}

void read_lines(VtkText& in, VtkArmature& read) {
  const int count = in.count("lines", kMostBones);
  in.count("line numbers", 3 * kMostBones);
  for (int i = 0; i < count; ++i) {
    if (in.count("points in a line", 1 << 20) != 2)
      in.refuse("a bone's line does not have two points", "write each bone as a line from head to tail");
    const int head = in.count("LINES", 1 << 20), tail = in.count("LINES", 1 << 20);
    read.lines.emplace_back(head, tail);
  }
}

// Reads the arrays of a FIELD section. Skips arrays that only concern posing or display.
void read_field(VtkText& in, VtkArmature& read) {
  in.word();
  const int arrays = in.count("arrays", 1000);
  for (int a = 0; a < arrays; ++a) {
    const std::string name(in.word());
    if (name == "METADATA") in.refuse("there are metadata inside the arrays", "save the armature without metadata");
    const int components = in.count("components", 1000), tuples = in.count("tuples", 2 * kMostBones);
    const std::string type(in.word());
    if (components < 0 || tuples < 0) in.refuse("an array has a negative size", "correct the file");
    const int count = components * tuples;
    if (name == "Parenthood") {
      read.parents.emplace();
      for (int i = 0; i < count; ++i) read.parents->push_back(in.count("Parenthood", kMostBones));
    } else if (type == "string") {
      std::vector<std::string> words;
      for (int i = 0; i < count; ++i) {
        words.push_back(decoded(in.line()));
        if (words.back().empty()) in.refuse("the file ends inside " + name.substr(0, 40), "copy the whole file again");
      }
      if (name == "Names") read.names = std::move(words);
    } else {
      for (int i = 0; i < count; ++i) in.number(("the array " + name.substr(0, 40)).c_str());
    }
  }
}
}  // namespace

Armature parse_bender_vtk(const std::string& text, const std::string& where) {
  if (!text.starts_with("# vtk DataFile"))
    throw Error("this is not a legacy VTK file", where, "save the armature as legacy ASCII .vtk");
  VtkText in(text, where);
  in.line();
  in.line();
  if (in.word() != "ASCII") in.refuse("the file is not ASCII", "save the armature as legacy ASCII .vtk");

  VtkArmature read;
  for (std::string_view word = in.word(); !word.empty(); word = in.word()) {
    if (word == "DATASET") {
      if (in.word() != "POLYDATA") in.refuse("the data set is not PolyData", "save the armature from Bender");
    } else if (word == "POINTS") {
      read_points(in, read);
    } else if (word == "LINES") {
      read_lines(in, read);
    } else if (word == "CELL_DATA") {
      in.count("cells", kMostBones);
    } else if (word == "FIELD") {
      read_field(in, read);
    } else if (word == "METADATA" || word == "INFORMATION" || word == "NAME") {
      in.line();
    } else {
      in.refuse("unknown word \"" + std::string(word.substr(0, 40)) + "\"", "save the armature from Bender");
    }
  }

  if (read.lines.empty()) throw Error("there are no bones", where, "save the armature from Bender");
  if (!read.parents || !read.names)
    throw Error(std::string("the array ") + (read.parents ? "Names" : "Parenthood") + " is missing", where,
                "save the armature from Bender");
  if (read.parents->size() != read.lines.size() || read.names->size() != read.lines.size())
    throw Error("there are " + std::to_string(read.lines.size()) + " bones, " + std::to_string(read.parents->size()) +
                    " parents and " + std::to_string(read.names->size()) + " names",
                where, "give every bone one parent and one name");

  std::vector<Bone> bones(read.lines.size());
  for (size_t i = 0; i < bones.size(); ++i) {
    const auto [head, tail] = read.lines[i];
    const int points = static_cast<int>(read.points.size());
    if (head < 0 || tail < 0 || head >= points || tail >= points)
      throw Error("a line points outside the " + std::to_string(points) + " points",
                  where + ", bone " + std::to_string(i), "correct the file");
    bones[i].name = (*read.names)[i];
    bones[i].parent = (*read.parents)[i];
    bones[i].head = read.points[head];
    bones[i].tail = read.points[tail];
  }
  Armature armature = parents_first(std::move(bones), where);
  check_armature(armature, where);
  return armature;
}

// ---- Reading .arm files.

namespace {
// The coordinate frame of a bone in RAS, with the bone's tail as origin and its own axes. The file gives heads and
// tails of the bone's children in this frame.
struct ArmFrame {
  glm::dquat axes{1, 0, 0, 0};
  glm::dvec3 tail{0};
  int bone = -1;
};

struct ArmReader {
  std::string where;
  XML_Parser parser = nullptr;
  std::vector<ArmFrame> open;
  glm::dvec3 scale{1};
  bool armature_seen = false;
  std::vector<Bone> bones;
  // The message about the first mistake in the file. It is stored and thrown later, since an exception must not pass
  // through the C parser.
  std::string what, what_to_do;

  void refuse(const std::string& mistake, const std::string& remedy) {
    if (what.empty()) what = mistake, what_to_do = remedy;
    XML_StopParser(parser, XML_FALSE);
  }
};

const char* attribute(const char** attributes, std::string_view key) {
  for (; *attributes; attributes += 2)
    if (key == attributes[0]) return attributes[1];
  return nullptr;
}

// Parses exactly `count` finite numbers. Stops the reader with an error message if the text is anything else.
std::array<double, 4> numbers_of(ArmReader& reader, const char* text, int count, const char* key) {
  std::array<double, 4> values{};
  const std::string_view all = text ? text : "";
  const char* place = all.data();
  const char* end = place + all.size();
  for (int i = 0; i <= count; ++i) {
    while (place != end && std::isspace(static_cast<unsigned char>(*place))) ++place;
    if (i == count) break;
    const auto [stop, error] = std::from_chars(place, end, values[i]);
    // Numbers whose magnitude is too small for a double occur in real files. They are read as zero.
    const bool tiny = error == std::errc::result_out_of_range && std::abs(values[i]) < 1;
    if ((error != std::errc() && !tiny) || !std::isfinite(values[i]) || std::abs(values[i]) > 1e9) place = nullptr;
    if (!place) break;
    if (tiny) values[i] = 0;
    place = stop;
  }
  if (place != end)
    reader.refuse(std::string("a bone's ") + key + " is not " + std::to_string(count) + " finite numbers",
                  "correct the attribute");
  return values;
}

glm::dvec3 vector_of(ArmReader& reader, const char* text, const char* key) {
  const auto v = numbers_of(reader, text, 3, key);
  return {v[0], v[1], v[2]};
}

glm::dquat orientation_of(ArmReader& reader, const char* text) {
  if (!text) return {1, 0, 0, 0};
  const auto q = numbers_of(reader, text, 4, "orientation");
  const glm::dquat turn(q[3], q[0], q[1], q[2]);
  const double length = glm::length(turn);
  if (length > 1e-6) return turn / length;
  reader.refuse("an orientation is not a rotation", "give x, y, z, w, not all zero");
  return {1, 0, 0, 0};
}

void arm_open(void* data, const char* element, const char** attributes) {
  ArmReader& reader = *static_cast<ArmReader*>(data);
  if (!reader.what.empty()) return;
  if (element == std::string_view("armature")) {
    if (reader.armature_seen) return reader.refuse("there are two armatures", "keep one armature in a file");
    reader.armature_seen = true;
    ArmFrame frame;
    frame.axes = orientation_of(reader, attribute(attributes, "orientation"));
    if (const char* location = attribute(attributes, "location")) frame.tail = vector_of(reader, location, "location");
    if (const char* scale = attribute(attributes, "scale")) reader.scale = vector_of(reader, scale, "scale");
    reader.open.push_back(frame);
  } else if (element == std::string_view("bone")) {
    if (reader.open.empty()) return reader.refuse("a bone stands outside the armature", "use an .arm file of Bender");
    if (std::ssize(reader.bones) == kMostBones)
      return reader.refuse("there are more than " + std::to_string(kMostBones) + " bones",
                           "use an armature with fewer bones");
    const char* name = attribute(attributes, "name");
    const ArmFrame parent = reader.open.back();
    const glm::dvec3 head =
        parent.tail + parent.axes * (reader.scale * vector_of(reader, attribute(attributes, "head"), "head"));
    const glm::dvec3 tail =
        parent.tail + parent.axes * (reader.scale * vector_of(reader, attribute(attributes, "tail"), "tail"));
    const glm::dquat axes = glm::normalize(parent.axes * orientation_of(reader, attribute(attributes, "orientation")));
    Bone bone{name ? name : "", parent.bone, lps_from_ras(head), lps_from_ras(tail)};
    bone.roll = roll_of(bone, lps_from_ras(axes * glm::dvec3(1, 0, 0)));
    reader.open.push_back({axes, tail, static_cast<int>(reader.bones.size())});
    reader.bones.push_back(std::move(bone));
  }
}

void arm_close(void* data, const char* element) {
  ArmReader& reader = *static_cast<ArmReader*>(data);
  if (element == std::string_view("bone") && !reader.open.empty()) reader.open.pop_back();
}
}  // namespace

Armature parse_bender_arm(const std::string& text, const std::string& where) {
  const std::unique_ptr<std::remove_pointer_t<XML_Parser>, decltype(&XML_ParserFree)> parser(XML_ParserCreate(nullptr),
                                                                                             XML_ParserFree);
  if (!parser) throw std::bad_alloc();
  ArmReader reader{.where = where, .parser = parser.get()};
  XML_SetUserData(parser.get(), &reader);
  XML_SetElementHandler(parser.get(), arm_open, arm_close);
  const bool whole = XML_Parse(parser.get(), text.data(), static_cast<int>(text.size()), XML_TRUE) == XML_STATUS_OK;
  const std::string here = where + ", line " + std::to_string(XML_GetCurrentLineNumber(parser.get()));
  if (!reader.what.empty()) throw Error(reader.what, here, reader.what_to_do);
  if (!whole)
    throw Error(std::string("this is not valid XML (") + XML_ErrorString(XML_GetErrorCode(parser.get())) + ")", here,
                "copy the whole file again");
  if (!reader.armature_seen) throw Error("there is no armature", where, "use an .arm file of Bender");
  Armature armature{std::move(reader.bones)};
  check_armature(armature, where);
  return armature;
}

// ---- Writing .vtk files.

std::string bender_vtk_text(const Armature& armature) {
  const int count = static_cast<int>(armature.bones.size());
  auto digits = [](double value) {
    char text[32];
    return std::string(text, std::to_chars(text, text + sizeof text, value).ptr);
  };
  auto ras = [&](const glm::dvec3& p) {
    return digits(0.0 - p.x) + " " + digits(0.0 - p.y) + " " + digits(p.z) + "\n";
  };
  const std::string n = std::to_string(count);

  std::string text = "# vtk DataFile Version 3.0\nLimber armature, RAS mm\nASCII\nDATASET POLYDATA\n";
  text += "POINTS " + std::to_string(2 * count) + " double\n";
  for (const Bone& bone : armature.bones) text += ras(bone.head) + ras(bone.tail);
  text += "\nLINES " + n + " " + std::to_string(3 * count) + "\n";
  for (int i = 0; i < count; ++i) text += "2 " + std::to_string(2 * i) + " " + std::to_string(2 * i + 1) + "\n";

  text += "\nCELL_DATA " + n + "\nFIELD FieldData 5\nTransforms 12 " + n + " double\n";
  for (int i = 0; i < count; ++i) text += "1 0 0 0 1 0 0 0 1 0 0 0\n";
  // The envelope radius only serves display. A tenth of the bone's length is easy to see.
  text += "EnvelopeRadiuses 1 " + n + " double\n";
  for (const Bone& bone : armature.bones) text += digits(0.1 * glm::length(bone.tail - bone.head)) + "\n";
  text += "Parenthood 1 " + n + " vtkIdType\n";
  for (const Bone& bone : armature.bones) text += std::to_string(bone.parent) + "\n";
  text += "Names 1 " + n + " string\n";
  for (const Bone& bone : armature.bones) text += encoded(bone.name) + "\n";
  text += "RestToPoseRotation 4 " + n + " double\n";
  for (int i = 0; i < count; ++i) text += "1 0 0 0\n";
  return text;
}

}  // namespace limber
