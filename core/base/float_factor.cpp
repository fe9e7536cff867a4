// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/base/float_factor.h"

#include <algorithm>
#include <cmath>
#include <new>
#include <string>

#include "core/base/error.h"

// The dense kernels of BLAS and LAPACK, in single precision.
extern "C" {
void ssyrk_(const char* half, const char* trans, const int* n, const int* k, const float* alpha, const float* A,
            const int* lda, const float* beta, float* C, const int* ldc);
void sgemm_(const char* trans_a, const char* trans_b, const int* m, const int* n, const int* k, const float* alpha,
            const float* A, const int* lda, const float* B, const int* ldb, const float* beta, float* C,
            const int* ldc);
void spotrf_(const char* half, const int* n, float* A, const int* lda, int* info);
void strsm_(const char* side, const char* half, const char* trans, const char* unit, const int* m, const int* n,
            const float* alpha, const float* A, const int* lda, float* B, const int* ldb);
void strsv_(const char* half, const char* trans, const char* unit, const int* n, const float* A, const int* lda,
            float* x, const int* step);
void sgemv_(const char* trans, const int* m, const int* n, const float* alpha, const float* A, const int* lda,
            const float* x, const int* step_x, const float* beta, float* y, const int* step_y);
}

namespace limber {

namespace {
constexpr float kOne = 1, kMinusOne = -1, kZero = 0;
constexpr int kStep = 1;
// Supernodes with more columns are split, because each panel also stores the unused triangle above its diagonal.
constexpr int kMostColumns = 256;

Supernodes split(const Supernodes& wide) {
  Supernodes result{{0}, {0}, {}};
  for (int s = 0; s < wide.count(); ++s) {
    const auto begin = wide.row.begin() + wide.first_row[s], end = wide.row.begin() + wide.first_row[s + 1];
    for (int c = wide.column[s]; c < wide.column[s + 1];) {
      result.row.insert(result.row.end(), begin + (c - wide.column[s]), end);
      c = std::min(c + kMostColumns, wide.column[s + 1]);
      result.column.push_back(c);
      result.first_row.push_back(std::ssize(result.row));
    }
  }
  return result;
}
}  // namespace

void FloatFactor::analyse(const Supernodes& supernodes) {
  try {
    nodes_ = split(supernodes);
    panel_first_.assign(1, 0);
    for (int s = 0; s < nodes_.count(); ++s)
      panel_first_.push_back(panel_first_.back() + std::int64_t(columns_of(s)) * rows_of(s));
    find_updates();
    if (size() <= room_) return;
    constexpr std::int64_t kSpare = 8;  // 1/8 more memory is allocated than needed: the next structure is similar
    panels_.reset();
    room_ = 0;
    panels_ = std::make_unique_for_overwrite<float[]>(size() + size() / kSpare);
    room_ = size() + size() / kSpare;
  } catch (const std::bad_alloc&) {
    throw Error("not enough memory for a system of " + std::to_string(supernodes.size() / 3) + " mesh nodes",
                "factorization", "use a coarser mesh, or more memory");
  }
}

// Lists the updates of each supernode, in the order of the supernodes that they come from.
void FloatFactor::find_updates() {
  std::vector<int> supernode_of(nodes_.size());
  for (int s = 0; s < nodes_.count(); ++s) std::fill_n(supernode_of.begin() + nodes_.column[s], columns_of(s), s);
  std::int64_t largest = 0;
  const auto for_updates = [&](const auto& body) {
    for (int s = 0; s < nodes_.count(); ++s) {
      const int *rows = nodes_.row.data() + nodes_.first_row[s], count = rows_of(s);
      for (int begin = columns_of(s), end = begin; begin < count; begin = end) {
        const int to = supernode_of[rows[begin]];
        while (end < count && supernode_of[rows[end]] == to) ++end;
        largest = std::max(largest, std::int64_t(count - begin) * (end - begin));
        body(to, Update{s, begin, end});
      }
    }
  };
  update_first_.assign(nodes_.count() + 1, 0);
  for_updates([&](int to, const Update&) { ++update_first_[to + 1]; });
  for (int s = 0; s < nodes_.count(); ++s) update_first_[s + 1] += update_first_[s];
  updates_.resize(update_first_.back());
  std::vector<std::int64_t> next(update_first_.begin(), update_first_.end() - 1);
  for_updates([&](int to, const Update& update) { updates_[next[to]++] = update; });
  product_.resize(largest);
  place_.assign(nodes_.size(), -1);
}

// Sets scale_ to the factors that, applied to rows and columns, make every diagonal entry of the matrix 1.
void FloatFactor::scale_by(const SparseColumns& matrix) {
  scale_.assign(nodes_.size(), 1);
  for (int c = 0; c < nodes_.size(); ++c)
    for (int k = matrix.first[c]; k < matrix.first[c + 1]; ++k)
      if (matrix.row[k] == c && matrix.value[k] > 0) scale_[c] = 1 / std::sqrt(matrix.value[k]);
}

// Writes the scaled matrix's entries to the panel of a supernode, and the positions of its rows to place_.
void FloatFactor::fill(int s, const SparseColumns& matrix) {
  for (auto k = nodes_.first_row[s]; k < nodes_.first_row[s + 1]; ++k)
    place_[nodes_.row[k]] = static_cast<int>(k - nodes_.first_row[s]);
  float* panel = panels_.get() + panel_first_[s];
  std::fill(panel, panels_.get() + panel_first_[s + 1], 0.0f);
  for (int c = nodes_.column[s]; c < nodes_.column[s + 1]; ++c, panel += rows_of(s))
    for (int k = matrix.first[c]; k < matrix.first[c + 1]; ++k)
      if (matrix.row[k] >= c)
        panel[place_[matrix.row[k]]] = static_cast<float>(matrix.value[k] * scale_[c] * scale_[matrix.row[k]]);
}

// Subtracts from a supernode's panel the updates from all earlier supernodes, which are products of their panels.
void FloatFactor::add_updates(int s) {
  float* panel = panels_.get() + panel_first_[s];
  const std::int64_t stride = rows_of(s);
  for (auto u = update_first_[s]; u < update_first_[s + 1]; ++u) {
    const Update& update = updates_[u];
    const int *rows = nodes_.row.data() + nodes_.first_row[update.from] + update.begin,
              row_count = rows_of(update.from);
    const int columns = update.end - update.begin, height = row_count - update.begin, below = row_count - update.end,
              inner = columns_of(update.from);
    const float* from = panels_.get() + panel_first_[update.from] + update.begin;
    // In the rows of the diagonal only the lower triangle is computed.
    ssyrk_("L", "N", &columns, &inner, &kOne, from, &row_count, &kZero, product_.data(), &height);
    if (below > 0)
      sgemm_("N", "T", &below, &columns, &inner, &kOne, from + columns, &row_count, from, &row_count, &kZero,
             product_.data() + columns, &height);
    for (int c = 0; c < columns; ++c) {
      float* to = panel + stride * (rows[c] - nodes_.column[s]);
      const float* by = product_.data() + std::int64_t(c) * height;
      for (int r = c; r < height; ++r) to[place_[rows[r]]] -= by[r];
    }
  }
}

// Factorizes the panel of a supernode after all updates were subtracted from it. Returns false when the panel's
// diagonal block is not positive definite.
bool FloatFactor::finish(int s) {
  float* panel = panels_.get() + panel_first_[s];
  const int rows = rows_of(s), columns = columns_of(s), below = rows - columns;
  int info = 0;
  spotrf_("L", &columns, panel, &rows, &info);
  if (info != 0) return false;
  if (below > 0) strsm_("R", "L", "T", "N", &below, &columns, &kOne, panel, &rows, panel + columns, &rows);
  return true;
}

bool FloatFactor::factorize(const SparseColumns& matrix) {
  scale_by(matrix);
  for (int s = 0; s < nodes_.count(); ++s) {
    fill(s, matrix);
    add_updates(s);
    if (!finish(s)) return false;
  }
  return true;
}

void FloatFactor::solve(std::span<const double> b, std::span<double> x) {
  // The right side is scaled to numbers of at most 1, so that none leaves the range of single precision.
  double largest = 0;
  for (int i = 0; i < nodes_.size(); ++i) largest = std::max(largest, std::abs(b[i] * scale_[i]));
  if (!(largest > 0)) {
    std::fill(x.begin(), x.end(), 0.0);
    return;
  }
  x_.resize(nodes_.size());
  below_.resize(nodes_.size());
  for (int i = 0; i < nodes_.size(); ++i) x_[i] = static_cast<float>(b[i] * scale_[i] / largest);

  for (int s = 0; s < nodes_.count(); ++s) {
    const float* panel = panels_.get() + panel_first_[s];
    const int* rows = nodes_.row.data() + nodes_.first_row[s];
    const int row_count = static_cast<int>(nodes_.first_row[s + 1] - nodes_.first_row[s]);
    const int columns = nodes_.column[s + 1] - nodes_.column[s], below = row_count - columns;
    float* own = x_.data() + nodes_.column[s];
    strsv_("L", "N", "N", &columns, panel, &row_count, own, &kStep);
    if (below == 0) continue;
    sgemv_("N", &below, &columns, &kOne, panel + columns, &row_count, own, &kStep, &kZero, below_.data(), &kStep);
    for (int r = 0; r < below; ++r) x_[rows[columns + r]] -= below_[r];
  }
  for (int s = nodes_.count() - 1; s >= 0; --s) {
    const float* panel = panels_.get() + panel_first_[s];
    const int* rows = nodes_.row.data() + nodes_.first_row[s];
    const int row_count = static_cast<int>(nodes_.first_row[s + 1] - nodes_.first_row[s]);
    const int columns = nodes_.column[s + 1] - nodes_.column[s], below = row_count - columns;
    float* own = x_.data() + nodes_.column[s];
    for (int r = 0; r < below; ++r) below_[r] = x_[rows[columns + r]];
    if (below > 0)
      sgemv_("T", &below, &columns, &kMinusOne, panel + columns, &row_count, below_.data(), &kStep, &kOne, own, &kStep);
    strsv_("L", "T", "N", &columns, panel, &row_count, own, &kStep);
  }
  for (int i = 0; i < nodes_.size(); ++i) x[i] = x_[i] * scale_[i] * largest;
}

}  // namespace limber
