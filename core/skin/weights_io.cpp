// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/skin/weights_io.h"

#include <algorithm>
#include <bit>
#include <cstring>
#include <fstream>
#include <limits>
#include <map>

#include <nlohmann/json.hpp>

#include "core/base/deflate.h"
#include "core/base/error.h"
#include "core/skin/best_four.h"
#include "core/volume/volume_io.h"

namespace limber {

namespace fs = std::filesystem;

namespace {
static_assert(sizeof(Influence) == 16 && std::endian::native == std::endian::little, "Influence is stored as it lies in memory");
const char* const kMakeAnew = "make weights anew with `limber weights`";

std::string tissue_sha256(const TissueVoxels& tissue) {
  std::string bytes;
  bytes.reserve(tissue.bricks().size() * (sizeof(glm::ivec3) + 64));
  for (const auto& brick : tissue.bricks()) {
    bytes.append(reinterpret_cast<const char*>(&brick.corner), sizeof brick.corner);
    bytes.append(reinterpret_cast<const char*>(brick.mask.data()), sizeof brick.mask);
  }
  return sha256_of_bytes(bytes.data(), bytes.size());
}

std::string text_of(const glm::ivec3& size) {
  return std::to_string(size.x) + " " + std::to_string(size.y) + " " + std::to_string(size.z);
}

struct Header {
  std::map<std::string, std::string> fields;  // "type", "sizes", and keys as "limber_bones"
  std::size_t data_begin = 0;
};

Header parse_header(const std::string& bytes, const std::string& where) {
  if (bytes.compare(0, 7, "NRRD000") != 0) throw Error("these are no weights", where, "give a W.nrrd, a folder of weight_NN.mha or Bender's skin map");
  Header header;
  std::size_t at = 0;
  for (;;) {
    const std::size_t end = bytes.find('\n', at);
    if (end == std::string::npos) throw Error("the header of the weights has no end", where, kMakeAnew);
    std::string line = bytes.substr(at, end - at);
    at = end + 1;
    if (!line.empty() && line.back() == '\r') line.pop_back();
    if (line.empty()) break;
    if (line[0] == '#' || line.compare(0, 4, "NRRD") == 0) continue;
    const std::size_t key_mark = line.find(":="), field_mark = line.find(": ");
    if (key_mark != std::string::npos && key_mark <= field_mark)
      header.fields[line.substr(0, key_mark)] = line.substr(key_mark + 2);
    else if (field_mark != std::string::npos)
      header.fields[line.substr(0, field_mark)] = line.substr(field_mark + 2);
  }
  header.data_begin = at;
  return header;
}

// Place in the rig of each of the file's bones.
std::vector<std::uint16_t> bones_in_rig(const std::string& names, const std::string& where, const Armature& armature) {
  const auto list = nlohmann::json::parse(names, nullptr, false);
  if (!list.is_array() || list.empty()) throw Error("the weights name no bones", where, kMakeAnew);
  std::map<std::string, int> place;
  for (std::size_t b = 0; b < armature.bones.size(); ++b) place[armature.bones[b].name] = static_cast<int>(b);
  std::vector<std::uint16_t> in_rig;
  for (const auto& name : list) {
    const auto found = name.is_string() ? place.find(name.get<std::string>()) : place.end();
    if (found == place.end()) throw Error("the weights name a bone that the rig lacks", where + ", " + name.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace).substr(0, 80), "use the rig they were made with, or " + std::string(kMakeAnew));
    in_rig.push_back(static_cast<std::uint16_t>(found->second));
  }
  return in_rig;
}

std::string inflated(const std::string& bytes, std::size_t begin, std::size_t size, const std::string& where) {
  std::string data(size, '\0');
  Inflater stream;
  std::string_view packed = std::string_view(bytes).substr(begin);
  std::size_t done = 0;
  for (bool moves = true; moves && !stream.ended();) {
    const Inflater::Step step = stream.inflate(packed, data.data() + done, size - done);
    packed.remove_prefix(step.taken);
    done += step.made;
    moves = !step.damaged && step.taken + step.made > 0;
  }
  if (!stream.ended() || done < size) throw Error("the compressed weights are damaged or too short", where, kMakeAnew);
  return data;
}

// By falling weight, bones as the rig numbers them. Throws for what no writer of ours makes.
void accept(Influence& influence, const std::vector<std::uint16_t>& in_rig, const std::string& where) {
  int sum = 0;
  for (int k = 0; k < 4; ++k) {
    sum += influence.weight[k];
    if (influence.weight[k] == 0) {
      influence.bone[k] = 0;
    } else if (influence.bone[k] >= in_rig.size()) {
      throw Error("a weight belongs to bone " + std::to_string(influence.bone[k]) + " of " + std::to_string(in_rig.size()), where, kMakeAnew);
    } else {
      influence.bone[k] = in_rig[influence.bone[k]];
    }
  }
  if (sum != kFullWeight) throw Error("a voxel's weights sum to " + std::to_string(sum) + " of " + std::to_string(kFullWeight), where, kMakeAnew);
  for (int k = 1; k < 4; ++k)
    for (int j = k; j > 0 && influence.weight[j] > influence.weight[j - 1]; --j) {
      std::swap(influence.weight[j], influence.weight[j - 1]);
      std::swap(influence.bone[j], influence.bone[j - 1]);
    }
}

std::vector<std::string> names_of(const Armature& armature) {
  std::vector<std::string> names;
  for (const Bone& bone : armature.bones) names.push_back(bone.name);
  return names;
}

void require_same_grid(const Grid& grid, const LabelVolume& volume, const Path& path) {
  if (grid.size != volume.grid.size)
    throw Error("the weights are for a grid of " + text_of(grid.size) + " voxels, the volume has " + text_of(volume.grid.size), path.string(),
                "give the volume they were made for");
}

// Tissue without any weight follows the nearest rig bone.
void cover_the_rest(BestFour& best, const LabelVolume& volume, const TissueVoxels& tissue, const Armature& armature,
                    const Path& path, std::vector<std::string>& warnings) {
  const AffineTransform from_voxel = world_from_voxel(volume.grid);
  std::int64_t left_out = 0;
  tissue.for_each([&](std::int64_t place, const glm::ivec3& v) {
    if (best.covered(place)) return;
    ++left_out;
    int nearest = 0;
    double least = std::numeric_limits<double>::max();
    for (std::size_t b = 0; b < armature.bones.size(); ++b)
      if (const double d = distance_to_bone(armature.bones[b], from_voxel * glm::dvec3(v)); d < least) least = d, nearest = static_cast<int>(b);
    best.hold(place, nearest);
  });
  if (left_out > 0)
    warnings.push_back(path.string() + " gives no bone to " + std::to_string(left_out) + " tissue voxels: each follows the nearest bone");
}

WeightsFile read_bender_series(const Path& folder, const LabelVolume& volume, const TissueVoxels& tissue, const Armature& armature) {
  std::vector<Path> files;
  for (const auto& entry : fs::directory_iterator(folder)) {
    const std::string name = entry.path().filename().string();
    if (name.rfind("weight_", 0) == 0 && (entry.path().extension() == ".mha" || entry.path().extension() == ".mhd")) files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  if (files.size() != armature.bones.size())
    throw Error("the folder holds " + std::to_string(files.size()) + " files weight_NN.mha, the rig has " + std::to_string(armature.bones.size()) + " bones",
                folder.string(), "give one file for each bone, in the rig's order");
  WeightsFile result;
  BestFour best(tissue.size());
  std::vector<std::int64_t> place(tissue.size());
  std::vector<float> values(tissue.size());
  for (std::size_t b = 0; b < files.size(); ++b) {
    const GreyVolume grey = read_grey_volume(files[b]);
    require_same_grid(grey.grid, volume, files[b]);
    result.warnings.insert(result.warnings.end(), grey.warnings.begin(), grey.warnings.end());
    tissue.for_each([&](std::int64_t i, const glm::ivec3& v) {
      place[i] = i;
      const float value = grey.voxels[grey.grid.index(v)];
      values[i] = value > 0 ? std::min(value, 1.0f) : 0.0f;  // also for NaN
    });
    best.offer(place, values, 1, 0, static_cast<int>(b));
  }
  cover_the_rest(best, volume, tissue, armature, folder, result.warnings);
  result.weights = best.weights(names_of(armature), tissue);
  return result;
}

WeightsFile read_bender_map(const Path& path, const LabelVolume& volume, const TissueVoxels& tissue, const Armature& armature) {
  constexpr int kFirstBone = 2;
  VolumeFile map = read_volume(path);
  require_same_grid(map.volume.grid, volume, path);
  std::vector<int> bone(1 << 16, -1);
  for (const Tissue& value : map.tissues.tissues) {
    if (value.file_value < 1 || value.file_value >= kFirstBone + double(armature.bones.size()))
      throw Error("the skin map holds the value " + std::to_string(static_cast<std::int64_t>(value.file_value)) + ", the rig has " +
                      std::to_string(armature.bones.size()) + " bones, numbered from 2",
                  path.string(), "give the rig it was made with");
    bone[value.label] = static_cast<int>(value.file_value) - kFirstBone;
  }
  WeightsFile result;
  result.warnings = std::move(map.warnings);
  BestFour best(tissue.size());
  tissue.for_each([&](std::int64_t place, const glm::ivec3& v) {
    if (const int b = bone[map.volume.at(v)]; b >= 0) best.hold(place, b);
  });
  cover_the_rest(best, volume, tissue, armature, path, result.warnings);
  result.weights = best.weights(names_of(armature), tissue);
  return result;
}
}  // namespace

SkinWeights parse_weights(const std::string& bytes, const std::string& where, const LabelVolume& volume,
                          const TissueVoxels& tissue, const Armature& armature) {
  const Header header = parse_header(bytes, where);
  auto field = [&](const std::string& name) {
    const auto found = header.fields.find(name);
    if (found == header.fields.end()) throw Error("the weights lack the field " + name, where, kMakeAnew);
    return found->second;
  };
  const std::string type = field("type"), encoding = field("encoding");
  if (type != "unsigned short" && type != "ushort" && type != "uint16" && type != "uint16_t")
    throw Error("the weights are of type " + type.substr(0, 40), where, "they should be unsigned short");
  if (field("endian") != "little") throw Error("the weights are not little-endian", where, kMakeAnew);
  if (field("limber_size") != text_of(volume.grid.size) || field("sizes") != "8 " + std::to_string(tissue.size()) ||
      field("limber_tissue_sha256") != tissue_sha256(tissue))
    throw Error("the weights belong to another volume", where, "give the volume they were made for, or " + std::string(kMakeAnew));
  const std::vector<std::uint16_t> in_rig = bones_in_rig(field("limber_bones"), where, armature);

  const std::size_t size = static_cast<std::size_t>(tissue.size()) * sizeof(Influence);
  std::string unpacked;
  const char* data = bytes.data() + header.data_begin;
  if (encoding == "gzip" || encoding == "gz") {
    unpacked = inflated(bytes, header.data_begin, size, where);
    data = unpacked.data();
  } else if (encoding != "raw") {
    throw Error("the weights are encoded as " + encoding.substr(0, 40), where, "save them raw or gzip");
  } else if (bytes.size() - header.data_begin != size) {
    throw Error("the weights hold " + std::to_string(bytes.size() - header.data_begin) + " bytes instead of " + std::to_string(size), where, kMakeAnew);
  }

  SkinWeights weights(names_of(armature), tissue);
  for (std::int64_t b = 0; b < std::ssize(tissue.bricks()); ++b) {
    const auto& brick = tissue.bricks()[b];
    SkinWeights::Chunk chunk(brick.count());
    std::memcpy(chunk.data(), data + brick.first * sizeof(Influence), chunk.size() * sizeof(Influence));
    for (Influence& influence : chunk) accept(influence, in_rig, where);
    weights.set_chunk(b, std::move(chunk));
  }
  return weights;
}

WeightsFile read_weights(const Path& path, const LabelVolume& volume, const TissueVoxels& tissue, const Armature& armature) {
  std::error_code error;
  if (fs::is_directory(path, error)) return read_bender_series(path, volume, tissue, armature);
  const std::string extension = path.extension().string();
  if (extension == ".mha" || extension == ".mhd") return read_bender_map(path, volume, tissue, armature);
  constexpr std::uint64_t kHeaderLimit = 1 << 20;
  return {parse_weights(read_file(path, kHeaderLimit + tissue.size() * sizeof(Influence)), path.string(), volume, tissue, armature), {}};
}

void check_weights_writable(const Path& path) {
  if (path.extension() != ".nrrd") throw Error("weights are written as .nrrd", path.string(), "choose a name that ends in .nrrd");
  check_place(path);
}

void write_weights(const SkinWeights& weights, const LabelVolume& volume, const TissueVoxels& tissue, const Path& path) {
  check_weights_writable(path);
  const nlohmann::json names = weights.bones();
  const std::string header = "NRRD0005\ntype: unsigned short\ndimension: 2\nsizes: 8 " + std::to_string(tissue.size()) +
                             "\nendian: little\nencoding: raw\nlimber_bones:=" + names.dump() + "\nlimber_size:=" + text_of(volume.grid.size) +
                             "\nlimber_tissue_sha256:=" + tissue_sha256(tissue) + "\n\n";
  write_atomically(path, [&](const Path& temporary) {
    std::ofstream out(temporary, std::ios::binary);
    out.write(header.data(), std::ssize(header));
    for (std::int64_t b = 0; b < weights.chunk_count(); ++b) {
      const auto& chunk = weights.chunk(b);
      out.write(reinterpret_cast<const char*>(chunk.data()), std::ssize(chunk) * sizeof(Influence));
    }
    out.flush();
    if (!out) throw Error("the weights cannot be written", path.string(), "check permissions and free space");
  });
}

void write_bender_weights(const SkinWeights& weights, const LabelVolume& volume, const TissueVoxels& tissue, const Path& folder) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (!fs::is_directory(folder)) throw Error("the folder cannot be made", folder.string(), "choose another place");
  const std::size_t digits = std::max<std::size_t>(2, std::to_string(weights.bones().size() - 1).size());
  std::vector<float> values(volume.voxels.size());
  for (std::size_t bone = 0; bone < weights.bones().size(); ++bone) {
    std::fill(values.begin(), values.end(), 0.0f);
    for (std::int64_t b = 0; b < weights.chunk_count(); ++b) {
      const auto& chunk = weights.chunk(b);
      tissue.for_each(b, b + 1, [&](std::int64_t place, const glm::ivec3& v) {
        values[volume.grid.index(v)] = static_cast<float>(chunk[place - tissue.bricks()[b].first].of(static_cast<int>(bone)));
      });
    }
    std::string number = std::to_string(bone);
    number.insert(0, digits - number.size(), '0');
    write_scalar_volume(volume.grid, values, folder / ("weight_" + number + ".mha"));
  }
}

}  // namespace limber
