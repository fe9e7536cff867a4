// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/resample/posed_voxels.h"

#include <algorithm>
#include <array>
#include <climits>
#include <cmath>
#include <cstdio>
#include <map>
#include <optional>

#include "core/base/error.h"
#include "core/base/parallel.h"
#include "core/resample/air_pockets.h"
#include "core/resample/body_tracer.h"
#include "core/resample/bone_volumes.h"
#include "core/resample/grey_sampler.h"
#include "core/resample/organ_volumes.h"
#include "core/resample/posed_skin.h"
#include "core/resample/preserve_connectivity.h"
#include "core/resample/rest_points.h"
#include "core/resample/skin_at_rest.h"
#include "core/resample/tissue_volumes.h"
#include "core/volume/tiled_labels.h"

namespace limber {

namespace {

constexpr glm::ivec3 kTile = RestPoints::kTile;  // size of a tile, output voxels; its inverse map takes 3 MB
constexpr std::int64_t kMostRest = 4 << 20;      // upper limit on the number of stored rest points (48 MB)
constexpr int kReach = 8;  // voxels: radius around a rest point within which a missing label is searched
// Smallest tissue, in voxels, that the mass limit applies to. Resampling alone changes smaller tissues noticeably.
constexpr std::int64_t kJudged = 5000;

// What write() finds in one tile of the posed volume: its counts, and the voxels that may need repair.
struct TileCounts {
  VoxelRange range;
  RowSet row_used, row_has_bone;  // 1 for each row (along x) with tissue (row_used) or with bone (row_has_bone)
  std::int64_t holes = 0, overlap = 0, bone_overlap = 0;
  std::vector<Label> lost;
  std::vector<UnderSkin> under_skin;
  std::vector<InnerSkin> inner_skin;
  struct BoneCounts {
    std::int64_t voxels = 0;
    double residual_mm = 0;
  };
  std::map<int, BoneCounts> bones;

  void add_bone_voxel(int bone, double residual_mm) {
    BoneCounts& seen = bones[bone];
    ++seen.voxels;
    seen.residual_mm = std::max(seen.residual_mm, residual_mm);
  }
};

// The soft tissue of one tile: the number of its voxels, and the label changes that are possible at its borders.
struct SoftBorders {
  std::map<Label, std::int64_t> by_cell;  // number of posed voxels that come from each tissue, by label
  std::vector<BorderMove> moves;
};

// Returns the number of rest points for which to reserve memory. For a small body, such as a limb, this is 1.25 times
// the number of tissue voxels, since a pose may enlarge the body. For a large body it is 0.
std::int64_t room_for_rest(const TissueVoxels& tissue) {
  const std::int64_t room = tissue.size() + tissue.size() / 4;
  return room <= kMostRest ? room : 0;
}

// Writes the posed volume tile by tile, then repairs it.
class PosedVoxels {
 public:
  PosedVoxels(const PosedBody& body, const ResampleSettings& settings, Posed& posed)
      : volume_(body.volume),
        labels_(body.labels),
        lattice_(body.lattice),
        bones_(body.bones),
        depth_(body.depth),
        settings_(settings),
        output_(body.output),
        mends_(body.mends),
        keeps_flesh_(body.mends && body.keeps_flesh),
        posed_(posed),
        rest_points_(output_.range, mends_ ? room_for_rest(body.lattice.tissue()) : 0,
                     [this](InverseMap& map, const VoxelRange& range) { fill(map, range); }),
        sampler_(volume_),
        tiles_(output_.grid),
        tracer_(lattice_, bones_, body.tets, depth_, labels_.priority, sampler_, output_.range, settings.nearest),
        world_from_rest_(world_from_voxel(volume_.grid)) {
    const std::int64_t voxels = output_.grid.voxel_count();
    rows_.resize(std::int64_t{output_.grid.size.y} * output_.grid.size.z);
    bone_rows_ = rows_;
    flesh_ = labels_.soft;
    for (size_t label = 0; label < flesh_.size(); ++label) flesh_[label] = labels_.soft[label] && !labels_.skin[label];
    if (mends_) skin_.emplace(volume_, body.lattice.tissue(), *depth_, labels_.soft, labels_.skin);
    if (mends_) posed_bones_ = TiledLabels(output_.grid);
    if (settings.displacement) posed.displacement.resize(voxels);
    if (settings.tiled_displacement) posed.tiled_displacement = TiledVectors(output_.grid);
    if (settings.jacobian) posed.jacobian.resize(voxels);
    if (settings.overlap) posed.overlap.resize(voxels);
    if (settings.grey) start_grey();
  }

