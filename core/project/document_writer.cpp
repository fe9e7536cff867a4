// SPDX-License-Identifier: AGPL-3.0-or-later
#include <algorithm>

#include "core/base/bytes.h"
#include "core/base/parallel.h"
#include "core/project/constraints_codec.h"
#include "core/project/document_codec.h"
#include "core/project/document_layout.h"
#include "core/project/key_shapes_codec.h"
#include "core/project/seams_codec.h"
#include "core/project/strips_codec.h"

namespace limber {

namespace {

void put(ByteWriter& out, const glm::dvec3& v) {
  for (int i = 0; i < 3; ++i) out.put(v[i]);
}
void put(ByteWriter& out, const glm::dquat& q) {
  for (double value : {q.w, q.x, q.y, q.z}) out.put(value);
}
void put(ByteWriter& out, const std::vector<std::string>& texts) {
  out.count(texts.size());
  for (const std::string& text : texts) out.text(text);
}

void put(ByteWriter& out, const TissueTable& table) {
  out.text(table.source);
  out.count(table.tissues.size());
  for (const Tissue& tissue : table.tissues) {
    out.put(tissue.label);
    out.put(tissue.file_value);
    out.text(tissue.name);
    for (int i = 0; i < 3; ++i) out.put(tissue.colour[i]);
    out.put(static_cast<std::uint8_t>(tissue.kind));
    for (double value : {tissue.density, tissue.young_modulus, tissue.poisson_ratio}) out.put(value);
    out.put(static_cast<std::int32_t>(tissue.priority));
  }
}

void put(ByteWriter& out, const FileType& type) {
  out.text(type.format);
  out.text(type.voxel_type);
  out.flag(type.compressed);
}

void put(ByteWriter& out, const Armature& armature) {
  out.count(armature.bones.size());
  for (const Bone& bone : armature.bones) {
    out.text(bone.name);
    out.put(static_cast<std::int32_t>(bone.parent));
    put(out, bone.head);
    put(out, bone.tail);
    out.put(bone.roll);
    const JointLimits& limits = bone.limits;
    out.put(static_cast<std::uint8_t>(limits.type));
    put(out, limits.axis);
    for (double value : {limits.minimum, limits.maximum, limits.cone, limits.twist_minimum, limits.twist_maximum})
      out.put(value);
  }
}

void put(ByteWriter& out, const Pose& pose) {
  out.count(pose.rotation.size());
  for (const glm::dquat& rotation : pose.rotation) put(out, rotation);
  put(out, pose.root_translation);
}

void put(ByteWriter& out, const NamedPose& pose) {
  out.text(pose.name);
  out.count(pose.rotation.size());
  for (const auto& [bone, rotation] : pose.rotation) {
    out.text(bone);
    put(out, rotation);
  }
  out.flag(pose.root_translation.has_value());
  put(out, pose.root_translation.value_or(glm::dvec3(0)));
  out.text(pose.picture);
}

void put(ByteWriter& out, const Anchors& anchors) {
  out.count(anchors.pins.size());
  for (const std::string& bone : anchors.pins) out.text(bone);
  out.count(anchors.poles.size());
  for (const auto& [bone, place] : anchors.poles) {
    out.text(bone);
    put(out, place);
  }
}

void put(ByteWriter& out, const WeightLocks& locks) {
  out.count(locks.bones.size());
  for (const std::string& bone : locks.bones) out.text(bone);
}

void put(ByteWriter& out, const BoneMap& map) {
  out.count(map.size());
  for (const auto& [label, bone] : map) {
    out.text(label);
    out.text(bone);
  }
}

void put(ByteWriter& out, const Measurements& measurements) {
  out.count(measurements.size());
  for (const Measurement& one : measurements) {
    out.text(one.name);
    out.put(static_cast<std::uint8_t>(one.kind));
    out.count(one.points.size());
    for (const glm::dvec3& point : one.points) put(out, point);
  }
}

void put(ByteWriter& out, const Motion& motion) {
  out.count(motion.joints.size());
  for (const BvhJoint& joint : motion.joints) {
    out.text(joint.name);
    out.put(static_cast<std::int32_t>(joint.parent));
    put(out, joint.offset);
    out.count(joint.channels.size());
    for (BvhChannel channel : joint.channels) out.put(static_cast<std::uint8_t>(channel));
    out.put(static_cast<std::int32_t>(joint.first_channel));
    out.flag(joint.end_site.has_value());
    put(out, joint.end_site.value_or(glm::dvec3(0)));
  }
  out.put(static_cast<std::int32_t>(motion.channel_count));
  out.put(static_cast<std::int32_t>(motion.frame_count));
  out.put(motion.frame_time);
  put(out, motion.warnings);
  out.count(motion.values.size());
  out.raw(motion.values.data(), motion.values.size() * sizeof(float));
}

void put(ByteWriter& out, const Visibility& visibility) {
  out.count(visibility.looks.size());
  for (const auto& [label, look] : visibility.looks) {
    out.put(label);
    out.flag(look.visible);
    out.put(look.opacity);
  }
  out.flag(visibility.clip_box.enabled);
  put(out, visibility.clip_box.low);
  put(out, visibility.clip_box.high);
  out.flag(visibility.clip_plane.enabled);
  put(out, visibility.clip_plane.point);
  put(out, visibility.clip_plane.normal);
}

void put(ByteWriter& out, const Keys& keys) {
  out.count(keys.bones.size());
  for (const auto& [bone, track] : keys.bones) {
    out.text(bone);
    out.count(track.size());
    for (const auto& [frame, rotation] : track) {
      out.put(static_cast<std::int32_t>(frame));
      put(out, rotation);
    }
  }
  out.count(keys.root.size());
  for (const auto& [frame, place] : keys.root) {
    out.put(static_cast<std::int32_t>(frame));
    put(out, place);
  }
}

void put(ByteWriter& out, const RetargetMap& map) {
  out.count(map.sources.size());
  for (const auto& [bone, source] : map.sources) {
    out.text(bone);
    out.text(source.joint);
    out.flag(source.rest_offset.has_value());
    put(out, source.rest_offset.value_or(glm::dquat(1, 0, 0, 0)));
  }
}

// Returns the influences of a group of bricks as eight arrays, one behind the other: four arrays of bones (first to
// fourth bone of every voxel), then four arrays of weights. Values of one kind compress better together.
std::string group_bytes(const SkinWeights& weights, std::int64_t group) {
  const std::int64_t first = group * kGroupBricks, end = std::min(weights.chunk_count(), first + kGroupBricks);
  std::vector<std::uint16_t> planes;
  std::int64_t count = 0;
  for (std::int64_t brick = first; brick < end; ++brick) count += std::ssize(weights.chunk(brick));
  planes.resize(static_cast<std::size_t>(count) * 8);
  std::int64_t place = 0;
  for (std::int64_t brick = first; brick < end; ++brick)
    for (const Influence& influence : weights.chunk(brick)) {
      for (int k = 0; k < 4; ++k) {
        planes[k * count + place] = influence.bone[k];
        planes[(k + 4) * count + place] = influence.weight[k];
      }
      ++place;
    }
  return {reinterpret_cast<const char*>(planes.data()), planes.size() * sizeof(std::uint16_t)};
}

}  // namespace

// Data needed while one document is written into one sink.
class DocumentWriter::Writing {
 public:
  Writing(DocumentWriter& memory, ChunkSink& sink, Packing packing, Progress& progress)
      : memory_(memory),
        sink_(sink),
        packing_(packing),
        progress_(progress) {}

