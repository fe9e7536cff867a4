// SPDX-License-Identifier: AGPL-3.0-or-later
// The volume energy of nearly incompressible flesh, without locking (linear tets that resist volume changes become far
// too stiff). The stiff part of the volume term acts on the mean of J over a patch of about eight tets that share
// faces, not on each tet [after de Souza Neto, Pires & Owen 2005, F-bar patches]:
//   K/2 V (Jbar - 1)^2,   Jbar = (sum of V_t J_t) / V
// where V_t is the volume of tissue in tet t, and V the sum of V_t. Only tissue counts, because tets at the skin also
// contain some air, which need not keep its volume. On each tet this energy acts as a pressure K (Jbar - 1) times the
// share of the tet that is tissue. The patch adds a rank-one matrix to the Hessian.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/fem/elastic_form.h"

namespace limber {

// An order of the tets in which the tets of each patch are adjacent.
struct PatchOrder {
  std::vector<std::int64_t> tet;       // #T: indices of the tets, patch by patch
  std::vector<std::int64_t> first{0};  // #patches + 1: index in `tet` of the first tet of each patch
};

// Groups tets into patches. A patch grows through faces from tet to tet, always to the neighbour that shares most nodes
// with the patch. The first tets of the patches follow a space-filling curve [Morton 1966]. A patch contains only tets
// whose `bulk` is above 0 and whose shear modulus is within a factor of 1.5 of that of its first tet; each tet without
// bulk is a patch of its own.
//   bulk, shear  #T, kPa
PatchOrder grow_patches(const NodePositions& rest, const Eigen::MatrixX4i& T, const std::vector<double>& bulk,
                        const std::vector<double>& shear, int size = 8);

class PatchForm {
 public:
  PatchForm() = default;
  //   first         #patches + 1: index of the first tet of each patch in `tets`
  //   bulk, filled  for each tet of `tets`: patch_bulk() and TetMaterial::filled. The bulk of a patch is the mean over
  //                 its tets, weighted by their volumes of tissue
  PatchForm(const ElasticForm& tets, std::vector<std::int64_t> first, const std::vector<double>& bulk,
            std::vector<double> filled);

  // value() returns the volume energy of all patches. pressures() computes the pressures that this energy causes.
  //   J         det F of every tet
  //   pressure  out: the pressure on every tet, kPa
  double value(const std::vector<double>& J) const;
  void pressures(const std::vector<double>& J, std::vector<double>& pressure) const;
  PatchStiffness stiffness() const { return {stiffness_, tissue_}; }

 private:
  double mean_ratio(std::size_t p, const std::vector<double>& J) const;

  std::vector<std::int64_t> first_;               // #patches + 1: index of the first tet of each patch
  std::vector<double> patch_tissue_, stiffness_;  // #patches: tissue, mm3; K / V, kPa/mm3 (0: no bulk)
  std::vector<double> filled_, tissue_;           // #T: share of the tet that is tissue; volume of tissue in it, mm3
};

}  // namespace limber
