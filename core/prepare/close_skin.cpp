// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/prepare/close_skin.h"

#include <algorithm>

#include "core/base/error.h"
#include "core/base/parallel.h"
#include "core/prepare/prepare.h"
#include "core/volume/outside_air.h"

namespace limber {

namespace {

constexpr double kFilledCavity = 0.7;  // density, g/cm3, from which a cavity is not air but tissue or fluid

constexpr std::array<glm::ivec3, 6> kFaces{{{-1, 0, 0}, {1, 0, 0}, {0, -1, 0}, {0, 1, 0}, {0, 0, -1}, {0, 0, 1}}};

// Finds the connected components of tissue within one layer of voxels. Voxels of the layer are connected if they share
// an edge or a corner (8-connected).
class LayerPieces {
 public:
  LayerPieces(const LabelVolume& volume, int axis, int layer)
      : volume_(volume),
        axis_(axis),
        layer_(layer),
        width_(volume.grid.size[(axis + 1) % 3]),
        height_(volume.grid.size[(axis + 2) % 3]) {
    piece_.assign(std::int64_t{width_} * height_, -1);
    for (int b = 0; b < height_; ++b)
      for (int a = 0; a < width_; ++a)
        if (is_tissue(a, b) && piece_at(a, b) < 0) {
          sizes.push_back(0);
          spread(a, b);
        }
  }

  glm::ivec3 voxel(int a, int b) const {
    glm::ivec3 v;
    v[axis_] = layer_;
    v[(axis_ + 1) % 3] = a;
    v[(axis_ + 2) % 3] = b;
    return v;
  }
  int piece_at(int a, int b) const { return piece_[a + std::int64_t{width_} * b]; }
  int piece_at(const glm::ivec3& v) const { return piece_at(v[(axis_ + 1) % 3], v[(axis_ + 2) % 3]); }
  int width() const { return width_; }
  int height() const { return height_; }

  std::vector<std::int64_t> sizes;  // voxel count of each component

 private:
  bool is_tissue(int a, int b) const { return volume_.at(voxel(a, b)) != 0; }

  void spread(int a, int b) {
    const int piece = static_cast<int>(sizes.size()) - 1;
    std::vector<glm::ivec2> waiting;
    const auto add = [&](int i, int j) {
      if (i < 0 || j < 0 || i >= width_ || j >= height_ || piece_at(i, j) >= 0 || !is_tissue(i, j)) return;
      piece_[i + std::int64_t{width_} * j] = piece;
      ++sizes[piece];
      waiting.push_back({i, j});
    };
    add(a, b);
    while (!waiting.empty()) {
      const glm::ivec2 at = waiting.back();
      waiting.pop_back();
      for (int j = -1; j <= 1; ++j)
        for (int i = -1; i <= 1; ++i) add(at.x + i, at.y + j);
    }
  }

  const LabelVolume& volume_;
  int axis_, layer_, width_, height_;
  std::vector<int> piece_;
};

// Decides, at one of the volume's six faces, which tissue was cut there and which tissue only touches the face. The
// rule is in close_skin.h.
class BorderSide {
 public:
  BorderSide(const LabelVolume& volume, int side, const LabelSet& bone)
      : pieces_(volume, side / 2, side % 2 ? volume.grid.size[side / 2] - 1 : 0),
        is_cut_(pieces_.sizes.size(), true) {
    const int axis = side / 2, next_layer = side % 2 ? volume.grid.size[axis] - 2 : 1;
    if (volume.grid.size[axis] < 2 || is_cut_.empty()) return;
    const LayerPieces next(volume, axis, next_layer);
    std::vector<std::int64_t> continued(is_cut_.size(), 0);
    std::vector<bool> has_bone(is_cut_.size(), false);
    std::vector<int> counted_for(next.sizes.size(), -1);
    for (int b = 0; b < pieces_.height(); ++b)
      for (int a = 0; a < pieces_.width(); ++a) {
        const int piece = pieces_.piece_at(a, b), beyond = next.piece_at(a, b);
        if (piece < 0) continue;
        if (bone[volume.at(pieces_.voxel(a, b))]) has_bone[piece] = true;
        if (beyond < 0 || counted_for[beyond] == piece) continue;
        counted_for[beyond] = piece;
        continued[piece] += next.sizes[beyond];
      }
    for (size_t p = 0; p < is_cut_.size(); ++p)
      is_cut_[p] = has_bone[p] || double(pieces_.sizes[p]) > kTouchShare * double(continued[p]);
  }

