// SPDX-License-Identifier: AGPL-3.0-or-later
// Tests that projects of earlier versions open.
#include <cmath>
#include <random>
#include <unordered_map>

#include <doctest/doctest.h>

#include "core/base/bytes.h"
#include "core/base/error.h"
#include "core/motion/constraint.h"
#include "core/motion/key_curve.h"
#include "core/project/document_codec.h"
#include "core/project/document_layout.h"
#include "core/project/seams_codec.h"
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

namespace {

// Removes the parts of the document and of its results that layout 8 does not have.
void drop_parts_after_8(Document& document) {
  document.measurements = nullptr;
  document.seams = nullptr;
  document.bone_map = nullptr;
  for (auto& result : document.results) {
    Result without = *result;
    without.from_seams = nullptr;
    without.from_bone_map = nullptr;
    result = std::make_shared<const Result>(without);
  }
}

}  // namespace

TEST_CASE("project: a document of the first layout opens, its motion as a clip") {
  Document now;
  now.armature = small_document().armature;
  now.clips = {small_document().clips[0]};
  Chunks chunks;
  DocumentWriter writer;
  const Node root = chunks.node(writer.write(now, chunks, Packing::Quick));
  REQUIRE(root.nodes.size() == 2);

  // Layout 1 has a flag for each of volume, tissues, volume type, armature, weights, pose, motion and visibility, then
  // the number of results.
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
  drop_parts_after_8(now);
  Chunks chunks;
  DocumentWriter writer;
  Node node = chunks.node(writer.write(now, chunks, Packing::Quick));
  // A document of layout 2 lacks at its end: the number of poses (4 bytes), and the flags of anchors, locks, layers,
  // seams, bone map and measurements (1 byte each). Otherwise it has the bytes of the newest layout.
  node.bytes.resize(node.bytes.size() - sizeof(std::uint32_t) - 6);
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
  drop_parts_after_8(now);
  Chunks chunks;
  DocumentWriter writer;
  Node node = chunks.node(writer.write(now, chunks, Packing::Quick));
  node.bytes.resize(node.bytes.size() - 6);
  node.bytes[0] = 3;
  std::vector<std::string> warnings;
  CHECK(same_contents(read_document(chunks.add(node), chunks, "old.limber", warnings), now));
  CHECK(warnings.empty());
}

TEST_CASE("project: a document of the fifth layout opens, without locks of weights") {
  Document now = small_document();
  now.locks = nullptr;
  now.layers = nullptr;
  drop_parts_after_8(now);
  Chunks chunks;
  DocumentWriter writer;
  Node node = chunks.node(writer.write(now, chunks, Packing::Quick));
  node.bytes.resize(node.bytes.size() - 5);
  node.bytes[0] = 5;
  std::vector<std::string> warnings;
  CHECK(same_contents(read_document(chunks.add(node), chunks, "old.limber", warnings), now));
  CHECK(warnings.empty());
}

