// SPDX-License-Identifier: AGPL-3.0-or-later
// Implements regrid(), which changes a volume's spacing; core/prepare/prepare.h describes the method.
#include <algorithm>
#include <cmath>
#include <optional>
#include <sstream>

#include "core/base/error.h"
#include "core/base/parallel.h"
#include "core/prepare/prepare.h"

namespace limber {

namespace {
constexpr std::int64_t kMostVoxels = std::int64_t{1} << 33;
constexpr double kLargestSpacing = 1e6;  // mm; a larger spacing is refused, as in volume files
// Labels whose shares of a voxel's volume differ by less than this count as having equal shares, since shares are sums
// of rounded products.
constexpr double kTie = 1e-9;
// Upper limit of the rounds in which lost layers are restored. A round may cause another one: a voxel that becomes skin
// may touch labels that skin did not touch before. In practice two rounds suffice.
constexpr int kMostRounds = 8;
constexpr int kBalancingRounds = 40;  // rounds of balanced_regrid(), after which voxel counts are near the wanted ones

struct Share {
  Label label;
  double volume;  // volume of the part of a box that has the label, in old voxels
};
using Shares = std::vector<Share>;  // shares of a box; it holds few labels, so a linear search is fast

void add_share(Shares& shares, Label label, double volume) {
  for (Share& share : shares)
    if (share.label == label) {
      share.volume += volume;
      return;
    }
  shares.push_back({label, volume});
}

double share_of(const Shares& shares, Label label) {
  for (const Share& share : shares)
    if (share.label == label) return share.volume;
  return 0;
}

// The interval that a new voxel covers along one axis, in units of old voxels: old voxel i is the interval [i, i + 1].
// cover(i) returns the length of the overlap with old voxel i.
struct Span {
  double low, high;
  int first, end;  // old voxels that overlap the interval: first .. end - 1
  int reach;       // `end`, or end + 1 when the interval extends beyond the volume into air
  double cover(int i) const { return std::min(high, i + 1.0) - std::max(low, static_cast<double>(i)); }
};

Span span(double low, double high, int size) {
  // Allows for rounding errors: an interval that ends at the border of two old voxels must not overlap the second
  // voxel.
  const double first = std::clamp(std::floor(low + kTie), 0.0, double(size)), end = std::ceil(high - kTie);
  const int inside = static_cast<int>(std::clamp(end, 0.0, double(size)));
  return {low, high, static_cast<int>(first), inside, end > inside ? inside + 1 : inside};
}

class Regrid {
 public:
  Regrid(const LabelVolume& from, const Grid& grid) : from_(from), to_{grid, {}} {
    for (int axis = 0; axis < 3; ++axis) {
      const double ratio = grid.spacing[axis] / from.grid.spacing[axis];
      for (int i = 0; i < grid.size[axis]; ++i)
        spans_[axis].push_back(span(i * ratio, (i + 1) * ratio, from.grid.size[axis]));
    }
    to_.voxels.resize(grid.voxel_count());
    const glm::dvec3 ratio = grid.spacing / from.grid.spacing;
    volume_ = ratio.x * ratio.y * ratio.z;
  }

  LabelVolume run(Progress& progress) {
    vote(progress);
    // Restores lost layers between tissue and air first, because skin must be closed. The voxels that become skin are
    // locked, so that the layers inside the body, which are restored next, do not open the skin again.
    if (!every_voxel_lies_in_an_old_one()) {
      locked_.assign(to_.voxels.size(), false);
      std::vector<std::int64_t> ignored, changed;
      progress.update("regrid", 0.7);
      close_all(all_insertions(Closing::Air), Closing::Air, ignored);
      progress.update("regrid", 0.85);
      close_all(all_insertions(Closing::Inside), Closing::Inside, changed);
      close_all(insertions_around(changed, Closing::Air), Closing::Air, ignored);
    }
    return std::move(to_);
  }

