// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/seams/find_seams.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <limits>
#include <optional>

#include "core/base/parallel.h"
#include "core/binding/flesh_graph.h"
#include "core/binding/geodesic_front.h"
#include "core/bones/min_cut.h"
#include "core/seams/limbs.h"
#include "core/seams/skin_layers.h"
#include "core/volume/tissue_set.h"

namespace limber {

namespace {

// Half width of the band (the tissue in which the cut may lie), as a share of the length of the limb's first bone.
constexpr double kBandShare = 0.2;
constexpr double kWidestBand = 50;     // upper limit on the half width of the band, mm
constexpr double kNarrowestBand = 4;   // lower limit on the half width of the band, in longest voxel edges
constexpr std::int64_t kGrain = 64;    // bricks per block of a parallel loop
constexpr std::int64_t kNodes = 4096;  // voxels of the band per block of a parallel loop
constexpr int kCostUnit = 1024;
// Cost of cutting through the border of a bridge (tissue between the skins of two limbs, see find_bridges()), relative
// to connective tissue.
constexpr double kBridge = 0.5;

// Cost of cutting through the tissues of each Layer, relative to connective tissue. Skin costs as much as connective
// tissue. Where skin is segmented only at the air, the sheet of skin between two limbs continues as connective tissue,
// and the cut should follow the middle of both.
constexpr std::array<double, kLayers> kCostOfLayer{1, 3, 6, 12};
double cost_of(TissueKind kind) { return kCostOfLayer[static_cast<int>(layer_of(kind))]; }

bool is_sheet(TissueKind kind) { return layer_of(kind) == Layer::Sheet; }

// The side of the cut on which a voxel of the band lies: with the limb, or with the part of the body that the limb
// touches (Other). Free: the cut decides.
enum class Side { Limb, Other, Free };

// Numbers of a voxel's six edges in a CutGraph: 0, 1, 2 lead to lower x, y, z; 3, 4, 5 to higher z, y, x. Edge 5 - k is
// the reverse of edge k.
constexpr int edge_up(int axis) { return 5 - axis; }
constexpr int axis_of(int edge) { return edge < 3 ? edge : 5 - edge; }
constexpr std::int32_t kCertain = 1 << 30;

// Returns the limb in a tissue's name, as in "Muscle, arms"; nothing when there is none. Ignores the names of bones and
// organs, because "head" there may mean a part of the bone or organ.
std::optional<LimbName> limb_of_tissue(const Tissue& tissue) {
  if (is_bone(tissue.kind) || tissue.kind == TissueKind::Organ || tissue.kind == TissueKind::Brain) return std::nullopt;
  return limb_named(tissue.name);
}

class SeamFinder {
 public:
  SeamFinder(const LabelVolume& volume, const TissueVoxels& tissue, const TissueTable& tissues,
             const Armature& armature, const BoneParts& parts)
      : volume_(volume),
        tissue_(tissue),
        armature_(armature),
        limbs_(limbs_of(armature)),
        seams_(volume.grid.size),
        kind_(65536, TissueKind::Unknown),
        named_(65536),
        world_(world_from_voxel(volume.grid)),
        inside_(tissue) {
    for (const Tissue& t : tissues.tissues) {
      kind_[t.label] = t.kind;
      named_[t.label] = limb_of_tissue(t);
    }
    if (limbs_.empty()) return;
    held_by_ = fixed_bone(volume, tissue, parts, armature);
    limb_of_bone_ = limb_of_bones(armature);
    spread_bones();
    find_bridges();
  }

  Seams run(Progress& progress) {
    node_of_.assign(tissue_.size(), -1);
    find_borders();
    for (size_t k = 0; k < limbs_.size(); ++k) {
      if (progress.cancelled()) throw Cancelled();
      progress.update("seams", double(k) / double(limbs_.size()));
      part(limbs_[k]);
    }
    progress.update("seams", 1);
    return std::move(seams_);
  }