  ChunkHash document(const Document& document) {
    Node root;
    ByteWriter out;
    out.put(kDocumentLayout);
    const auto part = [&](const auto& pointer) {
      out.flag(pointer != nullptr);
      if (pointer) root.nodes.push_back(write(pointer));
    };
    progress_.update("save", 0);
    part(document.volume);
    progress_.update("save", 0.5);
    part(document.tissues);
    part(document.volume_type);
    part(document.armature);
    part(document.weights);
    progress_.update("save", 0.75);
    part(document.pose);
    part(document.visibility);
    out.count(document.results.size());
    for (const auto& result : document.results) root.nodes.push_back(write(result));
    out.count(document.clips.size());
    for (const auto& clip : document.clips) root.nodes.push_back(write(clip));
    out.put(static_cast<std::int32_t>(document.clip));
    out.put(static_cast<std::int32_t>(document.frame));
    out.count(document.poses.size());
    for (const auto& pose : document.poses) root.nodes.push_back(write(pose));
    part(document.anchors);
    part(document.locks);
    part(document.layers);
    part(document.seams);
    part(document.bone_map);
    part(document.measurements);
    root.bytes = out.take();
    const ChunkHash hash = put_chunk(to_chunk(root));
    progress_.update("save", 1);
    return hash;
  }

