// SPDX-License-Identifier: AGPL-3.0-or-later
// Whether rays through a body take too long for a moving picture, by what its pictures took. With hysteresis, so that a
// picture does not go to and fro between rays and triangles.
#pragma once

namespace limber::render {

class Slowness {
 public:
  static constexpr double kBudget = 0.028;  // s that a picture may take while something moves
  static constexpr int kSharp = 2;          // pixels each way: a picture coarser than that is not worth its rays

  //   seconds  that rays took
  //   scale    pixels each way for each of them
  void measured(double seconds, int scale) {
    const double sharp = seconds * scale * scale / (kSharp * kSharp);
    slow_ = sharp > (slow_ ? 0.6 : 1.0) * kBudget;
  }
  bool slow() const { return slow_; }

 private:
  bool slow_ = false;
};

}  // namespace limber::render
