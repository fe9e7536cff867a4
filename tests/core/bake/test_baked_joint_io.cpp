// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/bake/baked_joint_io.h"

#include <cmath>

#include <doctest/doctest.h>

#include "core/base/error.h"
#include "tests/support/program.h"

using namespace limber;

namespace {

// A joint with shifts at 5 of the 12 nodes of its lattice. It is baked at two angles besides the rest pose.
BakedJoint small_joint() {
  BakedJoint joint{
      .bone = "Forearm", .axis = {0, 0.6, 0.8}, .degrees = {-10, 0, 45}, .glide = "off", .quality = "draft"};
  for (int i = 0; i < 32; ++i) joint.source.volume[i] = joint.source.weights[31 - i] = std::uint8_t(i);
  joint.at_baked = {{-10, 0.1, 0.2, 0.3}, {45, 0.4, 0.5, 0.6}};
  joint.between = {{22.5, 0.7, 0.8, 0.9}};
  joint.step = {2, 2, 1};
  joint.first = {-1, 3, 4};
  joint.size = {3, 2, 2};
  joint.nodes = {0, 1, 5, 10, 11};
  joint.shifts.resize(3);
  for (int n = 0; n < 5; ++n) {
    joint.shifts[0].emplace_back(0.25f * float(n), -1.5f, 0.0f);
    joint.shifts[2].emplace_back(-8.0f, 0.125f * float(n), 30.25f);
  }
  return joint;
}

}  // namespace

TEST_CASE("baked joint file: what is written is read back, and written again gives the same bytes") {
  const BakedJoint joint = small_joint();
  const std::string bytes = encode(joint);
  const BakedJoint back = decode_baked_joint(bytes, "here");
  CHECK(back == joint);
  CHECK(encode(back) == bytes);
  const test::TemporaryFolder folder;
  write_baked_joint(joint, folder / "elbow.bake");
  CHECK(read_baked_joint(folder / "elbow.bake") == joint);
}

TEST_CASE("baked joint file: one that is cut off, longer, or of another kind is refused with its name") {
  const std::string bytes = encode(small_joint());
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    CAPTURE(size);
    CHECK_THROWS_AS(decode_baked_joint(bytes.substr(0, size), "here"), Error);
  }
  for (const std::string& other : {bytes + "x", bytes + bytes, std::string("NRRD0004\n"), std::string(1 << 16, '\0')}) {
    std::string said;
    try {
      decode_baked_joint(other, "elbow.bake");
    } catch (const Error& error) {
      said = error.what();
    }
    CHECK(said.find("elbow.bake") != std::string::npos);
    CHECK(said.find('\n') == std::string::npos);
  }
}

TEST_CASE("baked joint file: a changed byte is found") {
  const std::string bytes = encode(small_joint());
  for (std::size_t at = 0; at < bytes.size(); ++at) {
    CAPTURE(at);
    std::string changed = bytes;
    changed[at] = static_cast<char>(changed[at] ^ 0x24);
    bool is_same = false;
    try {
      is_same = decode_baked_joint(changed, "here") == small_joint();
    } catch (const Error&) {
      continue;
    }
    CHECK(is_same);  // a byte of the head may only state the compression level, so changing it changes nothing else
  }
}

TEST_CASE("baked joint file: values that contradict each other are refused") {
  const auto refused = [](auto change) {
    BakedJoint joint = small_joint();
    change(joint);
    CHECK_THROWS_AS(decode_baked_joint(encode(joint), "here"), Error);
  };
  refused([](BakedJoint& joint) { joint.axis = {0, 1, 1}; });
  refused([](BakedJoint& joint) { joint.degrees = {-10, 1, 45}; });
  refused([](BakedJoint& joint) { joint.degrees = {45, 0, -10}; });
  refused([](BakedJoint& joint) { joint.degrees[2] = NAN; });
  refused([](BakedJoint& joint) { joint.degrees[2] = 1e9; });
  refused([](BakedJoint& joint) { joint.step.y = 0; });
  refused([](BakedJoint& joint) { joint.size = {1 << 20, 1 << 20, 1 << 20}; });
  refused([](BakedJoint& joint) { joint.size = {3, 2, 1}; });
  refused([](BakedJoint& joint) { joint.nodes = {0, 0, 1, 2, 3}; });
  refused([](BakedJoint& joint) { joint.nodes = {0, 1, 2, 3, -4}; });
  refused([](BakedJoint& joint) { joint.shifts[0].pop_back(); });
  refused([](BakedJoint& joint) { joint.shifts[0][1].y = NAN; });
  refused([](BakedJoint& joint) { joint.shifts[0][1].y = 1e9f; });
  refused([](BakedJoint& joint) { joint.between[0].skin_mm = -1; });
}
