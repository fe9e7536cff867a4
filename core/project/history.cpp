// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/project/history.h"

#include <algorithm>
#include <unordered_map>
#include <utility>

#include "core/motion/constraint.h"
#include "core/motion/strips.h"
#include "core/project/packed_volumes.h"
#include "core/resample/fem_steps.h"
#include "core/skin/weight_layers.h"

namespace limber {

namespace {

// Bytes that a heap block takes in addition to its contents: the heap's own data and a shared_ptr's use counts.
constexpr std::int64_t kBlock = 32;

template <class Vector>
requires requires(const Vector& values) {
  values.capacity();
  values.data();
}
std::int64_t heap_bytes(const Vector& values) {
  return values.capacity() == 0 ? 0 : static_cast<std::int64_t>(values.capacity() * sizeof(*values.data())) + kBlock;
}
std::int64_t heap_bytes(const std::string& text) { return static_cast<std::int64_t>(text.capacity()) + kBlock; }

std::int64_t own_bytes(const LabelVolume& volume) { return heap_bytes(volume.voxels); }
std::int64_t own_bytes(const TissueTable& table) {
  std::int64_t bytes = heap_bytes(table.tissues) + heap_bytes(table.source);
  for (const Tissue& tissue : table.tissues) bytes += heap_bytes(tissue.name);
  return bytes;
}
std::int64_t own_bytes(const FileType& type) { return heap_bytes(type.format) + heap_bytes(type.voxel_type); }
std::int64_t own_bytes(const Armature& armature) {
  std::int64_t bytes = heap_bytes(armature.bones);
  for (const Bone& bone : armature.bones) bytes += heap_bytes(bone.name);
  return bytes;
}
std::int64_t own_bytes(const SkinWeights& weights) {  // size without its chunks, which are counted separately
  std::int64_t bytes = kBlock + weights.chunk_count() * std::int64_t{sizeof(std::shared_ptr<const SkinWeights::Chunk>)};
  for (const std::string& bone : weights.bones()) bytes += heap_bytes(bone) + std::int64_t{sizeof bone};
  return bytes;
}
std::int64_t own_bytes(const SkinWeights::Chunk& chunk) { return chunk.heap_bytes() + kBlock; }
std::int64_t own_bytes(const Pose& pose) { return heap_bytes(pose.rotation); }
std::int64_t own_bytes(const Motion& motion) {
  std::int64_t bytes = heap_bytes(motion.joints) + heap_bytes(motion.values) + heap_bytes(motion.warnings);
  for (const BvhJoint& joint : motion.joints) bytes += heap_bytes(joint.name) + heap_bytes(joint.channels);
  for (const std::string& warning : motion.warnings) bytes += heap_bytes(warning);
  return bytes;
}
std::int64_t own_bytes(const NamedPose& pose) {
  std::int64_t bytes = heap_bytes(pose.name) + heap_bytes(pose.picture);
  for (const auto& [bone, rotation] : pose.rotation)
    bytes += kBlock + std::int64_t{sizeof(std::pair<std::string, glm::dquat>)} + 32 + heap_bytes(bone);
  return bytes;
}
std::int64_t own_bytes(const Clip& clip) {     // size without its motion, which is counted separately
  constexpr std::int64_t kNode = kBlock + 48;  // overhead of a map's node, bytes
  std::int64_t bytes = heap_bytes(clip.name) + heap_bytes(clip.markers) + kNode * std::ssize(clip.keys.root);
  for (const auto& [bone, source] : clip.map.sources)
    bytes += kNode + std::int64_t{sizeof source} + heap_bytes(bone) + heap_bytes(source.joint);
  for (const auto& [bone, track] : clip.keys.bones)
    bytes += kNode + heap_bytes(bone) + (kNode + 16) * std::ssize(track);
  bytes += (kNode + 56) * std::ssize(clip.keys.root_shapes);
  for (const auto& [bone, shapes] : clip.keys.shapes)
    bytes += kNode + heap_bytes(bone) + (kNode + 56) * std::ssize(shapes);
  for (const Marker& marker : clip.markers) bytes += heap_bytes(marker.name);
  for (const auto& [constraint, track] : clip.keys.weights)
    bytes += kNode + heap_bytes(constraint) + (kNode + 16) * std::ssize(track);
  for (const auto& [constraint, shapes] : clip.keys.weight_shapes)
    bytes += kNode + heap_bytes(constraint) + (kNode + 56) * std::ssize(shapes);
  if (clip.constraints) bytes += heap_bytes(clip.constraints->list);
  return bytes;
}
std::int64_t own_bytes(const Strips& strips) {  // size without the clips, which are counted separately
  constexpr std::int64_t kNode = kBlock + 32;   // overhead of a set's node, bytes
  std::int64_t bytes = heap_bytes(strips.tracks);
  for (const StripTrack& track : strips.tracks) {
    bytes += heap_bytes(track.name) + heap_bytes(track.strips);
    for (const Strip& strip : track.strips) {
      bytes += heap_bytes(strip.name);
      for (const std::string& bone : strip.bones.value_or(std::set<std::string>()))
        bytes += kNode + std::int64_t{sizeof bone} + heap_bytes(bone);
    }
  }
  return bytes;
}
std::int64_t own_bytes(const Anchors& anchors) {
  constexpr std::int64_t kNode = kBlock + 32;  // overhead of a node of a set or map, bytes
  std::int64_t bytes = 0;
  for (const std::string& bone : anchors.pins) bytes += kNode + std::int64_t{sizeof bone} + heap_bytes(bone);
  for (const auto& [bone, place] : anchors.poles)
    bytes += kNode + std::int64_t{sizeof bone + sizeof place} + heap_bytes(bone);
  return bytes;
}
std::int64_t own_bytes(const WeightLocks& locks) {
  constexpr std::int64_t kNode = kBlock + 32;  // overhead of a set's node, bytes
  std::int64_t bytes = 0;
  for (const std::string& bone : locks.bones) bytes += kNode + std::int64_t{sizeof bone} + heap_bytes(bone);
  return bytes;
}
std::int64_t own_bytes(const Seams& seams) { return seams.heap_bytes() + 2 * kBlock; }
std::int64_t own_bytes(const BoneMap& map) {
  constexpr std::int64_t kNode = kBlock + 32;  // overhead of a map's node, bytes
  std::int64_t bytes = 0;
  for (const auto& [label, bone] : map)
    bytes += kNode + std::int64_t{sizeof label + sizeof bone} + heap_bytes(label) + heap_bytes(bone);
  return bytes;
}
std::int64_t own_bytes(const Measurements& measurements) {
  std::int64_t bytes = heap_bytes(measurements);
  for (const Measurement& one : measurements) bytes += heap_bytes(one.name) + heap_bytes(one.points);
  return bytes;
}
std::int64_t own_bytes(const WeightLayer::Mask& mask) { return heap_bytes(mask); }
// Returns the layer's size without its mask blocks and the chunks of its weights. Documents share these, so they are
// counted separately.
std::int64_t own_bytes(const WeightLayer& layer) {
  return heap_bytes(layer.name) + own_bytes(layer.weights) + heap_bytes(layer.mask);
}
std::int64_t own_bytes(const WeightLayers& layers) { return heap_bytes(layers.layers); }
std::int64_t own_bytes(const Visibility& visibility) {
  return static_cast<std::int64_t>(visibility.looks.size()) *
         (kBlock + std::int64_t{sizeof(std::pair<Label, TissueLook>)} + 32);
}
std::int64_t own_bytes(const SolvedMesh& solved) {
  const FemMesh& mesh = solved.mesh;
  return heap_bytes(mesh.material) + heap_bytes(mesh.joint) + heap_bytes(mesh.tets.region) +
         static_cast<std::int64_t>((mesh.tets.V.size() + solved.V.size()) * sizeof(double) +
                                   mesh.tets.T.size() * sizeof(int)) +
         3 * kBlock;
}
std::int64_t own_bytes(const Overlap& overlap) { return heap_bytes(overlap.tissue) + heap_bytes(overlap.bones); }
std::int64_t own_bytes(const Result& result) {
  return heap_bytes(result.name) + heap_bytes(result.method) + heap_bytes(result.report);
}

}  // namespace

// Counts how many documents of the history use each part, by the part's address. Parts nested in another part (the
// chunks of weights, the parts that a result was made from) count once for each outer part, however many documents use
// the outer part.
class History::Ledger {
 public:
  void add(const Document& document) { visit(document, +1); }
  void remove(const Document& document) { visit(document, -1); }
  std::int64_t bytes() const { return bytes_ + volumes.bytes(); }

