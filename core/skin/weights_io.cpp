// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/skin/weights_io.h"

#include <algorithm>
#include <bit>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <limits>
#include <map>
#include <optional>

#include <nlohmann/json.hpp>

#include "core/base/deflate.h"
#include "core/base/error.h"
#include "core/base/json_text.h"
#include "core/skin/best_four.h"
#include "core/volume/volume_io.h"
#include "core/volume/seam_text.h"

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

constexpr std::size_t kLongestHeader = 1 << 20;

using Header = std::map<std::string, std::string>;  // fields as "type" and "sizes", keys as "limber_bones"

// Up to the empty line that ends it; the data follow.
Header read_header(std::istream& in, const std::string& where) {
  Header header;
  std::size_t read = 0;
  bool begins = true;
  for (std::string line;; line.clear()) {
    char c = 0;
    while (in.get(c) && c != '\n' && ++read < kLongestHeader) line += c;
    if (begins && line.compare(0, 7, "NRRD000") != 0)
      throw Error("these are no weights", where, "give a W.nrrd, a folder of weight_NN.mha or Bender's skin map");
    if (!in || read >= kLongestHeader) throw Error("the header of the weights has no end", where, kMakeAnew);
    if (!line.empty() && line.back() == '\r') line.pop_back();
    if (line.empty()) return header;
    const bool is_field = !begins && line[0] != '#';
    begins = false;
    if (!is_field) continue;
    const std::size_t key_mark = line.find(":="), field_mark = line.find(": ");
    if (key_mark != std::string::npos && key_mark <= field_mark)
      header[line.substr(0, key_mark)] = line.substr(key_mark + 2);
    else if (field_mark != std::string::npos)
      header[line.substr(0, field_mark)] = line.substr(field_mark + 2);
  }
}

// Place in the rig of each of the file's bones.
std::vector<std::uint16_t> bones_in_rig(const std::string& names, const std::string& where, const Armature& armature) {
  const auto list = nlohmann::json::parse(checked_json(names, where), nullptr, false);
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

// The numbers behind the header, as they are or inflated.
class WeightData {
 public:
  WeightData(std::istream& in, const std::string& encoding, const std::string& where) : in_(in), where_(where) {
    if (encoding == "gzip" || encoding == "gz")
      inflater_.emplace();
    else if (encoding != "raw")
      throw Error("the weights are encoded as " + encoding.substr(0, 40), where, "save them raw or gzip");
  }

  void read(void* to, std::size_t size) {
    if (!inflater_) {
      if (!in_.read(static_cast<char*>(to), static_cast<std::streamsize>(size))) fail("too short");
      return;
    }
    for (std::size_t done = 0; done < size;) {
      const std::size_t made = inflate(static_cast<char*>(to) + done, size - done);
      if (made == 0) fail("damaged or too short");
      done += made;
    }
  }

  // After the last number.
  void expect_end() {
    char beyond;
    if (inflater_ && (inflate(&beyond, 1) > 0 || !inflater_->ended())) fail("damaged or too long");
    if (!inflater_ && in_.peek() != std::istream::traits_type::eof()) fail("too long");
  }

 private:
  // Nothing where the stream has ended.
  std::size_t inflate(char* to, std::size_t room) {
    for (;;) {
      if (inflater_->ended()) return 0;
      if (packed_.empty()) {
        in_.read(buffer_.data(), std::ssize(buffer_));
        packed_ = {buffer_.data(), static_cast<std::size_t>(in_.gcount())};
      }
      const Inflater::Step step = inflater_->inflate(packed_, to, room);
      packed_.remove_prefix(step.taken);
      if (step.damaged) fail("damaged");
      if (step.made > 0 || step.taken == 0) return step.made;
    }
  }

  [[noreturn]] void fail(const std::string& how) const { throw Error("the weights are " + how, where_, kMakeAnew); }

  std::istream& in_;
  const std::string& where_;
  std::optional<Inflater> inflater_;
  std::array<char, 1 << 16> buffer_;
  std::string_view packed_;  // of the buffer, still to be inflated
};

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
    if (best.covered(tissue.brick_at(v), place)) return;
    ++left_out;
    int nearest = 0;
    double least = std::numeric_limits<double>::max();
    for (std::size_t b = 0; b < armature.bones.size(); ++b)
      if (const double d = distance_to_bone(armature.bones[b], from_voxel * glm::dvec3(v)); d < least) least = d, nearest = static_cast<int>(b);
    best.hold(tissue.brick_at(v), place, nearest);
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
  BestFour best(tissue);
  for (std::size_t b = 0; b < files.size(); ++b) {
    const GreyVolume grey = read_grey_volume(files[b]);
    require_same_grid(grey.grid, volume, files[b]);
    result.warnings.insert(result.warnings.end(), grey.warnings.begin(), grey.warnings.end());
    tissue.for_each([&](std::int64_t i, const glm::ivec3& v) {
      const float value = grey.voxels[grey.grid.index(v)];
      if (value > 0) best.offer(tissue.brick_at(v), i, static_cast<int>(b), std::min(value, 1.0f));  // not for NaN
    });
  }
  cover_the_rest(best, volume, tissue, armature, folder, result.warnings);
  result.weights = best.weights(names_of(armature));
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
  BestFour best(tissue);
  tissue.for_each([&](std::int64_t place, const glm::ivec3& v) {
    if (const int b = bone[map.volume.at(v)]; b >= 0) best.hold(tissue.brick_at(v), place, b);
  });
  cover_the_rest(best, volume, tissue, armature, path, result.warnings);
  result.weights = best.weights(names_of(armature));
  return result;
}
}  // namespace

