// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/repair/volume_model.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/base/parallel.h"

namespace limber {

namespace {

// A voxel whose volume falls below this share of its volume at rest counts as folded, since it is close to inversion.
constexpr float kLeastVolume = 0.25f;
// Factors of the terms of the total, chosen on the Bender arm. Smaller factors of the last three would lower the volume
// changes at +90 degrees to 1 %, but leave ripples on the skin and bulge the upper arm.
constexpr double kFold = 1, kOverlap = 0.5;
constexpr double kLocal = 0.5;   // factor of the sum of the squared volume changes of single voxels
constexpr double kShear = 0.02;  // factor of the sum of the squared shears
constexpr double kBend = 6;  // factor of the squared bend of the field, measured as the change of strain over a cell
// Half width, in percent, of the range around 0 in which |x| is replaced by a smooth function, since the minimizer
// needs a continuous derivative.
constexpr double kRounding = 0.2;
// Upper limit on the number of voxels over which the model sums. In finer volumes, a regular subset of the voxels is
// used.
constexpr std::int64_t kMostSamples = 250'000;
// A class of tissue counts only if it is at least this share of the soft tissue around the joint.
constexpr double kLeastShare = 0.005;
constexpr int kGrain = 128;  // cells per block of a parallel loop

struct Sample {
  glm::vec3 position;    // position relative to the joint, mm
  glm::vec3 base_slope;  // gradient of the fixed part of the share (FieldPoint::base), 1 / mm
  glm::vec3 mask_slope;  // gradient of the mask, 1 / mm
  glm::vec3 open;  // for each axis of the volume, how many of the two neighbours are tissue, as a share: 0, 1/2 or 1
  FieldPoint point;
  FleshClass tissue;
};

double rounded(double x) { return std::sqrt(x * x + kRounding * kRounding) - kRounding; }
double rounded_slope(double x) { return x / std::sqrt(x * x + kRounding * kRounding); }

// The turns with one common axis, by index, and the gaps that they can close.
struct Axis {
  glm::dvec3 axis;
  std::vector<int> turns;
  JointGaps gaps;
};

}  // namespace

class VolumeModel::Work {
 public:
  Work(const WeightedBody& body, const JointField& field, const JointMotion& motion, Blend blend)
      : field_(field),
        turn_count_(static_cast<int>(std::ssize(motion.turns))) {
    for (int t = 0; t < turn_count_; ++t) {
      const JointTurn& turn = motion.turns[t];
      tables_.emplace_back(blend, turn.angle);
      auto axis = std::find_if(axes_.begin(), axes_.end(), [&](const Axis& a) { return a.axis == turn.axis; });
      if (axis == axes_.end()) axis = axes_.insert(axes_.end(), {turn.axis, {}, {}});
      axis->turns.push_back(t);
    }
    for (Axis& axis : axes_) axis.gaps = joint_gaps(body, field, motion, axis.axis);
    gather_samples(body, motion);
  }

  struct Sums {
    std::vector<FleshChange> change;
    double folded = 0, shear = 0, overlap = 0, local = 0;
  };

  Value value(std::span<const double> nodes, const Tuning& tuning, std::vector<FleshChange>& slopes) const {
    Sums sums = sum_samples(nodes);
    add_gaps(nodes, sums);
    Value value{.total = 0, .change = sums.change};
    slopes.assign(turn_count_, {});
    const double each = 1.0 / turn_count_;
    for (int t = 0; t < turn_count_; ++t)
      for (int c = 0; c < kFleshClasses; ++c) {
        value.change[t][c] *= percent_of_[c];
        value.change[t][c] += tuning.bias[t][c];
        const double near = near_per_body_[c] * value.change[t][c], weight = each * tuning.turn_weights[t];
        value.total += weight * rounded(near);
        slopes[t][c] = weight * rounded_slope(near) * near_per_body_[c] * percent_of_[c];
      }
    value.folded = each * percent_of_all_ * sums.folded;
    value.overlap = each * percent_of_all_ * sums.overlap;
    value.total += tuning.care * (kFold * value.folded + kOverlap * value.overlap) +
                   kShear * percent_of_all_ * sums.shear + each * kLocal * percent_of_all_ * sums.local +
                   bending(nodes);
    return value;
  }

  // Writes the gradient of the total with respect to the node values.
  //   slopes  derivative of the total with respect to the volume change of each turn and tissue class, 1 / mm3
  //   care    factor on the costs of folded and overlapping tissue
  void differentiate(std::span<const double> nodes, const std::vector<FleshChange>& slopes, double care,
                     std::span<double> gradient) const;