 private:
  // Writes the node of a document part unless the sink already has that node. Returns the node's hash.
  template <class T>
  ChunkHash write(const std::shared_ptr<const T>& part) {
    const auto known = memory_.parts_.find(part.get());
    if (known != memory_.parts_.end() && !known->second.part.expired() && sink_.has(known->second.hash))
      return known->second.hash;
    Node node;
    ByteWriter out;
    out.put(static_cast<std::uint8_t>(PartKindOf<T>::kKind));
    fill(node, out, *part);
    std::string bytes = out.take();
    if (bytes.size() > kInlineBytes && node.leaves.empty()) {  // a long motion or report goes into leaves
      node.bytes.assign(1, bytes[0]);
      append_leaves(node, static_cast<std::int64_t>(bytes.size() - 1), [&](std::int64_t begin, std::int64_t end) {
        return bytes.substr(1 + static_cast<std::size_t>(begin), static_cast<std::size_t>(end - begin));
      });
    } else {
      node.bytes = std::move(bytes);
    }
    const ChunkHash hash = put_chunk(to_chunk(node));
    memory_.parts_[part.get()] = {part, hash};
    return hash;
  }

  template <class T>
  void fill(Node&, ByteWriter& out, const T& part) {
    put(out, part);
  }

  void fill(Node& node, ByteWriter& out, const LabelVolume& volume) {
    const Grid& grid = volume.grid;
    for (int i = 0; i < 3; ++i) out.put(static_cast<std::int32_t>(grid.size[i]));
    put(out, grid.spacing);
    put(out, grid.origin);
    for (int i = 0; i < 3; ++i) put(out, grid.direction[i]);
    const char* voxels = reinterpret_cast<const char*>(volume.voxels.data());
    append_leaves(node, std::ssize(volume.voxels) * std::int64_t{sizeof(Label)},
                  [&](std::int64_t begin, std::int64_t end) { return std::string(voxels + begin, voxels + end); });
  }

  void fill(Node& node, ByteWriter& out, const SkinWeights& weights) {
    put(out, weights.bones());
    const std::int64_t bricks = weights.chunk_count(), groups = (bricks + kGroupBricks - 1) / kGroupBricks;
    std::vector<std::uint16_t> lengths(bricks);
    for (std::int64_t brick = 0; brick < bricks; ++brick)
      lengths[brick] = static_cast<std::uint16_t>(weights.chunk(brick).size());
    // The number of voxels of each brick is stored in a leaf of its own. This leaf stays the same while weights change,
    // so it is written once.
    node.leaves.push_back(
        put_chunk({reinterpret_cast<const char*>(lengths.data()), lengths.size() * sizeof(std::uint16_t)}));

    std::vector<ChunkHash> hashes(groups);
    std::vector<std::int64_t> changed;
    for (std::int64_t group = 0; group < groups; ++group) {
      const auto known =
          std::find_if(memory_.last_weights_.begin(), memory_.last_weights_.end(), [&](const auto& last) {
            return same_bricks(last.second, weights, group) && sink_.has(last.second.groups[group]);
          });
      if (known == memory_.last_weights_.end()) changed.push_back(group);
      else hashes[group] = known->second.groups[group];
    }
    const auto written = put_all(std::ssize(changed), [&](std::int64_t i) { return group_bytes(weights, changed[i]); });
    for (std::size_t i = 0; i < changed.size(); ++i) hashes[changed[i]] = written[i];
    node.leaves.insert(node.leaves.end(), hashes.begin(), hashes.end());

    LastWeights& last = memory_.last_weights_[role_];
    last.bricks.resize(bricks);
    for (std::int64_t brick = 0; brick < bricks; ++brick) last.bricks[brick] = weights.shared_chunk(brick);
    last.groups = std::move(hashes);
  }

