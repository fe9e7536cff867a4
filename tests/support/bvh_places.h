// SPDX-License-Identifier: AGPL-3.0-or-later
// Computes where the joints of a BVH file are, from the file's text alone: no reader, skeleton or rotation of the
// program is used, so what the program writes can be checked.
#pragma once

#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <numbers>
#include <string>
#include <vector>

namespace limber::test {

struct PlainPoint {
  double x = 0, y = 0, z = 0;
};
inline double distance_of(const PlainPoint& a, const PlainPoint& b) {
  return std::hypot(a.x - b.x, a.y - b.y, a.z - b.z);
}

// A joint in a frame: its position, and the columns of its rotation matrix in the file's axes.
struct PlacedJoint {
  PlainPoint place;
  std::array<std::array<double, 3>, 3> columns;

  // Returns the position of a point that is at `offset` from the joint if no joint is turned.
  PlainPoint carried(const std::array<double, 3>& offset) const {
    std::array<double, 3> sum{place.x, place.y, place.z};
    for (int c = 0; c < 3; ++c)
      for (int axis = 0; axis < 3; ++axis) sum[axis] += columns[c][axis] * offset[c];
    return {sum[0], sum[1], sum[2]};
  }
};

class BvhPlaces {
 public:
  explicit BvhPlaces(const std::filesystem::path& file) {
    std::ifstream in(file);
    std::string word;
    std::vector<int> open;
    while (in >> word && word != "MOTION") {
      if (word == "ROOT" || word == "JOINT" || word == "End") {
        Joint joint{.parent = open.empty() ? -1 : open.back()};
        in >> joint.name;
        if (word == "End") joint.name = joints_[open.back()].name + " end";
        joints_.push_back(joint);
      } else if (word == "{") {
        open.push_back(static_cast<int>(joints_.size()) - 1);
      } else if (word == "}") {
        open.pop_back();
      } else if (word == "OFFSET") {
        for (double& value : joints_[open.back()].offset) in >> value;
      } else if (word == "CHANNELS") {
        int count = 0;
        in >> count;
        joints_[open.back()].channels.resize(count);
        for (std::string& channel : joints_[open.back()].channels) in >> channel;
      }
    }
    int frames = 0;
    in >> word >> frames >> word >> word >> frame_time;
    for (int f = 0; f < frames; ++f) place_frame(in);
  }

  std::size_t frames() const { return joints_.front().placed.size(); }
  bool has(const std::string& name) const {
    for (const Joint& joint : joints_)
      if (joint.name == name) return true;
    return false;
  }
  const std::vector<PlacedJoint>& of(const std::string& name) const {
    for (const Joint& joint : joints_)
      if (joint.name == name) return joint.placed;
    throw std::runtime_error("the file has no joint " + name);
  }

  double frame_time = 0;

 private:
  struct Joint {
    int parent = -1;
    std::string name{};
    std::array<double, 3> offset{};
    std::vector<std::string> channels{};
    std::vector<PlacedJoint> placed{};
  };

  void place_frame(std::istream& in) {
    for (Joint& joint : joints_) {
      std::array<double, 3> own = joint.offset;
      PlacedJoint placed{{}, {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}}};
      if (joint.parent >= 0) placed.columns = joints_[joint.parent].placed.back().columns;
      std::vector<std::pair<int, double>> turns;
      for (const std::string& channel : joint.channels) {
        double value = 0;
        in >> value;
        const int axis = channel[0] - 'X';
        if (channel.find("position") != std::string::npos) own[axis] = value;
        else turns.emplace_back(axis, value * std::numbers::pi / 180);
      }
      placed.place =
          joint.parent >= 0 ? joints_[joint.parent].placed.back().carried(own) : PlainPoint{own[0], own[1], own[2]};
      for (const auto& [axis, angle] : turns) {
        auto &a = placed.columns[(axis + 1) % 3], &b = placed.columns[(axis + 2) % 3];
        for (int k = 0; k < 3; ++k) {
          const double old_a = a[k], old_b = b[k];
          a[k] = std::cos(angle) * old_a + std::sin(angle) * old_b;
          b[k] = std::cos(angle) * old_b - std::sin(angle) * old_a;
        }
      }
      joint.placed.push_back(placed);
    }
  }

  std::vector<Joint> joints_;
};

}  // namespace limber::test
