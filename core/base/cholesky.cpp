// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/base/cholesky.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <string>
#include <utility>

#include <cholmod.h>

#include "core/base/error.h"
#include "core/base/float_factor.h"
#include "core/platform/memory_pages.h"
#include "core/platform/module.h"

// Declares two functions of the OpenMP runtime with which CHOLMOD is linked.
extern "C" void omp_set_max_active_levels(int);
extern "C" int omp_get_max_active_levels(void);

namespace limber {

namespace {
// A new elimination order is computed if a larger share of the nodes would have to move when the previous order is
// adapted to a new graph.
constexpr double kMostMended = 0.125;
// A factor with more numbers than this is refused, as if memory did not suffice: CHOLMOD counts the numbers by int.
constexpr std::size_t kMostNumbers = INT32_MAX;
// A new elimination order is computed if a factorization with the adapted order takes more operations than this
// multiple of those with the last new order.
constexpr double kDearer = 1.16;
constexpr double kAccuracy = 1e-10;  // conjugate gradients end when the error is below this share of the solution
// Conjugate gradients that have not converged after so many iterations show that single precision does not suffice.
constexpr int kMostIterations = 24;

// Limits CHOLMOD to the calling thread, by forbidding active OpenMP regions. Debian's CHOLMOD would start four threads
// inside a factorization, which doubles its time on few cores.
class OneThread {
 public:
  OneThread() : before_(omp_get_max_active_levels()) { omp_set_max_active_levels(0); }
  ~OneThread() { omp_set_max_active_levels(before_); }
  OneThread(const OneThread&) = delete;
  OneThread& operator=(const OneThread&) = delete;

 private:
  int before_;
};

// Makes OpenBLAS allocate its working memory. OpenBLAS does so at its first call, and retries forever when memory does
// not suffice. So this function first checks that enough memory can be mapped, and then makes the first call.
void require_blas_memory() {
  static const bool has_memory = [] {
    // Free address space that is required, bytes. OpenBLAS takes 128 MB.
    constexpr std::size_t kMost = std::size_t{160} << 20;
    if (!can_map(kMost))
      throw Error("not enough memory for the solver", "factorization", "use a coarser mesh, or more memory");
    using Factorize = void (*)(const char* half, const int* n, double* A, const int* lda, int* info);
    if (const auto factorize = reinterpret_cast<Factorize>(symbol_of_program("dpotrf_"))) {
      constexpr int kSize = 1;
      double one = 1;
      int info = 0;
      factorize("L", &kSize, &one, &kSize, &info);
    }
    return true;
  }();
  assert(has_memory);
  static_cast<void>(has_memory);
}

// Returns the pattern of a symmetric sparse matrix without values, given by its lower triangle: `row` lists the rows of
// the entries column by column, and column[c] is the index in `row` of the first entry of column c.
cholmod_sparse pattern_of(std::vector<int>& column, std::vector<int>& row) {
  cholmod_sparse A{};
  A.nrow = A.ncol = column.size() - 1;
  A.nzmax = row.size();
  A.p = column.data();
  A.i = row.data();
  A.stype = -1;
  A.itype = CHOLMOD_INT;
  A.xtype = CHOLMOD_PATTERN;
  A.dtype = CHOLMOD_DOUBLE;
  A.sorted = A.packed = 1;
  return A;
}
}  // namespace

void BlockGraphBuilder::add(std::span<const int> element) {
  for (int node : element)
    if (node >= 0) node_.push_back(node);
  first_.push_back(std::ssize(node_));
}

BlockGraph BlockGraphBuilder::build(const BlockGraph& base) const {
  // Lists the elements that contain each node: those of node i are element[first[i]] to element[first[i + 1] - 1].
  std::vector<std::int64_t> first(node_count_ + 1, 0);
  for (int node : node_) ++first[node + 1];
  for (int i = 0; i < node_count_; ++i) first[i + 1] += first[i];
  std::vector<int> element(node_.size());
  std::vector<std::int64_t> next(first.begin(), first.end() - 1);
  for (int e = 0; e + 1 < int(first_.size()); ++e)
    for (auto k = first_[e]; k < first_[e + 1]; ++k) element[next[node_[k]]++] = e;

  BlockGraph graph;
  graph.first.reserve(node_count_ + 1);
  std::vector<int> seen_by(node_count_, -1);
  for (int i = 0; i < node_count_; ++i) {
    seen_by[i] = i;
    const auto begin = std::ssize(graph.neighbour);
    if (base.node_count() > 0) {
      graph.neighbour.insert(graph.neighbour.end(), base.neighbour.begin() + base.first[i],
                             base.neighbour.begin() + base.first[i + 1]);
      if (first[i] == first[i + 1]) {
        graph.first.push_back(std::ssize(graph.neighbour));
        continue;
      }
      for (auto k = begin; k < std::ssize(graph.neighbour); ++k) seen_by[graph.neighbour[k]] = i;
    }
    for (auto k = first[i]; k < first[i + 1]; ++k)
      for (auto n = first_[element[k]]; n < first_[element[k] + 1]; ++n)
        if (std::exchange(seen_by[node_[n]], i) != i) graph.neighbour.push_back(node_[n]);
    std::sort(graph.neighbour.begin() + begin, graph.neighbour.end());
    graph.first.push_back(std::ssize(graph.neighbour));
  }
  return graph;
}

struct Cholesky::Factor {
  cholmod_common common;
  cholmod_factor* factor = nullptr;
  cholmod_dense *solution = nullptr, *work_y = nullptr, *work_e = nullptr;
  double operations = 0;

