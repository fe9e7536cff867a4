// SPDX-License-Identifier: AGPL-3.0-or-later
// Predicts, from the shares of a JointField, how turns of a joint change the volumes of skin, fat and muscle, and rates
// the shares. The total that is minimized is the weighted mean over the turns of
//
//    sum over skin, fat and muscle of |volume change|, %  +  folded tissue, %  +  half of the overlapping tissue, %
//
// plus terms that keep the deformation even and smooth: the squared volume change of each voxel, the squared shear r^2
// |grad w|^2 with the distance r from the joint, and the squared bend of the field over neighbouring nodes. The volume
// change of a tissue is the sum of det F - 1 over its voxels (turn_table.h), minus the volume that overlaps
// (joint_gaps.h). Percentages are of the tissue around the joint.
//
// The prediction does not include the other effects of resampling (whole voxels, mended skin). Therefore `bias`, the
// difference between resampled and predicted changes for some shares, is added to the prediction.
#pragma once

#include <array>
#include <memory>
#include <span>
#include <vector>

#include "core/repair/joint_gaps.h"
#include "core/repair/turn_table.h"

namespace limber {

// Volume changes of skin, fat and muscle in one turn, % of the body's volume of each.
using FleshChange = std::array<double, kFleshClasses>;

class VolumeModel {
 public:
  // Keeps references to body, field and motion, which must outlive the model.
  VolumeModel(const WeightedBody& body, const JointField& field, const JointMotion& motion, Blend blend,
              Progress& progress);
  ~VolumeModel();

  struct Value {
    double total = 0;                 // the value that is minimized
    std::vector<FleshChange> change;  // predicted volume change in each turn, %
    double folded = 0, overlap = 0;   // folded and overlapping tissue: means over the turns, % of the tissue
  };
  // Evaluates the model.
  //   nodes     values of the field's nodes, [0, 1]
  //   gradient  receives the derivatives of the total with respect to the node values; empty: they are not computed
  Value evaluate(std::span<const double> nodes, std::span<double> gradient) const;

  // Parameters of the total that are adapted during a repair.
  struct Tuning {
    std::vector<FleshChange> bias;     // difference between the resampled and the predicted change of each turn
    std::vector<double> turn_weights;  // weight of each turn's volume changes
    double care = 1;                   // factor on the costs of folded and of overlapping tissue
  };
  const Tuning& tuning() const { return tuning_; }
  void set_tuning(Tuning tuning) { tuning_ = std::move(tuning); }

 private:
  class Work;
  std::unique_ptr<Work> work_;
  Tuning tuning_;
};

}  // namespace limber
