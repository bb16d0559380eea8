#include "dem/supernodal_factor.h"

#include <cholmod.h>

#include <algorithm>
#include <stdexcept>

extern "C" {
void openblas_set_num_threads(int);
int openblas_get_num_threads();
}

namespace dem {

namespace {

using Block = Eigen::Map<const Eigen::MatrixXd, 0, Eigen::OuterStride<>>;

/// OpenBLAS on one thread while it lives: with several, sums depend on their number.
struct OneBlasThread {
  int before = openblas_get_num_threads();
  OneBlasThread() { openblas_set_num_threads(1); }
  ~OneBlasThread() { openblas_set_num_threads(before); }
};

} // namespace

struct SupernodalFactor::Data {
  SymmetricPattern pattern;
  cholmod_common common;
  cholmod_factor* factor = nullptr;
  std::vector<int> position;     ///< of each unknown in the order of the factor
  std::vector<int> supernode_of; ///< of each column of the factor
  std::vector<int> parent;       ///< of each supernode, -1 at a root
  mutable Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> work;

  explicit Data(const SymmetricPattern& p) : pattern(p)
  {
    cholmod_start(&common);
    common.supernodal = CHOLMOD_SUPERNODAL;
    common.nmethods = 1;
    common.method[0].ordering = CHOLMOD_METIS;
    common.postorder = 1;
    common.print = 0;
    common.error_handler = nullptr;
  }
  ~Data()
  {
    cholmod_free_factor(&factor, &common);
    cholmod_finish(&common);
  }
  Data(const Data&) = delete;

  cholmod_sparse matrix(const double* values)
  {
    cholmod_sparse a{};
    a.nrow = a.ncol = std::size_t(pattern.size());
    a.nzmax = pattern.row.size();
    a.p = pattern.column_start.data();
    a.i = pattern.row.data();
    a.x = const_cast<double*>(values);
    a.stype = -1;
    a.itype = CHOLMOD_INT;
    a.xtype = values ? CHOLMOD_REAL : CHOLMOD_PATTERN;
    a.dtype = CHOLMOD_DOUBLE;
    a.sorted = a.packed = 1;
    return a;
  }