 private:
  struct Node {
    glm::ivec3 voxel;
    std::int64_t place;
    float way;  // length of the path through tissue to the nearest face where the limbs meet, mm
  };

  struct Border {
    glm::ivec3 voxel;
    std::int64_t place;
    bool operator<(const Border& other) const { return place < other.place; }
    bool operator==(const Border& other) const { return place == other.place; }
  };

  bool may_hold(int bone, Label label) const {
    return !named_[label] || !limb_of_bone_[bone] || *named_[label] == *limb_of_bone_[bone];
  }

  // Assigns every tissue voxel to the nearest bone, along paths through tissue. If the name of a tissue contains a limb
  // ("Muscle, arms"), only bones of that limb count.
  void spread_bones() {
    bone_ = held_by_;
    std::vector<float> distance(tissue_.size(), std::numeric_limits<float>::infinity());
    std::vector<Label> label;  // label of each tissue voxel; empty when no label names a limb
    if (std::any_of(named_.begin(), named_.end(), [](const auto& name) { return name.has_value(); }))
      label.resize(tissue_.size());
    TissueFront front(volume_, tissue_);
    front.start_all([&](std::int64_t place, const glm::ivec3& v) {
      if (!label.empty()) label[place] = volume_.at(v);
      if (held_by_[place] == kSoft) return TissueFront::kNoSource;
      distance[place] = 0;
      return has_soft_beside(v) ? held_by_[place] : TissueFront::kNoSource;
    });
    front.spread(
        distance,
        [&](std::uint16_t bone, std::int64_t to, float way) {
          return way < distance[to] && (label.empty() || may_hold(bone, label[to]));
        },
        [&](std::uint16_t bone, std::int64_t to, float way) {
          distance[to] = way;
          bone_[to] = bone;
        });
  }

  // Returns how deep fat, muscle and deeper tissue usually lie below skin at the air. Only skin voxels that belong to
  // the given bones are measured.
  SkinLayers skin_layers(const std::vector<bool>& of_bones) {
    if (!rays_) rays_ = skin_rays(volume_, tissue_, kind_);
    return SkinLayers(*rays_, volume_.grid.spacing,
                      [&](std::int64_t place) { return bone_[place] != kSoft && of_bones[bone_[place]]; });
  }

  bool has_soft_beside(const glm::ivec3& v) const {
    bool found = false;
    for_each_joined(v, [&](int, const glm::ivec3&, std::int64_t there) { found |= held_by_[there] == kSoft; });
    return found;
  }

  TissueKind kind_at(const glm::ivec3& v) const { return kind_[volume_.at(v)]; }

  // Finds all tissue that is not a bridge: the tissue that is connected to some bone without crossing skin. A bridge is
  // tissue that skin separates from every bone. It lies between the skins of two limbs, where a segmentation that could
  // not separate the limbs has filled the air. A volume without skin has no bridges.
  void find_bridges() {
    TissueSet flesh(tissue_);
    std::atomic<bool> has_skin = false;
    for_bricks([&](std::int64_t place, const glm::ivec3& v) {
      const bool is_skin = kind_at(v) == TissueKind::Skin;
      if (!is_skin) flesh.add(v);
      else if (!has_skin) has_skin = true;
      if (held_by_[place] != kSoft) inside_.add(v);
    });
    has_skin_ = has_skin;
    if (has_skin_) inside_.spread(flesh);
  }

  bool is_bridge(const glm::ivec3& v) const {
    return has_skin_ && !inside_.contains(v) && kind_at(v) != TissueKind::Skin;
  }

  // Calls body(list index, voxel) for all tissue voxels on several threads. Voxels of one brick are visited by one
  // thread.
  template <class Body>
  void for_bricks(const Body& body) const {
    parallel_for(std::ssize(tissue_.bricks()), kGrain,
                 [&](std::int64_t begin, std::int64_t end) { tissue_.for_each(begin, end, body); });
  }