 private:
  // Returns the factor of the squared second difference of a row in the bending energy.
  double bend_of(const JointField::Row& row) const {
    const double r2 = glm::dot(field_.node_position(row[1]), field_.node_position(row[1]));
    return kBend * percent_of_all_ * field_.cell_edge() * r2;
  }
  static double second(const JointField::Row& row, std::span<const double> nodes) {
    return nodes[row[0]] - 2 * nodes[row[1]] + nodes[row[2]];
  }
  double bending(std::span<const double> nodes) const {
    double sum = 0;
    for (const JointField::Row& row : field_.rows()) {
      const double each = second(row, nodes);
      sum += bend_of(row) * each * each;
    }
    return sum;
  }
  void differentiate_bending(std::span<const double> nodes, std::span<double> gradient) const {
    for (const JointField::Row& row : field_.rows()) {
      const double slope = 2 * bend_of(row) * second(row, nodes);
      gradient[row[0]] += slope;
      gradient[row[1]] -= 2 * slope;
      gradient[row[2]] += slope;
    }
  }
  void gather_samples(const WeightedBody& body, const JointMotion& motion);
  Sums sum_samples(std::span<const double> nodes) const;
  void add_gaps(std::span<const double> nodes, Sums& sums) const;
  void differentiate_gaps(std::span<const double> nodes, const std::vector<FleshChange>& slopes, double care,
                          std::span<double> gradient) const;
  void scatter(const FieldPoint& point, double slope, std::span<double> gradient) const;

  struct Local {
    float w;
    glm::vec3 slope;  // gradient of w in world axes, 1 / mm
  };
  Local local(const Sample& sample, const std::array<float, 8>& values) const {
    const JointField::Shape& shape = field_.shape(sample.point.place);
    float sum = 0;
    glm::vec3 slope(0);
    for (int i = 0; i < 8; ++i) sum += shape.weight[i] * values[i], slope += shape.slope[i] * values[i];
    return {sample.point.base + sample.point.mask * sum,
            sample.base_slope + sample.mask_slope * sum +
                sample.point.mask * (axes_of_volume_ * (sample.open * (volume_from_world_ * slope)))};
  }
  std::array<float, 8> values_of(std::int64_t piece, std::span<const double> nodes) const {
    std::array<float, 8> values;
    for (int i = 0; i < 8; ++i) values[i] = static_cast<float>(nodes[field_.pieces()[piece][i]]);
    return values;
  }

  const JointField& field_;
  int turn_count_;
  std::vector<TurnTable> tables_;
  std::vector<Axis> axes_;
  std::vector<Sample> samples_;            // the voxels that are summed, sorted by cell
  std::vector<std::int32_t> piece_begin_;  // index of each cell's first sample, then the number of samples
  // Columns: unit axes of the volume; and the inverse of this matrix.
  glm::mat3 axes_of_volume_{1}, volume_from_world_{1};
  float sample_volume_ = 0;      // volume for which one sample stands, mm3
  FleshChange percent_of_{};     // 100 / volume of the body's tissue of each class
  FleshChange near_per_body_{};  // volume of each class in the whole body divided by its volume around the joint
  double percent_of_all_ = 0;    // 100 / volume of skin, fat and muscle around the joint
};

namespace {

// Computes gradients of a function of voxels in world axes by central differences. A neighbour that is not connected
// tissue is replaced by the voxel itself.
class Slopes {
 public:
  explicit Slopes(const WeightedBody& body) : tissue_(body.tissue), size_(body.volume.grid.size) {
    const glm::dmat3 linear = world_from_voxel(body.volume.grid).linear;
    world_ = glm::transpose(glm::inverse(linear));
  }
  struct Neighbours {
    // Indices of the neighbours towards lower x, higher x, ...; the voxel's own index where there is none.
    std::array<std::int64_t, 6> index;
    glm::vec3 open;
  };
  Neighbours neighbours(std::int64_t index, const glm::ivec3& voxel) const {
    Neighbours around;
    around.open = glm::vec3(0);
    for (int d = 0; d < 6; ++d) {
      glm::ivec3 next = voxel;
      next[d >> 1] += d & 1 ? 1 : -1;
      const bool inside = glm::all(glm::greaterThanEqual(next, glm::ivec3(0))) &&
                          glm::all(glm::lessThan(next, size_)) &&
                          !(tissue_.seams() && tissue_.seams()->is_cut_towards(voxel, d));
      const std::int64_t there = inside ? tissue_.index_of(next) : -1;
      around.index[d] = there < 0 ? index : there;
      if (there >= 0) around.open[d >> 1] += 0.5f;
    }
    return around;
  }
  template <class Function>
  glm::vec3 of(const Neighbours& around, const Function& function) const {
    glm::dvec3 rise;
    for (int axis = 0; axis < 3; ++axis)
      rise[axis] = (function(around.index[2 * axis + 1]) - function(around.index[2 * axis])) / 2;
    return glm::vec3(world_ * rise);
  }