  int n_supernodes() const { return int(factor->nsuper); }
  const int* super() const { return static_cast<const int*>(factor->super); }
  int first_column(int s) const { return super()[s]; }
  int n_columns(int s) const { return super()[s + 1] - super()[s]; }
  std::span<const int> rows(int s) const
  {
    const int* start = static_cast<const int*>(factor->pi);
    return {static_cast<const int*>(factor->s) + start[s], std::size_t(start[s + 1] - start[s])};
  }
  /// Rows of a supernode times its columns: the triangle first, then the rows below.
  Block block(int s) const
  {
    const auto n_rows = Eigen::Index(rows(s).size());
    const double* values =
        static_cast<const double*>(factor->x) + static_cast<const int*>(factor->px)[s];
    return {values, n_rows, n_columns(s), Eigen::OuterStride<>(n_rows)};
  }
};

SupernodalFactor::SupernodalFactor(const SymmetricPattern& pattern)
    : data_(std::make_unique<Data>(pattern))
{
  Data& d = *data_;
  const OneBlasThread one_thread;
  cholmod_sparse a = d.matrix(nullptr);
  d.factor = cholmod_analyze(&a, &d.common);
  if (!d.factor)
    throw std::runtime_error("the symbolic factorisation failed: not enough memory");
  const int n = pattern.size();
  d.position.resize(n);
  for (int k = 0; k < n; ++k)
    d.position[static_cast<const int*>(d.factor->Perm)[k]] = k;
  d.supernode_of.resize(n);
  for (int s = 0; s < d.n_supernodes(); ++s)
    for (int k = 0; k < d.n_columns(s); ++k)
      d.supernode_of[d.first_column(s) + k] = s;
  d.parent.assign(d.n_supernodes(), -1);
  for (int s = 0; s < d.n_supernodes(); ++s)
    if (const auto rows = d.rows(s); int(rows.size()) > d.n_columns(s))
      d.parent[s] = d.supernode_of[rows[d.n_columns(s)]];
}

SupernodalFactor::~SupernodalFactor() = default;
SupernodalFactor::SupernodalFactor(SupernodalFactor&&) noexcept = default;
SupernodalFactor& SupernodalFactor::operator=(SupernodalFactor&&) noexcept = default;

bool SupernodalFactor::factorise(std::span<const double> values)
{
  const OneBlasThread one_thread;
  cholmod_sparse a = data_->matrix(values.data());
  cholmod_factorize(&a, data_->factor, &data_->common);
  if (data_->common.status == CHOLMOD_OUT_OF_MEMORY)
    throw std::runtime_error("the factorisation failed: not enough memory");
  return data_->common.status == CHOLMOD_OK;
}

SupernodalFactor::SparseColumns
SupernodalFactor::half_solve(std::span<const Index> rows,
                             const Eigen::Ref<const Eigen::MatrixXd>& entries) const
{
  const Data& d = *data_;
  SparseColumns result;
  for (const Index row : rows)
    for (int s = d.supernode_of[d.position[row]]; s >= 0; s = d.parent[s])
      result.supernode.push_back(s);
  std::ranges::sort(result.supernode);
  result.supernode.erase(std::unique(result.supernode.begin(), result.supernode.end()),
                         result.supernode.end());

  const Eigen::Index k = entries.cols();
  auto& work = d.work;
  if (work.cols() != k)
    work.setZero(d.pattern.size(), k);
  for (std::size_t r = 0; r < rows.size(); ++r)
    work.row(d.position[rows[r]]) += entries.row(Eigen::Index(r));
  int n_rows = 0;
  Eigen::MatrixXd top, below;
  for (const int s : result.supernode) {
    const int n = d.n_columns(s);
    const Block block = d.block(s);
    top = work.middleRows(d.first_column(s), n);
    block.topRows(n).triangularView<Eigen::Lower>().solveInPlace(top);
    work.middleRows(d.first_column(s), n) = top;
    below.noalias() = block.bottomRows(block.rows() - n) * top;
    const std::span<const int> row = d.rows(s).subspan(n);
    for (std::size_t r = 0; r < row.size(); ++r)
      work.row(row[r]) -= below.row(Eigen::Index(r));
    result.first_row.push_back(n_rows);
    n_rows += n;
  }
  result.values.resize(n_rows, k);
  for (std::size_t p = 0; p < result.supernode.size(); ++p) {
    const int s = result.supernode[p];
    auto part = work.middleRows(d.first_column(s), d.n_columns(s));
    result.values.middleRows(result.first_row[p], d.n_columns(s)) = part;
    part.setZero();
  }
  return result;
}

Eigen::VectorXd SupernodalFactor::half_solve(const Eigen::VectorXd& b) const
{
  const Data& d = *data_;
  Eigen::VectorXd y(b.size());
  for (Eigen::Index i = 0; i < b.size(); ++i)
    y[d.position[i]] = b[i];
  Eigen::VectorXd below;
  for (int s = 0; s < d.n_supernodes(); ++s) {
    const int n = d.n_columns(s);
    const Block block = d.block(s);
    auto top = y.segment(d.first_column(s), n);
    block.topRows(n).triangularView<Eigen::Lower>().solveInPlace(top);
    below.noalias() = block.bottomRows(block.rows() - n) * top;
    const std::span<const int> row = d.rows(s).subspan(n);
    for (std::size_t r = 0; r < row.size(); ++r)
      y[row[r]] -= below[Eigen::Index(r)];
  }
  return y;
}

Eigen::VectorXd SupernodalFactor::back_solve(Eigen::VectorXd y) const
{
  const Data& d = *data_;
  Eigen::VectorXd below;
  for (int s = d.n_supernodes() - 1; s >= 0; --s) {
    const int n = d.n_columns(s);
    const Block block = d.block(s);
    const std::span<const int> row = d.rows(s).subspan(n);
    below.resize(Eigen::Index(row.size()));
    for (std::size_t r = 0; r < row.size(); ++r)
      below[Eigen::Index(r)] = y[row[r]];
    auto top = y.segment(d.first_column(s), n);
    top.noalias() -= block.bottomRows(block.rows() - n).transpose() * below;
    block.topRows(n).triangularView<Eigen::Lower>().transpose().solveInPlace(top);
  }
  Eigen::VectorXd x(y.size());
  for (Eigen::Index i = 0; i < x.size(); ++i)
    x[i] = y[d.position[i]];
  return x;
}

Eigen::MatrixXd SupernodalFactor::gram(const SparseColumns& a, const SparseColumns& b) const
{
  Eigen::MatrixXd result = Eigen::MatrixXd::Zero(a.values.cols(), b.values.cols());
  for (std::size_t i = 0, j = 0; i < a.supernode.size() && j < b.supernode.size();) {
    if (a.supernode[i] < b.supernode[j])
      ++i;
    else if (a.supernode[i] > b.supernode[j])
      ++j;
    else {
      const int n = data_->n_columns(a.supernode[i]);
      result.noalias() += a.values.middleRows(a.first_row[i++], n).transpose() *
                          b.values.middleRows(b.first_row[j++], n);
    }
  }
  return result;
}

Eigen::VectorXd SupernodalFactor::gram(const SparseColumns& a, const Eigen::VectorXd& y) const
{
  Eigen::VectorXd result = Eigen::VectorXd::Zero(a.values.cols());
  for (std::size_t p = 0; p < a.supernode.size(); ++p) {
    const int s = a.supernode[p], n = data_->n_columns(s);
    result.noalias() +=
        a.values.middleRows(a.first_row[p], n).transpose() * y.segment(data_->first_column(s), n);
  }
  return result;
}

void SupernodalFactor::add(const SparseColumns& a, const Eigen::Ref<const Eigen::VectorXd>& c,
                           Eigen::VectorXd& y) const
{
  for (std::size_t p = 0; p < a.supernode.size(); ++p) {
    const int s = a.supernode[p], n = data_->n_columns(s);
    y.segment(data_->first_column(s), n).noalias() += a.values.middleRows(a.first_row[p], n) * c;
  }
}

long SupernodalFactor::n_nonzeros() const
{
  return long(data_->common.lnz);
}

} // namespace dem
