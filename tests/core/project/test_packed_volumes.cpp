// SPDX-License-Identifier: AGPL-3.0-or-later
// An undo history of many edits of labels stays within its memory, and every step comes back bit for bit.
#include "core/project/packed_volumes.h"

#include <random>

#include <doctest/doctest.h>

#include "tests/support/documents.h"

using namespace limber;
using namespace limber::test;

namespace {

constexpr std::int64_t kMb = std::int64_t{1} << 20;

// Makes a volume of random labels, 2 MB by default.
LabelVolume block(unsigned seed, const glm::ivec3& size = glm::ivec3(128, 128, 64)) {
  LabelVolume volume;
  volume.grid.size = size;
  volume.voxels.resize(static_cast<std::size_t>(volume.grid.voxel_count()));
  std::mt19937 random(seed);
  for (Label& label : volume.voxels) label = static_cast<Label>(random() % 5);
  return volume;
}

// Returns the document with other labels in a small box.
Document painted(Document document, std::mt19937& random) {
  auto volume = std::make_shared<LabelVolume>(*document.volume);
  const glm::ivec3 low(random() % 100, random() % 100, random() % 50);
  const auto label = static_cast<Label>(random() % 60);
  for (int z = 0; z < 8; ++z)
    for (int y = 0; y < 8; ++y)
      for (int x = 0; x < 8; ++x) volume->at(low + glm::ivec3(x, y, z)) = label;
  document.volume = std::move(volume);
  return document;
}

Document with_pose(Document document, double x) {
  Pose pose;
  pose.root_translation.x = x;
  document.pose = std::make_shared<const Pose>(pose);
  return document;
}

}  // namespace

TEST_CASE("packed volumes: a hundred strokes fit in the memory of a few volumes, and each comes back bit for bit") {
  std::mt19937 random(1);
  Document now;
  now.volume = std::make_shared<const LabelVolume>(block(1));
  History history(now, "Open", 12 * kMb);
  std::vector<LabelVolume> expected = {*now.volume};
  for (int i = 0; i < 100; ++i) {
    // Every third edit does not change the labels.
    now = i % 3 == 2 ? with_pose(now, i) : painted(now, random);
    CHECK(history.commit("edit", now));
    expected.push_back(*now.volume);
    CHECK(history.bytes() <= history.limit());
  }
  now = {};
  CHECK(history.dropped() == 0);
  const auto is_expected = [&] {
    return history.current().volume->grid == expected[0].grid &&
           history.current().volume->voxels == expected[static_cast<std::size_t>(history.position())].voxels;
  };
  int wrong = 0;
  while (history.undo()) wrong += !is_expected();
  CHECK(history.position() == 0);
  while (history.redo()) wrong += !is_expected();
  CHECK(history.position() == 100);
  for (int i = 0; i < 60; ++i) {
    history.jump(static_cast<std::int64_t>(random() % 101));
    wrong += !is_expected();
    CHECK(history.bytes() <= history.limit());
  }
  CHECK(wrong == 0);
}

TEST_CASE("packed volumes: new edits after undo, amended steps and other grids between keep every step") {
  for (unsigned seed = 0; seed < 6; ++seed) {
    std::mt19937 random(seed);
    Document now;
    now.volume = std::make_shared<const LabelVolume>(block(seed));
    History history(now, "Open", 14 * kMb);
    std::vector<std::pair<std::int64_t, LabelVolume>> expected = {{history.revision(), *now.volume}};
    now = {};
    int wrong = 0;
    for (int i = 0; i < 120; ++i) {
      const auto what = random() % 10;
      if (what < 3) {
        history.jump(static_cast<std::int64_t>(random() % history.steps().size()));
      } else {
        const bool amends = what == 3;
        if (what == 4) {
          Document next = history.current();
          next.volume = std::make_shared<const LabelVolume>(
              block(static_cast<unsigned>(random()),
                    history.current().volume->grid.size.z == 64 ? glm::ivec3(128, 100, 70) : glm::ivec3(128, 128, 64)));
          history.commit("other grid", next);
        } else {
          Document next = painted(history.current(), random);
          amends ? history.amend("amended", next) : void(history.commit("stroke", next));
        }
        std::erase_if(expected, [&](const auto& known) {
          return std::none_of(history.steps().begin(), history.steps().end(),
                              [&](const auto& step) { return step.revision == known.first; });
        });
        expected.emplace_back(history.revision(), *history.current().volume);
      }
      for (const auto& [revision, volume] : expected)
        if (revision == history.revision())
          wrong +=
              !(history.current().volume->grid == volume.grid && history.current().volume->voxels == volume.voxels);
    }
    for (std::int64_t step = 0; step < std::ssize(history.steps()); ++step) {
      history.jump(step);
      bool found = false;
      for (const auto& [revision, volume] : expected)
        if (revision == history.revision()) found = history.current().volume->voxels == volume.voxels;
      wrong += !found;
    }
    CHECK(wrong == 0);
  }
}