  bool is_cut(const glm::ivec3& v) const { return is_cut_[pieces_.piece_at(v)]; }
  template <class Body>
  void for_each_cut_voxel(const Body& body) const {
    for (int b = 0; b < pieces_.height(); ++b)
      for (int a = 0; a < pieces_.width(); ++a)
        if (const int piece = pieces_.piece_at(a, b); piece >= 0 && is_cut_[piece]) body(pieces_.voxel(a, b));
  }

 private:
  LayerPieces pieces_;
  std::vector<bool> is_cut_;
};

class SkinCloser {
 public:
  SkinCloser(const LabelVolume& volume, const TissueTable& tissues, SkinGrowth growth, std::optional<Label> skin_label)
      : volume_(volume),
        growth_(growth),
        bone_(65536, 0),
        skin_(65536, 0),
        stays_(65536, 0),
        outside_(outside_air(volume)),
        given_label_(skin_label) {
    for (const Tissue& tissue : tissues.tissues) {
      bone_[tissue.label] = is_bone(tissue.kind);
      skin_[tissue.label] = tissue.kind == TissueKind::Skin;
      stays_[tissue.label] =
          tissue.kind == TissueKind::Nail || (tissue.kind == TissueKind::Cavity && tissue.density < kFilledCavity);
    }
    if (skin_label) skin_[*skin_label] = 1;
    closed_.covered.assign(65536, 0);
    main_label_ = skin_label ? *skin_label : main_skin(tissues);
    for (int side = 0; side < 6; ++side) border_.emplace_back(volume, side, bone_);
  }

  ClosedSkin close() {
    for (int side = 0; side < 6; ++side)
      border_[side].for_each_cut_voxel([&](const glm::ivec3& v) { closed_.cut[side] += !skin_[volume_.at(v)]; });
    std::vector<glm::ivec3> changed;
    for (const glm::ivec3& v : bare_voxels()) cover(v, changed);
    closed_.volume = volume_;
    if (std::any_of(changed.begin(), changed.end(), [&](const glm::ivec3& v) { return !volume_.grid.contains(v); }))
      grow(changed);
    sort(changed);
    closed_.changed_voxels = std::ssize(changed);
    label(changed);
    if (growth_ == SkinGrowth::Outward && !changed.empty()) closed_.enclosed_voxels = newly_enclosed();
    return std::move(closed_);
  }

 private:
  // Returns the skin label that has the most voxels. Skin labels are those whose kind is skin in the tissue table.
  Label main_skin(const TissueTable& tissues) const {
    std::vector<std::int64_t> counts(65536, 0);
    for (const Label label : volume_.voxels) counts[label] += skin_[label];
    std::vector<Label> named;
    for (const Tissue& tissue : tissues.tissues)
      if (skin_[tissue.label]) named.push_back(tissue.label);
    const std::string whom = "name the label that new skin gets with --skin-label";
    if (named.empty())
      throw Error("no tissue is skin", tissues.source.empty() ? "the tissue table" : tissues.source, whom);
    const Label most =
        *std::max_element(named.begin(), named.end(), [&](Label a, Label b) { return counts[a] < counts[b]; });
    if (counts[most] == 0 && named.size() > 1)
      throw Error("several tissues are skin and the volume has none of them", tissues.source, whom);
    return most;
  }

  bool is_open(const glm::ivec3& v, int face) const {
    const glm::ivec3 beside = v + kFaces[face];
    return volume_.grid.contains(beside) ? outside_[volume_.grid.index(beside)] : !border_[face].is_cut(v);
  }

  std::vector<glm::ivec3> bare_voxels() const {
    const glm::ivec3 size = volume_.grid.size;
    std::vector<std::vector<glm::ivec3>> by_slice(size.z);
    parallel_for(size.z, 1, [&](std::int64_t begin, std::int64_t end) {
      for (int z = static_cast<int>(begin); z < end; ++z)
        for (int y = 0; y < size.y; ++y)
          for (int x = 0; x < size.x; ++x) {
            const Label label = volume_.at({x, y, z});
            if (label == 0 || skin_[label] || stays_[label]) continue;
            bool open = false;
            for (int face = 0; face < 6; ++face) open |= is_open({x, y, z}, face);
            if (open) by_slice[z].push_back({x, y, z});
          }
    });
    std::vector<glm::ivec3> all;
    for (const auto& slice : by_slice) all.insert(all.end(), slice.begin(), slice.end());
    return all;
  }

