// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/skin/weight_problems.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>

#include "core/base/parallel.h"
#include "core/skin/neighbour_weights.h"

namespace limber {

namespace {

using Kind = WeightProblem::Kind;
constexpr int kMostPasses = 40;
constexpr int kAround = 3;

// Gives access to the tissue voxels and their face neighbours. In these functions, `place` is a voxel's index in the
// list of tissue voxels.
class Body {
 public:
  //   progress  updated from time to time, so that the user can cancel the search
  Body(const WeightedBody& body, const SkinWeights& weights, Progress& progress = no_progress())
      : body_(body),
        weights_(weights),
        progress_(progress),
        voxel_(body.tissue.size()) {
    body.tissue.for_each([&](std::int64_t place, const glm::ivec3& v) { voxel_[place] = glm::i16vec3(v); });
  }

  std::int64_t size() const { return std::ssize(voxel_); }
  // Reports that the share `done` of the search is done, [0, 1].
  void at(double done) {
    done_ = done;
    progress_.update("looking for problems", done_);
  }
  void go_on(std::int64_t count) const {
    constexpr std::int64_t kOften = 1 << 16;
    if (count % kOften == 0) progress_.update("looking for problems", done_);
  }
  glm::ivec3 voxel(std::int64_t place) const { return glm::ivec3(voxel_[place]); }
  Influence influence(std::int64_t place) const {
    const int brick = body_.tissue.brick_at(voxel(place));
    return weights_.chunk(brick)[place - body_.tissue.bricks()[brick].first];
  }
  // Calls visit(index) for each face neighbour that is tissue.
  template <class Visit>
  void beside(std::int64_t place, const Visit& visit) const {
    for (int d = 0; d < 6; ++d) {
      glm::ivec3 next = voxel(place);
      next[d >> 1] += d & 1 ? 1 : -1;
      if (!body_.volume.grid.contains(next)) continue;
      if (const std::int64_t there = body_.tissue.index_of(next); there >= 0) visit(there);
    }
  }

  // Finds the connected components of voxels that have the same group number. Returns the index of each voxel's
  // component, or -1 where `group` is negative. Components are numbered in the order of their first voxels.
  //   found  receives the voxels of each component
  std::vector<std::int32_t> pieces(const std::vector<std::int32_t>& group,
                                   std::vector<std::vector<std::int64_t>>& found) const {
    std::vector<std::int32_t> piece(size(), -1);
    for (std::int64_t start = 0; start < size(); ++start) {
      if (group[start] < 0 || piece[start] >= 0) continue;
      const auto number = static_cast<std::int32_t>(found.size());
      std::vector<std::int64_t>& voxels = found.emplace_back(1, start);
      piece[start] = number;
      for (std::size_t i = 0; i < voxels.size(); ++i) {
        go_on(static_cast<std::int64_t>(i) + 1);
        beside(voxels[i], [&](std::int64_t next) {
          if (piece[next] >= 0 || group[next] != group[start]) return;
          piece[next] = number;
          voxels.push_back(next);
        });
      }
      std::sort(voxels.begin(), voxels.end());
    }
    return piece;
  }

  // Returns the position of a voxel in the middle of the list, world, mm: the centre of the voxel that is nearest to
  // the mean position of all listed voxels.
  glm::dvec3 middle(const std::vector<std::int64_t>& voxels) const {
    glm::dvec3 mean(0);
    for (const auto place : voxels) mean += glm::dvec3(voxel(place)) / double(voxels.size());
    glm::dvec3 best(0);
    double least = std::numeric_limits<double>::max();
    for (const auto place : voxels) {
      const glm::dvec3 way = (glm::dvec3(voxel(place)) - mean) * body_.volume.grid.spacing;
      if (glm::dot(way, way) < least) least = glm::dot(way, way), best = glm::dvec3(voxel(place));
    }
    return world_from_voxel(body_.volume.grid) * best;
  }

  // Returns the bone with the largest sum of weights in these voxels.
  int main_bone(const std::vector<std::int64_t>& voxels) const {
    std::vector<std::int64_t> sum(body_.armature.bones.size());
    for (const auto place : voxels)
      for (int i = 0; i < 4; ++i) sum[influence(place).bone[i]] += influence(place).weight[i];
    return static_cast<int>(std::max_element(sum.begin(), sum.end()) - sum.begin());
  }