  // Calls body(direction, neighbour, the neighbour's list index) for each tissue voxel that shares a face with v,
  // unless a seam cuts the face.
  template <class Body>
  void for_each_joined(const glm::ivec3& v, const Body& body) const {
    for (int direction = 0; direction < 6; ++direction) {
      glm::ivec3 w = v;
      w[direction >> 1] += direction & 1 ? 1 : -1;
      if (volume_.at_or_air(w) == 0 || seams_.is_cut_towards(v, direction)) continue;
      body(direction, w, tissue_.index_of(w));
    }
  }

  glm::dvec3 face_centre(const glm::ivec3& v, const glm::ivec3& w) const {
    return world_ * (0.5 * (glm::dvec3(v) + glm::dvec3(w)));
  }

  bool is_of(const Limb& limb, std::int64_t place) const {
    return bone_[place] != kSoft && limb.has_bone[bone_[place]];
  }
  bool may_touch(const Limb& limb, std::int64_t place) const {
    return bone_[place] != kSoft && limb.may_touch[bone_[place]];
  }

  // Lists the voxels that share a face with a voxel of another bone, sorted by their index among the tissue voxels. The
  // cuts change bones later, so find_band() checks each listed voxel again.
  void find_borders() {
    if (limbs_.empty()) return;
    const auto bricks = std::ssize(tissue_.bricks());
    std::vector<std::vector<Border>> found((bricks + kGrain - 1) / kGrain);
    parallel_for(bricks, kGrain, [&](std::int64_t begin, std::int64_t end) {
      tissue_.for_each(begin, end, [&](std::int64_t place, const glm::ivec3& v) {
        for (int direction = 0; direction < 6; ++direction) {
          glm::ivec3 w = v;
          w[direction >> 1] += direction & 1 ? 1 : -1;
          const std::int64_t there = volume_.grid.contains(w) ? tissue_.index_of(w) : -1;
          if (there < 0 || bone_[there] == bone_[place]) continue;
          found[begin / kGrain].push_back({v, place});
          break;
        }
      });
    });
    for (const std::vector<Border>& some : found) borders_.insert(borders_.end(), some.begin(), some.end());
  }
  // Adds the voxels of the band that share a face with a voxel of another bone, now that the cut has changed bones.
  void add_borders() {
    const auto before = std::ssize(borders_);
    for (std::size_t n = 0; n < band_.size(); ++n) {
      const bool is_border = std::any_of(beside_[n].begin(), beside_[n].end(), [&](std::int32_t m) {
        return m >= 0 && bone_[band_[m].place] != bone_[band_[n].place];
      });
      if (is_border) borders_.push_back({band_[n].voxel, band_[n].place});
    }
    std::sort(borders_.begin() + before, borders_.end());
    std::inplace_merge(borders_.begin(), borders_.begin() + before, borders_.end());
    borders_.erase(std::unique(borders_.begin(), borders_.end()), borders_.end());
  }

  void part(const Limb& limb) {
    find_band(limb);
    if (!band_.empty()) {
      link_band();
      find_sides(limb);
      const std::vector<std::uint8_t> inside = cheapest_cut(limb);
      take_sides(limb, inside);
      add_borders();
      cut_faces(limb);
    }
    for (const Node& node : band_) node_of_[node.place] = -1;
    band_.clear();
  }