  LabelVolume run_balanced(Progress& progress) {
    vote(progress);
    const std::vector<Mixed> mixed = mixed_voxels();
    std::vector<double> wanted(65536, 0), log_weight(65536, 0);
    for (const Label label : from_.voxels) ++wanted[label];
    wanted[0] += volume_ * static_cast<double>(to_.grid.voxel_count()) - static_cast<double>(from_.voxels.size());
    for (double& each : wanted) each /= volume_;
    for (int round = 0; round < kBalancingRounds; ++round) {
      progress.update("regrid", 0.7 + 0.3 * round / kBalancingRounds);
      std::vector<double> count(65536, 0);
      for (const Label label : to_.voxels) ++count[label];
      // Corrects each weight by half of what its label lacks, since a full correction overshoots: the voxel count of a
      // small label changes by whole voxels.
      for (std::size_t label = 0; label < count.size(); ++label)
        if (wanted[label] > 0) log_weight[label] += 0.5 * std::log((wanted[label] + 1) / (count[label] + 1));
      for (const Mixed& voxel : mixed) to_.voxels[voxel.at] = heaviest(voxel.shares, log_weight);
    }
    keep_small(mixed, wanted);
    return std::move(to_);
  }

 private:
  struct Mixed {  // a new voxel with several labels
    std::int64_t at;
    Shares shares;
  };

  std::vector<Mixed> mixed_voxels() const {
    std::vector<Mixed> mixed;
    glm::ivec3 v;
    std::int64_t at = 0;
    for (v.z = 0; v.z < to_.grid.size.z; ++v.z)
      for (v.y = 0; v.y < to_.grid.size.y; ++v.y)
        for (v.x = 0; v.x < to_.grid.size.x; ++v.x, ++at) {
          if (only_label(spans_[0][v.x], spans_[1][v.y], spans_[2][v.z])) continue;
          Mixed one{at, {}};
          gather(v, one.shares);
          if (one.shares.size() > 1) mixed.push_back(std::move(one));
        }
    return mixed;
  }

  // Returns the label with the largest weighted share. If several labels have it, returns the smallest of these labels.
  static Label heaviest(const Shares& shares, const std::vector<double>& log_weight) {
    Label best = 0;
    double most = -INFINITY;
    for (const Share& share : shares) {
      const double weighted = std::log(share.volume) + log_weight[share.label];
      if (weighted > most || (weighted == most && share.label < best)) most = weighted, best = share.label;
    }
    return best;
  }

  // If a label has no voxel, but the volume of half a voxel or more, gives it the voxel in which its share is largest.
  void keep_small(const std::vector<Mixed>& mixed, const std::vector<double>& wanted) {
    std::vector<std::int64_t> count(65536, 0), best_at(65536, -1);
    std::vector<double> most(65536, 0);
    for (const Label label : to_.voxels) ++count[label];
    for (const Mixed& voxel : mixed)
      for (const Share& share : voxel.shares)
        if (share.volume > most[share.label]) most[share.label] = share.volume, best_at[share.label] = voxel.at;
    for (std::size_t label = 1; label < count.size(); ++label)
      if (count[label] == 0 && wanted[label] >= 0.5 && best_at[label] >= 0 && count[to_.voxels[best_at[label]]] > 1) {
        --count[to_.voxels[best_at[label]]];
        to_.voxels[best_at[label]] = static_cast<Label>(label);
      }
  }

  enum class Closing { Air, Inside };
  struct Insertion {
    std::int64_t voxel;
    Label label;
    double share;
  };

  const LabelVolume& from_;
  LabelVolume to_;
  std::vector<Span> spans_[3];
  std::vector<bool> locked_;
  double volume_;  // volume of a new voxel, in old voxels

  bool every_voxel_lies_in_an_old_one() const {
    return std::all_of(std::begin(spans_), std::end(spans_), [](const std::vector<Span>& spans) {
      return std::all_of(spans.begin(), spans.end(),
                         [](const Span& s) { return s.end - s.first == 1 && s.high - s.low <= 1 + kTie; });
    });
  }

  void gather(const Span& x, const Span& y, const Span& z, Shares& shares) const {
    shares.clear();
    double inside = 0;
    for (int k = z.first; k < z.end; ++k)
      for (int j = y.first; j < y.end; ++j) {
        const double area = z.cover(k) * y.cover(j);
        const Label* row = &from_.voxels[from_.grid.index({0, j, k})];
        for (int i = x.first; i < x.end;) {
          const Label label = row[i];
          double length = x.cover(i);
          for (++i; i < x.end && row[i] == label; ++i) length += x.cover(i);
          add_share(shares, label, area * length);
          inside += area * length;
        }
      }
    const double outside = (x.high - x.low) * (y.high - y.low) * (z.high - z.low) - inside;
    if (outside > kTie) add_share(shares, 0, outside);
  }