 private:
  const WeightedBody& body_;
  const SkinWeights& weights_;
  Progress& progress_;
  double done_ = 0;
  std::vector<glm::i16vec3> voxel_;
};

LabelSet bone_labels(const WeightedBody& body) {
  LabelSet labels(65536, 0);
  for (const Tissue& tissue : body.tissues.tissues) labels[tissue.label] = is_bone(tissue.kind);
  return labels;
}

// Returns how much the weights of two voxels differ: half the sum of the absolute differences, in 1/65535.
int difference(const Influence& a, const Influence& b) {
  int sum = 0;
  for (int i = 0; i < 4; ++i) {
    if (a.weight[i]) sum += std::abs(a.weight[i] - WeightRules::sum_of(b, std::array<int, 1>{a.bone[i]}));
    if (b.weight[i] && WeightRules::sum_of(a, std::array<int, 1>{b.bone[i]}) == 0) sum += b.weight[i];
  }
  return sum / 2;
}

int steps_between(const Armature& armature, int a, int b) {
  std::vector<int> line;
  for (int at = a; at >= 0; at = armature.bones[at].parent) line.push_back(at);
  int steps = 0;
  for (int at = b; at >= 0; at = armature.bones[at].parent, ++steps)
    if (const auto found = std::find(line.begin(), line.end(), at); found != line.end())
      return steps + static_cast<int>(found - line.begin());
  return std::numeric_limits<int>::max();  // the two bones have no common ancestor
}

// Finds connected components of tissue that contain no bone tissue and through which no bone of the rig runs.
void find_unreached(const WeightedBody& body, const Body& all, const LabelSet& bone,
                    std::vector<WeightProblem>& problems) {
  std::vector<std::vector<std::int64_t>> pieces;
  const std::vector<std::int32_t> piece = all.pieces(std::vector<std::int32_t>(all.size(), 0), pieces);
  if (pieces.size() < 2) return;
  std::vector<bool> reached(pieces.size(), false);
  for (std::int64_t place = 0; place < all.size(); ++place)
    if (bone[body.volume.at(all.voxel(place))]) reached[piece[place]] = true;
  const AffineTransform to_voxel = voxel_from_world(body.volume.grid);
  for (const Bone& rig_bone : body.armature.bones) {
    const glm::dvec3 from = to_voxel * rig_bone.head, to = to_voxel * rig_bone.tail, way = glm::abs(to - from);
    const int steps = 1 + static_cast<int>(std::min(2 * std::max({way.x, way.y, way.z}), 1e5));
    for (int i = 0; i <= steps; ++i) {
      const glm::dvec3 at = glm::round(glm::mix(from, to, double(i) / steps));
      if (!glm::all(glm::lessThan(glm::abs(at), glm::dvec3(1e6))) || body.volume.at_or_air(glm::ivec3(at)) == 0)
        continue;
      reached[piece[body.tissue.index_of(glm::ivec3(at))]] = true;
    }
  }
  for (std::size_t p = 0; p < pieces.size(); ++p)
    if (!reached[p])
      problems.push_back({Kind::Unreached, all.main_bone(pieces[p]), -1, all.middle(pieces[p]), std::move(pieces[p])});
}

// Finds islands: small patches that mainly follow a bone but are separate from the other tissue that follows this bone.
// Voxels of problems that were found before are left out.
void find_islands(const Body& all, const ProblemSettings& settings, std::vector<WeightProblem>& problems) {
  std::vector<std::int32_t> main(all.size());
  for (std::int64_t place = 0; place < all.size(); ++place) main[place] = all.influence(place).bone[0];
  for (const WeightProblem& problem : problems)
    for (const auto place : problem.voxels) main[place] = -1;
  std::vector<std::vector<std::int64_t>> pieces;
  all.pieces(main, pieces);
  std::map<int, std::size_t> largest;
  for (const auto& piece : pieces) largest[main[piece[0]]] = std::max(largest[main[piece[0]]], piece.size());
  for (auto& piece : pieces) {
    const int bone = main[piece[0]];
    if (double(piece.size()) < settings.island_share * double(largest[bone]))
      problems.push_back({Kind::Island, bone, -1, all.middle(piece), std::move(piece)});
  }
}

void find_far_bones(const WeightedBody& body, const Body& all, const ProblemSettings& settings,
                    std::vector<WeightProblem>& problems) {
  const int least = static_cast<int>(std::ceil(settings.far_weight * kFullWeight));
  std::map<std::pair<int, int>, bool> far;
  std::map<std::pair<int, int>, std::vector<std::int64_t>> found;
  for (std::int64_t place = 0; place < all.size(); ++place) {
    all.go_on(place);
    const Influence influence = all.influence(place);
    for (int i = 0; i < 4; ++i)
      for (int k = i + 1; k < 4; ++k) {
        if (influence.weight[k] < std::max(least, 1)) continue;
        const std::pair<int, int> pair(std::min(influence.bone[i], influence.bone[k]),
                                       std::max(influence.bone[i], influence.bone[k]));
        const auto [known, fresh] = far.insert({pair, false});
        if (fresh) known->second = steps_between(body.armature, pair.first, pair.second) >= settings.far_steps;
        if (known->second) found[pair].push_back(place);
      }
  }
  for (auto& [pair, voxels] : found) {
    const glm::dvec3 middle = all.middle(voxels);
    problems.push_back({Kind::FarBones, pair.first, pair.second, middle, std::move(voxels)});
  }
}

// Returns the rig bone that each voxel of bone tissue should follow, and -1 for all other voxels. Normally this is the
// bone that the voxel follows most. A small patch that touches bone tissue of another rig bone should instead follow
// the rig bone with which it shares the longest border. A patch is small relative to the largest patch of its own bone.
std::vector<std::int32_t> bones_of_bone_tissue(const WeightedBody& body, const Body& all, const LabelSet& bone,
                                               const ProblemSettings& settings) {
  std::vector<std::int32_t> follows(all.size(), -1);
  for (std::int64_t place = 0; place < all.size(); ++place)
    if (bone[body.volume.at(all.voxel(place))]) follows[place] = all.influence(place).bone[0];
  std::vector<std::vector<std::int64_t>> pieces;
  const std::vector<std::int32_t> piece = all.pieces(follows, pieces);
  std::map<int, std::size_t> largest;
  for (const auto& voxels : pieces) largest[follows[voxels[0]]] = std::max(largest[follows[voxels[0]]], voxels.size());
  // Decides the small patches in descending order of size, so that a patch joins a neighbour whose bone is already
  // decided.
  std::vector<std::size_t> small;
  for (std::size_t p = 0; p < pieces.size(); ++p)
    if (double(pieces[p].size()) < settings.island_share * double(largest[follows[pieces[p][0]]])) small.push_back(p);
  std::stable_sort(small.begin(), small.end(),
                   [&](std::size_t a, std::size_t b) { return pieces[a].size() > pieces[b].size(); });
  for (const std::size_t p : small) {
    std::map<int, int> border;
    const int own = follows[pieces[p][0]];
    for (const auto place : pieces[p])
      all.beside(place, [&](std::int64_t next) {
        if (follows[next] >= 0 && piece[next] != static_cast<std::int32_t>(p) && follows[next] != own)
          ++border[follows[next]];
      });
    const auto longest = std::max_element(border.begin(), border.end(),
                                          [](const auto& a, const auto& b) { return a.second < b.second; });
    if (longest == border.end()) continue;
    for (const auto place : pieces[p]) follows[place] = longest->first;
  }
  return follows;
}

void find_soft_bone(const WeightedBody& body, const Body& all, const LabelSet& bone, const ProblemSettings& settings,
                    std::vector<WeightProblem>& problems) {
  const std::vector<std::int32_t> follows = bones_of_bone_tissue(body, all, bone, settings);
  std::map<int, std::vector<std::int64_t>> found;
  for (std::int64_t place = 0; place < all.size(); ++place)
    if (follows[place] >= 0 && all.influence(place) != rigid_influence(follows[place]))
      found[follows[place]].push_back(place);
  for (auto& [main, voxels] : found) {
    const glm::dvec3 middle = all.middle(voxels);
    problems.push_back({Kind::SoftBone, main, -1, middle, std::move(voxels)});
  }
}

void find_steep(const WeightedBody& body, const Body& all, const LabelSet& bone, const ProblemSettings& settings,
                std::vector<WeightProblem>& problems) {
  const int steep = static_cast<int>(settings.steep * kFullWeight);
  std::vector<std::uint8_t> is_steep(all.size(), 0);
  parallel_for(all.size(), 8192, [&](std::int64_t begin, std::int64_t end) {
    for (auto place = begin; place < end; ++place) {
      if (bone[body.volume.at(all.voxel(place))]) continue;
      all.beside(place, [&](std::int64_t next) {
        // Differences to bone tissue are ignored, since bone tissue keeps its weights.
        if (!bone[body.volume.at(all.voxel(next))] && difference(all.influence(place), all.influence(next)) > steep)
          is_steep[place] = 1;
      });
    }
  });
  std::vector<std::int32_t> group(all.size());
  for (std::int64_t place = 0; place < all.size(); ++place) group[place] = is_steep[place] ? 0 : -1;
  std::vector<std::vector<std::int64_t>> pieces;
  all.pieces(group, pieces);
  for (auto& piece : pieces) {
    const int main = all.main_bone(piece);
    std::map<int, int> others;
    for (const auto place : piece)
      if (all.influence(place).bone[0] != main) ++others[all.influence(place).bone[0]];
    const auto most = std::max_element(others.begin(), others.end(),
                                       [](const auto& a, const auto& b) { return a.second < b.second; });
    const glm::dvec3 middle = all.middle(piece);
    problems.push_back({Kind::Steep, main, most == others.end() ? -1 : most->first, middle, std::move(piece)});
  }
}

}  // namespace

std::vector<WeightProblem> find_problems(const WeightedBody& body, const SkinWeights& weights,
                                         const ProblemSettings& settings, Progress& progress) {
  Body all(body, weights, progress);
  const LabelSet bone = bone_labels(body);
  std::vector<WeightProblem> problems;
  all.at(0);
  find_unreached(body, all, bone, problems);
  all.at(0.3);
  find_islands(all, settings, problems);
  all.at(0.6);
  find_far_bones(body, all, settings, problems);
  find_soft_bone(body, all, bone, settings, problems);
  all.at(0.8);
  find_steep(body, all, bone, settings, problems);
  std::erase_if(problems, [&](const WeightProblem& p) { return std::ssize(p.voxels) < settings.least_voxels; });
  std::stable_sort(problems.begin(), problems.end(), [](const auto& a, const auto& b) {
    return a.kind < b.kind || (a.kind == b.kind && a.voxels.size() > b.voxels.size());
  });
  return problems;
}

std::string describe(const WeightProblem& problem, const Armature& armature) {
  const auto name = [&](int bone) { return bone >= 0 ? armature.bones.at(bone).name : std::string("nothing"); };
  const std::string voxels =
      std::to_string(problem.voxels.size()) + (problem.voxels.size() == 1 ? " voxel" : " voxels");
  switch (problem.kind) {
    case Kind::Unreached: return voxels + " that no bone reaches, assigned to " + name(problem.bone);
    case Kind::Island: return voxels + " of " + name(problem.bone) + " separate from the rest";
    case Kind::FarBones:
      return voxels + " between " + name(problem.bone) + " and " + name(problem.other) + ", which are far apart";
    case Kind::SoftBone: return voxels + " of bone not rigid with " + name(problem.bone);
    case Kind::Steep:
      return voxels + " where weights change abruptly, at " + name(problem.bone) +
             (problem.other >= 0 ? " and " + name(problem.other) : "");
  }
  return voxels;
}

namespace {

TissueRegion region_of(const std::vector<std::int64_t>& voxels, std::int64_t size, const TissueRegion& within) {
  TissueRegion region(size, 0);
  for (const auto place : voxels) region[place] = within.empty() || within[place];
  return region;
}

// Gives all voxels of a separate component of tissue the influence of one voxel. This is the tissue voxel outside the
// component that is nearest to the component's centre.
WeightEdit attached(const WeightedBody& body, const SkinWeights& weights, const WeightProblem& problem,
                    const EditScope& scope) {
  const TissueRegion piece = region_of(problem.voxels, body.tissue.size(), {});
  const glm::dvec3 centre = voxel_from_world(body.volume.grid) * problem.place;
  std::int64_t nearest = -1;
  double least = std::numeric_limits<double>::max();
  body.tissue.for_each([&](std::int64_t place, const glm::ivec3& v) {
    if (piece[place]) return;
    const glm::dvec3 way = (glm::dvec3(v) - centre) * body.volume.grid.spacing;
    if (glm::dot(way, way) < least) least = glm::dot(way, way), nearest = place;
  });
  if (nearest < 0) return {weights};
  const Influence from = Body(body, weights).influence(nearest);
  return edited(body, weights, scope,
                [&](const WeightRules& rules, Influence& influence, std::int64_t, const glm::ivec3&) {
                  std::array<std::pair<int, double>, 4> target;
                  for (int i = 0; i < 4; ++i) target[i] = {from.bone[i], double(from.weight[i])};
                  return rules.blend(influence, target, 1);
                });
}

// Fills the patch from its rim inwards. Each voxel gets the mean weights of its neighbours that are outside the patch
// or already filled.
WeightEdit filled_in(const WeightedBody& body, const SkinWeights& weights, const WeightProblem& problem,
                     const EditScope& scope) {
  const Body all(body, weights);
  TissueRegion open = region_of(problem.voxels, body.tissue.size(), {});
  std::map<std::int64_t, Influence> made;
  std::vector<std::int64_t> left = problem.voxels;
  while (!left.empty()) {
    std::vector<std::pair<std::int64_t, Influence>> layer;
    std::vector<std::int64_t> inner;
    for (const auto place : left) {
      WeightSum mean;
      all.beside(place, [&](std::int64_t next) {
        if (open[next]) return;
        const auto known = made.find(next);
        add_to(mean, known == made.end() ? all.influence(next) : known->second, 1);
      });
      if (mean.empty()) inner.push_back(place);
      else layer.emplace_back(place, quantize(mean));
    }
    if (layer.empty()) break;
    for (const auto& [place, influence] : layer) made[place] = influence, open[place] = 0;
    left = std::move(inner);
  }
  return edited(body, weights, scope,
                [&](const WeightRules& rules, Influence& influence, std::int64_t place, const glm::ivec3&) {
                  const auto found = made.find(place);
                  if (found == made.end()) return WeightChange{};
                  std::array<std::pair<int, double>, 4> target;
                  for (int i = 0; i < 4; ++i) target[i] = {found->second.bone[i], double(found->second.weight[i])};
                  return rules.blend(influence, target, 1);
                });
}

WeightEdit smoothed_out(const WeightedBody& body, const SkinWeights& weights, const WeightProblem& problem,
                        EditScope scope, const TissueRegion& within, const ProblemSettings& settings) {
  const Body all(body, weights);
  const LabelSet bone = bone_labels(body);
  std::vector<std::int64_t> around = problem.voxels;
  TissueRegion near = region_of(around, body.tissue.size(), {});
  for (std::size_t begin = 0, ring = 0; ring < kAround; ++ring) {
    const std::size_t end = around.size();
    for (; begin < end; ++begin)
      all.beside(around[begin], [&](std::int64_t next) {
        if (near[next]) return;
        near[next] = 1;
        around.push_back(next);
      });
  }
  scope.region = region_of(around, body.tissue.size(), within);
  const int steep = static_cast<int>(settings.steep * kFullWeight);
  WeightEdit edit{weights};
  for (int pass = 0; pass < kMostPasses; ++pass) {
    const Body now(body, edit.weights);
    const bool still = std::any_of(problem.voxels.begin(), problem.voxels.end(), [&](std::int64_t place) {
      bool is_steep = false;
      now.beside(place, [&](std::int64_t next) {
        if (!bone[body.volume.at(now.voxel(next))])
          is_steep = is_steep || difference(now.influence(place), now.influence(next)) > steep;
      });
      return is_steep;
    });
    if (!still) break;
    WeightEdit next = smoothed(body, edit.weights, 1, 1, scope);
    const bool stuck = next.changed == 0;
    edit = std::move(next);
    if (stuck) break;
  }
  edit.changed = 0;
  const Body after(body, edit.weights);
  for (const auto place : around) edit.changed += after.influence(place) != all.influence(place);
  return edit;
}

}  // namespace

WeightEdit repaired(const WeightedBody& body, const SkinWeights& weights, const WeightProblem& problem,
                    const EditScope& scope, const ProblemSettings& settings) {
  EditScope there = scope;
  there.region = region_of(problem.voxels, body.tissue.size(), scope.region);
  switch (problem.kind) {
    case Kind::Unreached: return attached(body, weights, problem, there);
    case Kind::Island: return filled_in(body, weights, problem, there);
    case Kind::FarBones:
      return edited(body, weights, there,
                    [&](const WeightRules& rules, Influence& influence, std::int64_t, const glm::ivec3&) {
                      const bool lesser = influence.of(problem.bone) < influence.of(problem.other);
                      return rules.set(influence, lesser ? problem.bone : problem.other, 0);
                    });
    case Kind::SoftBone:
      there.rigid_bone_tissue = false;
      return edited(body, weights, there,
                    [&](const WeightRules& rules, Influence& influence, std::int64_t, const glm::ivec3&) {
                      return rules.set(influence, problem.bone, kFullWeight);
                    });
    case Kind::Steep: return smoothed_out(body, weights, problem, there, scope.region, settings);
  }
  return {weights};
}

}  // namespace limber
