// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/project/carved_project.h"

#include <algorithm>
#include <cstring>
#include <map>
#include <utility>
#include <vector>

#include "core/base/bytes.h"
#include "core/base/error.h"
#include "core/project/document_layout.h"

namespace limber {

namespace {

constexpr int kMostRoots = 64;       // number of root nodes (one for each save) that are tried, latest first
constexpr int kMostCandidates = 16;  // number of nodes that are tried for one part of the document
constexpr std::size_t kLargestNode = std::size_t{4} << 20;  // packed bytes; a larger chunk is not tried as a node

bool is_empty(const Document& document) { return document == Document{}; }

// Reads the document whose root node is `root`. Returns nothing where the document cannot be read or is empty.
std::optional<Document> try_root(const ChunkHash& root, ChunkSource& source, const std::string& where,
                                 std::vector<std::string>& warnings, Progress& progress) {
  try {
    std::vector<std::string> these;
    ReadLimits limits;
    limits.leave_out_damaged = true;
    Document document = read_document(root, source, where, these, limits, progress);
    if (is_empty(document)) return std::nullopt;
    warnings.insert(warnings.end(), these.begin(), these.end());
    return document;
  } catch (const Error&) {
    return std::nullopt;
  }
}

struct FoundNode {
  ChunkHash hash;
  Node node;
};

std::optional<Node> node_of(CarvedChunks& chunks, const ChunkHash& hash) {
  const auto packed = chunks.find(hash);
  if (!packed || packed->size() > kLargestNode) return std::nullopt;
  const auto chunk = unpack(*packed, hash);
  return chunk ? to_node(*chunk) : std::nullopt;
}

// The root node of a document, in the layout of core/project/document_writer.cpp.
struct Root {
  std::map<PartKind, ChunkHash> single;
  std::map<PartKind, std::vector<ChunkHash>> lists;

  std::string chunk() const {
    Node node;
    ByteWriter out;
    out.put(kDocumentLayout);
    const auto part = [&](PartKind kind) {
      const auto at = single.find(kind);
      out.flag(at != single.end());
      if (at != single.end()) node.nodes.push_back(at->second);
    };
    const auto list = [&](PartKind kind) {
      const auto at = lists.find(kind);
      out.count(at == lists.end() ? 0 : at->second.size());
      if (at != lists.end()) node.nodes.insert(node.nodes.end(), at->second.begin(), at->second.end());
    };
    for (const PartKind kind : {PartKind::Volume, PartKind::Tissues, PartKind::VolumeType, PartKind::Armature,
                                PartKind::Weights, PartKind::Pose, PartKind::Visibility})
      part(kind);
    list(PartKind::Result);
    list(PartKind::Clip);
    out.put(std::int32_t{0});  // the index of the shown clip; the next value is its frame
    out.put(std::int32_t{0});
    list(PartKind::NamedPose);
    for (const PartKind kind : {PartKind::Anchors, PartKind::WeightLocks, PartKind::WeightLayers, PartKind::Seams,
                                PartKind::BoneMap, PartKind::Measurements})
      part(kind);
    node.bytes = out.take();
    return to_chunk(node);
  }
};

// A chunk source that offers the carved chunks and one assembled root node.
class WithRoot final : public ChunkSource {
 public:
  WithRoot(ChunkSource& chunks, const Root& root)
      : chunks_(chunks),
        chunk_(root.chunk()),
        hash_(hash_of(chunk_)),
        packed_(pack(chunk_, Packing::Quick)) {}
  const ChunkHash& root() const { return hash_; }
  std::optional<std::string> find(const ChunkHash& hash) override {
    return hash == hash_ ? std::optional(packed_) : chunks_.find(hash);
  }

 private:
  ChunkSource& chunks_;
  std::string chunk_;
  ChunkHash hash_;
  std::string packed_;
};

// Returns whether the document contains a part of this kind.
bool has(const Document& document, PartKind kind) {
  switch (kind) {
    case PartKind::Volume: return document.volume != nullptr;
    case PartKind::Tissues: return document.tissues != nullptr;
    case PartKind::VolumeType: return document.volume_type != nullptr;
    case PartKind::Armature: return document.armature != nullptr;
    case PartKind::Weights: return document.weights != nullptr;
    case PartKind::Pose: return document.pose != nullptr;
    case PartKind::Visibility: return document.visibility != nullptr;
    case PartKind::Result: return !document.results.empty();
    case PartKind::Clip: return !document.clips.empty();
    case PartKind::NamedPose: return !document.poses.empty();
    case PartKind::Anchors: return document.anchors != nullptr;
    case PartKind::WeightLocks: return document.locks != nullptr;
    case PartKind::WeightLayers: return document.layers != nullptr;
    case PartKind::Seams: return document.seams != nullptr;
    case PartKind::BoneMap: return document.bone_map != nullptr;
    case PartKind::Measurements: return document.measurements != nullptr;
    default: return false;
  }
}

class Assembly {
 public:
  Assembly(CarvedChunks& chunks, const std::string& where, Progress& progress)
      : chunks_(chunks),
        where_(where),
        progress_(progress) {
    find_nodes();
  }

