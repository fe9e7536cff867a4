// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/bake/baked_joint_io.h"

#include <algorithm>
#include <cmath>
#include <string_view>

#include <glm/gtc/packing.hpp>

#include "core/base/bytes.h"
#include "core/base/deflate.h"
#include "core/base/error.h"

namespace limber {

namespace {

constexpr std::string_view kHead = "limber baked joint 1\n";
constexpr std::uint64_t kLargestFile = std::uint64_t{1} << 30;
constexpr std::size_t kLargest = std::size_t{1} << 31;  // unpacked bytes; a file that unpacks to more is refused
// A file with more unpacked bytes per packed byte is refused. Deflate reaches 1032 at most; real files have 1 to 20.
constexpr std::size_t kMostUnpacked = 200;
constexpr int kMostAngles = 64, kMostStep = 64;
constexpr std::int32_t kFurthestNode = 1 << 20;
constexpr float kFurthestShift = 2000;  // mm; a file with a larger shift is refused

[[noreturn]] void damaged(const std::string& where) {
  throw Error("this is not a baked joint, or it is damaged", where, "bake the joint again: limber bake-joint");
}

void put_vector(ByteWriter& writer, const glm::dvec3& v) {
  for (int axis = 0; axis < 3; ++axis) writer.put(v[axis]);
}
void put_vector(ByteWriter& writer, const glm::ivec3& v) {
  for (int axis = 0; axis < 3; ++axis) writer.put(static_cast<std::int32_t>(v[axis]));
}

void put_errors(ByteWriter& writer, const std::vector<BakeError>& errors) {
  writer.count(errors.size());
  for (const BakeError& error : errors)
    for (const double each : {error.degrees, error.flesh_mm, error.skin_mm, error.largest_mm}) writer.put(each);
}

double finite(ByteReader& reader) {
  const double value = reader.get<double>();
  reader.require(std::isfinite(value));
  return value;
}

std::vector<BakeError> get_errors(ByteReader& reader) {
  std::vector<BakeError> errors(reader.count(4 * sizeof(double)));
  for (BakeError& error : errors) {
    for (double* each : {&error.degrees, &error.flesh_mm, &error.skin_mm, &error.largest_mm}) *each = finite(reader);
    reader.require(error.flesh_mm >= 0 && error.skin_mm >= 0 && error.largest_mm >= 0);
  }
  return errors;
}

glm::ivec3 get_vector(ByteReader& reader, std::int32_t low, std::int32_t high) {
  glm::ivec3 v;
  for (int axis = 0; axis < 3; ++axis) {
    v[axis] = reader.get<std::int32_t>();
    reader.require(v[axis] >= low && v[axis] <= high);
  }
  return v;
}

void put_nodes(ByteWriter& writer, const std::vector<std::int32_t>& nodes) {
  // For each run of nodes with consecutive indices: the index of its first node, and its number of nodes.
  std::vector<std::pair<std::int32_t, std::int32_t>> runs;
  for (const std::int32_t place : nodes)
    if (!runs.empty() && runs.back().first + runs.back().second == place) ++runs.back().second;
    else runs.emplace_back(place, 1);
  writer.count(runs.size());
  for (const auto& [first, count] : runs) writer.put(first), writer.put(count);
}

// Reads the positions of the nodes. Their shifts follow later in the file.
//   angles  number of angles with shifts
std::vector<std::int32_t> get_nodes(ByteReader& reader, const glm::ivec3& size, std::size_t angles, std::size_t bytes) {
  const std::int64_t places = std::int64_t{size.x} * size.y * size.z;
  reader.require(places <= INT32_MAX);
  std::vector<std::int32_t> nodes;
  std::int64_t next = 0;
  for (std::size_t run = reader.count(8); run > 0; --run) {
    const std::int64_t first = reader.get<std::int32_t>(), count = reader.get<std::int32_t>();
    reader.require(first >= next && count > 0 && first + count <= places);
    reader.require((nodes.size() + count) * angles * 6 <= bytes);
    for (std::int64_t place = first; place < first + count; ++place) nodes.push_back(static_cast<std::int32_t>(place));
    next = first + count;
  }
  return nodes;
}

void put_shifts(ByteWriter& writer, const std::vector<glm::vec3>& shifts) {
  for (int axis = 0; axis < 3; ++axis)
    for (const glm::vec3& shift : shifts) writer.put(static_cast<std::uint16_t>(glm::packHalf1x16(shift[axis])));
}

std::vector<glm::vec3> get_shifts(ByteReader& reader, std::size_t count) {
  std::vector<glm::vec3> shifts(count);
  for (int axis = 0; axis < 3; ++axis)
    for (glm::vec3& shift : shifts) {
      shift[axis] = glm::unpackHalf1x16(reader.get<std::uint16_t>());
      reader.require(std::abs(shift[axis]) <= kFurthestShift);  // this also refuses NaN
    }
  return shifts;
}

std::string packed(const std::string& bytes) {
  std::string to;
  Deflater deflater(Deflater::Wrap::Zlib,
                    [&](const void* more, std::size_t size) { to.append(static_cast<const char*>(more), size); });
  deflater.write(bytes.data(), bytes.size());
  deflater.end();
  return to;
}

std::string unpacked(std::string_view packed, const std::string& where) {
  const std::size_t most = std::min(kLargest, kMostUnpacked * packed.size() + 65536);
  Inflater inflater;
  std::string bytes;
  std::string room(65536, '\0');
  for (;;) {
    const Inflater::Step step = inflater.inflate(packed, room.data(), room.size());
    packed.remove_prefix(step.taken);
    bytes.append(room, 0, step.made);
    if (step.damaged || bytes.size() > most) damaged(where);
    if (inflater.ended()) break;
    if (step.taken == 0 && step.made == 0) damaged(where);
  }
  if (!packed.empty() || inflater.behind() > 0) damaged(where);
  return bytes;
}

}  // namespace

std::string encode(const BakedJoint& joint) {
  ByteWriter writer;
  writer.text(joint.bone);
  put_vector(writer, joint.axis);
  writer.count(joint.degrees.size());
  for (const double degrees : joint.degrees) writer.put(degrees);
  for (const BakeSource::Hash* hash :
       {&joint.source.volume, &joint.source.bones, &joint.source.rig, &joint.source.weights})
    writer.raw(hash->data(), hash->size());
  writer.text(joint.glide);
  writer.text(joint.quality);
  writer.flag(joint.contact);
  put_errors(writer, joint.at_baked);
  put_errors(writer, joint.between);
  put_vector(writer, joint.step);
  put_vector(writer, joint.first);
  put_vector(writer, joint.size);
  put_nodes(writer, joint.nodes);
  for (const std::vector<glm::vec3>& shifts : joint.shifts) put_shifts(writer, shifts);
  return std::string(kHead) + packed(writer.take());
}

BakedJoint decode_baked_joint(const std::string& bytes, const std::string& where) {
  if (!bytes.starts_with(kHead)) damaged(where);
  const std::string whole = unpacked(std::string_view(bytes).substr(kHead.size()), where);
  ByteReader reader(whole, [&] { damaged(where); });
  BakedJoint joint;
  joint.bone = reader.text();
  for (int axis = 0; axis < 3; ++axis) joint.axis[axis] = finite(reader);
  reader.require(std::abs(glm::length(joint.axis) - 1) < 1e-6);
  joint.degrees.resize(reader.count(sizeof(double)));
  for (double& degrees : joint.degrees) {
    degrees = finite(reader);
    reader.require(std::abs(degrees) <= 180 && (&degrees == joint.degrees.data() || degrees > *(&degrees - 1)));
  }
  const auto rests = std::count(joint.degrees.begin(), joint.degrees.end(), 0.0);
  reader.require(rests == 1 && joint.degrees.size() > 1 && joint.degrees.size() <= kMostAngles);
  for (BakeSource::Hash* hash : {&joint.source.volume, &joint.source.bones, &joint.source.rig, &joint.source.weights})
    std::memcpy(hash->data(), reader.raw(hash->size()).data(), hash->size());
  joint.glide = reader.text();
  joint.quality = reader.text();
  joint.contact = reader.flag();
  joint.at_baked = get_errors(reader);
  joint.between = get_errors(reader);
  joint.step = get_vector(reader, 1, kMostStep);
  joint.first = get_vector(reader, -kFurthestNode, kFurthestNode);
  joint.size = get_vector(reader, 0, kFurthestNode);
  joint.nodes = get_nodes(reader, joint.size, joint.degrees.size() - 1, whole.size());
  for (const double degrees : joint.degrees)
    joint.shifts.push_back(get_shifts(reader, degrees == 0 ? 0 : joint.nodes.size()));
  reader.end();
  return joint;
}

BakedJoint read_baked_joint(const Path& path) {
  return decode_baked_joint(read_file(path, kLargestFile), path.string());
}

void write_baked_joint(const BakedJoint& joint, const Path& path) {
  const std::string bytes = encode(joint);
  decode_baked_joint(bytes, path.string());  // throws if the file could not be read again; then nothing is written
  write_file_atomically(path, bytes);
}

}  // namespace limber