  void run(Progress& progress) {
    int low = 0;  // lowest z of the layer of tiles that is added
    for_each_tile<TileCounts>(
        progress, "resample", [&](const VoxelRange& range, TileCounts& counts) { run_tile(range, counts); },
        [&](const TileCounts& tile) {
          if (const int next = tile.range.low.z - output_.range.low.z; !tile.range.empty() && next != low) {
            unsure_ = drop_covered(tiles_, under_skin_, unsure_, low);
            forget_corners_below(tile.range.high.z + 1);
            low = next;
          }
          add(tile);
        });
    drop_covered(tiles_, under_skin_, unsure_, low);
    forget_corners_below(INT_MAX);
  }

  // Returns the posed labels. Call this only if lay_in_rows() has not moved them to posed_.volume.
  TiledLabels take_tiles() { return std::move(tiles_); }
  void lay_in_rows() { posed_.volume = in_rows(std::move(tiles_)); }

  // Gives each soft tissue as many voxels as the inverse map finds in its cells. This is needed because interpolated
  // labels favour thick tissues over thin ones.
  void keep_soft_volumes(Progress& progress) {
    SoftBorders borders = soft_borders(progress);
    posed_.report.mended_voxels +=
        keep_tissue_volumes(posed_.volume, borders.by_cell, borders.moves, labels_.soft, labels_.skin).changed;
  }

  void keep_organs() {
    std::map<Label, std::int64_t> wanted;
    for (const auto& [label, voxels] : soft_voxels(volume_))
      if (voxels >= kOrgan && !labels_.skin[label]) wanted[label] = std::llround(double(voxels) * output_per_rest());
    posed_.report.kept_organs = keep_organ_volumes(posed_.volume, wanted, labels_.soft, labels_.skin);
  }

  void keep_masses(const TissueTable& tissues, Progress& progress) {
    MassExactReport& report = posed_.report.mass_exact.emplace();
    for (const auto& [label, voxels] : soft_voxels(volume_))
      report.tissues[label].wanted = std::llround(double(voxels) * output_per_rest());
    for (const auto& [label, voxels] : soft_voxels(posed_.volume)) report.tissues[label].before = voxels;
    std::map<Label, std::int64_t> wanted;
    for (const auto& [label, tissue] : report.tissues) {
      const double percent =
          100.0 * double(tissue.wanted - tissue.before) / double(std::max<std::int64_t>(tissue.wanted, 1));
      if (tissue.wanted >= kJudged && std::abs(percent) > settings_.mass_limit_percent)
        throw too_far(tissues, label, percent);
      wanted[label] = tissue.wanted;
    }
    report.changed_voxels =
        keep_tissue_volumes(posed_.volume, wanted, soft_borders(progress).moves, labels_.soft, labels_.skin).changed;
    for (const auto& [label, voxels] : soft_voxels(posed_.volume)) report.tissues[label].after = voxels;
  }

  void mend_tears() {
    const auto of_bone = [&](const glm::ivec3& voxel) {
      return bones_.rest_point(posed_bones_.at(voxel) - 1, glm::dvec3(output_.range.low + voxel));
    };
    const RowSet rest_rows = lattice_.tissue().rows(), bone_rest_rows = bones_.rest_rows();
    TiledLabels rest_bones = bones_.numbered();
    const auto bridges =
        mend_bones(posed_bones_, rest_bones, tiles_, labels_.soft, of_bone, {&bone_rows_, &bone_rest_rows});
    for (const glm::ivec3& voxel : bridges) write_bridge(voxel, rest_bones, of_bone(voxel));
    const std::int64_t kept = keep_bone_volumes(tiles_, posed_bones_, volume_, rest_bones, labels_.soft, of_bone,
                                                {&bone_rows_, &bone_rest_rows});
    rest_bones = {};
    const auto rest_point = [&](const glm::ivec3& voxel) {
      return posed_bones_.at(voxel) ? of_bone(voxel) : rest_points_.at(voxel);
    };
    const std::int64_t closed = close_skin(tiles_, under_skin_, flesh_);
    posed_.report.mended_voxels =
        std::ssize(bridges) + kept + closed + thin_skin(tiles_, inner_skin_, closed, flesh_, labels_.skin);
    std::vector<InnerSkin>().swap(inner_skin_);
    const std::vector<AirPocket> pockets = air_pockets(tiles_);
    std::vector<glm::ivec3> was_air =
        fill_grown_pockets(tiles_, volume_, {pockets, skin_->air_pockets_at_rest()}, flesh_, labels_.soft, rest_point);
    posed_.report.filled_air_voxels = std::ssize(was_air);
    posed_.report.new_skin_voxels =
        cover_bare_flesh(tiles_, pockets, under_skin_, flesh_, labels_.bone, labels_.skin, was_air);
    const Origins origins = origins_of(tiles_, was_air, rest_point);
    carry_fields(origins);
    for (const glm::ivec3& v : was_air) rows_[v.y + std::int64_t{output_.grid.size.y} * v.z] = 1;
    const auto any_rest_point = [&](const glm::ivec3& voxel) {
      const auto known = origins.find(output_.grid.index(voxel));
      return known != origins.end() ? known->second.rest : rest_point(voxel);
    };
    posed_.report.mended_voxels += preserve_connectivity(tiles_, volume_, labels_.soft, any_rest_point,
                                                         {&rows_, &rest_rows}, {&bone_rows_, &bone_rest_rows});
  }

