// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/volume_io/landmarks.h"

#include <cmath>

#include "core/base/error.h"
#include "core/base/text_parse.h"
#include "core/tissue/tissue_match.h"

namespace limber {

namespace {
constexpr std::uint64_t kMostBytes = 64 << 20;
constexpr double kFurthest = 1e6;  // mm; a coordinate with a larger absolute value is refused
}  // namespace

std::vector<Landmark> read_landmarks(const Path& path) {
  const std::string text = read_file(path, kMostBytes);
  std::vector<Landmark> landmarks;
  int number = 0;
  for (std::string_view rest = text; !rest.empty();) {
    const auto line = trimmed(take_line(rest));
    const std::string where = path.string() + " line " + std::to_string(++number);
    if (line.empty() || line[0] == '#') continue;
    const auto fields = csv_fields(line);
    if (fields == std::vector<std::string>{"name", "x", "y", "z"}) continue;
    if (fields.size() != 4)
      throw Error("the line has " + std::to_string(fields.size()) + " fields", where, "write name,x,y,z in mm");
    Landmark landmark{fields[0], {}};
    for (int i = 0; i < 3; ++i) {
      const auto value = number_of<double>(fields[i + 1]);
      if (!value || !(std::abs(*value) <= kFurthest))
        throw Error("the coordinate is " + in_quotes(fields[i + 1]), where, "write millimetres");
      landmark.position[i] = *value;
    }
    landmarks.push_back(std::move(landmark));
  }
  if (landmarks.empty()) throw Error("there is no landmark", path.string(), "write a line name,x,y,z in mm for each");
  return landmarks;
}

void write_landmarks(const std::vector<Landmark>& landmarks, const Path& path) {
  std::string text = "name,x,y,z\n";
  for (const auto& [name, p] : landmarks)
    text += csv_field(name) + "," + text_of(p.x) + "," + text_of(p.y) + "," + text_of(p.z) + "\n";
  write_file_atomically(path, text);
}

}  // namespace limber