  PackedVolumes volumes;
  // Replaces the volume of a document and updates the count of bytes.
  const PackedVolumes::SetVolume set_volume = [this](Document& document, std::shared_ptr<const LabelVolume> volume) {
    remove(document);
    document.volume = std::move(volume);
    add(document);
  };

 private:
  // Adds a use of a part (step 1) or removes a use (step -1). Returns true when the part's first use was added or its
  // last use was removed.
  template <class T>
  bool count(const std::shared_ptr<const T>& part, int step) {
    if (!part) return false;
    std::int64_t& uses = uses_[part.get()];
    const bool edge = step > 0 ? uses == 0 : uses == 1;
    uses += step;
    if (edge) bytes_ += step * (static_cast<std::int64_t>(sizeof(T)) + kBlock + own_bytes(*part));
    if (uses == 0) uses_.erase(part.get());
    return edge;
  }

  void visit_chunks(const SkinWeights& weights, int step) {
    for (std::int64_t brick = 0; brick < weights.chunk_count(); ++brick) count(weights.shared_chunk(brick), step);
  }
  void visit(const std::shared_ptr<const SkinWeights>& weights, int step) {
    if (count(weights, step)) visit_chunks(*weights, step);
  }
  void visit(const std::shared_ptr<const WeightLayers>& layers, int step) {
    if (!count(layers, step)) return;
    visit(layers->base, step);
    for (const auto& layer : layers->layers) {
      if (!count(layer, step)) continue;
      visit_chunks(layer->weights, step);
      for (const auto& mask : layer->mask) count(mask, step);
    }
  }

