// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/seams/find_seams.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <limits>
#include <optional>

#include "core/base/parallel.h"
#include "core/binding/chest_reach.h"
#include "core/binding/flesh_graph.h"
#include "core/binding/geodesic_front.h"
#include "core/seams/cheapest_cut.h"
#include "core/seams/limbs.h"
#include "core/seams/skin_layers.h"
#include "core/volume/tissue_set.h"

namespace limber {

namespace {

// Half width of the band (the tissue in which the cut may lie), as a share of the length of the limb's first bone.
constexpr double kBandShare = 0.2;
constexpr double kWidestBand = 50;    // mm; a wider half width is reduced to this
constexpr double kNarrowestBand = 4;  // in longest voxel edges; a narrower half width is widened to this
constexpr std::int64_t kGrain = 64;   // bricks per block of a parallel loop

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
    node_of_.resize(tissue_.size());
    find_borders();
    for (size_t k = 0; k < limbs_.size();) {
      if (progress.cancelled()) throw Cancelled();
      progress.update("seams", double(k) / double(limbs_.size()));
      k += part_from(k);
    }
    progress.update("seams", 1);
    return std::move(seams_);
  }

 private:
  using Node = SeamBand::Node;
  using Side = SeamBand::Side;

  struct Border {
    glm::ivec3 voxel;
    std::int64_t place;
    bool operator<(const Border& other) const { return place < other.place; }
    bool operator==(const Border& other) const { return place == other.place; }
  };

  bool may_hold(int bone, Label label) const {
    return !named_[label] || !limb_of_bone_[bone] || *named_[label] == *limb_of_bone_[bone];
  }

  // Assigns every tissue voxel to the nearest bone, along paths through tissue. The flanks of a chest without ribs are
  // nearest to the spine. If the name of a tissue contains a limb ("Muscle, arms"), only bones of that limb count.
  void spread_bones() {
    std::vector<BoneReach> reaches(armature_.bones.size());
    if (widen_chest(volume_.grid, tissue_, armature_, held_by_, reaches))
      spread_bones([&](std::uint16_t bone, float way) { return reaches[bone](way); });
    else spread_bones([](std::uint16_t, float way) { return way; });
  }

  // Assigns every tissue voxel to the bone with the least corrected path length.
  //   corrected  a function (bone, path length in mm) that returns the length to compare
  template <class Corrected>
  void spread_bones(const Corrected& corrected) {
    bone_.resize(tissue_.size());
    ZeroedVector<float> distance(tissue_.size());
    ZeroedVector<Label> label;  // label of each tissue voxel; empty when no label names a limb
    if (std::any_of(named_.begin(), named_.end(), [](const auto& name) { return name.has_value(); }))
      label.resize(tissue_.size());
    TissueFront front(volume_, tissue_);
    front.start_all([&](std::int64_t place, const glm::ivec3& v) {
      if (!label.empty()) label[place] = volume_.at(v);
      bone_[place] = held_by_[place];
      distance[place] = held_by_[place] == kSoft ? std::numeric_limits<float>::infinity() : 0;
      return held_by_[place];  // kSoft, which equals TissueFront::kNoSource, if no bone holds the voxel
    });
    front.spread(
        distance,
        [&](std::uint16_t bone, std::int64_t to, float way) {
          return corrected(bone, way) < distance[to] && (label.empty() || may_hold(bone, label[to]));
        },
        [&](std::uint16_t bone, std::int64_t to, float way) {
          distance[to] = corrected(bone, way);
          bone_[to] = bone;
        });
  }

