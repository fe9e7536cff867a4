// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/export/glb_writer.h"

#include <bit>
#include <cmath>
#include <limits>

#include <nlohmann/json.hpp>

#include "core/base/error.h"

namespace limber {

namespace {
using Json = nlohmann::ordered_json;

static_assert(std::endian::native == std::endian::little, "numbers are written in native byte order");

// glTF's numbers for the component types of arrays [glTF 2.0, 3.6.2.2].
constexpr int kFloat = 5126, kUnsignedShort = 5123, kUnsignedInt = 5125;
constexpr int kVertices = 34962, kIndices = 34963;  // glTF's numbers for the `target` of a buffer view

std::size_t whole_words(std::size_t bytes) { return (bytes + 3) / 4 * 4; }
}  // namespace

int GlbData::put(const void* values, std::size_t count, std::size_t size, int component, const char* type, Use use) {
  data_.resize(whole_words(data_.size()), '\0');
  accessors_.push_back({.offset = data_.size(),
                        .bytes = count * size,
                        .count = count,
                        .component = component,
                        .type = type,
                        .use = use});
  data_.append(static_cast<const char*>(values), count * size);
  return static_cast<int>(accessors_.size()) - 1;
}

int GlbData::add(const std::vector<float>& values, Use use) {
  return put(values.data(), values.size(), sizeof(float), kFloat, "SCALAR", use);
}
int GlbData::add(const std::vector<glm::vec3>& values, Use use) {
  return put(values.data(), values.size(), sizeof(glm::vec3), kFloat, "VEC3", use);
}
int GlbData::add(const std::vector<glm::vec4>& values, Use use) {
  return put(values.data(), values.size(), sizeof(glm::vec4), kFloat, "VEC4", use);
}
int GlbData::add(const std::vector<glm::mat4>& values, Use use) {
  return put(values.data(), values.size(), sizeof(glm::mat4), kFloat, "MAT4", use);
}
int GlbData::add(const std::vector<std::array<std::uint16_t, 4>>& values, Use use) {
  return put(values.data(), values.size(), 8, kUnsignedShort, "VEC4", use);
}
int GlbData::add(const std::vector<std::uint32_t>& values, Use use) {
  return put(values.data(), values.size(), sizeof(std::uint32_t), kUnsignedInt, "SCALAR", use);
}

int GlbData::add_places(const std::vector<glm::vec3>& places) {
  const int index = add(places, Use::Vertices);
  glm::vec3 low(std::numeric_limits<float>::max()), high(std::numeric_limits<float>::lowest());
  for (const glm::vec3& p : places) low = glm::min(low, p), high = glm::max(high, p);
  accessor(index).least = {low.x, low.y, low.z};
  accessor(index).most = {high.x, high.y, high.z};
  return index;
}

std::string GlbData::file(std::string_view description) const {
  Json json = Json::parse(description);
  for (const Accessor& accessor : accessors_) {
    Json view = {{"buffer", 0}, {"byteOffset", accessor.offset}, {"byteLength", accessor.bytes}};
    if (accessor.use != Use::Any) view["target"] = accessor.use == Use::Vertices ? kVertices : kIndices;
    json["bufferViews"].push_back(view);
    Json row = {{"bufferView", json["bufferViews"].size() - 1},
                {"componentType", accessor.component},
                {"count", accessor.count},
                {"type", accessor.type}};
    if (accessor.normalized) row["normalized"] = true;
    if (!accessor.least.empty()) row.update({{"min", accessor.least}, {"max", accessor.most}});
    json["accessors"].push_back(row);
  }
  const std::size_t data_size = whole_words(data_.size());
  json["buffers"] = Json::array({{{"byteLength", data_size}}});
  std::string text = json.dump(-1, ' ', false, Json::error_handler_t::replace);
  text.resize(whole_words(text.size()), ' ');
  const std::uint64_t total = 12 + 8 + text.size() + 8 + data_size;
  if (total > std::numeric_limits<std::uint32_t>::max())
    throw Error("the file would be larger than 4 GB, which glTF cannot hold", "glTF export",
                "export fewer tissues or shorter clips");
  std::string out = "glTF";
  const auto put = [&](std::uint64_t value) {
    for (int i = 0; i < 4; ++i) out += static_cast<char>(value >> 8 * i & 255);
  };
  put(2);
  put(total);
  put(text.size());
  out += "JSON" + text;
  put(data_size);
  out.append("BIN\0", 4);
  out += data_;
  out.resize(total, '\0');
  return out;
}

glm::dvec3 linear_colour(const glm::vec3& colour) {
  glm::dvec3 linear;
  for (int i = 0; i < 3; ++i)
    linear[i] = colour[i] <= 0.04045f ? colour[i] / 12.92 : std::pow((colour[i] + 0.055) / 1.055, 2.4);
  return linear;
}

}  // namespace limber