 private:
  // Writes a voxel that a rig bone has taken from soft tissue. The voxel gets the label of the nearest bone voxel at
  // its rest point. If the rest point lies in another bone, the nearest voxel of its own bone becomes the rest point.
  void write_bridge(const glm::ivec3& voxel, const LabelView& rest_bones, const glm::dvec3& rest) {
    const Label number = posed_bones_.at(voxel);
    const std::optional<glm::ivec3> own = nearest_voxel(rest_bones, number, rest);
    InverseMap map;
    map.reset({output_.range.low + voxel, output_.range.low + voxel});
    map.bone[0] = static_cast<std::uint16_t>(number - 1);
    const Label there = rest_bones.at_or_air(glm::ivec3(glm::floor(rest + 0.5)));
    map.rest[0] = own && there && there != number ? glm::dvec3(*own) : rest;
    map.use_row(map.range.low);
    TileCounts counts;
    write(map, counts);
    add(counts);
    if (own) tiles_.at(voxel) = volume_.at(*own);
  }

  void carry_fields(const Origins& origins) {
    for (const auto& [at, from] : origins) {
      const glm::ivec3 voxel = voxel_at(output_.grid, at);
      write_displacement(voxel, {at, tiles_.row(voxel.y, voxel.z) + TiledLabels::along_row(voxel.x)}, from.rest);
    }
    if (settings_.grey)
      for (const auto& [at, from] : origins) posed_.grey.voxels[at] = moved_grey(from.rest);
    if (settings_.jacobian)
      for (const auto& [at, from] : origins) posed_.jacobian[at] = posed_.jacobian[from.beside];
  }

  // Calls work(range, tile) for every tile, on several threads, then add(tile) for one tile after the other, in order.
  template <class Tile, class Work, class Add>
  void for_each_tile(Progress& progress, const char* stage, const Work& work, const Add& add) const {
    const glm::ivec3 size = output_.range.high - output_.range.low + 1, tiles = (size + kTile - 1) / kTile;
    const std::int64_t layer = std::int64_t{tiles.x} * tiles.y;
    for (int z = 0; z < tiles.z; ++z) {
      progress.update(stage, double(z) / tiles.z);
      std::vector<Tile> seen(layer);
      parallel_for(layer, 1, [&](std::int64_t begin, std::int64_t end) {
        for (auto t = begin; t < end && !progress.cancelled(); ++t) {
          const glm::ivec3 low = output_.range.low + kTile * glm::ivec3(t % tiles.x, t / tiles.x, z);
          work({low, glm::min(low + kTile - 1, output_.range.high)}, seen[t]);
        }
      });
      for (const Tile& tile : seen) add(tile);
    }
    progress.update(stage, 1);
  }

  void forget_corners_below(int z) const {
    // true: soft_borders() computes the tiles again later and needs these corners
    const bool fills_again = settings_.mass_exact || keeps_flesh_;
    if (!fills_again) lattice_.forget_corners_below(z);
  }

  SoftBorders soft_borders(Progress& progress) const {
    SoftBorders all;
    for_each_tile<SoftBorders>(
        progress, "volumes", [&](const VoxelRange& range, SoftBorders& tile) { find_borders(range, tile); },
        [&](const SoftBorders& tile) {
          for (const auto& [label, voxels] : tile.by_cell) all.by_cell[label] += voxels;
          all.moves.insert(all.moves.end(), tile.moves.begin(), tile.moves.end());
        });
    return all;
  }