  // Returns how deep fat, muscle and deeper tissue usually lie below skin at the air. Only skin voxels that belong to
  // the given bones are measured.
  SkinLayers skin_layers(const std::vector<bool>& of_bones) const {
    return SkinLayers(*rays_, volume_.grid.spacing,
                      [&](std::int64_t place) { return bone_[place] != kSoft && of_bones[bone_[place]]; });
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

  // Returns a byte for each brick: 1 if all its voxels belong to one bone.
  std::vector<std::uint8_t> bricks_of_one_bone() const {
    std::vector<std::uint8_t> is_of_one(tissue_.bricks().size());
    parallel_for(std::ssize(is_of_one), kGrain, [&](std::int64_t begin, std::int64_t end) {
      for (auto brick = begin; brick < end; ++brick) {
        const auto first = bone_.begin() + tissue_.bricks()[brick].first;
        is_of_one[brick] = std::all_of(first, first + tissue_.bricks()[brick].count(),
                                       [&](std::uint16_t bone) { return bone == *first; });
      }
    });
    return is_of_one;
  }

  // Returns true if the tissue of a brick and of the six bricks that share a face with it belongs to one bone.
  bool is_inside_one_bone(std::int64_t brick, const std::vector<std::uint8_t>& is_of_one_bone) const {
    if (!is_of_one_bone[brick]) return false;
    const glm::ivec3 grid = tissue_.brick_grid(), here = tissue_.bricks()[brick].corner / TissueVoxels::kBrick;
    for (int direction = 0; direction < 6; ++direction) {
      glm::ivec3 there = here;
      there[direction >> 1] += direction & 1 ? 1 : -1;
      if (glm::any(glm::lessThan(there, glm::ivec3(0))) || glm::any(glm::greaterThanEqual(there, grid))) continue;
      const int beside = tissue_.brick_at(there * TissueVoxels::kBrick);
      if (beside >= 0 &&
          (!is_of_one_bone[beside] || bone_[tissue_.bricks()[beside].first] != bone_[tissue_.bricks()[brick].first]))
        return false;
    }
    return true;
  }

  // Appends the voxels of brick number `at` that share a face with a voxel of another bone.
  void find_borders_of(std::int64_t at, std::vector<Border>& found) const {
    const TissueVoxels::Brick& brick = tissue_.bricks()[at];
    tissue_.for_each(at, at + 1, [&](std::int64_t place, const glm::ivec3& v) {
      for (int direction = 0; direction < 6; ++direction) {
        glm::ivec3 w = v;
        w[direction >> 1] += direction & 1 ? 1 : -1;
        const glm::ivec3 in = w - brick.corner;
        const bool is_in_brick = ((in.x | in.y | in.z) & ~7) == 0;
        const std::int64_t there = is_in_brick                ? TissueVoxels::index_in(brick, in)
                                   : volume_.grid.contains(w) ? tissue_.index_of(w)
                                                              : -1;
        if (there < 0 || bone_[there] == bone_[place]) continue;
        found.push_back({v, place});
        break;
      }
    });
  }

  // Lists the voxels that share a face with a voxel of another bone, sorted by their index among the tissue voxels.
  // Later some voxels are given to another bone, so find_band() checks each listed voxel again.
  void find_borders() {
    if (limbs_.empty()) return;
    const auto bricks = std::ssize(tissue_.bricks());
    const std::vector<std::uint8_t> is_of_one_bone = bricks_of_one_bone();
    std::vector<std::vector<Border>> found((bricks + kGrain - 1) / kGrain);
    parallel_for(bricks, kGrain, [&](std::int64_t begin, std::int64_t end) {
      for (auto brick = begin; brick < end; ++brick)
        if (!is_inside_one_bone(brick, is_of_one_bone)) find_borders_of(brick, found[begin / kGrain]);
    });
    for (const std::vector<Border>& some : found) borders_.insert(borders_.end(), some.begin(), some.end());
  }
  // Adds the voxels of the band that share a face with a voxel of another bone, now that the cut has changed bones.
  void add_borders(const SeamBand& band) {
    const auto before = std::ssize(borders_);
    for (std::size_t n = 0; n < band.nodes.size(); ++n) {
      const bool is_border = std::any_of(band.beside[n].begin(), band.beside[n].end(), [&](std::int32_t m) {
        return m >= 0 && bone_[band.nodes[m].place] != bone_[band.nodes[n].place];
      });
      if (is_border) borders_.push_back({band.nodes[n].voxel, band.nodes[n].place});
    }
    std::sort(borders_.begin() + before, borders_.end());
    std::inplace_merge(borders_.begin(), borders_.begin() + before, borders_.end());
    borders_.erase(std::unique(borders_.begin(), borders_.end()), borders_.end());
  }

  // Separates limb `first` from the body. Also separates the limbs that follow it in the list, up to the first one
  // whose band touches a band of an earlier limb. The bands of these limbs do not touch, so they are cut on several
  // threads. Returns how many limbs were separated.
  std::size_t part_from(std::size_t first) {
    std::vector<SeamBand> bands;
    for (std::size_t k = first; k < limbs_.size(); ++k) {
      SeamBand band{limbs_[k]};
      const bool is_apart = find_band(band);
      if (is_apart) bands.push_back(std::move(band));
      else clear(band);
      if (!is_apart) break;
    }
    const bool is_any =
        std::any_of(bands.begin(), bands.end(), [](const SeamBand& band) { return !band.nodes.empty(); });
    if (is_any && !rays_) rays_ = skin_rays(volume_, tissue_, kind_);
    parallel_for(std::ssize(bands), 1, [&](std::int64_t begin, std::int64_t end) {
      for (std::int64_t i = begin; i < end; ++i) find_cut(bands[i]);
    });
    for (const SeamBand& band : bands) {
      take_sides(band);
      add_borders(band);
      cut_faces(band);
      clear(band);
    }
    return bands.size();
  }
  void find_cut(SeamBand& band) {
    if (band.nodes.empty()) return;
    link(band);
    find_sides(band);
    band.inside =
        cheapest_cut(band, volume_, kind_, seams_, skin_layers(band.limb.has_bone), skin_layers(band.limb.may_touch));
  }
  void clear(const SeamBand& band) {
    for (const Node& node : band.nodes) node_of_[node.place] = 0;
  }
  std::int32_t node_at(std::int64_t place) const { return node_of_[place] - 1; }

  // Returns true if a tissue voxel is in a band other than the given one.
  bool is_of_other(const SeamBand& band, std::int64_t place) const {
    const std::int32_t node = node_at(place);
    return node >= std::ssize(band.nodes) || (node >= 0 && band.nodes[node].place != place);
  }
  // Finds the voxels of a band. Returns false if the band touches the band of another limb.
  bool find_band(SeamBand& band) {
    const Limb& limb = band.limb;
    std::vector<std::int32_t> open;
    bool is_apart = true;
    const auto add = [&](const glm::ivec3& v, std::int64_t place, float way) {
      open.push_back(static_cast<std::int32_t>(band.nodes.size()));
      band.nodes.push_back({v, place, way});
      node_of_[place] = static_cast<std::int32_t>(band.nodes.size());
    };
    for (const auto& [v, place] : borders_) {
      if (!is_of(limb, place)) continue;
      for_each_joined(v, [&](int, const glm::ivec3& w, std::int64_t there) {
        if (is_of(limb, there) || !may_touch(limb, there) || !is_free(limb, armature_, face_centre(v, w))) return;
        for (const auto& [voxel, at] : {std::pair{v, place}, {w, there}}) {
          if (node_at(at) < 0) add(voxel, at, 0);
          else is_apart = is_apart && !is_of_other(band, at);
        }
      });
    }
    const glm::dvec3 spacing = volume_.grid.spacing;
    const float width = width_of_band(limb);
    for (size_t i = 0; i < open.size() && is_apart; ++i) {
      const Node from = band.nodes[open[i]];
      for_each_joined(from.voxel, [&](int direction, const glm::ivec3& w, std::int64_t there) {
        if (is_of_other(band, there)) is_apart = false;
        const float way = from.way + static_cast<float>(spacing[direction >> 1]);
        if (!is_apart || way > width || bone_[there] == kSoft) return;
        if (const std::int32_t node = node_at(there); node < 0) {
          add(w, there, way);
        } else if (way < band.nodes[node].way) {
          band.nodes[node].way = way;
          open.push_back(node);
        }
      });
    }
    return is_apart;
  }
  float width_of_band(const Limb& limb) const {
    double width = kWidestBand;
    if (limb.root >= 0)
      width =
          std::min(width, kBandShare * glm::distance(armature_.bones[limb.root].head, armature_.bones[limb.root].tail));
    const glm::dvec3 spacing = volume_.grid.spacing;
    return static_cast<float>(std::max(width, kNarrowestBand * std::max({spacing.x, spacing.y, spacing.z})));
  }

  // Stores which voxels of the band are connected, and which are bridges. Also marks the ends of the band: voxels that
  // are connected to tissue outside the band.
  void link(SeamBand& band) const {
    std::array<std::int32_t, 6> none;
    none.fill(-1);
    band.beside.assign(band.nodes.size(), none);
    band.is_end.assign(band.nodes.size(), 0);
    for (const Node& node : band.nodes) band.is_bridge.push_back(is_bridge(node.voxel));
    for (std::size_t n = 0; n < band.nodes.size(); ++n)
      for_each_joined(band.nodes[n].voxel, [&](int direction, const glm::ivec3&, std::int64_t there) {
        const int axis = direction >> 1;
        band.beside[n][direction & 1 ? SeamBand::edge_up(axis) : axis] = node_at(there);
        band.is_end[n] = band.is_end[n] || node_at(there) < 0;
      });
  }

  // Sets the side of each voxel of the band. The side is fixed for bones, for tissue whose name contains a limb and for
  // the ends of the band (link()). All other voxels are Side::Free: the cut decides.
  void find_sides(SeamBand& band) const {
    const Limb& limb = band.limb;
    const auto limb_name =
        limb_of_bone_[std::find(limb.has_bone.begin(), limb.has_bone.end(), true) - limb.has_bone.begin()];
    band.side.clear();
    for (std::size_t n = 0; n < band.nodes.size(); ++n) band.side.push_back(side_of(band, limb_name, n));
  }
  Side side_of(const SeamBand& band, const std::optional<LimbName>& limb_name, std::size_t n) const {
    const Limb& limb = band.limb;
    const Node& node = band.nodes[n];
    const Side own = is_of(limb, node.place) ? Side::Limb : Side::Other;
    if (held_by_[node.place] != kSoft) return own;
    const auto named = named_[volume_.at(node.voxel)];
    if (named && limb_name && (*named != *limb_name || own == Side::Limb)) return own;
    return band.is_end[n] ? own : Side::Free;
  }

  // Gives each voxel whose side the cut has changed the bone of a neighbour on the new side. A fragment that is
  // connected to no voxel with a fixed side (Band::side) on its own side goes to the other side.
  void take_sides(const SeamBand& band) {
    const Limb& limb = band.limb;
    const std::vector<std::uint8_t>& inside = band.inside;
    std::vector<bool> settled(band.nodes.size());
    std::vector<std::int32_t> open;
    for (std::int32_t n = 0; n < std::ssize(band.nodes); ++n)
      if (is_of(limb, band.nodes[n].place) == bool(inside[n]) && band.side[n] != Side::Free) {
        settled[n] = true;
        open.push_back(n);
      }
    for (const bool keeps_sides : {true, false})
      for (size_t i = 0; i < open.size(); ++i)
        for (const std::int32_t m : band.beside[open[i]]) {
          if (m < 0 || settled[m] || (keeps_sides && inside[m] != inside[open[i]])) continue;
          settled[m] = true;
          const std::int64_t there = band.nodes[m].place, here = band.nodes[open[i]].place;
          if (is_of(limb, there) != is_of(limb, here)) bone_[there] = bone_[here];
          open.push_back(m);
        }
  }

  void cut_faces(const SeamBand& band) {
    const Limb& limb = band.limb;
    struct Face {
      glm::ivec3 lower;
      int axis;
    };
    std::vector<Face> faces;
    for (std::size_t n = 0; n < band.nodes.size(); ++n) {
      if (!is_of(limb, band.nodes[n].place)) continue;
      for (int edge = 0; edge < 6; ++edge) {
        if (band.beside[n][edge] < 0) continue;
        const Node &here = band.nodes[n], &there = band.nodes[band.beside[n][edge]];
        if (is_of(limb, there.place) || !may_touch(limb, there.place)) continue;
        if (is_free(limb, armature_, face_centre(here.voxel, there.voxel)))
          faces.push_back({glm::min(here.voxel, there.voxel), SeamBand::axis_of(edge)});
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
  ZeroedVector<std::uint16_t> held_by_;  // rig bone of each voxel of bone tissue; kSoft: another tissue
  ZeroedVector<std::uint16_t> bone_;     // rig bone that each tissue voxel follows
  ZeroedVector<std::int32_t> node_of_;   // 1 + index in its band of each tissue voxel; 0: in no band
  std::vector<Border> borders_;
  bool has_skin_ = false;
  TissueSet inside_;                          // bones, and the tissue connected to them without crossing skin
  std::optional<std::vector<SkinRay>> rays_;  // computed when the first limb is separated
};

}  // namespace

Seams find_seams(const LabelVolume& volume, const TissueVoxels& tissue, const TissueTable& tissues,
                 const Armature& armature, const BoneParts& parts, Progress& progress) {
  return SeamFinder(volume, tissue, tissues, armature, parts).run(progress);
}

}  // namespace limber