  static bool same_bricks(const LastWeights& last, const SkinWeights& weights, std::int64_t group) {
    if (std::ssize(last.bricks) != weights.chunk_count()) return false;
    const std::int64_t first = group * kGroupBricks, end = std::min(weights.chunk_count(), first + kGroupBricks);
    for (std::int64_t brick = first; brick < end; ++brick)
      if (last.bricks[brick].lock() != weights.shared_chunk(brick)) return false;
    return true;
  }

  // Writes a weight layer. One leaf tells which bricks have a mask. Then each group of bricks has a leaf with the masks
  // of its bricks in order.
  void fill(Node& node, ByteWriter& out, const WeightLayer& layer) {
    out.text(layer.name);
    out.flag(layer.visible);
    out.put(layer.opacity);
    node.nodes.push_back(write_weights(layer.weights));
    const std::int64_t bricks = std::ssize(layer.mask);
    std::vector<std::uint8_t> covers(bricks);
    for (std::int64_t brick = 0; brick < bricks; ++brick) covers[brick] = layer.mask[brick] != nullptr;
    node.leaves.push_back(put_chunk({reinterpret_cast<const char*>(covers.data()), covers.size()}));
    const auto leaves = put_all((bricks + kGroupBricks - 1) / kGroupBricks, [&](std::int64_t group) {
      std::string bytes;
      for (std::int64_t brick = group * kGroupBricks; brick < std::min(bricks, (group + 1) * kGroupBricks); ++brick)
        if (const auto& mask = layer.mask[brick])
          bytes.append(reinterpret_cast<const char*>(mask->data()), mask->size() * sizeof(std::uint16_t));
      return bytes;
    });
    node.leaves.insert(node.leaves.end(), leaves.begin(), leaves.end());
  }

  // Writes the base weights first, then the layers from bottom to top.
  void fill(Node& node, ByteWriter& out, const WeightLayers& layers) {
    role_ = 1;
    node.nodes.push_back(write(layers.base));
    out.count(layers.layers.size());
    for (const auto& layer : layers.layers) {
      ++role_;
      node.nodes.push_back(write(layer));
    }
    role_ = 0;
  }

  // Writes a layer's weights and returns the hash of their node. The layer holds them by value and not by shared
  // pointer, so the writer cannot remember them in parts_.
  ChunkHash write_weights(const SkinWeights& weights) {
    Node node;
    ByteWriter out;
    out.put(static_cast<std::uint8_t>(PartKind::Weights));
    fill(node, out, weights);
    node.bytes = out.take();
    return put_chunk(to_chunk(node));
  }

  void fill(Node& node, ByteWriter& out, const Result& result) {
    const auto part = [&](const auto& pointer) {
      out.flag(pointer != nullptr);
      if (pointer) node.nodes.push_back(write(pointer));
    };
    part(result.volume);
    part(result.from_volume);
    part(result.from_tissues);
    part(result.from_armature);
    part(result.from_weights);
    part(result.from_pose);
    out.text(result.name);
    out.text(result.method);
    out.text(result.report);
    // Writes the optional parts last, and leaves out those behind the last one that exists. So a result without
    // optional parts has the same bytes as in earlier layouts.
    const bool has_sources = result.from_seams || result.from_bone_map;
    if (result.solved || result.overlap || has_sources) part(result.solved);
    if (result.overlap || has_sources) part(result.overlap);
    if (has_sources) part(result.from_seams);
    if (has_sources) part(result.from_bone_map);
  }

  void fill(Node&, ByteWriter& out, const Overlap& overlap) {
    for (const auto* voxels : {&overlap.tissue, &overlap.bones}) {
      out.count(voxels->size());
      for (const std::int64_t voxel : *voxels) out.put(voxel);
    }
  }

  void fill(Node&, ByteWriter& out, const SolvedMesh& solved) {
    out.text(encode(solved.mesh));
    out.text(encode(FemStep{.V = solved.V}));
  }