  void visit(const std::shared_ptr<const Result>& result, int step) {
    if (!count(result, step)) return;
    count(result->volume, step);
    count(result->from_volume, step);
    count(result->from_tissues, step);
    count(result->from_armature, step);
    visit(result->from_weights, step);
    count(result->from_pose, step);
    count(result->solved, step);
    count(result->overlap, step);
    count(result->from_seams, step);
    count(result->from_bone_map, step);
  }

  void visit(const std::shared_ptr<const Clip>& clip, int step) {
    if (!count(clip, step)) return;
    count(clip->motion, step);
    if (count(clip->strips, step))
      for (const auto& one : clips_of(*clip->strips)) visit(one, step);
  }

  void visit(const Document& document, int step) {
    count(document.volume, step);
    count(document.tissues, step);
    count(document.volume_type, step);
    count(document.armature, step);
    visit(document.weights, step);
    count(document.pose, step);
    count(document.visibility, step);
    for (const auto& result : document.results) visit(result, step);
    for (const auto& clip : document.clips) visit(clip, step);
    for (const auto& pose : document.poses) count(pose, step);
    count(document.anchors, step);
    count(document.locks, step);
    visit(document.layers, step);
    count(document.seams, step);
    count(document.bone_map, step);
    count(document.measurements, step);
    bytes_ += step * (static_cast<std::int64_t>(sizeof(Step)) + heap_bytes(document.results) +
                      heap_bytes(document.clips) + heap_bytes(document.poses));
  }

