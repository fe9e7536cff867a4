// SPDX-License-Identifier: AGPL-3.0-or-later
// A sparse supernodal Cholesky factor in single precision, which takes half the memory and half the time of one in
// double precision. It is too inexact to solve a system by itself: it serves as the preconditioner of conjugate
// gradients in double precision (cholesky.h). The matrix is scaled to a diagonal of ones before it is rounded, so that
// stiff and soft parts keep the same number of digits. The method is left-looking: each supernode, a group of columns
// with the same rows, collects the updates from all supernodes before it [Ng & Peyton 1993, SIAM J. Sci. Comput. 14].
// All work runs on one thread.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace limber {

// The structure of a supernodal factor. The columns of supernode s are [column[s], column[s + 1]). Its rows, in rising
// order and beginning with its own columns, are row[first_row[s] .. first_row[s + 1]).
struct Supernodes {
  std::vector<int> column;              // first column of each supernode; one more entry gives the end of the last one
  std::vector<std::int64_t> first_row;  // for each supernode, index of its first entry in `row`; one more gives the end
  std::vector<int> row;

  int count() const { return static_cast<int>(column.size()) - 1; }
  int size() const { return column.empty() ? 0 : column.back(); }  // rows of the matrix
};

// A symmetric matrix in compressed columns. Only entries on and below the diagonal are used.
struct SparseColumns {
  std::span<const int> first;  // #columns + 1 indices into `row` and `value`
  std::span<const int> row;
  std::span<const double> value;
};

class FloatFactor {
 public:
  // Sets the structure, the positions of entries, that the factors of all later matrices have. Throws Error when memory
  // does not suffice.
  void analyse(const Supernodes& supernodes);
  // Factorizes a matrix, whose entries must lie in the structure. Returns false when it is not positive definite in
  // single precision; then solve() must not be called.
  bool factorize(const SparseColumns& matrix);
  // Solves the factorized system approximately. Both lists have one number for each row, and may be the same list.
  void solve(std::span<const double> b, std::span<double> x);

  // Returns how many numbers the factor has, 4 bytes each.
  std::int64_t size() const { return panel_first_.empty() ? 0 : panel_first_.back(); }

 private:
  // The contribution of one supernode to a later one: its rows [begin, end) are columns of the later supernode.
  struct Update {
    int from;
    int begin, end;
  };
  int columns_of(int s) const { return nodes_.column[s + 1] - nodes_.column[s]; }
  int rows_of(int s) const { return static_cast<int>(nodes_.first_row[s + 1] - nodes_.first_row[s]); }
  void find_updates();
  void scale_by(const SparseColumns& matrix);
  void fill(int s, const SparseColumns& matrix);
  void add_updates(int s);
  bool finish(int s);

  Supernodes nodes_;
  // For each supernode, the first of its numbers in panels_: rows x columns, column by column.
  std::vector<std::int64_t> panel_first_;
  std::vector<std::int64_t> update_first_;  // for each supernode, the first of its updates
  std::vector<Update> updates_;
  std::unique_ptr<float[]> panels_;
  std::int64_t room_ = 0;      // number of numbers that panels_ has memory for
  std::vector<double> scale_;  // factor by which each row and column is scaled: 1 / sqrt(diagonal entry)
  // Working memory: the position of each row in the supernode that is being computed, a product of two panels, and the
  // vectors of solve().
  std::vector<int> place_;
  std::vector<float> product_, x_, below_;
};

}  // namespace limber