  void cover(const glm::ivec3& v, std::vector<glm::ivec3>& changed) {
    const Label label = volume_.at(v);
    if (growth_ == SkinGrowth::Inward) {
      if (bone_[label]) {
        ++closed_.bare_bone_voxels;
        return;
      }
      changed.push_back(v);
    } else {
      for (int face = 0; face < 6; ++face)
        if (is_open(v, face)) changed.push_back(v + kFaces[face]);
    }
    ++closed_.covered[label];
  }

  void grow(std::vector<glm::ivec3>& changed) {
    closed_.volume = pad(volume_, 1);
    closed_.is_padded = true;
    for (glm::ivec3& v : changed) v += 1;
  }

  void sort(std::vector<glm::ivec3>& changed) const {
    const auto index = [&](const glm::ivec3& v) { return closed_.volume.grid.index(v); };
    std::sort(changed.begin(), changed.end(),
              [&](const glm::ivec3& a, const glm::ivec3& b) { return index(a) < index(b); });
    changed.erase(std::unique(changed.begin(), changed.end()), changed.end());
  }

  void label(const std::vector<glm::ivec3>& changed) {
    std::vector<Label> labels(changed.size(), main_label_);
    const bool has_several =
        !given_label_ && std::count_if(skin_.begin(), skin_.end(), [](auto is_skin) { return is_skin != 0; }) > 1;
    if (has_several) labels = nearest_skin(changed);
    for (size_t i = 0; i < changed.size(); ++i) closed_.volume.at(changed[i]) = labels[i];
  }

  // Returns, for each changed voxel, the label of the nearest skin voxel. The distance is the number of steps through
  // voxel faces, along a path of tissue voxels and changed voxels.
  std::vector<Label> nearest_skin(const std::vector<glm::ivec3>& changed) const {
    const LabelVolume& volume = closed_.volume;
    const auto index = [&](const glm::ivec3& v) { return volume.grid.index(v); };
    std::vector<std::uint8_t> is_passable(volume.voxels.size());
    std::transform(volume.voxels.begin(), volume.voxels.end(), is_passable.begin(),
                   [](Label label) { return label != 0; });
    for (const glm::ivec3& v : changed) is_passable[index(v)] = 1;
    std::vector<Label> found(volume.voxels.size(), 0);
    std::vector<glm::ivec3> layer, next;
    const glm::ivec3 size = volume.grid.size;
    glm::ivec3 v;
    for (v.z = 0; v.z < size.z; ++v.z)
      for (v.y = 0; v.y < size.y; ++v.y)
        for (v.x = 0; v.x < size.x; ++v.x)
          if (const Label label = volume.at(v); label && skin_[label]) {
            found[index(v)] = label;
            layer.push_back(v);
          }
    for (; !layer.empty(); layer.swap(next), next.clear())
      for (const glm::ivec3& from : layer)
        for (const glm::ivec3& face : kFaces) {
          const glm::ivec3 to = from + face;
          if (!volume.grid.contains(to) || !is_passable[index(to)] || found[index(to)]) continue;
          found[index(to)] = found[index(from)];
          next.push_back(to);
        }
    std::vector<Label> labels;
    for (const glm::ivec3& c : changed) labels.push_back(found[index(c)] ? found[index(c)] : main_label_);
    return labels;
  }

  // Returns the number of voxels that were connected to the outside air before and are now enclosed by the new skin.
  std::int64_t newly_enclosed() const {
    const std::vector<std::uint8_t> outside = outside_air(closed_.volume);
    const int margin = closed_.is_padded ? 1 : 0;
    const glm::ivec3 size = volume_.grid.size;
    std::int64_t enclosed = 0;
    glm::ivec3 v;
    for (v.z = 0; v.z < size.z; ++v.z)
      for (v.y = 0; v.y < size.y; ++v.y)
        for (v.x = 0; v.x < size.x; ++v.x) {
          const std::int64_t now = closed_.volume.grid.index(v + margin);
          enclosed += outside_[volume_.grid.index(v)] && closed_.volume.voxels[now] == 0 && !outside[now];
        }
    return enclosed;
  }

  const LabelVolume& volume_;
  const SkinGrowth growth_;
  LabelSet bone_, skin_, stays_;
  const std::vector<std::uint8_t> outside_;
  const std::optional<Label> given_label_;
  Label main_label_ = 0;
  std::vector<BorderSide> border_;
  ClosedSkin closed_;
};

}  // namespace

ClosedSkin close_skin(const LabelVolume& volume, const TissueTable& tissues, SkinGrowth growth,
                      std::optional<Label> skin_label) {
  return SkinCloser(volume, tissues, growth, skin_label).close();
}

}  // namespace limber