  int node_count = 0;
  std::vector<int> rank;                     // position of each node in the elimination order
  std::vector<int> parent;                   // for each rank, the parent's rank in the elimination tree; #nodes
  double fresh_operations = 0;               // operations of a factorization of the node graph with the last new order
  std::vector<std::int64_t> below_first{0};  // for each rank, the index in `below` of its first entry; #nodes + 1
  std::vector<int> below;        // ranks of the block rows below the diagonal, rising within each block column
  std::vector<int> column, row;  // positions of the matrix's entries in compressed columns, by rank
  std::vector<double> value, right_side;
  FloatFactor single;
  bool is_double = false;  // true: the matrix is factorized in double precision
  int repeated = 0;        // number of factorizations that were repeated in double precision
  std::vector<double> x, residual, better, way, image;  // vectors of the conjugate gradients, by rank
  std::unique_ptr<double[]> room;                       // memory for the numbers of the factor in double precision
  std::size_t room_size = 0;

  Factor() {
    cholmod_start(&common);
    common.print = 0;
    common.quick_return_if_not_posdef = true;
  }
  ~Factor() {
    cholmod_free_dense(&solution, &common);
    cholmod_free_dense(&work_y, &common);
    cholmod_free_dense(&work_e, &common);
    free_factor();
    cholmod_finish(&common);
  }
  Factor(const Factor&) = delete;
  Factor& operator=(const Factor&) = delete;

  // Throws Error if the last call of CHOLMOD failed (negative status). The message names lack of memory as the cause,
  // because no other failure depends on the input.
  void require(const char* what) const {
    if (common.status >= 0) return;
    throw Error("not enough memory for a system of " + std::to_string(node_count) + " mesh nodes",
                std::string(what) + " (CHOLMOD status " + std::to_string(common.status) + ")",
                "use a coarser mesh, or more memory");
  }