  // Finds the band, the tissue in which the cut is searched. It is the tissue near the voxel faces where the free part
  // of the limb (is_free()) meets parts of the body that the limb may touch.
  void find_band(const Limb& limb) {
    std::vector<std::int32_t> open;
    for (const auto& [v, place] : borders_) {
      if (!is_of(limb, place)) continue;
      for_each_joined(v, [&](int, const glm::ivec3& w, std::int64_t there) {
        if (is_of(limb, there) || !may_touch(limb, there) || !is_free(limb, armature_, face_centre(v, w))) return;
        for (const auto& [voxel, at] : {std::pair{v, place}, {w, there}})
          if (node_of_[at] < 0) {
            node_of_[at] = static_cast<std::int32_t>(band_.size());
            open.push_back(node_of_[at]);
            band_.push_back({voxel, at, 0});
          }
      });
    }
    const glm::dvec3 spacing = volume_.grid.spacing;
    const double longest = std::max({spacing.x, spacing.y, spacing.z});
    double width = kWidestBand;
    if (limb.root >= 0)
      width =
          std::min(width, kBandShare * glm::distance(armature_.bones[limb.root].head, armature_.bones[limb.root].tail));
    width = std::max(width, kNarrowestBand * longest);
    for (size_t i = 0; i < open.size(); ++i) {
      const Node from = band_[open[i]];
      for_each_joined(from.voxel, [&](int direction, const glm::ivec3& w, std::int64_t there) {
        const float way = from.way + static_cast<float>(spacing[direction >> 1]);
        if (way > width || bone_[there] == kSoft) return;
        std::int32_t& node = node_of_[there];
        if (node < 0) {
          node = static_cast<std::int32_t>(band_.size());
          band_.push_back({w, there, way});
        } else if (way < band_[node].way) {
          band_[node].way = way;
        } else {
          return;
        }
        open.push_back(node);
      });
    }
  }

  // Stores which voxels of the band are connected. Also marks the ends of the band: voxels that are connected to tissue
  // outside the band.
  void link_band() {
    std::array<std::int32_t, 6> none;
    none.fill(-1);
    beside_.assign(band_.size(), none);
    is_end_.assign(band_.size(), false);
    for (std::size_t n = 0; n < band_.size(); ++n)
      for_each_joined(band_[n].voxel, [&](int direction, const glm::ivec3&, std::int64_t there) {
        const int axis = direction >> 1;
        beside_[n][direction & 1 ? edge_up(axis) : axis] = node_of_[there];
        is_end_[n] = is_end_[n] || node_of_[there] < 0;
      });
  }

  // Returns how deep each voxel of the band lies inside a sheet of tissue: the distance to the nearest voxel of the
  // band outside the sheet, in units of the shortest voxel edge. The value is 0 outside the sheet.
  //   is_of_sheet  returns true if a voxel of the band lies in a sheet
  template <class IsOfSheet>
  std::vector<float> depth_in_sheets(const IsOfSheet& is_of_sheet) const {
    std::vector<float> depth(band_.size(), std::numeric_limits<float>::infinity());
    std::vector<std::int32_t> open;
    for (size_t n = 0; n < band_.size(); ++n)
      if (!is_of_sheet(band_[n])) {
        depth[n] = 0;
        open.push_back(static_cast<std::int32_t>(n));
      }
    const glm::dvec3 spacing = volume_.grid.spacing;
    const glm::vec3 step(spacing / std::min({spacing.x, spacing.y, spacing.z}));
    for (size_t i = 0; i < open.size(); ++i)
      for (int edge = 0; edge < 6; ++edge) {
        const std::int32_t node = beside_[open[i]][edge];
        const float way = depth[open[i]] + step[axis_of(edge)];
        if (node < 0 || depth[node] <= way) continue;
        depth[node] = way;
        open.push_back(node);
      }
    for (float& d : depth)
      if (d == std::numeric_limits<float>::infinity()) d = 0;
    return depth;
  }

  // Returns the cost of cutting through each voxel of the band. The cost falls with the depth inside a sheet (skin and
  // connective tissue), so that the cut follows the sheet's middle. In a bridge (see find_bridges()) the cost falls
  // with the third power of the depth, because a bridge is short.
  std::vector<double> costs() const {
    const std::vector<float> in_sheet =
        depth_in_sheets([&](const Node& node) { return is_sheet(kind_at(node.voxel)); });
    const std::vector<float> in_bridge = depth_in_sheets([&](const Node& node) { return is_bridge(node.voxel); });
    std::vector<double> cost(band_.size());
    for (size_t n = 0; n < band_.size(); ++n) {
      cost[n] = is_bridge(band_[n].voxel) ? kBridge / std::pow(1 + in_bridge[n], 3)
                                          : cost_of(kind_at(band_[n].voxel)) / (1 + in_sheet[n]);
    }
    return cost;
  }