TEST_CASE("project: a document of the sixth layout opens, without layers of weights") {
  Document now = small_document();
  now.layers = nullptr;
  drop_parts_after_8(now);
  Chunks chunks;
  DocumentWriter writer;
  Node node = chunks.node(writer.write(now, chunks, Packing::Quick));
  node.bytes.resize(node.bytes.size() - 4);
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

TEST_CASE("project: a document of the eighth layout opens, without seams and bone map") {
  Document now = small_document();
  drop_parts_after_8(now);
  Chunks chunks;
  DocumentWriter writer;
  Node node = chunks.node(writer.write(now, chunks, Packing::Quick));
  node.bytes.resize(node.bytes.size() - 3);
  node.bytes[0] = 8;
  std::vector<std::string> warnings;
  CHECK(same_contents(read_document(chunks.add(node), chunks, "old.limber", warnings), now));
  CHECK(warnings.empty());
}

TEST_CASE("project: a document of the ninth layout opens, without measurements") {
  Document now = small_document();
  now.measurements = nullptr;
  Chunks chunks;
  DocumentWriter writer;
  Node node = chunks.node(writer.write(now, chunks, Packing::Quick));
  node.bytes.resize(node.bytes.size() - 1);
  node.bytes[0] = 9;
  std::vector<std::string> warnings;
  CHECK(same_contents(read_document(chunks.add(node), chunks, "old.limber", warnings), now));
  CHECK(warnings.empty());
}

TEST_CASE("project: a document of the tenth layout opens, its keys without shapes") {
  Document now = small_document();
  for (auto& clip : now.clips) {
    Clip plain = *clip;
    plain.keys.shapes.clear();
    plain.keys.root_shapes.clear();
    clip = std::make_shared<const Clip>(plain);
  }
  REQUIRE(!now.clips[0]->keys.empty());
  Chunks chunks;
  DocumentWriter writer;
  Node node = chunks.node(writer.write(now, chunks, Packing::Quick));
  node.bytes[0] = 10;
  std::vector<std::string> warnings;
  CHECK(same_contents(read_document(chunks.add(node), chunks, "old.limber", warnings), now));
  CHECK(warnings.empty());
}

TEST_CASE("project: a document of the eleventh layout opens, its clips without constraints") {
  Document now = small_document();
  REQUIRE(now.clips[0]->constraints);
  for (auto& clip : now.clips) {
    Clip plain = *clip;
    plain.constraints = nullptr;
    plain.keys.weights.clear();
    plain.keys.weight_shapes.clear();
    clip = std::make_shared<const Clip>(plain);
  }
  Chunks chunks;
  DocumentWriter writer;
  Node node = chunks.node(writer.write(now, chunks, Packing::Quick));
  node.bytes[0] = 11;
  std::vector<std::string> warnings;
  CHECK(same_contents(read_document(chunks.add(node), chunks, "old.limber", warnings), now));
  CHECK(warnings.empty());
}

TEST_CASE("project: wrong constraints are refused, far ones brought near, and weights of none left out") {
  Document now;
  Clip clip{.name = "keys"};
  Constraint aim{.name = "Aim", .kind = ConstraintKind::Aim, .weight = 7, .bone = "Arm", .place{1e300, -5, 0}};
  clip.constraints = std::make_shared<const Constraints>(Constraints{{aim}});
  clip.keys.weights["Aim"] = {{3, -0.5}};
  clip.keys.weights["Gone"] = {{4, 1}};
  const auto read = [](const Clip& written) {
    Document document;
    document.clips = {std::make_shared<const Clip>(written)};
    Chunks chunks;
    DocumentWriter writer;
    std::vector<std::string> warnings;
    const ChunkHash root = writer.write(document, chunks, Packing::Quick);
    return *read_document(root, chunks, "new.limber", warnings).clips[0];
  };
  const Clip back = read(clip);
  aim.weight = 1;
  aim.place.x = 1e7;
  CHECK(back.constraints->list == std::vector<Constraint>{aim});
  CHECK(back.keys.weights == std::map<std::string, std::map<int, double>>{{"Aim", {{3, 0}}}});
  // Tests a single constraint with empty names, the shortest possible.
  const Constraints shortest{{Constraint{}}};
  CHECK(*read({.name = "c", .constraints = std::make_shared<const Constraints>(shortest)}).constraints == shortest);
  const auto refused = [&](const auto& change) {
    Constraint wrong = aim;
    change(wrong);
    Clip with = clip;
    with.constraints = std::make_shared<const Constraints>(Constraints{{wrong, {.name = "Other", .bone = "Arm"}}});
    CHECK_THROWS_AS(read(with), Error);
  };
  refused([](Constraint& c) { c.place.y = NAN; });
  refused([](Constraint& c) { c.weight = INFINITY; });
  refused([](Constraint& c) { c.rotation = {0, 0, 0, 0}; });
  refused([](Constraint& c) { c.chain = -1; });
  refused([](Constraint& c) { c.kind = static_cast<ConstraintKind>(6); });
  refused([](Constraint& c) { c.name = "Other"; });
}

TEST_CASE("project: shapes of keys that do not exist are left out, and what is too far is brought near") {
  Document now;
  Clip clip{.name = "keys"};
  clip.keys.bones["Arm"] = {{3, {1, 0, 0, 0}}, {9, {0, 1, 0, 0}}};
  clip.keys.root = {{0, {1e17, 5, 0}}};
  clip.keys.shapes["Arm"][3] = {Interpolation::Bezier, HandleKind::Free, {0, -1e308, 1}, {1e308, 0, 2}};
  Clip stray = clip;
  stray.keys.shapes["Arm"][4] = {.next = Interpolation::Bezier};
  stray.keys.shapes["Leg"][3] = {.next = Interpolation::Bezier};
  now.clips = {std::make_shared<const Clip>(stray)};
  Chunks chunks;
  DocumentWriter writer;
  std::vector<std::string> warnings;
  const Document back = read_document(writer.write(now, chunks, Packing::Quick), chunks, "new.limber", warnings);
  clip.keys.root[0].x = 1e7;
  clip.keys.shapes["Arm"][3] = {Interpolation::Bezier, HandleKind::Free, {0, -1e6, 1}, {1e6, 0, 2}};
  CHECK(back.clips[0]->keys == clip.keys);
  for (int frame = 0; frame <= 12; ++frame) {
    const glm::dquat q = value_at(back.clips[0]->keys.bones.at("Arm"), back.clips[0]->keys.shapes.at("Arm"), frame);
    CHECK(std::abs(glm::length(q) - 1) < 1e-9);
  }
}

TEST_CASE("project: keys and tangents that are no numbers are refused") {
  for (const int wrong : {0, 1, 2}) {
    Document now;
    Clip clip{.name = "keys"};
    clip.keys.bones["Arm"] = {{3, {1, 0, 0, 0}}};
    if (wrong == 0) clip.keys.bones["Arm"][3].x = NAN;
    if (wrong == 1) clip.keys.root[3] = {0, INFINITY, 0};
    if (wrong == 2) clip.keys.shapes["Arm"][3] = {.next = Interpolation::Bezier, .out = {NAN, 0, 0}};
    now.clips = {std::make_shared<const Clip>(clip)};
    Chunks chunks;
    DocumentWriter writer;
    const ChunkHash root = writer.write(now, chunks, Packing::Quick);
    std::vector<std::string> warnings;
    CHECK_THROWS_AS(read_document(root, chunks, "new.limber", warnings), Error);
  }
}

TEST_CASE("project: measurements with too few points, or points that are no numbers, are refused") {
  for (const Measurement& wrong :
       {Measurement{"A", MeasureKind::Angle, {{0, 0, 0}, {1, 0, 0}}}, Measurement{"G", MeasureKind::Girth, {{0, 0, 0}}},
        Measurement{"D", MeasureKind::Distance, {{0, 0, 0}, {1, NAN, 0}}}}) {
    Document now;
    now.measurements = std::make_shared<const Measurements>(Measurements{wrong});
    Chunks chunks;
    DocumentWriter writer;
    const ChunkHash root = writer.write(now, chunks, Packing::Quick);
    std::vector<std::string> warnings;
    CHECK_THROWS_AS(read_document(root, chunks, "new.limber", warnings), Error);
  }
}

TEST_CASE("project: seams of another volume, or beside air, are left out and said so") {
  for (const bool other_grid : {false, true}) {
    Document now = small_document();
    REQUIRE(now.seams);
    Seams wrong(other_grid ? now.volume->grid.size + 1 : now.volume->grid.size);
    wrong.cut({0, 4, 4}, 0);  // this face lies beside air
    now.seams = std::make_shared<const Seams>(wrong);
    Chunks chunks;
    DocumentWriter writer;
    std::vector<std::string> warnings;
    const Document back = read_document(writer.write(now, chunks, Packing::Quick), chunks, "new.limber", warnings);
    CHECK(!back.seams);
    CHECK(*back.bone_map == *now.bone_map);
    CHECK(warnings == std::vector<std::string>{"the seams do not belong to the volume and were left out"});
  }
}

TEST_CASE("project: seams that are damaged are refused, whatever is wrong with them") {
  const auto read = [](const std::string& bytes) {
    ByteReader in(bytes, [] { throw Error("damaged", "here", ""); });
    const Seams seams = get_seams(in, [](std::int64_t needed) {
      if (needed > 1 << 20) throw Error("too large", "here", "");
    });
    in.end();
    return seams;
  };
  const Seams seams = *small_document().seams;
  ByteWriter out;
  put(out, seams);
  const std::string whole = out.take();
  CHECK(read(whole) == seams);
  std::mt19937 random(3);
  for (std::size_t cut = 0; cut < whole.size(); ++cut) CHECK_THROWS_AS(read(whole.substr(0, cut)), Error);
  for (int i = 0; i < 3000; ++i) {
    std::string bytes = whole;
    for (int changes = 1 + static_cast<int>(random() % 3); changes > 0; --changes)
      bytes[random() % bytes.size()] = static_cast<char>(random());
    try {
      const Seams changed = read(bytes);
      ByteWriter again;
      put(again, changed);
      CHECK(again.take() == bytes);
    } catch (const Error&) {
    }
  }
}

}  // namespace limber::test
