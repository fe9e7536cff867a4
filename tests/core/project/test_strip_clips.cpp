// SPDX-License-Identifier: AGPL-3.0-or-later
// Tests how documents and projects store strips, and how strips follow changes of the clips that they play.
#include "core/project/strip_clips.h"

#include <limits>
#include <random>
#include <unordered_map>

#include <doctest/doctest.h>

#include "core/base/bytes.h"
#include "core/base/error.h"
#include "core/motion/strip_edits.h"
#include "core/project/bone_names.h"
#include "core/project/document_codec.h"
#include "core/project/document_layout.h"
#include "core/project/history.h"
#include "core/project/strips_codec.h"
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

// Returns a strip none of whose values is the default.
Strip odd_strip(const std::shared_ptr<const Clip>& clip, const std::string& name, int start) {
  Strip strip{.name = name, .clip = clip, .start = start, .first = -3, .last = 40, .skip = 1.25, .speed = 0.3};
  strip.repeat = 2.5;
  strip.reversed = strip.mirrored = strip.muted = true;
  strip.goes_on = strip.holds = false;
  strip.blend = StripBlend::AddChange;
  strip.influence = 0.125;
  strip.blend_in = 7;
  strip.blend_out = 9;
  strip.bones = std::set<std::string>{"Lower", "no bone \xff"};
  strip.place = {-0.75, {1, -2, 1e-9}, {3, 4, -0.0}};
  return strip;
}

// Returns a document with two clips, and with a third clip that plays the two as strips.
Document with_strips() {
  Document document = small_document();
  Strips strips;
  strips.tracks.push_back({.name = "Low", .solo = true});
  insert_strip(strips.tracks[0], strip_of(document.clips[1], strips, 5));
  insert_strip(strips.tracks[0], odd_strip(document.clips[0], "odd", -20));
  strips.tracks.push_back({.name = "High \xfe", .muted = true});
  insert_strip(strips.tracks[1], odd_strip(document.clips[1], "other", 90));
  Clip clip{.name = "Strips", .rate = 25};
  clip.strips = std::make_shared<const Strips>(strips);
  document.clips.push_back(std::make_shared<const Clip>(clip));
  document.clip = 2;
  return document;
}
const Strips& strips_of(const Document& document, std::size_t clip = 2) { return *document.clips[clip]->strips; }

Document back_from(Chunks& chunks, const ChunkHash& root) {
  std::vector<std::string> warnings;
  Document back = read_document(root, chunks, "strips.limber", warnings);
  CHECK(warnings.empty());
  return back;
}

}  // namespace

TEST_CASE("project: strips are written and read back, and play the document's own clips") {
  const Document now = with_strips();
  Chunks chunks;
  DocumentWriter writer;
  const Document back = back_from(chunks, writer.write(now, chunks, Packing::Quick));
  REQUIRE(back.clips.size() == 3);
  Strips expected = strips_of(now);
  for (StripTrack& track : expected.tracks)
    for (Strip& strip : track.strips) strip.clip = back.clips[strip.clip == now.clips[0] ? 0 : 1];
  CHECK(strips_of(back) == expected);
  // If another writer writes the document again, its root chunk has the same hash.
  Chunks others;
  DocumentWriter other;
  CHECK(other.write(back, others, Packing::Quick) == writer.write(now, chunks, Packing::Quick));
}

TEST_CASE("project: a document of the twelfth layout opens, without strips, and a newer one is refused") {
  const Document now = small_document();
  Chunks chunks;
  DocumentWriter writer;
  Node node = chunks.node(writer.write(now, chunks, Packing::Quick));
  CHECK(node.bytes[0] == static_cast<char>(kDocumentLayout));
  node.bytes[0] = 12;
  CHECK(same_contents(back_from(chunks, chunks.add(node)), now));
  node.bytes[0] = static_cast<char>(kDocumentLayout + 1);
  std::vector<std::string> warnings;
  CHECK_THROWS_AS(read_document(chunks.add(node), chunks, "new.limber", warnings), Error);
}

TEST_CASE("project: strips of a clip that has strips itself are refused") {
  Document now = with_strips();
  Strips outer;
  outer.tracks.push_back({.name = "Outer", .strips = {strip_of(now.clips[2], {}, 0)}});
  Clip clip{.name = "Outer"};
  clip.strips = std::make_shared<const Strips>(outer);
  now.clips = {std::make_shared<const Clip>(clip)};
  now.clip = 0;
  Chunks chunks;
  DocumentWriter writer;
  const ChunkHash root = writer.write(now, chunks, Packing::Quick);
  std::vector<std::string> warnings;
  CHECK_THROWS_AS(read_document(root, chunks, "bad.limber", warnings), Error);
  const Document saved = read_document(root, chunks, "bad.limber", warnings, {.leave_out_damaged = true});
  CHECK(saved.clips.empty());
  CHECK(saved.armature);
}