  // Cost of a cut that makes a voxel part of the limb's surface (of_limb), or part of the surface of the body part that
  // the limb touches (of_other).
  struct SurfaceCost {
    double of_limb, of_other;
  };

  // Returns the cost of a cut that makes v a surface voxel; the flesh lies in the direction `inward`. If fat or muscle
  // is less deep below this surface than it usually is below skin at the air, the cost is higher than `own_cost`. The
  // depth of bone is ignored, because bone lies near the skin in a hand but deep in a thigh.
  SurfaceCost cost_as_surface(double own_cost, glm::ivec3 v, int inward, const SkinLayers& of_limb,
                              const SkinLayers& of_other) const {
    const int axis = inward >> 1, reach = std::max(of_limb.reach(axis), of_other.reach(axis));
    SurfaceCost cost{own_cost, own_cost};
    for (int k = 1; k < reach && !seams_.is_cut_towards(v, inward); ++k) {
      v[axis] += inward & 1 ? 1 : -1;
      const Label label = volume_.at_or_air(v);
      const Layer deepest = layer_of(kind_[label]);
      if (label == 0 || deepest == Layer::Deep) break;
      for (const Layer layer : {Layer::Fat, Layer::Muscle}) {
        if (layer > deepest) continue;
        const double most = kCostOfLayer[static_cast<int>(layer)];
        cost.of_limb = std::max(cost.of_limb, most * of_limb.surprise(axis, layer, k));
        cost.of_other = std::max(cost.of_other, most * of_other.surprise(axis, layer, k));
      }
    }
    return cost;
  }

  // Sets the side of each voxel of the band. The side is fixed for bones, for tissue whose name contains a limb and for
  // the ends of the band (link_band()). All other voxels are Side::Free: the cut decides.
  void find_sides(const Limb& limb) {
    const auto limb_name =
        limb_of_bone_[std::find(limb.has_bone.begin(), limb.has_bone.end(), true) - limb.has_bone.begin()];
    side_.clear();
    for (std::size_t n = 0; n < band_.size(); ++n) side_.push_back(side_of(limb, limb_name, n));
  }
  Side side_of(const Limb& limb, const std::optional<LimbName>& limb_name, std::size_t n) const {
    const Node& node = band_[n];
    const Side own = is_of(limb, node.place) ? Side::Limb : Side::Other;
    if (held_by_[node.place] != kSoft) return own;
    const auto named = named_[volume_.at(node.voxel)];
    if (named && limb_name && (*named != *limb_name || own == Side::Limb)) return own;
    return is_end_[n] ? own : Side::Free;
  }

  std::vector<std::uint8_t> cheapest_cut(const Limb& limb) {
    const std::vector<double> cost = costs();
    const SkinLayers of_limb = skin_layers(limb.has_bone), of_other = skin_layers(limb.may_touch);
    CutGraph<6> graph{beside_, std::vector<std::array<std::int32_t, 6>>(band_.size()),
                      std::vector<std::int32_t>(band_.size())};
    const glm::dvec3 s = volume_.grid.spacing, area(s.y * s.z, s.x * s.z, s.x * s.y);
    const double smallest = std::min({area.x, area.y, area.z});
    const auto set_capacities = [&](std::int32_t n) {
      graph.terminal[n] = side_[n] == Side::Limb ? kCertain : side_[n] == Side::Other ? -kCertain : 0;
      for (int axis = 0; axis < 3; ++axis) {
        const int up = edge_up(axis), down = 5 - up;
        const std::int32_t m = beside_[n][up];
        if (m < 0 || (side_[n] != Side::Free && side_[m] != Side::Free))
          continue;  // no cut can change the side of either voxel
        const SurfaceCost here = cost_as_surface(cost[n], band_[n].voxel, 2 * axis, of_limb, of_other);
        const SurfaceCost beyond = cost_as_surface(cost[m], band_[m].voxel, 2 * axis + 1, of_limb, of_other);
        const double unit = kCostUnit * area[axis] / smallest;
        const auto capacity = [&](double surface) {
          return std::max(1, static_cast<int>(std::lround(unit * surface)));
        };
        graph.capacity[n][up] = capacity(here.of_limb + beyond.of_other);
        graph.capacity[m][down] = capacity(beyond.of_limb + here.of_other);
      }
    };
    parallel_for(std::ssize(band_), kNodes, [&](std::int64_t begin, std::int64_t end) {
      for (std::int64_t n = begin; n < end; ++n) set_capacities(static_cast<std::int32_t>(n));
    });
    return min_cut(std::move(graph));
  }

