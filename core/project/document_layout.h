// SPDX-License-Identifier: AGPL-3.0-or-later
// The byte layout that the document's writer and reader share. Every change of the layout needs a new kDocumentLayout.
#pragma once

#include <cstdint>

#include "core/project/document.h"
#include "core/resample/fem_steps.h"
#include "core/skin/weight_layers.h"

namespace limber {

// The reader also accepts the earlier layouts. Layout 1 has one motion and no clips. Layout 2 has no pose library, 3
// has no anchors, 4 has only bits 0 and 1 of packed_reference(), 5 has no weight locks, 6 has no weight layers, 7 has
// no overlap in a result, 8 has neither seams nor a bone map, 9 has no measurements, 10 has no shapes of keys, 11 has
// no constraints, and 12 has no strips.
constexpr std::uint32_t kDocumentLayout = 13;

// The first byte of a part, which names its type.
enum class PartKind : std::uint8_t {
  Volume = 1,
  Tissues,
  VolumeType,
  Armature,
  Weights,
  Pose,
  Motion,
  Visibility,
  Result,
  Clip,
  NamedPose,
  Anchors,
  WeightLocks,
  WeightLayer,
  WeightLayers,
  SolvedMesh,
  Overlap,
  Seams,
  BoneMap,
  Measurements
};

template <class T>
struct PartKindOf;
template <>
struct PartKindOf<LabelVolume> {
  static constexpr PartKind kKind = PartKind::Volume;
  static constexpr const char* kName = "volume";
};
template <>
struct PartKindOf<TissueTable> {
  static constexpr PartKind kKind = PartKind::Tissues;
  static constexpr const char* kName = "tissues";
};
template <>
struct PartKindOf<FileType> {
  static constexpr PartKind kKind = PartKind::VolumeType;
  static constexpr const char* kName = "volume's file type";
};
template <>
struct PartKindOf<Armature> {
  static constexpr PartKind kKind = PartKind::Armature;
  static constexpr const char* kName = "rig";
};
template <>
struct PartKindOf<SkinWeights> {
  static constexpr PartKind kKind = PartKind::Weights;
  static constexpr const char* kName = "weights";
};
template <>
struct PartKindOf<Pose> {
  static constexpr PartKind kKind = PartKind::Pose;
  static constexpr const char* kName = "pose";
};
template <>
struct PartKindOf<Motion> {
  static constexpr PartKind kKind = PartKind::Motion;
  static constexpr const char* kName = "motion";
};
template <>
struct PartKindOf<Visibility> {
  static constexpr PartKind kKind = PartKind::Visibility;
  static constexpr const char* kName = "visibility";
};
template <>
struct PartKindOf<Result> {
  static constexpr PartKind kKind = PartKind::Result;
  static constexpr const char* kName = "result";
};
template <>
struct PartKindOf<Clip> {
  static constexpr PartKind kKind = PartKind::Clip;
  static constexpr const char* kName = "clip";
};
template <>
struct PartKindOf<NamedPose> {
  static constexpr PartKind kKind = PartKind::NamedPose;
  static constexpr const char* kName = "pose of the library";
};
template <>
struct PartKindOf<Anchors> {
  static constexpr PartKind kKind = PartKind::Anchors;
  static constexpr const char* kName = "pins and poles";
};
template <>
struct PartKindOf<WeightLocks> {
  static constexpr PartKind kKind = PartKind::WeightLocks;
  static constexpr const char* kName = "locks of weights";
};
template <>
struct PartKindOf<WeightLayer> {
  static constexpr PartKind kKind = PartKind::WeightLayer;
  static constexpr const char* kName = "layer of weights";
};
template <>
struct PartKindOf<WeightLayers> {
  static constexpr PartKind kKind = PartKind::WeightLayers;
  static constexpr const char* kName = "layers of weights";
};
template <>
struct PartKindOf<SolvedMesh> {
  static constexpr PartKind kKind = PartKind::SolvedMesh;
  static constexpr const char* kName = "mesh of a result";
};
template <>
struct PartKindOf<Overlap> {
  static constexpr PartKind kKind = PartKind::Overlap;
  static constexpr const char* kName = "overlap of a result";
};
template <>
struct PartKindOf<Seams> {
  static constexpr PartKind kKind = PartKind::Seams;
  static constexpr const char* kName = "seams";
};
template <>
struct PartKindOf<BoneMap> {
  static constexpr PartKind kKind = PartKind::BoneMap;
  static constexpr const char* kName = "bone map";
};
template <>
struct PartKindOf<Measurements> {
  static constexpr PartKind kKind = PartKind::Measurements;
  static constexpr const char* kName = "measurements";
};

// Packs three settings of a clip into one byte. Bits 0 and 1 are the retargeting's reference, bits 2 and 3 the rest
// stance (T-pose, A-pose, ...) of the source skeleton, and bits 4 and 5 the rig's rest stance.
inline std::uint8_t packed_reference(const Clip& clip) {
  return static_cast<std::uint8_t>(static_cast<int>(clip.retarget.reference) |
                                   static_cast<int>(clip.map.stances.source) << 2 |
                                   static_cast<int>(clip.map.stances.rig) << 4);
}

// Size of the leaves of voxels or long text, bytes. The last leaf may be smaller.
constexpr std::int64_t kLeafBytes = std::int64_t{1} << 20;
constexpr std::int64_t kGroupBricks = 32;  // number of weight bricks whose influences fill one leaf, 256 KB at most
constexpr std::size_t kInlineBytes = std::size_t{64} << 10;  // bytes; a larger part goes into leaves

}  // namespace limber
