// SPDX-License-Identifier: AGPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "core/base/bytes.h"
#include "core/base/error.h"
#include "core/base/parallel.h"
#include "core/motion/key_curve.h"
#include "core/platform/memory.h"
#include "core/project/constraints_codec.h"
#include "core/project/document_codec.h"
#include "core/project/document_layout.h"
#include "core/project/key_shapes_codec.h"
#include "core/project/seams_codec.h"
#include "core/project/strips_codec.h"

namespace limber {

namespace {

constexpr std::uint32_t kMostInList = 100'000;
constexpr std::int64_t kMostFrames = 1 << 28;
constexpr std::int32_t kLongestAxis = 1 << 20;
constexpr std::int64_t kBatch = 32;  // number of leaves that are unpacked in parallel

bool is_finite(const glm::dquat& q) {
  return std::isfinite(q.w) && std::isfinite(q.x) && std::isfinite(q.y) && std::isfinite(q.z);
}
bool is_finite(const glm::dvec3& v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }

glm::dvec3 get_vector(ByteReader& in) {
  glm::dvec3 v;
  for (int i = 0; i < 3; ++i) v[i] = in.get<double>();
  return v;
}
// Reads a vector of finite numbers and brings its components into [-most, most].
glm::dvec3 get_within(ByteReader& in, double most) {
  const glm::dvec3 v = get_vector(in);
  in.require(is_finite(v));
  return glm::clamp(v, -most, most);
}
glm::dquat get_rotation(ByteReader& in) {
  glm::dquat q;
  for (double* value : {&q.w, &q.x, &q.y, &q.z}) *value = in.get<double>();
  return q;
}
// Reads a frame number. Limits its magnitude, so that a sum of a few frame numbers cannot overflow.
std::int32_t get_frame(ByteReader& in) {
  const auto frame = in.get<std::int32_t>();
  in.require(std::abs(std::int64_t{frame}) <= kMostFrames);
  return frame;
}
std::vector<std::string> get_texts(ByteReader& in) {
  std::vector<std::string> texts(in.count(4));
  for (std::string& text : texts) text = in.text();
  return texts;
}

void get(ByteReader& in, TissueTable& table) {
  table.source = in.text();
  table.tissues.resize(in.count(40));
  for (Tissue& tissue : table.tissues) {
    tissue.label = in.get<Label>();
    tissue.file_value = in.get<double>();
    tissue.name = in.text();
    for (int i = 0; i < 3; ++i) tissue.colour[i] = in.get<float>();
    tissue.kind = static_cast<TissueKind>(in.get_below<std::uint8_t>(static_cast<int>(TissueKind::Nail) + 1));
    for (double* value : {&tissue.density, &tissue.young_modulus, &tissue.poisson_ratio}) *value = in.get<double>();
    tissue.priority = in.get<std::int32_t>();
  }
}

void get(ByteReader& in, FileType& type) {
  type.format = in.text();
  type.voxel_type = in.text();
  type.compressed = in.flag();
}

void get(ByteReader& in, Armature& armature) {
  armature.bones.resize(in.count(100));
  for (int b = 0; b < std::ssize(armature.bones); ++b) {
    Bone& bone = armature.bones[b];
    bone.name = in.text();
    bone.parent = in.get<std::int32_t>();
    in.require(bone.parent >= -1 && bone.parent < b);
    bone.head = get_vector(in);
    bone.tail = get_vector(in);
    bone.roll = in.get<double>();
    JointLimits& limits = bone.limits;
    limits.type =
        static_cast<JointLimits::Type>(in.get_below<std::uint8_t>(static_cast<int>(JointLimits::Type::Ball) + 1));
    limits.axis = get_vector(in);
    for (double* value : {&limits.minimum, &limits.maximum, &limits.cone, &limits.twist_minimum, &limits.twist_maximum})
      *value = in.get<double>();
  }
}

void get(ByteReader& in, Pose& pose) {
  pose.rotation.resize(in.count(32));
  for (glm::dquat& rotation : pose.rotation) rotation = get_rotation(in);
  pose.root_translation = get_vector(in);
}

void get(ByteReader& in, Motion& motion) {
  motion.joints.resize(in.count(40));
  std::int64_t last_channel = 0;
  for (int j = 0; j < std::ssize(motion.joints); ++j) {
    BvhJoint& joint = motion.joints[j];
    joint.name = in.text();
    joint.parent = in.get<std::int32_t>();
    in.require(joint.parent >= -1 && joint.parent < j);
    joint.offset = get_vector(in);
    joint.channels.resize(in.count(1));
    for (BvhChannel& channel : joint.channels)
      channel = static_cast<BvhChannel>(in.get_below<std::uint8_t>(static_cast<int>(BvhChannel::Zrotation) + 1));
    joint.first_channel = in.get<std::int32_t>();
    in.require(joint.first_channel >= 0);
    last_channel = std::max(last_channel, joint.first_channel + std::ssize(joint.channels));
    const bool has_end = in.flag();
    const glm::dvec3 end = get_vector(in);
    if (has_end) joint.end_site = end;
  }
  motion.channel_count = in.get<std::int32_t>();
  motion.frame_count = in.get<std::int32_t>();
  motion.frame_time = in.get<double>();
  motion.warnings = get_texts(in);
  motion.values.resize(in.count(sizeof(float)));
  const std::string_view values = in.raw(motion.values.size() * sizeof(float));
  if (!values.empty()) std::memcpy(motion.values.data(), values.data(), values.size());
  in.require(motion.channel_count >= last_channel && motion.frame_count >= 0 &&
             std::int64_t{motion.channel_count} * motion.frame_count == std::ssize(motion.values));
}

void get(ByteReader& in, Keys& keys) {
  for (std::size_t bones = in.count(44); bones > 0; --bones) {
    auto& track = keys.bones[in.text()];
    for (std::size_t count = in.count(36); count > 0; --count) {
      const auto frame = get_frame(in);
      track[frame] = get_rotation(in);
      in.require(is_finite(track[frame]));
    }
    in.require(!track.empty());
  }
  for (std::size_t count = in.count(28); count > 0; --count) {
    const auto frame = get_frame(in);
    keys.root[frame] = get_within(in, kFarthestShift);
  }
}

void get(ByteReader& in, NamedPose& pose) {
  pose.name = in.text();
  for (std::size_t count = in.count(36); count > 0; --count) {
    const std::string bone = in.text();
    pose.rotation[bone] = get_rotation(in);
  }
  const bool has_place = in.flag();
  const glm::dvec3 place = get_vector(in);
  if (has_place) pose.root_translation = place;
  pose.picture = in.text();
}

void get(ByteReader& in, Anchors& anchors) {
  for (const std::string& bone : get_texts(in)) anchors.pins.insert(bone);
  for (std::size_t count = in.count(28); count > 0; --count) {
    glm::dvec3& place = anchors.poles[in.text()];
    place = get_vector(in);
    in.require(is_finite(place));
  }
}

void get(ByteReader& in, WeightLocks& locks) {
  for (const std::string& bone : get_texts(in)) locks.bones.insert(bone);
}

void get(ByteReader& in, BoneMap& map) {
  for (std::size_t count = in.count(8); count > 0; --count) {
    const std::string label = in.text();
    map[label] = in.text();
  }
}

void get(ByteReader& in, Measurements& measurements) {
  constexpr double kFarthest = 1e6;  // mm; a measured point this far from the origin or further is refused
  measurements.resize(in.count(13));
  std::set<std::string> names;
  for (Measurement& one : measurements) {
    one.name = in.text();
    in.require(!one.name.empty() && names.insert(one.name).second);
    one.kind = static_cast<MeasureKind>(in.get_below<std::uint8_t>(kMeasureKinds));
    one.points.resize(in.count(24));
    in.require(is_complete(one.kind, one.points.size()));
    for (glm::dvec3& point : one.points) {
      point = get_vector(in);
      in.require(is_finite(point) && glm::length(point) < kFarthest);
    }
  }
}

void get(ByteReader& in, SolvedMesh& solved) {
  const std::string mesh = in.text(), step = in.text();
  try {
    solved.mesh = decode_fem_mesh(mesh, "");
    solved.V = decode_fem_step(step, "").V;
  } catch (const Error&) {
    in.require(false);
  }
  in.require(solved.V.rows() == solved.mesh.tets.V.rows());
}

void get(ByteReader& in, Overlap& overlap) {
  for (auto* voxels : {&overlap.tissue, &overlap.bones}) {
    voxels->resize(in.count(sizeof(std::int64_t)));
    std::int64_t last = -1;
    for (std::int64_t& voxel : *voxels) {
      voxel = in.get<std::int64_t>();
      in.require(voxel > last);
      last = voxel;
    }
  }
}

void get(ByteReader& in, RetargetMap& map) {
  for (std::size_t count = in.count(41); count > 0; --count) {
    RetargetMap::Source& source = map.sources[in.text()];
    source.joint = in.text();
    const bool has_offset = in.flag();
    const glm::dquat offset = get_rotation(in);
    if (has_offset) source.rest_offset = offset;
  }
}

void get(ByteReader& in, Clip& clip) {
  clip.name = in.text();
  clip.rate = in.get<double>();
  in.require(clip.rate >= 0.01 && clip.rate <= 10'000);  // the range of rates that clip_of() accepts, frames per second
  for (int* number : {&clip.start, &clip.first, &clip.last, &clip.range_start, &clip.range_end})
    *number = get_frame(in);
  in.require(clip.first >= 0 && clip.first <= clip.last &&
             (!clip.motion || clip.last < std::max(1, clip.motion->frame_count)));
  get(in, clip.map);
  clip.retarget.travel = static_cast<Travel>(in.get_below<std::uint8_t>(static_cast<int>(Travel::Free) + 1));
  clip.retarget.mirror = in.flag();
  clip.retarget.scale = in.get<double>();
  in.require(std::isfinite(clip.retarget.scale) && clip.retarget.scale >= 0);
  const int packed = in.get_below<std::uint8_t>(1 << 6);
  in.require((packed & 3) <= static_cast<int>(Reference::FirstFrame));
  clip.retarget.reference = static_cast<Reference>(packed & 3);
  clip.map.stances = {static_cast<RestStance>(packed >> 2 & 3), static_cast<RestStance>(packed >> 4)};
  get(in, clip.keys);
  clip.markers.resize(in.count(8));
  for (Marker& marker : clip.markers) {
    marker.frame = get_frame(in);
    marker.name = in.text();
  }
  if (!in.at_end()) get_shapes(in, clip.keys);
  if (!in.at_end()) get_constraints(in, clip);
}

void get(ByteReader& in, Visibility& visibility) {
  const std::size_t count = in.count(7);
  for (std::size_t i = 0; i < count; ++i) {
    const auto label = in.get<Label>();
    TissueLook& look = visibility.looks[label];
    look.visible = in.flag();
    look.opacity = in.get<float>();
  }
  visibility.clip_box.enabled = in.flag();
  visibility.clip_box.low = get_vector(in);
  visibility.clip_box.high = get_vector(in);
  visibility.clip_plane.enabled = in.flag();
  visibility.clip_plane.point = get_vector(in);
  visibility.clip_plane.normal = get_vector(in);
}

// Returns true if the weights fit the volume: equal numbers of bricks, and of tissue voxels in each brick.
bool fits(const SkinWeights& weights, const LabelVolume& volume) {
  const TissueVoxels tissue(volume);
  if (std::ssize(tissue.bricks()) != weights.chunk_count()) return false;
  for (std::int64_t brick = 0; brick < weights.chunk_count(); ++brick)
    if (tissue.bricks()[brick].count() != std::ssize(weights.chunk(brick))) return false;
  return true;
}

bool are_of_one_body(const SkinWeights& a, const SkinWeights& b) {
  bool same = a.bones() == b.bones() && a.chunk_count() == b.chunk_count();
  for (std::int64_t brick = 0; same && brick < a.chunk_count(); ++brick)
    same = a.chunk(brick).size() == b.chunk(brick).size();
  return same;
}
bool are_of_one_body(const WeightLayers& layers, const SkinWeights& weights) {
  return are_of_one_body(*layers.base, weights) &&
         std::all_of(layers.layers.begin(), layers.layers.end(),
                     [&](const auto& layer) { return are_of_one_body(layer->weights, weights); });
}

// Sets a flag during its lifetime, and then restores the flag's earlier value.
class Restored {
 public:
  Restored(bool& flag, bool value) : flag_(flag), before_(std::exchange(flag, value)) {}
  ~Restored() { flag_ = before_; }
  Restored(const Restored&) = delete;
  Restored& operator=(const Restored&) = delete;

 private:
  bool& flag_;
  bool before_;
};

class Reading {
 public:
  Reading(ChunkSource& source, const std::string& where, std::vector<std::string>& warnings, const ReadLimits& limits,
          Progress& progress)
      : source_(source),
        where_(where),
        warnings_(warnings),
        limits_(limits),
        progress_(progress),
        bytes_left_(limits.most_bytes > 0 ? limits.most_bytes : available_memory() / 10 * 9) {}

  Document document(const ChunkHash& root) {
    const Node node = this->node(root, "contents");
    ByteReader in(node.bytes, [this] { throw damaged("contents"); });
    const auto layout = in.get<std::uint32_t>();
    if (layout < 1 || layout > kDocumentLayout)
      throw Error("the document was written by a newer version of Limber", where_, "open it with that version");
    Document document;
    std::size_t next = 0;
    const auto part = [&](auto& pointer) {
      if (!in.flag()) return;
      in.require(next < node.nodes.size());
      read_or_leave_out(node.nodes[next++], pointer);
    };
    part(document.volume);
    part(document.tissues);
    part(document.volume_type);
    part(document.armature);
    part(document.weights);
    part(document.pose);
    std::shared_ptr<const Motion> only_motion;
    if (layout == 1) part(only_motion);
    part(document.visibility);
    const auto list = [&]<class T>(std::vector<std::shared_ptr<const T>>& parts) {
      const auto count = in.get_below<std::uint32_t>(kMostInList);
      in.require(node.nodes.size() - next >= count);
      for (const std::size_t end = next + count; next < end; ++next) {
        std::shared_ptr<const T> one;
        read_or_leave_out(node.nodes[next], one);
        if (one) parts.push_back(std::move(one));
      }
    };
    list(document.results);
    if (layout == 1) {
      if (only_motion) document.clips.push_back(std::make_shared<const Clip>(clip_of(only_motion, "Motion")));
    } else {
      list(document.clips);
      document.clip = in.get<std::int32_t>();
      document.frame = get_frame(in);
      in.require(document.clip >= 0);
      if (layout > 2) list(document.poses);
      if (layout > 3) part(document.anchors);
      if (layout > 5) part(document.locks);
      if (layout > 6) part(document.layers);
      if (layout > 8) part(document.seams);
      if (layout > 8) part(document.bone_map);
      if (layout > 9) part(document.measurements);
    }
    in.require(next == node.nodes.size());
    in.end();
    document.clip = std::clamp<int>(document.clip, 0, std::max<int>(0, static_cast<int>(document.clips.size()) - 1));
    leave_out_what_does_not_fit(document);
    progress_.update("open", 1);
    return document;
  }

 private:
  Error damaged(const std::string& what) const {
    return {
        "the " + what + " in the project cannot be read: it is damaged or incomplete", where_,
        "open an earlier copy, or recover the undamaged parts: limber project " + where_ + " recover -o OUT.limber"};
  }

  std::string chunk(const ChunkHash& hash, const std::string& what) {
    const auto packed = source_.find(hash);
    auto chunk = packed ? unpack(*packed, hash) : std::nullopt;
    if (!chunk) throw damaged(what);
    return std::move(*chunk);
  }
  Node node(const ChunkHash& hash, const std::string& what) {
    auto node = to_node(chunk(hash, what));
    if (!node) throw damaged(what);
    return std::move(*node);
  }

  // Calls take(i, bytes) for each leaf, in order. Throws Error where a leaf is missing or damaged.
  template <class Take>
  void for_leaves(const std::vector<ChunkHash>& leaves, std::size_t first, const std::string& what, const Take& take) {
    for_each_leaf(leaves, first, take, [&](std::int64_t) { throw damaged(what); });
  }
  // Calls take(i, bytes) for each undamaged leaf, and lost(i) for each missing or damaged leaf, in the leaves' order.
  template <class Take, class Lost>
  void for_each_leaf(const std::vector<ChunkHash>& leaves, std::size_t first, const Take& take, const Lost& lost) {
    const std::int64_t count = std::ssize(leaves) - static_cast<std::int64_t>(first);
    for (std::int64_t begin = 0; begin < count; begin += kBatch) {
      progress_.update("open", static_cast<double>(begin) / static_cast<double>(count));
      const std::int64_t batch = std::min(kBatch, count - begin);
      std::vector<std::string> bytes(batch);
      std::vector<std::uint8_t> whole(batch);
      for (std::int64_t i = 0; i < batch; ++i)
        if (auto packed = source_.find(leaves[first + begin + i])) {
          bytes[i] = std::move(*packed);
          whole[i] = 1;
        }
      parallel_for(batch, 1, [&](std::int64_t from, std::int64_t end) {
        for (std::int64_t i = from; i < end; ++i) {
          auto chunk = whole[i] ? unpack(bytes[i], leaves[first + begin + i]) : std::nullopt;
          whole[i] = chunk.has_value();
          if (chunk) bytes[i] = std::move(*chunk);
        }
      });
      for (std::int64_t i = 0; i < batch; ++i) {
        if (whole[i]) take(begin + i, bytes[i]);
        else lost(begin + i);
      }
    }
  }

  void take_memory(std::int64_t bytes, const std::string& what) {
    if (bytes > bytes_left_)
      throw Error("the " + what + " in the project needs " + std::to_string(bytes / 1'000'000) + " MB of memory, " +
                      std::to_string(bytes_left_ / 1'000'000) + " MB are free",
                  where_, "close other programs, or use a larger machine");
    bytes_left_ -= bytes;
  }

  // Returns the part with this hash. Each part is read once: later calls with its hash return the same pointer.
  template <class T>
  std::shared_ptr<const T> read(const ChunkHash& hash) {
    const std::string what = PartKindOf<T>::kName;
    const auto known = parts_.find(hash.bytes);
    if (known != parts_.end()) {
      if (known->second.kind != PartKindOf<T>::kKind) throw damaged(what);
      return std::static_pointer_cast<const T>(known->second.part);
    }
    const Node node = this->node(hash, what);
    ByteReader in(node.bytes, [&] { throw damaged(what); });
    in.require(in.get<std::uint8_t>() == static_cast<std::uint8_t>(PartKindOf<T>::kKind));
    auto part = std::make_shared<const T>(read_part(node, in, static_cast<const T*>(nullptr)));
    parts_[hash.bytes] = {PartKindOf<T>::kKind, part};
    return part;
  }

  template <class T>
  void read_or_leave_out(const ChunkHash& hash, std::shared_ptr<const T>& part) {
    if (!limits_.leave_out_damaged) {
      part = read<T>(hash);
      return;
    }
    try {
      part = read<T>(hash);
    } catch (const Error&) {
      warnings_.push_back(std::string("the ") + PartKindOf<T>::kName + " is damaged and was left out");
    }
  }

  template <class T>
  T read_part(const Node& node, ByteReader& in, const T*) {
    const std::string what = PartKindOf<T>::kName;
    T part;
    if (node.leaves.empty()) {
      get(in, part);
      in.end();
      return part;
    }
    in.end();
    std::string bytes;
    for_leaves(node.leaves, 0, what, [&](std::int64_t, const std::string& leaf) {
      take_memory(2 * std::ssize(leaf), what);
      bytes += leaf;
    });
    ByteReader from_leaves(bytes, [&] { throw damaged(what); });
    get(from_leaves, part);
    from_leaves.end();
    return part;
  }

  LabelVolume read_part(const Node& node, ByteReader& in, const LabelVolume*) {
    LabelVolume volume;
    Grid& grid = volume.grid;
    for (int i = 0; i < 3; ++i) grid.size[i] = static_cast<int>(in.get_below<std::uint32_t>(kLongestAxis + 1));
    grid.spacing = get_vector(in);
    grid.origin = get_vector(in);
    for (int i = 0; i < 3; ++i) grid.direction[i] = get_vector(in);
    in.end();
    in.require(is_finite(grid.spacing) && is_finite(grid.origin) &&
               glm::all(glm::greaterThan(grid.spacing, glm::dvec3(0))));
    for (int i = 0; i < 3; ++i) in.require(is_finite(grid.direction[i]));

    const std::int64_t bytes = checked_voxel_bytes(grid, in);
    in.require(std::ssize(node.leaves) == (bytes + kLeafBytes - 1) / kLeafBytes);
    take_memory(bytes, "volume");
    volume.voxels.resize(grid.voxel_count());
    char* to = reinterpret_cast<char*>(volume.voxels.data());
    std::vector<std::int64_t> lost;
    for_each_leaf(
        node.leaves, 0,
        [&](std::int64_t i, const std::string& leaf) {
          in.require(std::ssize(leaf) == std::min(kLeafBytes, bytes - i * kLeafBytes));
          if (!is_all_zero(leaf.data(), leaf.size())) std::memcpy(to + i * kLeafBytes, leaf.data(), leaf.size());
        },
        [&](std::int64_t i) { lose(lost, i, "volume"); });
    if (lost.empty()) return volume;
    if (lost.size() == node.leaves.size()) throw damaged("volume");
    const auto slice_of = [&](std::int64_t byte) {
      return byte / (std::int64_t{sizeof(Label)} * grid.size.x * grid.size.y);
    };
    warnings_.push_back(part_lost("volume", lost.size(), node.leaves.size()) + "their voxels, within slices " +
                        std::to_string(slice_of(lost.front() * kLeafBytes)) + " to " +
                        std::to_string(slice_of(std::min(bytes, (lost.back() + 1) * kLeafBytes) - 1)) + ", are air");
    return volume;
  }

  // Adds the index of a damaged block to `lost`. Throws Error when the limits do not allow leaving out damaged blocks.
  void lose(std::vector<std::int64_t>& lost, std::int64_t block, const std::string& what) const {
    if (!limits_.leave_out_damaged) throw damaged(what);
    lost.push_back(block);
  }
  static std::string part_lost(const std::string& what, std::size_t lost, std::size_t all) {
    return std::to_string(lost) + " of " + std::to_string(all) + " blocks of the " + what + " are lost: ";
  }

  static std::int64_t checked_voxel_bytes(const Grid& grid, const ByteReader& in) {
    const std::int64_t slice = std::int64_t{grid.size.x} * grid.size.y;  // voxels of a slice, at most 2^40
    in.require(slice == 0 || grid.size.z <= (std::int64_t{1} << 42) / slice);
    return slice * grid.size.z * std::int64_t{sizeof(Label)};
  }

  SkinWeights read_part(const Node& node, ByteReader& in, const SkinWeights*) {
    std::vector<std::string> bones = get_texts(in);
    in.end();
    in.require(!node.leaves.empty());
    const std::string lengths_bytes = chunk(node.leaves[0], "weights");
    in.require(lengths_bytes.size() % sizeof(std::uint16_t) == 0);
    std::vector<std::uint16_t> lengths(lengths_bytes.size() / sizeof(std::uint16_t));
    if (!lengths.empty()) std::memcpy(lengths.data(), lengths_bytes.data(), lengths_bytes.size());
    const std::int64_t bricks = std::ssize(lengths);
    in.require(std::ssize(node.leaves) - 1 == (bricks + kGroupBricks - 1) / kGroupBricks);

    std::vector<std::shared_ptr<const SkinWeights::Chunk>> chunks;
    std::vector<std::int64_t> lost;
    for_each_leaf(
        node.leaves, 1,
        [&](std::int64_t group, const std::string& leaf) {
          const auto first = lengths.begin() + group * kGroupBricks;
          const std::vector<std::uint16_t> counts(first, first + std::min(kGroupBricks, bricks - group * kGroupBricks));
          // Several sets of weights may share a group of bricks (equal hash), which is in memory once.
          auto& known = groups_[node.leaves[group + 1].bytes];
          const bool shared = std::equal(known.begin(), known.end(), counts.begin(), counts.end(),
                                         [](const auto& brick, std::uint16_t count) { return brick->size() == count; });
          if (!shared || known.empty()) known = read_group(leaf, counts, in);
          for (const auto& brick : known)
            for (const Influence influence : *brick)
              for (int k = 0; k < 4; ++k) in.require(influence.bone[k] < std::max<std::size_t>(1, bones.size()));
          chunks.insert(chunks.end(), known.begin(), known.end());
        },
        [&](std::int64_t group) {
          lose(lost, group, "weights");
          chunks.resize(static_cast<std::size_t>(std::min(bricks, (group + 1) * kGroupBricks)));
        });
    if (!lost.empty()) {
      if (lost.size() + 1 == node.leaves.size()) throw damaged("weights");
      warnings_.push_back(part_lost("weights", lost.size(), node.leaves.size() - 1) +
                          "their voxels got the weights of a neighbouring block; compute or paint the weights again");
      fill_lost_bricks(chunks, lengths);
    }
    return {std::move(bones), std::move(chunks)};
  }

  // Fills each lost brick with the last influence of the bricks before it, or else with the first influence of all.
  static void fill_lost_bricks(std::vector<std::shared_ptr<const SkinWeights::Chunk>>& bricks,
                               const std::vector<std::uint16_t>& lengths) {
    Influence known = rigid_influence(0);
    for (const auto& brick : bricks)
      if (brick && brick->size() > 0) {
        known = *brick->begin();
        break;
      }
    for (std::size_t i = 0; i < bricks.size(); ++i) {
      if (!bricks[i])
        bricks[i] = std::make_shared<const SkinWeights::Chunk>(SkinWeights::Influences(lengths[i], known));
      for (const Influence influence : *bricks[i]) known = influence;
    }
  }

  std::vector<std::shared_ptr<const SkinWeights::Chunk>> read_group(const std::string& leaf,
                                                                    const std::vector<std::uint16_t>& counts,
                                                                    const ByteReader& in) {
    std::size_t count = 0;
    for (std::uint16_t one : counts) count += one;
    in.require(leaf.size() == count * sizeof(Influence));
    take_memory(std::ssize(leaf), "weights");
    std::vector<std::uint16_t> planes(count * 8);
    if (count > 0) std::memcpy(planes.data(), leaf.data(), leaf.size());

    std::vector<std::shared_ptr<const SkinWeights::Chunk>> bricks;
    std::size_t place = 0;
    for (std::uint16_t length : counts) {
      SkinWeights::Influences brick(length);
      for (Influence& influence : brick) {
        int sum = 0;
        for (std::size_t k = 0; k < 4; ++k) {
          influence.bone[k] = planes[k * count + place];
          influence.weight[k] = planes[(k + 4) * count + place];
          sum += influence.weight[k];
        }
        in.require(sum == kFullWeight);
        ++place;
      }
      bricks.push_back(std::make_shared<const SkinWeights::Chunk>(brick));
    }
    return bricks;
  }

  WeightLayer read_part(const Node& node, ByteReader& in, const WeightLayer*) {
    WeightLayer layer;
    layer.name = in.text();
    layer.visible = in.flag();
    layer.opacity = in.get<double>();
    in.end();
    in.require(layer.opacity >= 0 && layer.opacity <= 1 && node.nodes.size() == 1 && !node.leaves.empty());
    layer.weights = *read<SkinWeights>(node.nodes[0]);
    const std::int64_t bricks = layer.weights.chunk_count();
    const std::string covers = chunk(node.leaves[0], "layer of weights");
    in.require(std::ssize(covers) == bricks &&
               std::ssize(node.leaves) - 1 == (bricks + kGroupBricks - 1) / kGroupBricks);
    layer.mask.resize(bricks);
    for_leaves(node.leaves, 1, "layer of weights", [&](std::int64_t group, const std::string& leaf) {
      take_memory(std::ssize(leaf), "layers of weights");
      std::size_t place = 0;
      for (std::int64_t brick = group * kGroupBricks; brick < std::min(bricks, (group + 1) * kGroupBricks); ++brick) {
        if (!covers[brick]) continue;
        WeightLayer::Mask mask(layer.weights.chunk(brick).size());
        const std::size_t bytes = mask.size() * sizeof(std::uint16_t);
        in.require(leaf.size() - place >= bytes);
        if (bytes > 0) std::memcpy(mask.data(), leaf.data() + place, bytes);
        place += bytes;
        layer.mask[brick] = std::make_shared<const WeightLayer::Mask>(std::move(mask));
      }
      in.require(place == leaf.size());
    });
    return layer;
  }

  WeightLayers read_part(const Node& node, ByteReader& in, const WeightLayers*) {
    const std::size_t count = in.get_below<std::uint32_t>(kMostInList);
    in.end();
    in.require(count > 0 && node.nodes.size() == count + 1 && node.leaves.empty());
    WeightLayers layers{read<SkinWeights>(node.nodes[0]), {}};
    for (std::size_t i = 1; i <= count; ++i) layers.layers.push_back(read<WeightLayer>(node.nodes[i]));
    return layers;
  }

  Result read_part(const Node& node, ByteReader& in, const Result*) {
    Result result;
    std::size_t next = 0;
    const auto part = [&]<class T>(std::shared_ptr<const T>& pointer) {
      if (!in.flag()) return;
      in.require(next < node.nodes.size());
      pointer = read<T>(node.nodes[next++]);
    };
    if (!node.leaves.empty()) return from_leaves<Result>(node, in);
    part(result.volume);
    part(result.from_volume);
    part(result.from_tissues);
    part(result.from_armature);
    part(result.from_weights);
    part(result.from_pose);
    result.name = in.text();
    result.method = in.text();
    result.report = in.text();
    if (!in.at_end()) part(result.solved);
    if (!in.at_end()) part(result.overlap);
    if (!in.at_end()) part(result.from_seams);
    if (!in.at_end()) part(result.from_bone_map);
    in.require(next == node.nodes.size());
    in.end();
    if (result.overlap)
      for (const auto* voxels : {&result.overlap->tissue, &result.overlap->bones})
        in.require(voxels->empty() || (result.volume && voxels->back() < std::ssize(result.volume->voxels)));
    return result;
  }

  SolvedMesh read_part(const Node& node, ByteReader& in, const SolvedMesh*) {
    if (!node.leaves.empty()) return from_leaves<SolvedMesh>(node, in);
    SolvedMesh solved;
    get(in, solved);
    in.end();
    return solved;
  }

  Seams read_part(const Node& node, ByteReader& in, const Seams*) {
    if (!node.leaves.empty()) return from_leaves<Seams>(node, in);
    Seams seams = get_seams(in, [&](std::int64_t bytes) { take_memory(bytes, "seams"); });
    in.end();
    return seams;
  }

  Clip read_part(const Node& node, ByteReader& in, const Clip*) {
    if (!node.leaves.empty()) return from_leaves<Clip>(node, in);
    Clip clip;
    const bool has_motion = in.flag();
    const std::size_t motions = has_motion ? 1 : 0;
    in.require(node.nodes.size() >= motions);
    if (has_motion) clip.motion = read<Motion>(node.nodes[0]);
    get(in, clip);
    in.require(node.nodes.size() == motions || (!has_motion && !in.at_end() && !reads_strips_));
    if (in.at_end()) return clip;
    // Strips of these clips are refused (reads_strips_), so that clips cannot be nested deeply.
    std::vector<std::shared_ptr<const Clip>> clips;
    {
      const Restored nested(reads_strips_, true);
      for (const ChunkHash& hash : node.nodes) clips.push_back(read<Clip>(hash));
    }
    clip.strips = std::make_shared<const Strips>(get_strips(in, clips));
    in.end();
    return clip;
  }

  // Reads a part whose bytes were too long for its node (a long report, many keys) from the node's leaves.
  template <class T>
  T from_leaves(const Node& node, ByteReader& in) {
    const std::string what = PartKindOf<T>::kName;
    in.end();
    std::string bytes;
    for_leaves(node.leaves, 0, what, [&](std::int64_t, const std::string& leaf) {
      take_memory(2 * std::ssize(leaf), what);
      bytes += leaf;
    });
    ByteReader all(bytes, [&] { throw damaged(what); });
    const Node whole{node.nodes, {}, {}};
    return read_part(whole, all, static_cast<const T*>(nullptr));
  }

  void leave_out_what_does_not_fit(Document& document) {
    if (document.weights && (!document.volume || !fits(*document.weights, *document.volume))) {
      warnings_.push_back("the weights do not belong to the volume and were left out");
      document.weights = nullptr;
      document.layers = nullptr;
    }
    if (document.layers && (!document.weights || !are_of_one_body(*document.layers, *document.weights))) {
      warnings_.push_back("the layers of weights do not belong to the weights and were left out");
      document.layers = nullptr;
    }
    if (document.seams && (!document.volume || !fit(*document.seams, *document.volume))) {
      warnings_.push_back("the seams do not belong to the volume and were left out");
      document.seams = nullptr;
    }
    if (document.pose && (!document.armature || document.pose->rotation.size() != document.armature->bones.size())) {
      warnings_.push_back("the pose does not belong to the rig and was left out");
      document.pose = nullptr;
    }
  }

  struct Known {
    PartKind kind;
    std::shared_ptr<const void> part;
  };
  ChunkSource& source_;
  const std::string& where_;
  std::vector<std::string>& warnings_;
  const ReadLimits& limits_;
  Progress& progress_;
  std::int64_t bytes_left_;
  bool reads_strips_ = false;  // true while the clips of strips are read
  std::map<std::array<std::uint8_t, 32>, Known> parts_;
  std::map<std::array<std::uint8_t, 32>, std::vector<std::shared_ptr<const SkinWeights::Chunk>>> groups_;
};

}  // namespace

Document read_document(const ChunkHash& root, ChunkSource& source, const std::string& where,
                       std::vector<std::string>& warnings, const ReadLimits& limits, Progress& progress) {
  return Reading(source, where, warnings, limits, progress).document(root);
}

}  // namespace limber