TEST_CASE("packed volumes: two long groups of strokes with a new grid between them are gone through and come back") {
  for (const std::int64_t limit : {8 * kMb, 9 * kMb, 12 * kMb}) {
    std::mt19937 random(11);
    Document now;
    now.volume = std::make_shared<const LabelVolume>(block(1));
    History history(now, "Open", limit);
    std::vector<LabelVolume> expected = {*now.volume};
    for (int i = 0; i < 30; ++i) {
      if (i == 10) now.volume = std::make_shared<const LabelVolume>(block(2, {128, 100, 70}));
      else now = painted(now, random);
      history.commit("edit", now);
      expected.push_back(*now.volume);
    }
    now = {};
    REQUIRE(history.dropped() == 0);
    const auto is_expected = [&] {
      return history.current().volume &&
             history.current().volume->voxels == expected[static_cast<std::size_t>(history.position())].voxels;
    };
    int wrong = 0;
    // Jumps from one end to the other, then steps. States on either side of the change of grid are packed relative to
    // different volumes.
    for (const std::int64_t start : {0, 30, 5, 29, 0}) {
      history.jump(start);
      wrong += !is_expected();
      while (history.redo()) wrong += !is_expected();
      history.jump(start);
      while (history.undo()) wrong += !is_expected();
    }
    for (int i = 0; i < 100; ++i) {
      history.jump(static_cast<std::int64_t>(random() % 31));
      wrong += !is_expected();
    }
    CHECK(wrong == 0);
  }
}

TEST_CASE("packed volumes: where the changes alone fill the memory, only the oldest steps are dropped") {
  std::mt19937 random(12);
  Document now;
  now.volume = std::make_shared<const LabelVolume>(block(1));
  History history(now, "Open", 6 * kMb);
  std::vector<std::pair<std::int64_t, LabelVolume>> expected;
  for (int i = 0; i < 60; ++i) {
    // Changes 2 % of the voxels, scattered, so that the record of the change is large.
    auto volume = std::make_shared<LabelVolume>(*now.volume);
    for (int k = 0; k < 20'000; ++k)
      volume->voxels[random() % volume->voxels.size()] = static_cast<Label>(random() % 9);
    now.volume = std::move(volume);
    history.commit("edit", now);
    expected.emplace_back(history.revision(), *now.volume);
  }
  now = {};
  CHECK(history.dropped() > 0);
  CHECK(history.bytes() <= history.limit() + 3 * kMb);
  CHECK(history.steps().size() >= 6);  // the latest edits can be undone
  int wrong = 0;
  for (std::int64_t step = std::ssize(history.steps()) - 1; step >= 0; --step) {
    history.jump(step);
    for (const auto& [revision, volume] : expected)
      if (revision == history.revision()) wrong += history.current().volume->voxels != volume.voxels;
  }
  CHECK(wrong == 0);
}

TEST_CASE("packed volumes: a volume that something still holds comes back as the same object") {
  std::mt19937 random(3);
  Document first;
  first.volume = std::make_shared<const LabelVolume>(block(9));
  const auto held = first.volume;  // a result holds the volume that it was made from
  History history(first, "Open", 6 * kMb);
  Document now = first;
  for (int i = 0; i < 20; ++i) history.commit("stroke", now = painted(now, random));
  CHECK_FALSE(history.steps().front().document.volume);  // the oldest state's volume is kept only in packed form
  history.jump(0);
  CHECK(history.current().volume == held);
}

TEST_CASE("packed volumes: a change of most voxels is not packed, and small volumes are left alone") {
  std::mt19937 random(4);
  Document now;
  now.volume = std::make_shared<const LabelVolume>(block(1));
  History history(now, "Open", 5 * kMb);
  for (unsigned i = 2; i < 8; ++i) {
    now.volume = std::make_shared<const LabelVolume>(block(i));
    history.commit("all new", now);
  }
  CHECK(history.dropped() > 0);
  CHECK(history.bytes() <= history.limit() + 3 * kMb);
  for (const History::Step& step : history.steps()) CHECK(step.document.volume);
}
