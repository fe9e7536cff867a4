// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/resample/bone_volumes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numeric>

#include "core/base/parallel.h"
#include "core/volume/label_sampler.h"

namespace limber {

namespace {

// Upper limit on the passes over a bone's tissues. Each pass computes the price of every tissue again. The passes end
// earlier if no price changes.
constexpr int kSweeps = 16;
// Upper limit on a tissue's price (the number added to its memberships), in either direction. A tissue that needs a
// higher price has hardly any voxels near its border, and stays a little too small.
constexpr float kMostPrice = 0.2f;
// Upper limit on the number of tissues that compete for one voxel: those with the largest memberships.
constexpr int kAsked = 3;
// Upper limit on the random number that is added to each membership. Without this number, all voxels along a flat
// border would have equal memberships and would change their tissue together, so a tissue could not gain just some of
// them.
constexpr float kDither = 1e-3f;

using Counts = std::map<Label, std::int64_t>;

// A voxel near the border of its tissue, and the tissues that may take it.
struct Contested {
  std::int64_t at;  // index of the voxel in the posed volume
  std::array<Label, kAsked> label;
  std::array<float, kAsked> membership;  // membership of each tissue in `label`, in descending order
  int count;                             // number of tissues in `label`; 0: the voxel keeps its tissue
};

struct Bone {
  Counts at_rest, posed;
  Counts settled;  // number of posed voxels that keep their tissue, by label
  std::vector<Contested> contested;
  std::map<Label, float> price;
};
using Bones = std::map<Label, Bone>;

// Calls body(voxel, number) for every voxel of bone tissue in a slice; the number is 1 + the index of its rig bone.
template <class Body>
void for_each_in_slice(const LabelView& bones, int z, const RowSet* rows, const Body& body) {
  const glm::ivec3 size = bones.grid.size;
  std::vector<Label> room;
  for (int y = 0; y < size.y; ++y) {
    if (rows && !(*rows)[y + std::int64_t{size.y} * z]) continue;
    const Label* row = bones.row(y, z, room);
    for (int x = 0; x < size.x; ++x)
      if (row[x]) body(glm::ivec3(x, y, z), row[x]);
  }
}

Bones bones_at_rest(const LabelVolume& rest, const LabelView& rest_bones, const RowSet* rows) {
  Bones bones;
  for (int z = 0; z < rest.grid.size.z; ++z)
    for_each_in_slice(rest_bones, z, rows, [&](const glm::ivec3& v, Label bone) { ++bones[bone].at_rest[rest.at(v)]; });
  return bones;
}

// Returns a pseudo-random number in [0, 1).
float noise(std::uint64_t seed) {
  seed = (seed ^ seed >> 30) * 0xbf58476d1ce4e5b9;
  seed = (seed ^ seed >> 27) * 0x94d049bb133111eb;
  return static_cast<float>(seed >> 40) / (1 << 24);
}

// Returns the tissues that may take a voxel of tissue `own`, with their memberships. The count is 0 if the voxel keeps
// its tissue.
Contested contested(const LabelSampler::Memberships& found, Label own) {
  Contested voxel{0, {}, {}, 0};
  for (int i = 0; i < found.count; ++i) {
    const auto share = static_cast<float>(found.share[i]);
    int place = std::min(voxel.count, kAsked - 1);
    if (voxel.count == kAsked && voxel.membership[place] >= share) continue;
    voxel.count = std::min(voxel.count + 1, kAsked);
    for (; place > 0 && voxel.membership[place - 1] < share; --place) {
      voxel.label[place] = voxel.label[place - 1];
      voxel.membership[place] = voxel.membership[place - 1];
    }
    voxel.label[place] = found.label[i];
    voxel.membership[place] = share;
  }
  const bool is_near = voxel.count > 1 && voxel.membership[0] - voxel.membership[1] < 2 * kMostPrice;
  const bool has_own =
      std::find(voxel.label.begin(), voxel.label.begin() + voxel.count, own) != voxel.label.begin() + voxel.count;
  if (!is_near || !has_own) voxel.count = 0;
  return voxel;
}

// Adds the bone voxels of one slice to the counts and the contested voxels of the rig bones to which they belong.
void read_slice(const LabelView& posed, const LabelView& posed_bones, int z, const RowSet* rows,
                const LabelSampler& sampler, const LabelSet& is_bone, const RestPoint& rest_point, Bones& bones) {
  for_each_in_slice(posed_bones, z, rows, [&](const glm::ivec3& v, Label number) {
    const Label own = posed.at(v);
    Contested voxel = contested(sampler.memberships(rest_point(v), is_bone), own);
    Bone& bone = bones[number];
    ++bone.posed[own];
    if (voxel.count == 0) {
      ++bone.settled[own];
      return;
    }
    voxel.at = posed.grid.index(v);
    for (int i = 0; i < voxel.count; ++i) voxel.membership[i] += kDither * noise(kAsked * voxel.at + i + 1);
    bone.contested.push_back(voxel);
  });
}

void add(Bones&& slice, Bones& bones) {
  for (auto& [number, part] : slice) {
    Bone& bone = bones[number];
    for (const auto& [label, count] : part.posed) bone.posed[label] += count;
    for (const auto& [label, count] : part.settled) bone.settled[label] += count;
    bone.contested.insert(bone.contested.end(), part.contested.begin(), part.contested.end());
  }
}

// Returns the tissue that gets a voxel: the one with the largest sum of membership and price. If two sums are equal,
// the voxel's present tissue `own` is preferred.
Label highest(const Contested& voxel, const std::map<Label, float>& price, Label own) {
  Label best = 0;
  float most = -INFINITY;
  for (int i = 0; i < voxel.count; ++i) {
    const float sum = voxel.membership[i] + price.at(voxel.label[i]);
    if (sum > most || (sum == most && voxel.label[i] == own)) most = sum, best = voxel.label[i];
  }
  return best;
}

// Returns the price (the number added to a tissue's memberships) at which the tissue gets `wanted` of the bone's
// contested voxels (voxels near a border between tissues).
float price_of(Label label, std::int64_t wanted, const Bone& bone) {
  std::vector<float> least;  // lowest price at which the tissue gets each voxel that it may take
  for (const Contested& voxel : bone.contested) {
    float own = -INFINITY, others = -INFINITY;
    for (int i = 0; i < voxel.count; ++i)
      if (voxel.label[i] == label) own = voxel.membership[i];
      else others = std::max(others, voxel.membership[i] + bone.price.at(voxel.label[i]));
    if (own > -INFINITY) least.push_back(others - own);
  }
  if (wanted <= 0) return -kMostPrice;
  if (wanted >= std::ssize(least)) return kMostPrice;
  const auto next = least.begin() + wanted;
  std::nth_element(least.begin(), next, least.end());
  return std::clamp((*std::max_element(least.begin(), next) + *next) / 2, -kMostPrice, kMostPrice);
}

std::int64_t total(const Counts& counts) {
  return std::accumulate(counts.begin(), counts.end(), std::int64_t{0},
                         [](std::int64_t sum, const auto& count) { return sum + count.second; });
}

// Returns the number of posed voxels that each tissue of a bone should have, so that its share of the bone's voxels is
// the same as at rest.
Counts wanted(const Bone& bone) {
  const double scale = double(total(bone.posed)) / double(total(bone.at_rest));
  Counts wanted;
  for (const auto& [label, count] : bone.posed) wanted[label] = 0;
  for (const auto& [label, count] : bone.at_rest) wanted[label] = std::llround(scale * double(count));
  return wanted;
}

void set_prices(Bone& bone, const Counts& wanted) {
  for (const Contested& voxel : bone.contested)
    for (int i = 0; i < voxel.count; ++i) bone.price[voxel.label[i]] = 0;
  const auto smaller = [](const auto& a, const auto& b) { return a.second < b.second; };
  const Label largest = std::max_element(wanted.begin(), wanted.end(), smaller)->first;
  for (int sweep = 0; sweep < kSweeps; ++sweep) {
    bool changed = false;
    for (auto& [label, price] : bone.price) {
      if (label == largest) continue;  // its price stays 0: only differences of prices matter
      const auto goal = wanted.find(label);
      const float next = price_of(label, (goal == wanted.end() ? 0 : goal->second) - bone.settled[label], bone);
      changed |= next != price;
      price = next;
    }
    if (!changed) break;
  }
}

}  // namespace

std::int64_t keep_bone_volumes(LabelEdit posed, const LabelView& posed_bones, const LabelVolume& rest,
                               const LabelView& rest_bones, const LabelSet& soft, const RestPoint& rest_point,
                               const MendRows& rows) {
  LabelSet is_bone(soft.size());
  for (size_t label = 1; label < soft.size(); ++label) is_bone[label] = !soft[label];
  const LabelSampler sampler(rest);
  Bones bones = bones_at_rest(rest, rest_bones, rows.rest);
  std::vector<Bones> slices(posed.grid.size.z);
  parallel_for(posed.grid.size.z, 1, [&](std::int64_t begin, std::int64_t end) {
    for (auto z = begin; z < end; ++z)
      read_slice(posed, posed_bones, static_cast<int>(z), rows.posed, sampler, is_bone, rest_point, slices[z]);
  });
  for (Bones& slice : slices) add(std::move(slice), bones);

  std::int64_t changed = 0;
  for (auto& [number, bone] : bones) {
    const Counts goal = wanted(bone);
    if (goal == bone.posed) continue;
    set_prices(bone, goal);
    for (const Contested& voxel : bone.contested) {
      Label& label = posed.at(voxel_at(posed.grid, voxel.at));
      const Label best = highest(voxel, bone.price, label);
      changed += best != label;
      label = best;
    }
  }
  return changed;
}

}  // namespace limber