  void fill(Node& node, ByteWriter& out, const Clip& clip) {
    out.flag(clip.motion != nullptr);
    if (clip.motion) node.nodes.push_back(write(clip.motion));
    out.text(clip.name);
    out.put(clip.rate);
    for (int number : {clip.start, clip.first, clip.last, clip.range_start, clip.range_end})
      out.put(static_cast<std::int32_t>(number));
    put(out, clip.map);
    out.put(static_cast<std::uint8_t>(clip.retarget.travel));
    out.flag(clip.retarget.mirror);
    out.put(clip.retarget.scale);
    out.put(packed_reference(clip));
    put(out, clip.keys);
    out.count(clip.markers.size());
    for (const Marker& marker : clip.markers) {
      out.put(static_cast<std::int32_t>(marker.frame));
      out.text(marker.name);
    }
    // Without shapes of keys, constraints and strips, a clip has the same bytes as in earlier layouts.
    const bool has_strips = clip.strips != nullptr, constrained = has_constraints(clip) || has_strips;
    if (clip.keys.shapes.size() + clip.keys.root_shapes.size() > 0 || constrained) put_shapes(out, clip.keys);
    if (constrained) put_constraints(out, clip);
    if (!has_strips) return;
    const std::vector<std::shared_ptr<const Clip>> clips = clips_of(*clip.strips);
    for (const auto& one : clips) node.nodes.push_back(write(one));
    put_strips(out, *clip.strips, clips);
  }

  template <class Bytes>
  void append_leaves(Node& node, std::int64_t size, const Bytes& bytes) {
    const auto written = put_all((size + kLeafBytes - 1) / kLeafBytes, [&](std::int64_t leaf) {
      return bytes(leaf * kLeafBytes, std::min(size, (leaf + 1) * kLeafBytes));
    });
    node.leaves.insert(node.leaves.end(), written.begin(), written.end());
  }

  // Hashes and packs the chunks in parallel and puts them into the sink in order.
  template <class Chunk>
  std::vector<ChunkHash> put_all(std::int64_t count, const Chunk& chunk) {
    constexpr std::int64_t kBatch = 32;  // number of leaves in memory at once, each at most a megabyte
    std::vector<ChunkHash> hashes(count);
    for (std::int64_t first = 0; first < count; first += kBatch) {
      progress_.update("save", static_cast<double>(first) / static_cast<double>(count));
      const std::int64_t batch = std::min(kBatch, count - first);
      std::vector<std::string> bytes(batch);
      std::vector<std::uint8_t> missing(batch);
      parallel_for(batch, 1, [&](std::int64_t begin, std::int64_t end) {
        for (std::int64_t i = begin; i < end; ++i) {
          bytes[i] = chunk(first + i);
          hashes[first + i] = hash_of(bytes[i]);
        }
      });
      for (std::int64_t i = 0; i < batch; ++i) missing[i] = !sink_.has(hashes[first + i]);
      parallel_for(batch, 1, [&](std::int64_t begin, std::int64_t end) {
        for (std::int64_t i = begin; i < end; ++i)
          if (missing[i]) bytes[i] = pack(bytes[i], packing_);
      });
      for (std::int64_t i = 0; i < batch; ++i)
        if (missing[i] && !sink_.has(hashes[first + i]))
          sink_.put(hashes[first + i], bytes[i]);  // the sink stores equal chunks once
    }
    return hashes;
  }

  ChunkHash put_chunk(const std::string& chunk) {
    const ChunkHash hash = hash_of(chunk);
    if (!sink_.has(hash)) sink_.put(hash, pack(chunk, packing_));
    return hash;
  }

  DocumentWriter& memory_;
  ChunkSink& sink_;
  const Packing packing_;
  Progress& progress_;
  int role_ = 0;  // which weights are written: 0 the blend, 1 the base, 2, 3, ... the layers from bottom to top
};

ChunkHash DocumentWriter::write(const Document& document, ChunkSink& sink, Packing packing, Progress& progress) {
  std::erase_if(parts_, [](const auto& entry) { return entry.second.part.expired(); });
  return Writing(*this, sink, packing, progress).document(document);
}

}  // namespace limber
