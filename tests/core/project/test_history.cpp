// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/project/history.h"

#include <doctest/doctest.h>

#include "tests/support/documents.h"

using namespace limber;
using namespace limber::test;

namespace {
Document with_pose(Document document, double x) {
  Pose pose = *document.pose;
  pose.root_translation.x = x;
  document.pose = std::make_shared<const Pose>(std::move(pose));
  return document;
}
}  // namespace

TEST_CASE(
    "history: after 1000 random edits, undoing all gives the first document bit for bit and redoing all the last") {
  std::mt19937 random(1);
  const Document first = small_document();
  History history(first);
  Document last = first;
  for (int i = 0; i < 1000; ++i) {
    last = random_edit(last, random);
    CHECK(history.commit("edit", last));
  }
  const Document untouched = small_document();
  while (history.undo()) {
  }
  CHECK(history.position() == 0);
  CHECK(history.current() == first);
  CHECK(same_contents(history.current(), untouched));
  while (history.redo()) {
  }
  CHECK(history.position() == 1000);
  CHECK(history.current() == last);
  CHECK(history.dropped() == 0);
  CHECK(history.note().empty());
}

TEST_CASE("history: an equal document is no edit, a new edit cuts what could be redone, and a jump goes anywhere") {
  const Document first = small_document();
  History history(first, "Open");
  CHECK_FALSE(history.commit("nothing", first));
  history.commit("a", with_pose(first, 1));
  history.commit("b", with_pose(first, 2));
  history.jump(0);
  CHECK(history.current() == first);
  history.jump(2);
  CHECK(history.current().pose->root_translation.x == 2);
  CHECK(history.undo());
  CHECK(history.commit("c", with_pose(first, 3)));
  CHECK_FALSE(history.can_redo());
  REQUIRE(history.steps().size() == 3);
  CHECK(history.steps()[0].label == "Open");
  CHECK(history.steps()[2].label == "c");
}

TEST_CASE("history: what is saved follows the state, not the count of edits") {
  const Document first = small_document();
  History history(first);
  CHECK_FALSE(history.unsaved());
  history.commit("a", with_pose(first, 1));
  CHECK(history.unsaved());
  history.mark_saved(history.revision());
  history.commit("b", with_pose(first, 2));
  CHECK(history.unsaved());
  history.undo();
  CHECK_FALSE(history.unsaved());
  history.undo();
  CHECK(history.unsaved());
  history.commit("c", with_pose(first, 3));  // a new state at the saved state's position
  CHECK(history.unsaved());
  history.redo();
  CHECK(history.unsaved());
}

TEST_CASE("history: parts that steps share are counted once, weights by brick") {
  const Document first = large_document(1);
  History history(first);
  const std::int64_t alone = history.bytes();
  std::int64_t packed = 0;
  for (std::int64_t b = 0; b < first.weights->chunk_count(); ++b) packed += first.weights->chunk(b).heap_bytes();
  CHECK(packed > 64 * 32 * 32);
  CHECK(alone >= 64 * 32 * 32 * 2 + packed);
  CHECK(bytes_of(first) == alone);

  Document stroke = first;
  SkinWeights weights = *first.weights;
  SkinWeights::Influences chunk = weights.chunk(3);
  chunk[5] = rigid_influence(0);
  weights.set_chunk(3, std::move(chunk));
  stroke.weights = std::make_shared<const SkinWeights>(std::move(weights));
  history.commit("stroke", stroke);
  const std::int64_t own = stroke.weights->chunk(3).heap_bytes();
  CHECK(own > 512);
  CHECK(history.bytes() - alone > own);
  CHECK(history.bytes() - alone < own + 8192);

  history.undo();
  Document named = first;
  named.tissues = std::make_shared<const TissueTable>();
  history.commit("names", named);  // drops the step of the stroke, and thereby the brick that it stored
  CHECK(history.bytes() - alone < 2048);
}

TEST_CASE("history: over the limit the oldest states go, the memory stays under it and a note says so") {
  constexpr std::int64_t kLimit = std::int64_t{16} << 20;
  History history(large_document(0), "Open", kLimit);
  std::mt19937 random(3);
  for (int i = 1; i <= 1000; ++i) {
    // Most edits are small changes of one volume; every tenth replaces all weights.
    if (i % 10 == 0) {
      Document next = history.current();
      next.weights = large_document(static_cast<std::uint32_t>(i)).weights;
      history.commit("weights", next);
    } else {
      Document next = history.current();
      Visibility looks;
      looks.looks[static_cast<Label>(random() % 100)].opacity = 0.5f;
      next.visibility = std::make_shared<const Visibility>(looks);
      history.commit("look", next);
    }
    CHECK(history.bytes() <= kLimit);
  }
  CHECK(history.dropped() > 0);
  CHECK(history.dropped() + std::ssize(history.steps()) == 1001);
  CHECK(history.note() ==
        "The " + std::to_string(history.dropped()) + " oldest steps were dropped to keep undo within 16 MB.");
  CHECK(history.steps().size() > 300);

  // A history made of the remaining steps counts the same memory.
  History again(history.steps()[0].document, "", std::int64_t{1} << 40);
  for (std::size_t i = 1; i < history.steps().size(); ++i) again.commit("", history.steps()[i].document);
  CHECK(again.bytes() == history.bytes());
}

TEST_CASE("history: a document larger than the limit still leaves half of the limit to undo") {
  const Document first = large_document(0);  // 1.2 MB
  History history(first, "Open", std::int64_t{1} << 20);
  for (int i = 0; i < 10; ++i) {
    Document next = history.current();
    next.visibility = std::make_shared<const Visibility>();
    history.commit("look", next);
  }
  CHECK(history.steps().size() == 11);
  CHECK(history.dropped() == 0);
}

TEST_CASE("history: an amended step is one step, and memory counts it once") {
  const Document first = small_document();
  History history(first);
  history.commit("Frame 1", with_pose(first, 1));
  history.commit("Turn", with_pose(first, 2));
  history.undo();
  const std::int64_t before = history.bytes();
  for (int i = 0; i < 50; ++i) history.amend("Frame " + std::to_string(i), with_pose(first, i));
  CHECK(history.steps().size() == 2);
  CHECK_FALSE(history.can_redo());
  CHECK(history.bytes() < before);
  CHECK(history.current().pose->root_translation.x == 49);
  CHECK(history.steps()[1].label == "Frame 49");
  CHECK(history.unsaved());
  history.undo();
  CHECK(history.current() == first);
}