  // Returns the label of a box if all its old voxels have the same label, else nothing. This case is fast and the most
  // frequent one.
  std::optional<Label> only_label(const Span& x, const Span& y, const Span& z) const {
    if (x.reach > x.end || y.reach > y.end || z.reach > z.end || x.first == x.end || y.first == y.end ||
        z.first == z.end)
      return std::nullopt;
    const Label label = from_.at({x.first, y.first, z.first});
    for (int k = z.first; k < z.end; ++k)
      for (int j = y.first; j < y.end; ++j) {
        const Label* row = &from_.voxels[from_.grid.index({0, j, k})];
        for (int i = x.first; i < x.end; ++i)
          if (row[i] != label) return std::nullopt;
      }
    return label;
  }

  void gather(const glm::ivec3& v, Shares& shares) const {
    gather(spans_[0][v.x], spans_[1][v.y], spans_[2][v.z], shares);
  }

  // Returns the label with the largest share. Returns nothing if several labels have the largest share.
  static std::optional<Label> largest(const Shares& shares, double volume) {
    const auto most = std::max_element(shares.begin(), shares.end(),
                                       [](const Share& a, const Share& b) { return a.volume < b.volume; });
    for (const Share& share : shares)
      if (share.label != most->label && share.volume > most->volume - kTie * volume) return std::nullopt;
    return most->label;
  }

  Label break_tie(const glm::ivec3& v, const Shares& shares, double volume) const {
    double most = 0;
    for (const Share& share : shares) most = std::max(most, share.volume);
    Span grown[3];
    for (int axis = 0; axis < 3; ++axis) {
      const Span& s = spans_[axis][v[axis]];
      grown[axis] = span(s.low - 1, s.high + 1, from_.grid.size[axis]);
    }
    Shares around;
    gather(grown[0], grown[1], grown[2], around);
    std::optional<Share> best;
    for (const Share& share : shares) {
      if (share.volume < most - kTie * volume) continue;
      const double wide = share_of(around, share.label);
      if (!best || wide > best->volume + kTie * volume ||
          (wide > best->volume - kTie * volume && share.label < best->label))
        best = {share.label, wide};
    }
    return best->label;
  }

  void vote(Progress& progress) {
    const glm::ivec3 size = to_.grid.size;
    constexpr int kSlices = 16;
    for (int first = 0; first < size.z; first += kSlices) {
      progress.update("regrid", 0.7 * first / size.z);
      const int rows = size.y * std::min(kSlices, size.z - first);
      parallel_for(rows, 16, [&](std::int64_t begin, std::int64_t end) {
        Shares shares;
        for (std::int64_t row = begin; row < end; ++row) {
          glm::ivec3 v(0, row % size.y, first + row / size.y);
          Label* out = &to_.voxels[to_.grid.index(v)];
          for (; v.x < size.x; ++v.x) {
            if (const auto only = only_label(spans_[0][v.x], spans_[1][v.y], spans_[2][v.z])) {
              out[v.x] = *only;
              continue;
            }
            gather(v, shares);
            const auto winner = shares.size() == 1 ? shares[0].label : largest(shares, volume_);
            out[v.x] = winner ? *winner : break_tie(v, shares, volume_);
          }
        }
      });
    }
  }

  // Returns true if the labels a and b touch in the old volume, within the boxes of the new voxels p and q. Old voxels
  // touch if they share a face; if `corners` is true, an edge or a corner is enough.
  bool met(const glm::ivec3& p, const glm::ivec3& q, Label a, Label b, bool corners) const {
    glm::ivec3 low, high;
    for (int axis = 0; axis < 3; ++axis) {
      low[axis] = std::min(spans_[axis][p[axis]].first, spans_[axis][q[axis]].first);
      high[axis] = std::max(spans_[axis][p[axis]].reach, spans_[axis][q[axis]].reach);
    }
    for (int z = low.z; z < high.z; ++z)
      for (int y = low.y; y < high.y; ++y)
        for (int x = low.x; x < high.x; ++x) {
          if (from_.at_or_air({x, y, z}) != a) continue;
          for (int k = std::max(z - 1, low.z); k <= std::min(z + 1, high.z - 1); ++k)
            for (int j = std::max(y - 1, low.y); j <= std::min(y + 1, high.y - 1); ++j)
              for (int i = std::max(x - 1, low.x); i <= std::min(x + 1, high.x - 1); ++i)
                if ((corners || std::abs(i - x) + std::abs(j - y) + std::abs(k - z) == 1) &&
                    from_.at_or_air({i, j, k}) == b)
                  return true;
        }
    return false;
  }