  struct FreeFactor {
    cholmod_common* common;
    void operator()(cholmod_factor* factor) const { cholmod_free_factor(&factor, common); }
  };
  using Analysed = std::unique_ptr<cholmod_factor, FreeFactor>;
  Analysed order(const BlockGraph& graph);
  void expand(const BlockGraph& graph);
  void expand(const cholmod_factor& nodes);
  void take_room();
  void free_factor();
  SparseColumns matrix() const { return {column, row, value}; }
  void multiply(std::span<const double> by, std::span<double> product) const;
  bool factorize_in_double();
  void solve_in_double();
  bool iterate();
};

// Orders the nodes by the previous order, adapted to the graph, or by a new nested dissection. A postorder of the
// elimination tree follows, so that supernodes (groups of columns with equal pattern) are contiguous. Returns the
// analysed factor of the node graph, which has one row per node.
Cholesky::Factor::Analysed Cholesky::Factor::order(const BlockGraph& graph) {
  std::vector<int> node_column{0}, node_row;
  node_count = graph.node_count();
  node_row.reserve(graph.neighbour.size() / 2 + node_count);
  for (int i = 0; i < node_count; ++i) {
    node_row.push_back(i);
    for (auto k = graph.first[i]; k < graph.first[i + 1]; ++k)
      if (graph.neighbour[k] > i) node_row.push_back(graph.neighbour[k]);
    node_column.push_back(int(node_row.size()));
  }
  cholmod_sparse A = pattern_of(node_column, node_row);
  common.nmethods = 1;
  common.postorder = true;
  common.supernodal = CHOLMOD_SUPERNODAL;

  std::vector<int> given;
  if (std::ssize(rank) == node_count) given = mended_order(graph, rank, parent, kMostMended);
  Analysed nodes(nullptr, FreeFactor{&common});
  double by_nodes = INFINITY;  // operations of a factorization of the node graph with the chosen order
  if (!given.empty()) {
    common.method[0].ordering = CHOLMOD_GIVEN;
    nodes.reset(cholmod_analyze_p(&A, given.data(), nullptr, 0, &common));
    require("ordering");
    by_nodes = common.fl;
  }
  if (by_nodes > kDearer * fresh_operations) {
    common.method[0].ordering = CHOLMOD_METIS;
    Analysed fresh(cholmod_analyze(&A, &common), FreeFactor{&common});
    require("ordering");
    if (common.fl < by_nodes) nodes.swap(fresh);
    fresh_operations = by_nodes = std::min(common.fl, by_nodes);
  }
  operations = 27 * by_nodes;

  std::vector<int> new_rank(node_count);
  for (int k = 0; k < node_count; ++k) new_rank[static_cast<int*>(nodes->Perm)[k]] = k;
  parent = elimination_tree(graph, new_rank);
  rank = std::move(new_rank);
  return nodes;
}

void Cholesky::Factor::expand(const BlockGraph& graph) {
  const int n = graph.node_count();
  below_first.assign(1, 0);
  below.clear();
  row.clear();
  std::vector<int> node_of(n);
  for (int i = 0; i < n; ++i) node_of[rank[i]] = i;
  for (int r = 0; r < n; ++r) {
    const int i = node_of[r];
    const auto begin = std::ssize(below);
    for (auto k = graph.first[i]; k < graph.first[i + 1]; ++k)
      if (rank[graph.neighbour[k]] > r) below.push_back(rank[graph.neighbour[k]]);
    std::sort(below.begin() + begin, below.end());
    below_first.push_back(std::ssize(below));
  }

  const std::int64_t entries = 9 * (n + std::ssize(below));
  if (entries > std::int64_t{1} << 30) common.status = CHOLMOD_TOO_LARGE;
  require("assembly");
  column.assign(1, 0);
  row.reserve(entries);
  for (int r = 0; r < n; ++r)
    for (int c = 0; c < 3; ++c) {
      for (int k = 0; k < 3; ++k) row.push_back(3 * r + k);
      for (auto b = below_first[r]; b < below_first[r + 1]; ++b)
        for (int k = 0; k < 3; ++k) row.push_back(3 * below[b] + k);
      column.push_back(int(row.size()));
    }
  value.assign(entries, 0);
}

// Expands the analysed factor `nodes`, which has one row and column per node, to three rows and columns per node: the
// three rows of each node have the same pattern. An analysis of the node graph takes a ninth of the time of an analysis
// of all rows.
void Cholesky::Factor::expand(const cholmod_factor& nodes) {
  factor = cholmod_allocate_factor(3 * nodes.n, &common);
  require("analysis");
  const auto numbers = [&](std::size_t count) {
    auto* result = static_cast<int*>(cholmod_malloc(count, sizeof(int), &common));
    require("analysis");
    return result;
  };
  factor->is_ll = factor->is_super = 1;
  factor->nsuper = nodes.nsuper;
  factor->ssize = 3 * nodes.ssize;
  factor->xsize = 9 * nodes.xsize;
  factor->maxcsize = 9 * nodes.maxcsize;
  factor->maxesize = 3 * nodes.maxesize;
  if (factor->xsize > kMostNumbers) common.status = CHOLMOD_TOO_LARGE;
  require("analysis");
  const auto scaled = [&](const void* from, std::size_t count, int by) {
    int* to = numbers(count);
    std::transform(static_cast<const int*>(from), static_cast<const int*>(from) + count, to,
                   [by](int value) { return by * value; });
    return to;
  };
  factor->super = scaled(nodes.super, nodes.nsuper + 1, 3);
  factor->pi = scaled(nodes.pi, nodes.nsuper + 1, 3);
  factor->px = scaled(nodes.px, nodes.nsuper + 1, 9);
  auto* rows = numbers(factor->ssize);
  factor->s = rows;
  for (std::size_t k = 0; k < nodes.ssize; ++k)
    for (int c = 0; c < 3; ++c) *rows++ = 3 * static_cast<const int*>(nodes.s)[k] + c;
}

// Gives the factor memory that this class owns and reuses. Memory that CHOLMOD allocates itself would return to the
// system at each analysis.
void Cholesky::Factor::take_room() {
  constexpr std::size_t kSpare = 8;  // 1/8 more memory is allocated than needed, because the next graph is similar
  if (factor->xsize > room_size) try {
      room.reset();
      room_size = factor->xsize + factor->xsize / kSpare;
      room = std::make_unique_for_overwrite<double[]>(room_size);
    } catch (const std::bad_alloc&) {
      room_size = 0;
      common.status = CHOLMOD_OUT_OF_MEMORY;
      require("factorization");
    }
  factor->x = room.get();
  factor->xtype = CHOLMOD_REAL;
  factor->dtype = CHOLMOD_DOUBLE;
}

void Cholesky::Factor::free_factor() {
  if (factor && factor->xtype != CHOLMOD_PATTERN) {
    factor->x = nullptr;
    factor->xtype = CHOLMOD_PATTERN;
  }
  cholmod_free_factor(&factor, &common);
}

Cholesky::Cholesky(const BlockGraph& graph) : factor_(std::make_unique<Factor>()) { analyse(graph); }

void Cholesky::analyse(const BlockGraph& graph) {
  const OneThread one_thread;
  factor_->free_factor();
  const Factor::Analysed nodes = factor_->order(graph);
  factor_->expand(graph);
  factor_->expand(*nodes);
  require_blas_memory();
  const cholmod_factor& factor = *factor_->factor;
  const auto numbers = [](const void* from, std::size_t count) {
    return std::span(static_cast<const int*>(from), count);
  };
  const auto columns = numbers(factor.super, factor.nsuper + 1), first_rows = numbers(factor.pi, factor.nsuper + 1),
             rows = numbers(factor.s, factor.ssize);
  factor_->single.analyse(
      {{columns.begin(), columns.end()}, {first_rows.begin(), first_rows.end()}, {rows.begin(), rows.end()}});
}

Cholesky::~Cholesky() = default;
Cholesky::Cholesky(Cholesky&&) noexcept = default;
Cholesky& Cholesky::operator=(Cholesky&&) noexcept = default;

int Cholesky::node_count() const { return int(factor_->rank.size()); }
int Cholesky::rank(int node) const { return factor_->rank[node]; }

Cholesky::Place Cholesky::place(int row, int column) const {
  const int r = factor_->rank[row], c = factor_->rank[column];
  const auto begin = factor_->below_first[c], end = factor_->below_first[c + 1];
  const std::int64_t stride = 3 * (1 + end - begin);
  const std::int64_t first = factor_->column[3 * c];
  if (r == c) return {first, stride};
  const auto at = std::lower_bound(factor_->below.begin() + begin, factor_->below.begin() + end, r);
  if (at == factor_->below.begin() + end || *at != r) return {-1, 0};
  return {first + 3 * (1 + (at - factor_->below.begin() - begin)), stride};
}

void Cholesky::places(std::span<const int> nodes, Place* places) const {
  const auto place_of = [&](std::size_t row, std::size_t column) -> Place& {
    return places[row * (row + 1) / 2 + column];
  };
  for (std::size_t j = 0; j < nodes.size(); ++j) {
    if (nodes[j] < 0) {
      for (std::size_t i = j; i < nodes.size(); ++i) place_of(i, j) = {-1, 0};
      continue;
    }
    const int c = factor_->rank[nodes[j]];
    const int *begin = factor_->below.data() + factor_->below_first[c],
              *end = factor_->below.data() + factor_->below_first[c + 1];
    const std::int64_t stride = 3 * (1 + end - begin), first = factor_->column[3 * c];
    place_of(j, j) = {first, stride};
    const int* at = begin;  // moves forward only: `below` and `nodes` are both sorted by rank
    for (std::size_t i = j + 1; i < nodes.size(); ++i) {
      const int r = factor_->rank[nodes[i]];
      while (at != end && *at < r) ++at;
      place_of(i, j) = at != end && *at == r ? Place{first + 3 * (1 + (at - begin)), stride} : Place{-1, 0};
    }
  }
}

std::span<double> Cholesky::values() { return factor_->value; }
void Cholesky::clear() { std::fill(factor_->value.begin(), factor_->value.end(), 0.0); }

bool Cholesky::factorize() {
  const OneThread one_thread;
  factor_->is_double = false;
  return factor_->single.factorize(factor_->matrix()) || factor_->factorize_in_double();
}

bool Cholesky::Factor::factorize_in_double() {
  is_double = true;
  ++repeated;
  cholmod_sparse A = pattern_of(column, row);
  A.x = value.data();
  A.xtype = CHOLMOD_REAL;
  common.status = CHOLMOD_OK;
  if (factor->xtype == CHOLMOD_PATTERN) take_room();
  cholmod_factorize(&A, factor, &common);
  require("factorization");
  return common.status != CHOLMOD_NOT_POSDEF && factor->minor == factor->n;
}

void Cholesky::Factor::solve_in_double() {
  cholmod_dense B{};
  B.nrow = B.d = B.nzmax = right_side.size();
  B.ncol = 1;
  B.x = right_side.data();
  B.xtype = CHOLMOD_REAL;
  B.dtype = CHOLMOD_DOUBLE;
  cholmod_solve2(CHOLMOD_A, factor, &B, nullptr, &solution, nullptr, &work_y, &work_e, &common);
  require("solution");
  std::copy_n(static_cast<const double*>(solution->x), right_side.size(), x.begin());
}

// Multiplies the matrix, of which the lower triangle is stored, by a vector.
void Cholesky::Factor::multiply(std::span<const double> by, std::span<double> product) const {
  std::fill(product.begin(), product.end(), 0.0);
  for (std::size_t c = 0; c + 1 < column.size(); ++c) {
    const double own = by[c];
    double sum = 0;
    for (int k = column[c]; k < column[c + 1]; ++k) {
      const std::size_t r = row[k];
      if (r < c) continue;
      product[r] += value[k] * own;
      if (r > c) sum += value[k] * by[r];
    }
    product[c] += sum;
  }
}

// Solves for `right_side` by conjugate gradients, preconditioned by the factor in single precision. The solution is in
// `x`. Returns false when the iterations do not converge, or show that the matrix is not positive definite.
bool Cholesky::Factor::iterate() {
  const auto dot = [](const std::vector<double>& a, const std::vector<double>& b) {
    double sum = 0;
    for (std::size_t i = 0; i < a.size(); ++i) sum += a[i] * b[i];
    return sum;
  };
  std::fill(x.begin(), x.end(), 0.0);
  residual = right_side;
  image.resize(x.size());
  better.resize(x.size());
  single.solve(residual, better);
  way = better;
  // The dot product of the residual and the preconditioned residual is about the squared energy of the error.
  double error = dot(residual, better);
  if (!std::isfinite(error)) return false;
  const double enough = kAccuracy * kAccuracy * error;
  for (int k = 0; error > enough; ++k) {
    if (k == kMostIterations) return false;
    multiply(way, image);
    const double bend = dot(way, image);
    if (!(bend > 0)) return false;
    const double length = error / bend;
    for (std::size_t i = 0; i < x.size(); ++i) {
      x[i] += length * way[i];
      residual[i] -= length * image[i];
    }
    single.solve(residual, better);
    // Uses the change of the residual, not the whole residual (Polak-Ribiere), because the preconditioner is inexact.
    const double next = dot(residual, better);
    double turned = 0;
    for (std::size_t i = 0; i < x.size(); ++i) turned -= length * image[i] * better[i];
    for (std::size_t i = 0; i < x.size(); ++i) way[i] = better[i] + turned / error * way[i];
    error = next;
  }
  return error >= 0;
}

bool Cholesky::solve(std::span<double> b) {
  const OneThread one_thread;
  const int n = node_count();
  assert(std::ssize(b) == 3 * n);
  auto& right = factor_->right_side;
  right.resize(3 * n);
  factor_->x.resize(3 * n);
  for (int i = 0; i < n; ++i) std::copy_n(&b[3 * i], 3, &right[3 * rank(i)]);
  if (!factor_->is_double && !factor_->iterate() && !factor_->factorize_in_double()) return false;
  if (factor_->is_double) factor_->solve_in_double();
  for (int i = 0; i < n; ++i) std::copy_n(&factor_->x[3 * rank(i)], 3, &b[3 * i]);
  return true;
}

std::int64_t Cholesky::factor_size() const { return factor_->single.size(); }
int Cholesky::repeated_in_double() const { return factor_->repeated; }
double Cholesky::factor_operations() const { return factor_->operations; }

}  // namespace limber
