// SPDX-License-Identifier: AGPL-3.0-or-later
// Computes how a blend moves tissue that follows a turning bone by a share w and a still bone by 1 - w. For every blend
// of two such bones, the tissue's motion in the plane perpendicular to the axis is a rotation and a scaling: a point
// with the complex coordinate q in this plane moves to z(w) q, and its position along the axis stays. If w varies in
// space, the local volume changes by
//
//    det F = |z|^2 + Re(k) (q . grad w) + Im(k) (iq . grad w),     k = conj(z) dz/dw
//
// where q . grad w is the distance from the axis times the slope of w away from the axis, and iq . grad w is the
// distance times the slope of w around the axis. The functions are tabulated from the blend's own rule, so they hold
// for every blend of blend_rule.h.
#pragma once

#include <complex>
#include <vector>

#include "core/deform/skinning.h"

namespace limber {

class TurnTable {
 public:
  // Tabulates |z|^2, Re(k) and Im(k) for one blend and one turn.
  //   angle  angle of the turn, radians, less than pi
  TurnTable(Blend blend, double angle);

  // The tabulated functions at a share w, [0, 1], and their derivatives with respect to w.
  struct Values {
    float volume, away, about;        // the functions |z|^2, Re(k) and Im(k) in the formula of det F
    float volume_w, away_w, about_w;  // derivatives of volume, away and about with respect to w
  };
  Values at(float w) const {
    const float place = w * kSteps;
    const int i = place <= 0 ? 0 : place >= kSteps - 1 ? kSteps - 1 : static_cast<int>(place);
    const float t = place - static_cast<float>(i);
    const Row &a = rows_[i], &b = rows_[i + 1];
    return {a.volume + t * (b.volume - a.volume), a.away + t * (b.away - a.away), a.about + t * (b.about - a.about),
            (b.volume - a.volume) * kSteps,       (b.away - a.away) * kSteps,     (b.about - a.about) * kSteps};
  }
  // Returns the angle by which tissue of share w turns about the axis, radians, and its derivative with respect to w.
  std::pair<double, double> angle_at(double w) const;

 private:
  static constexpr int kSteps = 256;
  struct Row {
    float volume, away, about, angle;
  };
  std::vector<Row> rows_;
};

}  // namespace limber