WeightsFile parse_weights(std::istream& in, const std::string& where, const LabelVolume& volume, const TissueVoxels& tissue,
                          const Armature& armature) {
  const Header header = read_header(in, where);
  auto field = [&](const std::string& name) {
    const auto found = header.find(name);
    if (found == header.end()) throw Error("the weights lack the field " + name, where, kMakeAnew);
    return found->second;
  };
  const std::string type = field("type");
  if (type != "unsigned short" && type != "ushort" && type != "uint16" && type != "uint16_t")
    throw Error("the weights are of type " + type.substr(0, 40), where, "they should be unsigned short");
  if (field("endian") != "little") throw Error("the weights are not little-endian", where, kMakeAnew);
  if (field("limber_size") != text_of(volume.grid.size) || field("sizes") != "8 " + std::to_string(tissue.size()) ||
      field("limber_tissue_sha256") != tissue_sha256(tissue))
    throw Error("the weights belong to another volume", where, "give the volume they were made for, or " + std::string(kMakeAnew));
  const std::vector<std::uint16_t> in_rig = bones_in_rig(field("limber_bones"), where, armature);

  WeightData data(in, field("encoding"), where);
  std::vector<std::shared_ptr<const SkinWeights::Chunk>> chunks;
  chunks.reserve(tissue.bricks().size());
  for (const auto& brick : tissue.bricks()) {
    SkinWeights::Influences influences(brick.count());
    data.read(influences.data(), influences.size() * sizeof(Influence));
    for (Influence& influence : influences) accept(influence, in_rig, where);
    chunks.push_back(std::make_shared<const SkinWeights::Chunk>(influences));
  }
  data.expect_end();
  WeightsFile file{{names_of(armature), std::move(chunks)}, {}};
  if (const auto text = header.find("limber_seams"); text != header.end())
    file.seams = text->second.empty() ? nullptr : std::make_shared<const Seams>(seams_of_text(text->second, volume.grid.size, where));
  return file;
}

WeightsFile read_weights(const Path& path, const LabelVolume& volume, const TissueVoxels& tissue, const Armature& armature) {
  std::error_code error;
  if (fs::is_directory(path, error)) return read_bender_series(path, volume, tissue, armature);
  const std::string extension = path.extension().string();
  if (extension == ".mha" || extension == ".mhd") return read_bender_map(path, volume, tissue, armature);
  if (!fs::is_regular_file(path, error)) throw Error("there is no such file of weights", path.string(), "name a file on disk");
  std::ifstream in(path, std::ios::binary);
  if (!in) throw Error("the file cannot be opened", path.string(), std::strerror(errno));
  return parse_weights(in, path.string(), volume, tissue, armature);
}

void check_weights_writable(const Path& path) {
  if (path.extension() != ".nrrd") throw Error("weights are written as .nrrd", path.string(), "choose a name that ends in .nrrd");
  check_place(path);
}

void write_weights(const SkinWeights& weights, const LabelVolume& volume, const TissueVoxels& tissue, const Path& path,
                   SeamsOfWeights seams) {
  check_weights_writable(path);
  std::string seam_line;
  if (seams == SeamsOfWeights::OfTissue) {
    const std::string text = tissue.seams() ? text_of_seams(*tissue.seams()) : "";
    if (text.size() < kLongestHeader / 2) seam_line = "\nlimber_seams:=" + text;
  }
  const nlohmann::json names = weights.bones();
  const std::string header = "NRRD0005\ntype: unsigned short\ndimension: 2\nsizes: 8 " + std::to_string(tissue.size()) +
                             "\nendian: little\nencoding: raw\nlimber_bones:=" + names.dump() + "\nlimber_size:=" + text_of(volume.grid.size) +
                             "\nlimber_tissue_sha256:=" + tissue_sha256(tissue) + seam_line + "\n\n";
  write_atomically(path, [&](const Path& temporary) {
    std::ofstream out(temporary, std::ios::binary);
    out.write(header.data(), std::ssize(header));
    for (std::int64_t b = 0; b < weights.chunk_count(); ++b) {
      const SkinWeights::Influences influences = weights.chunk(b);
      out.write(reinterpret_cast<const char*>(influences.data()), std::ssize(influences) * sizeof(Influence));
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