  std::unordered_map<const void*, std::int64_t> uses_;
  std::int64_t bytes_ = 0;
};

History::History(Document first, std::string label, std::int64_t limit_bytes) : limit_(limit_bytes) {
  reset(std::move(first), std::move(label));
}

History::~History() = default;

bool History::commit(std::string label, Document next) {
  if (next == current()) return false;
  drop_redo();
  ledger_->add(next);
  steps_.push_back({std::move(label), std::move(next), next_revision_++});
  ledger_->volumes.resize(steps_, std::ssize(steps_), ledger_->set_volume);
  ++position_;
  keep_within_limit();
  return true;
}

void History::amend(std::string label, Document next) {
  if (next == current()) return;
  drop_redo();
  if (next.volume != current().volume) ledger_->volumes.unlink(steps_, position_, ledger_->set_volume);
  ledger_->add(next);
  ledger_->remove(current());
  steps_.back() = {std::move(label), std::move(next), next_revision_++};
  keep_within_limit();
}

void History::reset(Document first, std::string label) {
  steps_.clear();
  position_ = dropped_ = 0;
  saved_ = next_revision_++;
  ledger_ = std::make_unique<Ledger>();
  ledger_->add(first);
  steps_.push_back({std::move(label), std::move(first), saved_});
  ledger_->volumes.resize(steps_, 1, ledger_->set_volume);
}

bool History::undo() {
  if (!can_undo()) return false;
  go_to(position_ - 1);
  return true;
}

bool History::redo() {
  if (!can_redo()) return false;
  go_to(position_ + 1);
  return true;
}

void History::jump(std::int64_t step) { go_to(std::clamp<std::int64_t>(step, 0, std::ssize(steps_) - 1)); }

void History::go_to(std::int64_t step) {
  position_ = step;
  ledger_->volumes.unpack(steps_, step, ledger_->set_volume);
  pack_volumes();
}

void History::drop_redo() {
  ledger_->volumes.resize(steps_, position_ + 1, ledger_->set_volume);
  for (; can_redo(); steps_.pop_back()) ledger_->remove(steps_.back().document);
}

void History::pack_volumes() {
  while (bytes() > limit_ && ledger_->volumes.pack(steps_, position_, ledger_->set_volume)) {
  }
}

std::int64_t History::bytes() const { return ledger_->bytes(); }
std::int64_t History::current_bytes() const { return bytes_of(current()); }

std::int64_t bytes_of(const Document& document) {
  History alone(document);
  return alone.bytes();
}

void History::set_limit(std::int64_t bytes) {
  limit_ = bytes;
  keep_within_limit();
}

// Packs volumes, and if that is not enough, drops the oldest undo steps first. When no undo step is left, drops redo
// steps, the last one first.
void History::keep_within_limit() {
  pack_volumes();
  if (bytes() <= limit_) return;
  const std::int64_t most = std::max(limit_, current_bytes() + limit_ / 2);
  for (; bytes() > most && position_ > 0; --position_, ++dropped_) {
    ledger_->volumes.erase_front(steps_, 1, ledger_->set_volume);
    ledger_->remove(steps_.front().document);
    steps_.erase(steps_.begin());
  }
  for (; bytes() > most && can_redo(); ++dropped_) {
    ledger_->volumes.resize(steps_, std::ssize(steps_) - 1, ledger_->set_volume);
    ledger_->remove(steps_.back().document);
    steps_.pop_back();
  }
}

std::string History::note() const {
  if (dropped_ == 0) return "";
  const std::string steps =
      dropped_ == 1 ? "The oldest step was" : "The " + std::to_string(dropped_) + " oldest steps were";
  return steps + " dropped to keep undo within " + std::to_string(limit_ >> 20) + " MB.";
}

}  // namespace limber