  void find_borders(const VoxelRange& range, SoftBorders& borders) const {
    thread_local InverseMap map;
    map.has_volume_ratio = false;
    if (!fill(map, range)) return;
    std::int64_t i = 0;
    glm::ivec3 v;
    for (v.z = range.low.z; v.z <= range.high.z; ++v.z)
      for (v.y = range.low.y; v.y <= range.high.y; ++v.y)
        for (v.x = range.low.x; v.x <= range.high.x; ++v.x, ++i) {
          if (!map.is_covered(i) || map.bone[i] != InverseMap::kNoBone) continue;
          const glm::ivec3 voxel = v - output_.range.low;
          const Label label = posed_.volume.at(voxel), own = volume_.voxels[map.cell[i]];
          if (label == 0 || !labels_.soft[label]) continue;
          ++borders.by_cell[labels_.soft[own] ? own : label];
          if (!is_enclosed(posed_.volume, voxel))
            add_moves(posed_.volume, voxel, sampler_, glm::dvec3(map.rest[i]), labels_.soft, borders.moves);
        }
  }

  std::map<Label, std::int64_t> soft_voxels(const LabelVolume& volume) const {
    std::vector<std::int64_t> counts(65536);
    for (const Label label : volume.voxels) ++counts[label];
    std::map<Label, std::int64_t> soft;
    for (int label = 1; label < 65536; ++label)
      if (counts[label] && labels_.soft[label]) soft[static_cast<Label>(label)] = counts[label];
    return soft;
  }

  // Returns the number of output voxels that have the volume of one rest voxel.
  double output_per_rest() const {
    const glm::dvec3& ratio = lattice_.output().ratio;
    return ratio.x * ratio.y * ratio.z;
  }

  Error too_far(const TissueTable& tissues, Label label, double percent) const {
    const Tissue* tissue = tissues.find(label);
    char text[200];
    std::snprintf(text, sizeof text, "%.60s would have to %s %.1f %% to keep its mass, but at most %g %% is corrected",
                  tissue ? tissue->name.c_str() : "a tissue", percent > 0 ? "gain" : "lose", std::abs(percent),
                  settings_.mass_limit_percent);
    return Error(text, "mass-exact", "use finite elements, bend less, or raise --mass-limit");
  }

  void run_tile(const VoxelRange& range, TileCounts& counts) {
    thread_local InverseMap map;
    map.has_volume_ratio = settings_.jacobian;
    if (!fill(map, range)) return;
    write(map, counts);
    if (mends_) rest_points_.keep(map);
  }

  bool fill(InverseMap& map, const VoxelRange& range) const { return tracer_.fill(map, range, settings_.grey); }

  void write(const InverseMap& map, TileCounts& counts) {
    counts.range = map.range;
    counts.row_used = map.row_used;
    counts.row_has_bone.assign(map.row_used.size(), 0);
    counts.lost = map.lost;
    const std::int64_t length = map.range.high.x - map.range.low.x + 1;
    std::int64_t map_row = 0;
    glm::ivec3 v;
    for (v.z = map.range.low.z; v.z <= map.range.high.z; ++v.z)
      for (v.y = map.range.low.y; v.y <= map.range.high.y; ++v.y, ++map_row) {
        if (!map.row_used[map_row] && !settings_.grey) continue;
        const glm::ivec3 first = glm::ivec3(0, v.y, v.z) - output_.range.low;
        const std::int64_t row = output_.grid.index(first), row_in_tiles = tiles_.row(first.y, first.z);
        std::int64_t i = map_row * length;
        for (v.x = map.range.low.x; v.x <= map.range.high.x; ++v.x, ++i) {
          const bool covered = map.is_covered(i);
          if (settings_.grey) posed_.grey.voxels[row + v.x] = covered ? moved_grey(map.rest[i]) : still_grey(v);
          if (!covered) continue;
          const std::int64_t in_tiles = row_in_tiles + TiledLabels::along_row(first.x + v.x);
          counts.row_has_bone[map_row] |= write_voxel(map, i, v, {row + v.x, in_tiles}, counts);
        }
      }
  }

  // Index of a voxel in volumes (x fastest) and its index in tiles_.
  struct Place {
    std::int64_t at, in_tiles;
  };