  // Finds the lost layer between the new voxels p (label a) and q (label b). Returns its label, and which of the two
  // voxels gets the label. Returns nothing if their boxes contain no other tissue, or if the voxels are locked.
  std::optional<Insertion> insertion(const glm::ivec3& p, const glm::ivec3& q, Label a, Label b) const {
    Shares of_p, of_q, together;
    gather(p, of_p);
    gather(q, of_q);
    for (const Shares* shares : {&of_p, &of_q})
      for (const Share& share : *shares)
        if (share.label != 0 && share.label != a && share.label != b) add_share(together, share.label, share.volume);
    if (together.empty()) return std::nullopt;
    const Share between = *std::max_element(together.begin(), together.end(), [](const Share& s, const Share& t) {
      return s.volume < t.volume || (s.volume == t.volume && s.label > t.label);
    });
    const double in_p = share_of(of_p, between.label), in_q = share_of(of_q, between.label);
    const std::int64_t i = to_.grid.index(p), k = to_.grid.index(q);
    bool p_gives_way = in_p > in_q || (in_p == in_q && i < k);
    // Between tissue and air, the air voxel is changed if most of its box is tissue, else the tissue voxel beside it.
    // So the body keeps its volume.
    const bool keep_p = a == 0 && share_of(of_p, 0) >= 0.5 * volume_;
    const bool keep_q = b == 0 && share_of(of_q, 0) >= 0.5 * volume_;
    if (a == 0 || b == 0) p_gives_way = a == 0 ? !keep_p : keep_q;
    const bool may_p = !locked_[i] && !keep_p, may_q = !locked_[k] && !keep_q;
    if (!may_p && !may_q) return std::nullopt;
    const bool take_p = may_p && (!may_q || p_gives_way);
    return Insertion{take_p ? i : k, between.label, take_p ? in_p : in_q};
  }

  // If a layer between the new voxels p and p + step was lost, appends the change that restores it to `insertions`.
  void add_insertion(const glm::ivec3& p, const glm::ivec3& step, Closing closing,
                     std::vector<Insertion>& insertions) const {
    const glm::ivec3 q = p + step;
    const Label a = to_.at(p), b = to_.at(q);
    if (a == b || (closing == Closing::Air) != (a == 0 || b == 0)) return;
    const bool by_face = std::abs(step.x) + std::abs(step.y) + std::abs(step.z) == 1;
    if ((!by_face && closing == Closing::Inside) || met(p, q, a, b, !by_face)) return;
    if (const auto found = insertion(p, q, a, b)) insertions.push_back(*found);
  }

  // Returns the step to neighbour number n of a voxel (0 .. 26, by face, edge or corner); 13 is the voxel itself.
  static glm::ivec3 step_to_neighbour(int n) { return {n % 3 - 1, n / 3 % 3 - 1, n / 9 - 1}; }

  std::vector<Insertion> insertions_of_slice(int z, Closing closing) const {
    std::vector<Insertion> insertions;
    const glm::ivec3 size = to_.grid.size;
    // The steps to half of the 26 neighbours, so that each pair of voxels is visited once.
    std::vector<glm::ivec3> steps;
    for (int n = 14; n < 27; ++n)
      if (z + step_to_neighbour(n).z < size.z) steps.push_back(step_to_neighbour(n));
    for (int y = 0; y < size.y; ++y) {
      const Label* row = &to_.voxels[to_.grid.index({0, y, z})];
      for (const glm::ivec3& step : steps) {
        if (y + step.y < 0 || y + step.y >= size.y) continue;
        const Label* other = row + to_.grid.index(step);
        for (int x = std::max(0, -step.x); x < size.x - std::max(0, step.x); ++x)
          if (row[x] != other[x]) add_insertion({x, y, z}, step, closing, insertions);
      }
    }
    return insertions;
  }

