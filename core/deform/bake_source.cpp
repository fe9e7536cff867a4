// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/deform/bake_source.h"

#include <string>
#include <utility>
#include <vector>

#include "core/base/bytes.h"
#include "core/base/error.h"
#include "core/base/file.h"
#include "core/base/parallel.h"

namespace limber {

namespace {

constexpr std::int64_t kBricks = 256;  // number of bricks that one task hashes together

BakeSource::Hash hash_of(const std::string& bytes) { return sha256(bytes.data(), bytes.size()); }

// Returns the hash of all bricks: the bricks' bytes are hashed in groups, then the list of these hashes is hashed.
//   head  bytes that are put before the list of hashes
//   put   function that writes the bytes of one brick
template <class Put>
BakeSource::Hash hash_of_bricks(std::int64_t count, std::string head, const Put& put) {
  std::vector<BakeSource::Hash> parts((count + kBricks - 1) / kBricks);
  parallel_for(count, kBricks, [&](std::int64_t begin, std::int64_t end) {
    ByteWriter writer;
    for (auto brick = begin; brick < end; ++brick) put(brick, writer);
    parts[begin / kBricks] = hash_of(writer.take());
  });
  for (const BakeSource::Hash& part : parts) head.append(reinterpret_cast<const char*>(part.data()), part.size());
  return hash_of(head);
}

void put_vector(ByteWriter& writer, const glm::dvec3& v) {
  for (int axis = 0; axis < 3; ++axis) writer.put(v[axis] + 0.0);  // -0 becomes 0
}

std::string bytes_of(const Grid& grid) {
  ByteWriter writer;
  for (int axis = 0; axis < 3; ++axis) writer.put(grid.size[axis]);
  put_vector(writer, grid.spacing);
  put_vector(writer, grid.origin);
  for (int axis = 0; axis < 3; ++axis) put_vector(writer, grid.direction[axis]);
  return writer.take();
}

BakeSource::Hash hash_of_rig(const Armature& armature) {
  ByteWriter writer;
  for (const Bone& bone : armature.bones) {
    writer.text(bone.name);
    writer.put(static_cast<std::int32_t>(bone.parent));
    put_vector(writer, bone.head);
    put_vector(writer, bone.tail);
  }
  return hash_of(writer.take());
}

}  // namespace

BakeSource bake_source(const LabelVolume& volume, const TissueVoxels& tissue, const LabelSet& is_bone,
                       const Armature& armature, const SkinWeights& weights) {
  const std::int64_t count = std::ssize(tissue.bricks());
  BakeSource source;
  source.volume = hash_of_bricks(count, bytes_of(volume.grid), [&](std::int64_t brick, ByteWriter& writer) {
    for (int axis = 0; axis < 3; ++axis) writer.put(static_cast<std::int32_t>(tissue.bricks()[brick].corner[axis]));
    writer.raw(tissue.bricks()[brick].mask.data(), sizeof tissue.bricks()[brick].mask);
    tissue.for_each(brick, brick + 1, [&](std::int64_t, const glm::ivec3& v) { writer.put(volume.at(v)); });
  });
  source.bones = hash_of_bricks(count, "bones", [&](std::int64_t brick, ByteWriter& writer) {
    std::uint64_t bones = 0;
    int bits = 0;
    tissue.for_each(brick, brick + 1, [&](std::int64_t, const glm::ivec3& v) {
      bones = bones << 1 | (is_bone[volume.at(v)] != 0);
      if (++bits % 64 == 0) writer.put(std::exchange(bones, 0));
    });
    writer.put(bones);
  });
  source.rig = hash_of_rig(armature);
  ByteWriter names;
  for (const std::string& bone : weights.bones()) names.text(bone);
  source.weights = hash_of_bricks(weights.chunk_count(), names.take(), [&](std::int64_t brick, ByteWriter& writer) {
    for (const Influence influence : weights.chunk(brick))
      for (int i = 0; i < 4; ++i) {
        writer.put(influence.weight[i] ? influence.bone[i] : std::uint16_t{0});
        writer.put(influence.weight[i]);
      }
  });
  return source;
}

void check_source(const BakedJoint& joint, const BakeSource& body) {
  const char* differs = joint.source.volume != body.volume     ? "another volume"
                        : joint.source.rig != body.rig         ? "another rig"
                        : joint.source.weights != body.weights ? "other weights"
                        : joint.source.bones != body.bones     ? "other bone labels"
                                                               : nullptr;
  if (differs)
    throw Error(std::string("the joint was baked from ") + differs, joint.bone,
                "give the same volume, rig, weights and tissues, or bake the joint again: limber bake-joint");
}

}  // namespace limber