  std::optional<Document> document(std::vector<std::string>& warnings) {
    for (const PartKind kind :
         {PartKind::Volume, PartKind::Tissues, PartKind::VolumeType, PartKind::Armature, PartKind::Weights,
          PartKind::Pose, PartKind::Visibility, PartKind::Anchors, PartKind::WeightLocks, PartKind::WeightLayers,
          PartKind::Seams, PartKind::BoneMap, PartKind::Measurements})
      choose_one(kind);
    for (const PartKind kind : {PartKind::Result, PartKind::Clip, PartKind::NamedPose}) choose_all(kind);
    WithRoot source(chunks_, root_);
    return try_root(source.root(), source, where_, warnings, progress_);
  }

 private:
  // Collects the nodes of each kind of document part, latest first. The posed volumes of results and the weights of
  // weight layers go last, so that the document's own volume and weights are tried before them.
  void find_nodes() {
    std::vector<std::pair<PartKind, ChunkHash>> owned;
    for (const ChunkHash& hash : chunks_.latest_first()) {
      progress_.update("recover", 1);
      auto node = node_of(chunks_, hash);
      if (!node || node->bytes.empty()) continue;
      const auto kind = static_cast<PartKind>(node->bytes[0]);
      const bool has_posed_volume = kind == PartKind::Result && node->bytes.size() > 1 && node->bytes[1] == 1;
      if (has_posed_volume && !node->nodes.empty()) owned.emplace_back(PartKind::Volume, node->nodes[0]);
      const bool has_weights = kind == PartKind::WeightLayer || kind == PartKind::WeightLayers;
      if (has_weights && !node->nodes.empty()) owned.emplace_back(PartKind::Weights, node->nodes[0]);
      nodes_[kind].push_back({hash, std::move(*node)});
    }
    for (const auto& [kind, hash] : owned) {
      auto& of_kind = nodes_[kind];
      std::stable_partition(of_kind.begin(), of_kind.end(), [&](const FoundNode& one) { return one.hash != hash; });
    }
  }

  void choose_one(PartKind kind) {
    auto& candidates = nodes_[kind];
    for (std::size_t i = 0; i < std::min<std::size_t>(candidates.size(), kMostCandidates); ++i) {
      Root trial = needed_by(kind);
      trial.single[kind] = candidates[i].hash;
      if (!reads(trial, kind)) continue;
      root_.single[kind] = candidates[i].hash;
      return;
    }
  }
  void choose_all(PartKind kind) {
    auto& candidates = nodes_[kind];
    for (auto one = candidates.rbegin(); one != candidates.rend(); ++one) {
      Root trial;
      trial.lists[kind] = {one->hash};
      if (reads(trial, kind)) root_.lists[kind].push_back(one->hash);
    }
  }

  // Returns a root node with the other parts that the reader needs to check a part of this kind. For example, weights
  // can be checked only with their volume.
  Root needed_by(PartKind kind) const {
    Root root;
    const auto take = [&](PartKind part) {
      if (const auto at = root_.single.find(part); at != root_.single.end()) root.single[part] = at->second;
    };
    if (kind == PartKind::Weights || kind == PartKind::WeightLayers || kind == PartKind::Seams) take(PartKind::Volume);
    if (kind == PartKind::WeightLayers) take(PartKind::Weights);
    if (kind == PartKind::Pose) take(PartKind::Armature);
    return root;
  }
  bool reads(const Root& root, PartKind kind) {
    WithRoot source(chunks_, root);
    std::vector<std::string> ignored;
    const auto document = try_root(source.root(), source, where_, ignored, progress_);
    return document && has(*document, kind);
  }

  CarvedChunks& chunks_;
  const std::string& where_;
  Progress& progress_;
  std::map<PartKind, std::vector<FoundNode>> nodes_;
  Root root_;
};

}  // namespace

Project put_together(CarvedChunks& chunks, const std::string& where, Progress& progress) {
  Project project;
  project.editor = chunks.state("editor").value_or("");
  project.thumbnail = chunks.state("thumbnail").value_or("");
  ChunkHash last;
  const auto told = chunks.state("root");
  if (told && told->size() == last.bytes.size()) {
    std::memcpy(last.bytes.data(), told->data(), told->size());
    if (auto document = try_root(last, chunks, where, project.warnings, progress)) {
      project.document = std::move(*document);
      return project;
    }
  }
  int tried = 0;
  for (const ChunkHash& hash : chunks.latest_first()) {
    const auto node = node_of(chunks, hash);
    if (!node || !node->leaves.empty() || node->nodes.empty() || node->bytes.size() < sizeof(std::uint32_t)) continue;
    if (++tried > kMostRoots) break;
    std::vector<std::string> warnings{"the contents of the last save are lost; the latest readable save is recovered"};
    if (!told) warnings[0] = "it is unknown which save was the last; the latest readable save is recovered";
    if (auto document = try_root(hash, chunks, where, warnings, progress)) {
      project.document = std::move(*document);
      project.warnings = std::move(warnings);
      return project;
    }
  }
  std::vector<std::string> warnings{
      "the list of the project's parts is lost; the latest part of each kind is recovered"};
  if (auto document = Assembly(chunks, where, progress).document(warnings)) {
    project.document = std::move(*document);
    project.warnings = std::move(warnings);
    return project;
  }
  project.warnings = {
      "no part of the project is complete; its undamaged chunks stay in the new file until the next save"};
  return project;
}

}  // namespace limber
