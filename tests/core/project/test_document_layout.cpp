// SPDX-License-Identifier: AGPL-3.0-or-later
// Projects of earlier versions.
#include <unordered_map>

#include <doctest/doctest.h>

#include "core/project/bytes.h"
#include "core/project/document_codec.h"
#include "core/project/document_layout.h"
#include "tests/support/documents.h"

namespace limber::test {

namespace {

class Chunks final : public ChunkSink, public ChunkSource {
 public:
  bool has(const ChunkHash& hash) override { return chunks_.contains(hash); }
  void put(const ChunkHash& hash, const std::string& packed) override { chunks_[hash] = packed; }
  std::optional<std::string> find(const ChunkHash& hash) override {
    const auto found = chunks_.find(hash);
    return found == chunks_.end() ? std::nullopt : std::optional(found->second);
  }
  Node node(const ChunkHash& hash) { return *to_node(*unpack(*find(hash), hash)); }
  ChunkHash add(const Node& node) {
    const std::string chunk = to_chunk(node);
    put(hash_of(chunk), pack(chunk, Packing::Quick));
    return hash_of(chunk);
  }

 private:
  std::unordered_map<ChunkHash, std::string, ChunkHash::Hasher> chunks_;
};

}  // namespace

TEST_CASE("project: a document of the first layout opens, its motion as a clip") {
  Document now;
  now.armature = small_document().armature;
  now.clips = {small_document().clips[0]};
  Chunks chunks;
  DocumentWriter writer;
  const Node root = chunks.node(writer.write(now, chunks, Packing::Quick));
  REQUIRE(root.nodes.size() == 2);

  // Layout 1: volume, tissues, volume type, armature, weights, pose, motion, visibility; then the results.
  Node old;
  old.nodes = {root.nodes[0], chunks.node(root.nodes[1]).nodes[0]};
  ByteWriter out;
  out.put(std::uint32_t{1});
  for (const bool there : {false, false, false, true, false, false, true, false}) out.flag(there);
  out.count(0);
  old.bytes = out.take();

  std::vector<std::string> warnings;
  const Document back = read_document(chunks.add(old), chunks, "old.limber", warnings);
  CHECK(warnings.empty());
  CHECK(*back.armature == *now.armature);
  REQUIRE(back.clips.size() == 1);
  CHECK(back.clips[0]->motion->values == now.clips[0]->motion->values);
  CHECK(back.clips[0]->last == now.clips[0]->motion->frame_count - 1);
  CHECK(back.clips[0]->keys.empty());
}

TEST_CASE("project: a document of the second layout opens, with an empty library of poses") {
  Document now = small_document();
  now.poses.clear();
  now.anchors = nullptr;
  now.locks = nullptr;
  now.layers = nullptr;
  Chunks chunks;
  DocumentWriter writer;
  Node node = chunks.node(writer.write(now, chunks, Packing::Quick));
  // The same, without the count of poses and the flags of anchors, locks and layers at its end.
  node.bytes.resize(node.bytes.size() - sizeof(std::uint32_t) - 3);
  node.bytes[0] = 2;
  std::vector<std::string> warnings;
  CHECK(same_contents(read_document(chunks.add(node), chunks, "old.limber", warnings), now));
  CHECK(warnings.empty());
}

TEST_CASE("project: a document of the third layout opens, without pins and poles") {
  Document now = small_document();
  now.anchors = nullptr;
  now.locks = nullptr;
  now.layers = nullptr;
  Chunks chunks;
  DocumentWriter writer;
  Node node = chunks.node(writer.write(now, chunks, Packing::Quick));
  node.bytes.resize(node.bytes.size() - 3);
  node.bytes[0] = 3;
  std::vector<std::string> warnings;
  CHECK(same_contents(read_document(chunks.add(node), chunks, "old.limber", warnings), now));
  CHECK(warnings.empty());
}

TEST_CASE("project: a document of the fifth layout opens, without locks of weights") {
  Document now = small_document();
  now.locks = nullptr;
  now.layers = nullptr;
  Chunks chunks;
  DocumentWriter writer;
  Node node = chunks.node(writer.write(now, chunks, Packing::Quick));
  node.bytes.resize(node.bytes.size() - 2);
  node.bytes[0] = 5;
  std::vector<std::string> warnings;
  CHECK(same_contents(read_document(chunks.add(node), chunks, "old.limber", warnings), now));
  CHECK(warnings.empty());
}

TEST_CASE("project: a document of the sixth layout opens, without layers of weights") {
  Document now = small_document();
  now.layers = nullptr;
  Chunks chunks;
  DocumentWriter writer;
  Node node = chunks.node(writer.write(now, chunks, Packing::Quick));
  node.bytes.pop_back();
  node.bytes[0] = 6;
  std::vector<std::string> warnings;
  CHECK(same_contents(read_document(chunks.add(node), chunks, "old.limber", warnings), now));
  CHECK(warnings.empty());
}

TEST_CASE("project: layers that belong to other weights are left out and said so, the weights stay") {
  Document now = small_document();
  REQUIRE(now.layers);
  now.weights = std::make_shared<const SkinWeights>(std::vector<std::string>{"Other"}, TissueVoxels(*now.volume));
  Chunks chunks;
  DocumentWriter writer;
  std::vector<std::string> warnings;
  const Document back = read_document(writer.write(now, chunks, Packing::Quick), chunks, "new.limber", warnings);
  CHECK(!back.layers);
  CHECK(*back.weights == *now.weights);
  CHECK(warnings == std::vector<std::string>{"the layers of weights do not belong to the weights and were left out"});
}

}  // namespace limber::test