  // Writes one posed voxel. Returns true if the voxel is bone.
  bool write_voxel(const InverseMap& map, std::int64_t i, const glm::ivec3& v, const Place& place, TileCounts& counts) {
    const std::int64_t at = place.at;
    const Label label = label_of(map, i);
    tiles_.data()[place.in_tiles] = label;
    if (map.bone[i] != InverseMap::kNoBone && mends_)
      posed_bones_.data()[place.in_tiles] = static_cast<Label>(map.bone[i] + 1);
    if (mends_ && !labels_.skin[label] && may_touch_air(map, i, v)) {
      const glm::dvec3 rest = map.rest[i];
      if (labels_.bone[label] ? skin_->was_bone_covered(rest) : skin_->was_covered(rest))
        counts.under_skin.push_back({at, skin_->skin_over(rest)});
    }
    if (mends_ && labels_.skin[label] && !may_touch_air(map, i, v))
      counts.inner_skin.push_back(
          {static_cast<float>((*depth_)(map.rest[i])),
           std::array<std::uint16_t, 3>{static_cast<std::uint16_t>(v.x - output_.range.low.x),
                                        static_cast<std::uint16_t>(v.y - output_.range.low.y),
                                        static_cast<std::uint16_t>(v.z - output_.range.low.z)}});
    write_fields(map, i, v, place);
    count(map, i, v, label, counts);
    return map.bone[i] != InverseMap::kNoBone || labels_.bone[label];
  }

  // Returns true if a voxel may touch air: one of its face neighbours is air, or is in another tile and so unknown.
  static bool may_touch_air(const InverseMap& map, std::int64_t i, const glm::ivec3& v) {
    const glm::ivec3 size = map.range.high - map.range.low + 1;
    std::int64_t stride = 1;
    for (int axis = 0; axis < 3; stride *= size[axis++]) {
      if (v[axis] == map.range.low[axis] || v[axis] == map.range.high[axis]) return true;
      if (!map.is_covered(i - stride) || !map.is_covered(i + stride)) return true;
    }
    return false;
  }

  Label label_of(const InverseMap& map, std::int64_t i) const {
    const glm::dvec3 rest = map.rest[i];
    if (map.bone[i] != InverseMap::kNoBone) {
      const Label label = settings_.nearest ? sampler_.nearest(rest) : sampler_.tissue(rest, labels_.bone);
      return labels_.bone[label] ? label : sampler_.nearest_of(rest, labels_.bone, kReach);
    }
    const Label own = volume_.voxels[map.cell[i]];
    Label label = settings_.nearest ? own : sampler_.tissue(rest);
    if (label == 0) label = own;  // then the rest point is on the outer border of the tissue
    if (!labels_.bone[label]) return label;
    Label soft = settings_.nearest ? Label{0} : sampler_.tissue(rest, labels_.soft);
    if (soft == 0) soft = sampler_.prevailing(rest, labels_.soft, kReach);
    return soft ? soft : label;
  }

  // Writes the displacement of a posed voxel (posed - rest position, mm) into the fields that the settings request.
  void write_displacement(const glm::ivec3& voxel, const Place& place, const glm::dvec3& rest) const {
    if (!settings_.displacement && !settings_.tiled_displacement) return;
    const glm::dvec3 to(output_.range.low + voxel);
    const glm::vec3 moved = world_from_rest_.linear * (lattice_.output().to_rest(to) - rest);
    if (settings_.displacement) posed_.displacement[place.at] = moved;
    if (settings_.tiled_displacement) posed_.tiled_displacement.data()[place.in_tiles] = moved;
  }

  void write_fields(const InverseMap& map, std::int64_t i, const glm::ivec3& v, const Place& place) const {
    const std::int64_t at = place.at;
    write_displacement(v - output_.range.low, place, glm::dvec3(map.rest[i]));
    if (settings_.jacobian)
      posed_.jacobian[at] =
          map.bone[i] != InverseMap::kNoBone ? 1.0f : static_cast<float>(map.posed_per_rest[i] / output_per_rest());
    if (settings_.overlap)
      posed_.overlap[at] = map.flags[i] & InverseMap::kBoneOverlap ? Label{2}
                           : map.flags[i] & InverseMap::kOverlap   ? Label{1}
                                                                   : Label{0};
  }

  void count(const InverseMap& map, std::int64_t i, const glm::ivec3& v, Label label, TileCounts& counts) const {
    counts.holes += label == 0;
    counts.overlap += (map.flags[i] & InverseMap::kOverlap) != 0;
    counts.bone_overlap += (map.flags[i] & InverseMap::kBoneOverlap) != 0;
    if (!labels_.bone[label]) return;
    const int bone =
        map.bone[i] != InverseMap::kNoBone ? map.bone[i] : bones_.owner(voxel_at(volume_.grid, map.cell[i]));
    if (bone >= 0) counts.add_bone_voxel(bone, bones_.residual(bone, map.rest[i], v));
  }

