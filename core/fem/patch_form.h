// SPDX-License-Identifier: AGPL-3.0-or-later
// Nearly incompressible flesh without locking: the stiff part of the volume term acts on the mean of J over a patch of
// about eight tets that share faces, not on each tet [after de Souza Neto, Pires & Owen 2005, F-bar patches]:
//   K/2 V (Jbar - 1)^2,   Jbar = sum of V_t J_t / V
// with V_t the tissue that the tet holds: a mesh has some room around its tissue, which has no volume to keep. On its
// tets it acts as a pressure K (Jbar - 1), by how full they are, and its own curvature is of rank one.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/fem/elastic_form.h"

namespace limber {

// Tets in an order in which every patch stands together.
struct PatchOrder {
  std::vector<std::int64_t> tet;       // #T
  std::vector<std::int64_t> first{0};  // #patches + 1
};

// Patches grow from tet to tet over faces, to the neighbour that shares most nodes with the patch, in the order of a
// curve through space [Morton 1966]. Only tets of `bulk` above 0 share a patch, and only those whose shear is within a
// factor of 1.5 of the patch's first; the others are patches of their own.
//   bulk, shear  #T, kPa
PatchOrder grow_patches(const NodePositions& rest, const Eigen::MatrixX4i& T, const std::vector<double>& bulk,
                        const std::vector<double>& shear, int size = 8);

class PatchForm {
 public:
  PatchForm() = default;
  // first  as in PatchOrder, over the tets of `tets`, in whose order `bulk` and `filled` (TetMaterial) stand; a patch
  // takes the mean
  //        of its tets' bulk by tissue
  PatchForm(const ElasticForm& tets, std::vector<std::int64_t> first, const std::vector<double>& bulk,
            std::vector<double> filled);

  // J  of every tet
  double value(const std::vector<double>& J) const;
  void pressures(const std::vector<double>& J, std::vector<double>& pressure) const;  // kPa, of every tet
  PatchStiffness stiffness() const { return {stiffness_, tissue_}; }

 private:
  double mean_ratio(std::size_t p, const std::vector<double>& J) const;

  std::vector<std::int64_t> first_;               // #patches + 1
  std::vector<double> patch_tissue_, stiffness_;  // #patches: mm3; K / V, 0 where the bulk is
  std::vector<double> filled_, tissue_;           // #T: share of a tet, mm3 in it
};

}  // namespace limber