TEST_CASE("project: strips that are damaged are refused, whatever is wrong with them") {
  const Document document = with_strips();
  const auto clips = clips_of(strips_of(document));
  const auto read = [&](const std::string& bytes) {
    ByteReader in(bytes, [] { throw Error("damaged", "here", ""); });
    const Strips strips = get_strips(in, clips);
    in.end();
    return strips;
  };
  ByteWriter out;
  put_strips(out, strips_of(document), clips);
  const std::string whole = out.take();
  CHECK(read(whole) == strips_of(document));
  for (std::size_t cut = 0; cut < whole.size(); ++cut) CHECK_THROWS_AS(read(whole.substr(0, cut)), Error);
  std::mt19937 random(7);
  int refused = 0;
  for (int i = 0; i < 3000; ++i) {
    std::string bytes = whole;
    for (int changes = 1 + static_cast<int>(random() % 3); changes > 0; --changes)
      bytes[random() % bytes.size()] = static_cast<char>(random());
    try {
      for (const StripTrack& track : read(bytes).tracks)
        for (const Strip& strip : track.strips) {
          CHECK(strip.first <= strip.last);
          CHECK(strip.influence <= 1);
          CHECK(end_of(strip, 25) >= strip.start);
        }
    } catch (const Error&) {
      ++refused;
    }
  }
  CHECK(refused > 500);
}

TEST_CASE("project: a strip that begins behind its end is refused as damaged") {
  const auto clip = small_document().clips[1];
  Strips strips;
  strips.tracks.push_back({.name = "Track", .strips = {strip_of(clip, {}, 0)}});
  Strip& strip = strips.tracks[0].strips[0];
  strip.first = 0;
  strip.last = 10;
  strip.repeat = 3;
  const auto read_back = [&](double skip) {
    strip.skip = skip;
    ByteWriter out;
    put_strips(out, strips, {clip});
    const std::string bytes = out.take();
    ByteReader in(bytes, [] { throw Error("damaged", "here", ""); });
    return get_strips(in, {clip});
  };
  for (const double skip : {0.0, 12.5, 30.0}) CHECK(read_back(skip).tracks[0].strips[0].skip == skip);
  for (const double skip :
       {-1e-3, 30.1, 1e13, 1e300, std::numeric_limits<double>::infinity(), std::numeric_limits<double>::quiet_NaN()})
    CHECK_THROWS_AS(read_back(skip), Error);
}

TEST_CASE("project: strips play a clip as it was edited, follow its new name, and go with it") {
  const Document before = with_strips();
  Document next = before;
  const auto edit = [&](std::size_t index, const std::function<void(Clip&)>& change) {
    Clip clip = *next.clips[index];
    change(clip);
    next.clips[index] = std::make_shared<const Clip>(clip);
  };
  edit(1, [](Clip& clip) { clip.range_end = 77; });
  relink_strips(before, next);
  CHECK(strips_of(next).tracks[0].strips[1].clip == next.clips[1]);
  CHECK(strips_of(next).tracks[1].strips[0].clip == next.clips[1]);
  CHECK(strips_of(next).tracks[0].strips[0].clip == before.clips[0]);
  // The strip's other values have not changed.
  CHECK(strips_of(next).tracks[0].strips[1].start == 5);

  const Document edited = next;
  edit(1, [](Clip& clip) { clip.name = "another name"; });
  relink_strips(edited, next);
  CHECK(strips_of(next).tracks[1].strips[0].clip == next.clips[1]);

  const Document renamed = next;
  next.clips.erase(next.clips.begin() + 1);
  relink_strips(renamed, next);
  REQUIRE(strips_of(next, 1).tracks[0].strips.size() == 1);
  CHECK(strips_of(next, 1).tracks[0].strips[0].name == "odd");
  CHECK(strips_of(next, 1).tracks[1].strips.empty());
  // In a document whose clips have not changed, nothing is replaced.
  Document same = next;
  relink_strips(next, same);
  CHECK(same == next);
}

TEST_CASE("project: the bones of a strip follow the rig's names") {
  Document document = with_strips();
  const Armature before = *document.armature;
  Armature after = before;
  const auto lower = before.find("Lower");
  REQUIRE(lower);
  after.bones[*lower].name = "Shank";
  follow_names(document, before, after);
  const std::set<std::string> bones = *strips_of(document).tracks[0].strips[0].bones;
  CHECK(bones.contains("Shank"));
  CHECK(!bones.contains("Lower"));
}

TEST_CASE("history: clips that strips play count once, and strips with them") {
  const Document document = with_strips();
  Document without = document;
  without.clips.resize(2);
  without.clip = 0;
  const std::int64_t strips = bytes_of(document) - bytes_of(without);
  CHECK(strips > static_cast<std::int64_t>(3 * sizeof(Strip)));
  CHECK(strips < 10'000);
  Document alone = document;
  alone.clips = {document.clips[2]};
  alone.clip = 0;
  // The document `alone` does not list the first two clips, but its strips still hold them, so it needs about the same
  // memory.
  CHECK(bytes_of(document) - bytes_of(alone) < 200);
}

}  // namespace limber::test