  void start_grey() {
    grey_.emplace(*settings_.grey);
    const auto& voxels = settings_.grey->voxels;
    outside_ = voxels.empty() ? 0 : *std::min_element(voxels.begin(), voxels.end());
    posed_.grey.grid = output_.grid;
    posed_.grey.type = settings_.grey->type;
    posed_.grey.voxels.resize(output_.grid.voxel_count());
  }

  float moved_grey(const glm::dvec3& rest) const { return (*grey_)(world_from_rest_ * rest); }

  // Returns the grey value of an air voxel: the input's value at the same position if there is air at rest, else (the
  // body has moved away) the lowest value of the input.
  float still_grey(const glm::ivec3& v) const {
    const glm::dvec3 rest = lattice_.output().to_rest(glm::dvec3(v)), world = world_from_rest_ * rest;
    return sampler_.nearest(rest) == 0 && grey_->covers(world) ? (*grey_)(world) : outside_;
  }

  void add(const TileCounts& tile) {
    DeformReport& report = posed_.report;
    for (std::int64_t i = 0; i < std::ssize(tile.row_used); ++i) {
      const int height = tile.range.high.y - tile.range.low.y + 1;
      const glm::ivec3 row(output_.range.low.x, tile.range.low.y + i % height, tile.range.low.z + i / height);
      const std::int64_t at = output_.grid.index(row - output_.range.low) / output_.grid.size.x;
      rows_[at] |= tile.row_used[i];
      bone_rows_[at] |= tile.row_has_bone[i];
    }
    report.new_hole_voxels += tile.holes;
    report.overlap_voxels += tile.overlap;
    report.bone_overlap_voxels += tile.bone_overlap;
    for (Label label : tile.lost) ++report.overlap_by_label[label];
    under_skin_.insert(under_skin_.end(), tile.under_skin.begin(), tile.under_skin.end());
    inner_skin_.insert(inner_skin_.end(), tile.inner_skin.begin(), tile.inner_skin.end());
    for (const auto& [bone, seen] : tile.bones) {
      report.bones[bone].voxels += seen.voxels;
      report.bones[bone].rigid_residual_mm = std::max(report.bones[bone].rigid_residual_mm, seen.residual_mm);
    }
  }

  const LabelVolume& volume_;
  const LabelSets& labels_;
  const PosedLattice& lattice_;
  const RigidBones& bones_;
  const TissueDepth* depth_;
  const ResampleSettings& settings_;
  const OutputGrid& output_;
  const bool mends_, keeps_flesh_;
  Posed& posed_;
  std::optional<SkinAtRest> skin_;
  LabelSet flesh_;          // soft tissues without skin
  RestPoints rest_points_;  // rest points of the posed voxels as they are before any repair
  std::vector<UnderSkin> under_skin_;
  std::ptrdiff_t unsure_ = 0;  // index in under_skin_ of the first voxel that drop_covered() must check again
  std::vector<InnerSkin> inner_skin_;
  RowSet rows_, bone_rows_;  // 1 for each row of the output with tissue (rows_) or with bone tissue (bone_rows_)
  TiledLabels posed_bones_;  // 1 + the index of the rig bone at each posed bone voxel, 0 elsewhere
  const LabelSampler sampler_;
  TiledLabels tiles_;  // labels of the posed volume
  const BodyTracer tracer_;
  AffineTransform world_from_rest_;
  std::optional<GreySampler> grey_;
  float outside_ = 0;
};

}  // namespace

std::optional<TiledLabels> write_voxels(const PosedBody& body, const ResampleSettings& settings, Posed& posed,
                                        Progress& progress) {
  PosedVoxels voxels(body, settings, posed);
  voxels.run(progress);
  if (body.mends) voxels.mend_tears();
  const bool keeps_flesh = body.mends && body.keeps_flesh, keeps_organs = body.mends && posed.report.settled;
  if (!keeps_flesh && !keeps_organs && !settings.mass_exact) return voxels.take_tiles();
  voxels.lay_in_rows();
  if (keeps_flesh) voxels.keep_soft_volumes(progress);
  if (keeps_organs) voxels.keep_organs();
  if (settings.mass_exact) voxels.keep_masses(body.tissues, progress);
  return std::nullopt;
}

}  // namespace limber