  // Gives each voxel whose side the cut has changed the bone of a neighbour on the new side. A fragment that is
  // connected to no voxel with a fixed side (side_) on its own side goes to the other side.
  void take_sides(const Limb& limb, const std::vector<std::uint8_t>& inside) {
    std::vector<bool> settled(band_.size());
    std::vector<std::int32_t> open;
    for (std::int32_t n = 0; n < std::ssize(band_); ++n)
      if (is_of(limb, band_[n].place) == bool(inside[n]) && side_[n] != Side::Free) {
        settled[n] = true;
        open.push_back(n);
      }
    for (const bool keeps_sides : {true, false})
      for (size_t i = 0; i < open.size(); ++i)
        for (const std::int32_t m : beside_[open[i]]) {
          if (m < 0 || settled[m] || (keeps_sides && inside[m] != inside[open[i]])) continue;
          settled[m] = true;
          const std::int64_t there = band_[m].place, here = band_[open[i]].place;
          if (is_of(limb, there) != is_of(limb, here)) bone_[there] = bone_[here];
          open.push_back(m);
        }
  }

  void cut_faces(const Limb& limb) {
    struct Face {
      glm::ivec3 lower;
      int axis;
    };
    std::vector<Face> faces;
    for (std::size_t n = 0; n < band_.size(); ++n) {
      if (!is_of(limb, band_[n].place)) continue;
      for (int edge = 0; edge < 6; ++edge) {
        if (beside_[n][edge] < 0) continue;
        const Node &here = band_[n], &there = band_[beside_[n][edge]];
        if (is_of(limb, there.place) || !may_touch(limb, there.place)) continue;
        if (is_free(limb, armature_, face_centre(here.voxel, there.voxel)))
          faces.push_back({glm::min(here.voxel, there.voxel), axis_of(edge)});
      }
    }
    for (const Face& face : faces) seams_.cut(face.lower, face.axis);
  }

  const LabelVolume& volume_;
  const TissueVoxels& tissue_;
  const Armature& armature_;
  const std::vector<Limb> limbs_;
  Seams seams_;
  std::vector<TissueKind> kind_;                // tissue kind of each label
  std::vector<std::optional<LimbName>> named_;  // limb that the name of each label contains
  std::vector<std::optional<LimbName>> limb_of_bone_;
  AffineTransform world_;
  std::vector<std::uint16_t> held_by_, bone_;  // rig bone of each tissue voxel; held_by_: kSoft outside bone tissue
  std::vector<std::int32_t> node_of_;          // index in band_ of each tissue voxel; -1: not in the band
  std::vector<Node> band_;
  std::vector<std::array<std::int32_t, 6>> beside_;  // neighbour in band_ of each voxel of the band, by edge; -1: none
  std::vector<bool> is_end_;  // true for each voxel of the band that is connected to tissue outside it
  std::vector<Side> side_;    // side of each voxel of the band
  std::vector<Border> borders_;
  bool has_skin_ = false;
  TissueSet inside_;                          // bones, and the tissue connected to them without crossing skin
  std::optional<std::vector<SkinRay>> rays_;  // computed at first use
};

}  // namespace

Seams find_seams(const LabelVolume& volume, const TissueVoxels& tissue, const TissueTable& tissues,
                 const Armature& armature, const BoneParts& parts, Progress& progress) {
  return SeamFinder(volume, tissue, tissues, armature, parts).run(progress);
}

}  // namespace limber
