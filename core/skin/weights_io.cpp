// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/skin/weights_io.h"

#include <algorithm>
#include <bit>
#include <fstream>
#include <limits>
#include <map>

#include <nlohmann/json.hpp>

#include "core/base/error.h"
#include "core/base/json_text.h"
#include "core/base/parallel.h"
#include "core/skin/top_four.h"
#include "core/volume/seam_text.h"
#include "core/volume_io/nrrd.h"
#include "core/volume_io/volume_io.h"
#include "core/volume_io/voxel_source.h"

namespace limber {

namespace fs = std::filesystem;

namespace {
static_assert(sizeof(Influence) == 16 && std::endian::native == std::endian::little,
              "Influence is stored as it lies in memory");
const char* const kMakeAnew = "compute the weights again with `limber weights`";

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

// Upper limit on the text that describes seams, characters. If the text is longer, the weights are stored without it.
constexpr std::size_t kLongestSeams = 1 << 19;

// Returns the rig's bone index for each bone that the file names.
std::vector<std::uint16_t> bones_in_rig(const std::string& names, const std::string& where, const Armature& armature) {
  const auto list = nlohmann::json::parse(checked_json(names, where), nullptr, false);
  if (!list.is_array() || list.empty()) throw Error("the weights name no bones", where, kMakeAnew);
  std::map<std::string, int> place;
  for (std::size_t b = 0; b < armature.bones.size(); ++b) place[armature.bones[b].name] = static_cast<int>(b);
  std::vector<std::uint16_t> in_rig;
  for (const auto& name : list) {
    const auto found = name.is_string() ? place.find(name.get<std::string>()) : place.end();
    if (found == place.end())
      throw Error("the weights name a bone that the rig lacks",
                  where + ", " + name.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace).substr(0, 80),
                  "use the rig that the weights were made with, or " + std::string(kMakeAnew));
    in_rig.push_back(static_cast<std::uint16_t>(found->second));
  }
  return in_rig;
}

// Converts an influence that was read from a file: replaces the file's bone indices by those of the rig, and sorts the
// bones by descending weight. Throws Error for bones or sums that write_weights() never writes.
void accept(Influence& influence, const std::vector<std::uint16_t>& in_rig, const std::string& where) {
  int sum = 0;
  for (int k = 0; k < 4; ++k) {
    sum += influence.weight[k];
    if (influence.weight[k] == 0) {
      influence.bone[k] = 0;
    } else if (influence.bone[k] >= in_rig.size()) {
      throw Error("a weight belongs to bone number " + std::to_string(influence.bone[k]) +
                      ", but the number of bones is " + std::to_string(in_rig.size()),
                  where, kMakeAnew);
    } else {
      influence.bone[k] = in_rig[influence.bone[k]];
    }
  }
  if (sum != kFullWeight)
    throw Error("a voxel's weights sum to " + std::to_string(sum) + " instead of " + std::to_string(kFullWeight), where,
                kMakeAnew);
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
    throw Error(
        "the weights are for a grid of " + text_of(grid.size) + " voxels, the volume has " + text_of(volume.grid.size),
        path.string(), "give the volume that the weights were made for");
}

// Makes every tissue voxel that has no weight yet follow the nearest bone of the rig. Adds a warning if there are any.
void cover_the_rest(BestFour& best, const LabelVolume& volume, const TissueVoxels& tissue, const Armature& armature,
                    const Path& path, std::vector<std::string>& warnings) {
  const AffineTransform from_voxel = world_from_voxel(volume.grid);
  std::int64_t left_out = 0;
  tissue.for_each([&](std::int64_t place, const glm::ivec3& v) {
    if (best.covered(tissue.brick_at(v), place)) return;
    ++left_out;
    int nearest = 0;
    double least = std::numeric_limits<double>::max();
    for (std::size_t b = 0; b < armature.bones.size(); ++b)
      if (const double d = distance_to_bone(armature.bones[b], from_voxel * glm::dvec3(v)); d < least)
        least = d, nearest = static_cast<int>(b);
    best.hold(tissue.brick_at(v), place, nearest);
  });
  if (left_out > 0)
    warnings.push_back(path.string() + " gives no bone to " + std::to_string(left_out) +
                       " tissue voxels: each of these voxels follows its nearest bone");
}

WeightsFile read_bender_series(const Path& folder, const LabelVolume& volume, const TissueVoxels& tissue,
                               const Armature& armature) {
  std::vector<Path> files;
  for (const auto& entry : fs::directory_iterator(folder)) {
    const std::string name = entry.path().filename().string();
    if (name.rfind("weight_", 0) == 0 && (entry.path().extension() == ".mha" || entry.path().extension() == ".mhd"))
      files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  if (files.size() != armature.bones.size())
    throw Error("the folder holds " + std::to_string(files.size()) + " files weight_NN.mha, the rig has " +
                    std::to_string(armature.bones.size()) + " bones",
                folder.string(), "give one file for each bone, in the rig's order");
  WeightsFile result;
  BestFour best(tissue);
  for (std::size_t b = 0; b < files.size(); ++b) {
    const GreyVolume grey = read_grey_volume(files[b]);
    require_same_grid(grey.grid, volume, files[b]);
    result.warnings.insert(result.warnings.end(), grey.warnings.begin(), grey.warnings.end());
    tissue.for_each([&](std::int64_t i, const glm::ivec3& v) {
      const float value = grey.voxels[grey.grid.index(v)];
      // The comparison is false for NaN, so a NaN value is ignored.
      if (value > 0) best.offer(tissue.brick_at(v), i, static_cast<int>(b), std::min(value, 1.0f));
    });
  }
  cover_the_rest(best, volume, tissue, armature, folder, result.warnings);
  result.weights = best.weights(names_of(armature));
  return result;
}

WeightsFile read_bender_map(const Path& path, const LabelVolume& volume, const TissueVoxels& tissue,
                            const Armature& armature) {
  constexpr int kFirstBone = 2;
  VolumeFile map = read_volume(path);
  require_same_grid(map.volume.grid, volume, path);
  std::vector<int> bone(1 << 16, -1);
  for (const Tissue& value : map.tissues.tissues) {
    if (value.file_value < 1 || value.file_value >= kFirstBone + double(armature.bones.size()))
      throw Error("the skin map holds the value " + std::to_string(static_cast<std::int64_t>(value.file_value)) +
                      ", the rig has " + std::to_string(armature.bones.size()) + " bones, numbered from 2",
                  path.string(), "give the rig that the map was made with");
    bone[value.label] = static_cast<int>(value.file_value) - kFirstBone;
  }
  WeightsFile result;
  result.warnings = std::move(map.warnings);
  BestFour best(tissue);
  tissue.for_each([&](std::int64_t place, const glm::ivec3& v) {
    if (const int b = bone[map.volume.at(v)]; b >= 0) best.hold(tissue.brick_at(v), place, b);
  });
  cover_the_rest(best, volume, tissue, armature, path, result.warnings);
  result.weights = best.weights(names_of(armature));
  return result;
}

std::vector<std::shared_ptr<const SkinWeights::Chunk>> read_chunks(VoxelSource& data, const TissueVoxels& tissue,
                                                                   const std::vector<std::uint16_t>& in_rig,
                                                                   const std::string& where) {
  std::vector<std::shared_ptr<const SkinWeights::Chunk>> chunks;
  chunks.reserve(tissue.bricks().size());
  for (const auto& brick : tissue.bricks()) {
    SkinWeights::Influences influences(brick.count());
    data.read(influences.data(), influences.size() * sizeof(Influence));
    for (Influence& influence : influences) accept(influence, in_rig, where);
    chunks.push_back(std::make_shared<const SkinWeights::Chunk>(influences));
  }
  if (const auto beyond = data.finish(); !beyond.empty())
    throw Error("the file has more weights than the volume has tissue voxels", where, kMakeAnew);
  return chunks;
}

WeightsFile read_nrrd(const Path& path, const LabelVolume& volume, const TissueVoxels& tissue,
                      const Armature& armature) {
  const std::string where = path.string();
  const OpenedVolume opened = open_volume(path, no_progress(), Holding::Weights);
  const VolumeHeader& header = opened.header;
  const auto key = [&](const char* name) {
    const auto found = header.keys.find(name);
    if (found == header.keys.end())
      throw Error(std::string("the file holds no weights: it lacks the key ") + name, where, kMakeAnew);
    return found->second;
  };
  const std::vector<std::uint16_t> in_rig = bones_in_rig(key(kWeightsKey), where, armature);
  if (header.voxel_type != VoxelType::UInt16)
    throw Error("the weights are of type " + std::string(to_string(header.voxel_type)), where,
                "the type must be unsigned short");
  if (header.big_endian) throw Error("the weights are not little-endian", where, kMakeAnew);
  const glm::ivec3& numbers = header.grid.size;
  if (key("limber_size") != text_of(volume.grid.size) || numbers.x != 8 || numbers.y != tissue.size() ||
      numbers.z != 1 || key("limber_tissue_sha256") != tissue_sha256(tissue))
    throw Error("the weights belong to another volume", where,
                "give the volume that the weights were made for, or " + std::string(kMakeAnew));
  WeightsFile file{{names_of(armature), read_chunks(*opened.voxels, tissue, in_rig, where)}, header.warnings};
  if (const auto text = header.keys.find("limber_seams"); text != header.keys.end())
    file.seams = text->second.empty()
                     ? nullptr
                     : std::make_shared<const Seams>(seams_of_text(text->second, volume.grid.size, where));
  return file;
}
}  // namespace

WeightsFile read_weights(const Path& path, const LabelVolume& volume, const TissueVoxels& tissue,
                         const Armature& armature) {
  std::error_code error;
  if (fs::is_directory(path, error)) return read_bender_series(path, volume, tissue, armature);
  const std::string extension = path.extension().string();
  if (extension == ".mha" || extension == ".mhd") return read_bender_map(path, volume, tissue, armature);
  if (!fs::is_regular_file(path, error))
    throw Error("there is no such file of weights", path.string(), "name a file on disk");
  return read_nrrd(path, volume, tissue, armature);
}

void check_weights_writable(const Path& path) {
  if (path.extension() != ".nrrd")
    throw Error("weights cannot be written with this extension", path.string(), "use a name that ends in .nrrd");
  check_place(path);
}

void write_weights(const SkinWeights& weights, const LabelVolume& volume, const TissueVoxels& tissue, const Path& path,
                   SeamsOfWeights seams) {
  check_weights_writable(path);
  std::string seam_line;
  if (seams == SeamsOfWeights::OfTissue) {
    const std::string text = tissue.seams() ? text_of_seams(*tissue.seams()) : "";
    if (text.size() < kLongestSeams) seam_line = "\nlimber_seams:=" + text;
  }
  const nlohmann::json names = weights.bones();
  const std::string header = "NRRD0005\ntype: unsigned short\ndimension: 2\nsizes: 8 " + std::to_string(tissue.size()) +
                             "\nendian: little\nencoding: raw\nlimber_bones:=" + nrrd_escaped(names.dump()) +
                             "\nlimber_size:=" + text_of(volume.grid.size) +
                             "\nlimber_tissue_sha256:=" + tissue_sha256(tissue) + seam_line + "\n\n";
  write_atomically(path, [&](const Path& temporary) {
    std::ofstream out(temporary, std::ios::binary);
    out.write(header.data(), std::ssize(header));
    // Chunks are unpacked on several threads, a thousand at a time.
    constexpr std::int64_t kAtOnce = 1024, kGrain = 32;
    ZeroedVector<Influence> influences;
    for (std::int64_t from = 0; from < weights.chunk_count(); from += kAtOnce) {
      const std::int64_t to = std::min(from + kAtOnce, weights.chunk_count());
      const auto place = [&](std::int64_t b) {
        return (b < weights.chunk_count() ? tissue.bricks()[b].first : tissue.size()) - tissue.bricks()[from].first;
      };
      influences.resize(place(to));
      parallel_for(to - from, kGrain, [&](std::int64_t begin, std::int64_t end) {
        for (std::int64_t b = from + begin; b < from + end; ++b) {
          const SkinWeights::Influences of_brick = weights.chunk(b);
          std::copy(of_brick.begin(), of_brick.end(), influences.begin() + place(b));
        }
      });
      out.write(reinterpret_cast<const char*>(influences.data()), std::ssize(influences) * sizeof(Influence));
    }
    out.flush();
    if (!out) throw Error("the weights cannot be written", path.string(), "check permissions and free space");
  });
}

void write_bender_weights(const SkinWeights& weights, const LabelVolume& volume, const TissueVoxels& tissue,
                          const Path& folder) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (!fs::is_directory(folder, error))
    throw Error("the folder cannot be made", folder.string(), "choose another place");
  const std::size_t digits = std::max<std::size_t>(2, std::to_string(weights.bones().size() - 1).size());
  std::vector<float> values(volume.voxels.size());
  for (std::size_t bone = 0; bone < weights.bones().size(); ++bone) {
    std::fill(values.begin(), values.end(), 0.0f);
    for (std::int64_t b = 0; b < weights.chunk_count(); ++b) {
      const auto& chunk = weights.chunk(b);
      tissue.for_each(b, b + 1, [&](std::int64_t place, const glm::ivec3& v) {
        values[volume.grid.index(v)] =
            static_cast<float>(chunk[place - tissue.bricks()[b].first].of(static_cast<int>(bone)));
      });
    }
    std::string number = std::to_string(bone);
    number.insert(0, digits - number.size(), '0');
    write_scalar_volume(volume.grid, values, folder / ("weight_" + number + ".mha"));
  }
}

}  // namespace limber