  std::vector<Insertion> insertions_around(const std::vector<std::int64_t>& changed, Closing closing) const {
    std::vector<Insertion> insertions;
    const glm::ivec3 size = to_.grid.size;
    for (const std::int64_t i : changed) {
      const glm::ivec3 p(i % size.x, i / size.x % size.y, i / (std::int64_t{size.x} * size.y));
      for (int n = 0; n < 27; ++n)
        if (to_.grid.contains(p + step_to_neighbour(n))) add_insertion(p, step_to_neighbour(n), closing, insertions);
    }
    return insertions;
  }

  std::vector<Insertion> all_insertions(Closing closing) const {
    std::vector<std::vector<Insertion>> of_slice(to_.grid.size.z);
    parallel_for(to_.grid.size.z, 1, [&](std::int64_t begin, std::int64_t end) {
      for (std::int64_t z = begin; z < end; ++z) of_slice[z] = insertions_of_slice(static_cast<int>(z), closing);
    });
    std::vector<Insertion> all;
    for (const auto& insertions : of_slice) all.insert(all.end(), insertions.begin(), insertions.end());
    return all;
  }

  // Writes the given changes of voxels to the new volume. Repeats this with the changes that thereby become necessary
  // around these voxels. Appends the indices of all changed voxels to `changed`.
  void close_all(std::vector<Insertion> insertions, Closing closing, std::vector<std::int64_t>& changed) {
    for (int round = 0; round < kMostRounds && !insertions.empty(); ++round) {
      // If a voxel would get several labels, the label with the largest share wins, then the smaller label.
      std::sort(insertions.begin(), insertions.end(), [](const Insertion& a, const Insertion& b) {
        if (a.voxel != b.voxel) return a.voxel < b.voxel;
        return a.share != b.share ? a.share > b.share : a.label < b.label;
      });
      std::vector<std::int64_t> now;
      for (const Insertion& one : insertions)
        if (now.empty() || now.back() != one.voxel) {
          now.push_back(one.voxel);
          to_.voxels[one.voxel] = one.label;
          if (closing == Closing::Air) locked_[one.voxel] = true;
        }
      changed.insert(changed.end(), now.begin(), now.end());
      insertions = insertions_around(now, closing);
    }
  }
};
}  // namespace

namespace {
// Returns the grid of another spacing. Throws Error for a spacing that is not positive or gives too many voxels.
Grid grid_at(const LabelVolume& volume, const glm::dvec3& spacing) {
  std::ostringstream asked;
  asked << spacing.x << " x " << spacing.y << " x " << spacing.z << " mm";
  Grid grid = volume.grid;
  double count = 1;
  for (int axis = 0; axis < 3; ++axis) {
    if (!(spacing[axis] > 0) || spacing[axis] > kLargestSpacing)
      throw Error("a spacing must be a positive number of millimetres, a million at most", asked.str(),
                  "choose for example --spacing 2");
    const double extent = volume.grid.size[axis] * volume.grid.spacing[axis] / spacing[axis];
    count *= std::max(1.0, std::ceil(extent - kTie));
    if (!(count <= static_cast<double>(kMostVoxels)))
      throw Error("the new volume would have more than " + std::to_string(kMostVoxels) + " voxels", asked.str(),
                  "choose a coarser spacing");
    grid.size[axis] = static_cast<int>(std::max(1.0, std::ceil(extent - kTie)));
  }
  // The lowest corner of the grid keeps its position, so the centre of the lowest voxel moves.
  grid.spacing = spacing;
  grid.origin = volume.grid.origin + volume.grid.direction * (0.5 * (spacing - volume.grid.spacing));
  return grid;
}
}  // namespace

LabelVolume regrid(const LabelVolume& volume, const glm::dvec3& spacing, Progress& progress) {
  const Grid grid = grid_at(volume, spacing);
  return spacing == volume.grid.spacing ? volume : Regrid(volume, grid).run(progress);
}

LabelVolume balanced_regrid(const LabelVolume& volume, double spacing, Progress& progress) {
  return Regrid(volume, grid_at(volume, glm::dvec3(spacing))).run_balanced(progress);
}

}  // namespace limber