 private:
  const TissueVoxels& tissue_;
  glm::ivec3 size_;
  glm::dmat3 world_;
};

}  // namespace

void VolumeModel::Work::gather_samples(const WeightedBody& body, const JointMotion& motion) {
  const std::vector<FleshClass> classes = flesh_classes(body.tissues);
  const std::vector<TissueKind> kinds = body.tissues.kinds();
  std::array<std::int64_t, kFleshClasses + 1> counts{}, near{};
  body.tissue.for_each([&](std::int64_t index, const glm::ivec3& voxel) {
    const Label label = body.volume.at(voxel);
    ++counts[static_cast<int>(classes[label])];
    if (field_.mask(index) > 0 && !is_bone(kinds[label])) ++near[static_cast<int>(classes[label])];
  });
  const double voxel_volume = body.volume.grid.voxel_volume();
  const std::int64_t soft = std::accumulate(near.begin(), near.end(), std::int64_t{0});
  for (int c = 0; c < kFleshClasses; ++c) {
    percent_of_[c] = counts[c] ? 100 / (counts[c] * voxel_volume) : 0;
    // Ignores a class of tissue of which there is hardly anything around the joint.
    near_per_body_[c] = near[c] > kLeastShare * soft ? double(counts[c]) / near[c] : 0;
  }
  percent_of_all_ = 100 / (std::max<std::int64_t>(soft, 1) * voxel_volume);
  const int every = static_cast<int>((soft + kMostSamples - 1) / kMostSamples);
  sample_volume_ = static_cast<float>(voxel_volume * std::max(every, 1));
  axes_of_volume_ = glm::mat3(body.volume.grid.direction);
  volume_from_world_ = glm::inverse(axes_of_volume_);

  const AffineTransform world = world_from_voxel(body.volume.grid);
  const Slopes slopes(body);
  std::vector<Sample> unsorted;
  body.tissue.for_each([&](std::int64_t index, const glm::ivec3& voxel) {
    const Label label = body.volume.at(voxel);
    if (field_.mask(index) == 0 || is_bone(kinds[label])) return;
    if (every > 1 && (voxel.x + 3 * voxel.y + 5 * voxel.z) % every) return;
    const auto around = slopes.neighbours(index, voxel);
    unsorted.push_back({glm::vec3(world * glm::dvec3(voxel) - motion.centre),
                        slopes.of(around, [&](std::int64_t i) { return (1.0 - field_.mask(i)) * field_.share(i); }),
                        slopes.of(around, [&](std::int64_t i) { return double(field_.mask(i)); }), around.open,
                        field_.point(index, voxel), classes[label]});
  });
  piece_begin_.assign(field_.pieces().size() + 1, 0);
  for (const Sample& sample : unsorted) ++piece_begin_[sample.point.piece + 1];
  for (std::size_t p = 0; p < field_.pieces().size(); ++p) piece_begin_[p + 1] += piece_begin_[p];
  samples_.resize(unsorted.size());
  std::vector<std::int32_t> end(piece_begin_.begin(), piece_begin_.end() - 1);
  for (const Sample& sample : unsorted) samples_[end[sample.point.piece]++] = sample;
}

VolumeModel::Work::Sums VolumeModel::Work::sum_samples(std::span<const double> nodes) const {
  const std::int64_t pieces = std::ssize(field_.pieces()), blocks = (pieces + kGrain - 1) / kGrain;
  const int width = turn_count_ * kFleshClasses + 3;
  std::vector<double> partial(blocks * width, 0);
  parallel_for(blocks, 1, [&](std::int64_t first, std::int64_t last) {
    for (std::int64_t block = first; block < last; ++block) {
      double* sums = &partial[block * width];
      for (std::int64_t p = block * kGrain; p < std::min(pieces, (block + 1) * kGrain); ++p) {
        if (piece_begin_[p] == piece_begin_[p + 1]) continue;
        const std::array<float, 8> values = values_of(p, nodes);
        for (int s = piece_begin_[p]; s < piece_begin_[p + 1]; ++s) {
          const Sample& sample = samples_[s];
          const Local here = local(sample, values);
          for (const Axis& axis : axes_) {
            const glm::vec3 a(axis.axis);
            const glm::vec3 away = sample.position - a * glm::dot(a, sample.position);
            const float along_away = glm::dot(away, here.slope),
                        along_about = glm::dot(glm::cross(a, sample.position), here.slope);
            for (const int t : axis.turns) {
              const TurnTable::Values at = tables_[t].at(here.w);
              const float det = at.volume + at.away * along_away + at.about * along_about;
              if (sample.tissue != FleshClass::Other)
                sums[t * kFleshClasses + static_cast<int>(sample.tissue)] += det - 1;
              const float lack = std::max(0.0f, kLeastVolume - det);
              sums[width - 3] += lack * lack / kLeastVolume;
              sums[width - 1] += (det - 1) * (det - 1);
            }
          }
          sums[width - 2] += glm::dot(sample.position, sample.position) * glm::dot(here.slope, here.slope);
        }
      }
    }
  });
  Sums sums{.change = std::vector<FleshChange>(turn_count_, FleshChange{})};
  for (std::int64_t block = 0; block < blocks; ++block) {
    const double* part = &partial[block * width];
    for (int t = 0; t < turn_count_; ++t)
      for (int c = 0; c < kFleshClasses; ++c) sums.change[t][c] += sample_volume_ * part[t * kFleshClasses + c];
    sums.folded += sample_volume_ * part[width - 3];
    sums.shear += sample_volume_ * part[width - 2];
    sums.local += sample_volume_ * part[width - 1];
  }
  return sums;
}

void VolumeModel::Work::add_gaps(std::span<const double> nodes, Sums& sums) const {
  for (const Axis& axis : axes_) {
    const double area = axis.gaps.step * axis.gaps.step;
    for (const JointGap& gap : axis.gaps.gaps) {
      const double before = field_.value(gap.before, nodes), after = field_.value(gap.after, nodes);
      for (const int t : axis.turns) {
        const double opens = tables_[t].angle_at(after).first - tables_[t].angle_at(before).first,
                     overlap = -(gap.width + gap.radius * opens);
        if (overlap <= 0) continue;
        sums.overlap += area * overlap;
        const double depth = overlap / 2 / axis.gaps.step;
        for (int d = 0; d < std::min<double>(JointGaps::kDepth, depth); ++d) {
          const double cut = area * axis.gaps.step * std::min(1.0, depth - d);
          for (const int first : {gap.first_before, gap.first_after})
            if (const FleshClass c = axis.gaps.inward[first + d]; c != FleshClass::Other)
              sums.change[t][static_cast<int>(c)] -= cut;
        }
      }
    }
  }
}

void VolumeModel::Work::scatter(const FieldPoint& point, double slope, std::span<double> gradient) const {
  if (point.piece < 0 || point.mask == 0) return;
  const JointField::Shape& shape = field_.shape(point.place);
  for (int i = 0; i < 8; ++i) gradient[field_.pieces()[point.piece][i]] += slope * point.mask * shape.weight[i];
}

void VolumeModel::Work::differentiate_gaps(std::span<const double> nodes, const std::vector<FleshChange>& slopes,
                                           double care, std::span<double> gradient) const {
  const double all = care * kOverlap * percent_of_all_ / turn_count_;
  for (const Axis& axis : axes_) {
    const double area = axis.gaps.step * axis.gaps.step;
    for (const JointGap& gap : axis.gaps.gaps) {
      const double before = field_.value(gap.before, nodes), after = field_.value(gap.after, nodes);
      double by_before = 0, by_after = 0;
      for (const int t : axis.turns) {
        const auto [angle_before, rise_before] = tables_[t].angle_at(before);
        const auto [angle_after, rise_after] = tables_[t].angle_at(after);
        const double overlap = -(gap.width + gap.radius * (angle_after - angle_before));
        if (overlap <= 0) continue;
        double by_overlap = all * area;
        const int d = static_cast<int>(overlap / 2 / axis.gaps.step);
        if (d < JointGaps::kDepth)
          for (const int first : {gap.first_before, gap.first_after})
            if (const FleshClass c = axis.gaps.inward[first + d]; c != FleshClass::Other)
              by_overlap -= slopes[t][static_cast<int>(c)] * area / 2;
        by_before += by_overlap * gap.radius * rise_before;
        by_after -= by_overlap * gap.radius * rise_after;
      }
      scatter(gap.before, by_before, gradient);
      scatter(gap.after, by_after, gradient);
    }
  }
}

void VolumeModel::Work::differentiate(std::span<const double> nodes, const std::vector<FleshChange>& slopes,
                                      double care, std::span<double> gradient) const {
  const std::int64_t pieces = std::ssize(field_.pieces());
  const float fold = static_cast<float>(care * kFold * percent_of_all_ / turn_count_ * 2 / kLeastVolume),
              shear = static_cast<float>(kShear * percent_of_all_ * 2),
              local_slope = static_cast<float>(kLocal * percent_of_all_ * 2 / turn_count_);
  std::vector<std::array<double, 8>> by_corner(pieces, std::array<double, 8>{});
  parallel_for(pieces, kGrain, [&](std::int64_t begin, std::int64_t end) {
    for (std::int64_t p = begin; p < end; ++p) {
      if (piece_begin_[p] == piece_begin_[p + 1]) continue;
      const std::array<float, 8> values = values_of(p, nodes);
      for (int s = piece_begin_[p]; s < piece_begin_[p + 1]; ++s) {
        const Sample& sample = samples_[s];
        const Local here = local(sample, values);
        float by_w = 0;
        glm::vec3 by_slope = here.slope * (shear * glm::dot(sample.position, sample.position));
        for (const Axis& axis : axes_) {
          const glm::vec3 a(axis.axis);
          const glm::vec3 away = sample.position - a * glm::dot(a, sample.position),
                          about = glm::cross(a, sample.position);
          const float along_away = glm::dot(away, here.slope), along_about = glm::dot(about, here.slope);
          float by_away = 0, by_about = 0;
          for (const int t : axis.turns) {
            const TurnTable::Values at = tables_[t].at(here.w);
            const float det = at.volume + at.away * along_away + at.about * along_about;
            float by_det = -fold * std::max(0.0f, kLeastVolume - det) + local_slope * (det - 1);
            if (sample.tissue != FleshClass::Other)
              by_det += static_cast<float>(slopes[t][static_cast<int>(sample.tissue)]);
            by_w += by_det * (at.volume_w + at.away_w * along_away + at.about_w * along_about);
            by_away += by_det * at.away;
            by_about += by_det * at.about;
          }
          by_slope += by_away * away + by_about * about;
        }
        const JointField::Shape& shape = field_.shape(sample.point.place);
        const float by_sum = sample.point.mask * by_w + glm::dot(sample.mask_slope, by_slope);
        const glm::vec3 by_node_slope =
            sample.point.mask *
            (by_slope * axes_of_volume_ * glm::mat3(sample.open.x, 0, 0, 0, sample.open.y, 0, 0, 0, sample.open.z) *
             volume_from_world_);
        for (int i = 0; i < 8; ++i)
          by_corner[p][i] += sample_volume_ * (shape.weight[i] * by_sum + glm::dot(shape.slope[i], by_node_slope));
      }
    }
  });
  std::fill(gradient.begin(), gradient.end(), 0.0);
  for (std::int64_t p = 0; p < pieces; ++p)
    for (int i = 0; i < 8; ++i) gradient[field_.pieces()[p][i]] += by_corner[p][i];
  differentiate_gaps(nodes, slopes, care, gradient);
  differentiate_bending(nodes, gradient);
}

VolumeModel::VolumeModel(const WeightedBody& body, const JointField& field, const JointMotion& motion, Blend blend,
                         Progress& progress) {
  progress.update("joint", 0.1);
  work_ = std::make_unique<Work>(body, field, motion, blend);
  tuning_ = {.bias = std::vector<FleshChange>(motion.turns.size(), FleshChange{}),
             .turn_weights = std::vector<double>(motion.turns.size(), 1)};
}

VolumeModel::~VolumeModel() = default;

VolumeModel::Value VolumeModel::evaluate(std::span<const double> nodes, std::span<double> gradient) const {
  std::vector<FleshChange> slopes;
  const Value value = work_->value(nodes, tuning_, slopes);
  if (!gradient.empty()) work_->differentiate(nodes, slopes, tuning_.care, gradient);
  return value;
}

}  // namespace limber
