#include "dem/supernodal_factor.h"

#include "dem/factor_strips.h"
#include "dem/one_thread.h"

#include <cholmod.h>

#include <algorithm>
#include <optional>
#include <stdexcept>
#include <variant>

namespace dem {

struct SupernodalFactor::Data {
  SymmetricPattern pattern;
  cholmod_common common;
  cholmod_factor* factor = nullptr;
  std::vector<int> position;     ///< of each unknown in the order of the factor
  std::vector<int> supernode_of; ///< of each column of the factor
  std::vector<int> parent;       ///< of each supernode, -1 at a root
  std::variant<std::monostate, FactorStrips<double>, FactorStrips<float>> strips;
  mutable std::vector<Lanes> work; ///< scratch, zero between calls

  /// Calls a function with the strips, whatever they are stored in.
  template <typename Work>
  void with_strips(Work&& use) const
  {
    if (const auto* full = std::get_if<FactorStrips<double>>(&strips))
      use(*full);
    else
      use(std::get<FactorStrips<float>>(strips));
  }

  explicit Data(const SymmetricPattern& p) : pattern(p)
  {
    cholmod_start(&common);
    common.supernodal = CHOLMOD_SUPERNODAL;
    common.nmethods = 1;
    common.method[0].ordering = CHOLMOD_NESDIS;
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
  /// Its dense block, stored by columns: the triangle first, then the rows below.
  const double* block(int s) const
  {
    return static_cast<const double*>(factor->x) + static_cast<const int*>(factor->px)[s];
  }
};

SupernodalFactor::SupernodalFactor(const SymmetricPattern& pattern, FactorPrecision precision)
    : data_(std::make_unique<Data>(pattern))
{
  Data& d = *data_;
  const OneThread one_thread;
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
  std::vector<int> n_columns, n_rows;
  for (int s = 0; s < d.n_supernodes(); ++s) {
    n_columns.push_back(d.n_columns(s));
    n_rows.push_back(int(d.rows(s).size()));
  }
  if (precision == FactorPrecision::full)
    d.strips.emplace<FactorStrips<double>>(std::move(n_columns), std::move(n_rows));
  else
    d.strips.emplace<FactorStrips<float>>(std::move(n_columns), std::move(n_rows));
}

SupernodalFactor::~SupernodalFactor() = default;
SupernodalFactor::SupernodalFactor(SupernodalFactor&&) noexcept = default;
SupernodalFactor& SupernodalFactor::operator=(SupernodalFactor&&) noexcept = default;

bool SupernodalFactor::factorise(std::span<const double> values)
{
  const OneThread one_thread;
  cholmod_sparse a = data_->matrix(values.data());
  cholmod_factorize(&a, data_->factor, &data_->common);
  if (data_->common.status == CHOLMOD_OUT_OF_MEMORY)
    throw std::runtime_error("the factorisation failed: not enough memory");
  if (data_->common.status != CHOLMOD_OK)
    return false;
  const auto store = [&](auto& strips) {
    for (int s = 0; s < data_->n_supernodes(); ++s)
      strips.store(s, data_->block(s));
  };
  if (auto* full = std::get_if<FactorStrips<double>>(&data_->strips))
    store(*full);
  else
    store(std::get<FactorStrips<float>>(data_->strips));
  return true;
}

SupernodalFactor::SparseColumns
SupernodalFactor::half_solve(std::span<const Index> rows,
                             const Eigen::Ref<const Eigen::MatrixXd>& entries) const
{
  const Data& d = *data_;
  SparseColumns result;
  result.n_columns = int(entries.cols());
  for (const Index row : rows)
    for (int s = d.supernode_of[d.position[row]]; s >= 0; s = d.parent[s])
      result.supernode.push_back(s);
  std::ranges::sort(result.supernode);
  result.supernode.erase(std::unique(result.supernode.begin(), result.supernode.end()),
                         result.supernode.end());
  std::vector<Lanes>& work = d.work;
  work.resize(std::size_t(d.pattern.size()), no_lanes());
  for (std::size_t r = 0; r < rows.size(); ++r)
    for (Eigen::Index c = 0; c < entries.cols(); ++c)
      work[d.position[rows[r]]][c] += entries(Eigen::Index(r), c);
  std::vector<Lanes> front;
  for (const int s : result.supernode) {
    const std::span<const int> row = d.rows(s);
    front.assign(row.size() + front_padding, no_lanes());
    for (std::size_t r = 0; r < row.size(); ++r)
      front[r] = work[row[r]];
    d.with_strips([&](const auto& strips) { strips.eliminate(s, front.data()); });
    const int n = d.n_columns(s);
    result.first_row.push_back(int(result.row.size()));
    result.row.insert(result.row.end(), front.begin(), front.begin() + n);
    std::fill_n(work.begin() + d.first_column(s), n, no_lanes());
    for (std::size_t r = std::size_t(n); r < row.size(); ++r)
      work[row[r]] = front[r];
  }
  return result;
}

namespace {

/// Zeros for a front and its padding, on the boundary of a register.
double* zero_front(std::vector<Lanes>& memory, std::size_t n_rows)
{
  memory.assign((n_rows + front_padding) / n_lanes + 1, no_lanes());
  return reinterpret_cast<double*>(memory.data());
}

} // namespace

Eigen::VectorXd SupernodalFactor::half_solve(const Eigen::VectorXd& b) const
{
  const Data& d = *data_;
  Eigen::VectorXd y(b.size());
  for (Eigen::Index i = 0; i < b.size(); ++i)
    y[d.position[i]] = b[i];
  std::vector<Lanes> aligned;
  for (int s = 0; s < d.n_supernodes(); ++s) {
    const std::span<const int> row = d.rows(s);
    double* front = zero_front(aligned, row.size());
    for (std::size_t r = 0; r < row.size(); ++r)
      front[r] = y[row[r]];
    d.with_strips([&](const auto& strips) { strips.eliminate(s, front); });
    for (std::size_t r = 0; r < row.size(); ++r)
      y[row[r]] = front[r];
  }
  return y;
}

Eigen::VectorXd SupernodalFactor::back_solve(Eigen::VectorXd y) const
{
  const Data& d = *data_;
  std::vector<Lanes> aligned;
  for (int s = d.n_supernodes() - 1; s >= 0; --s) {
    const std::span<const int> row = d.rows(s);
    double* front = zero_front(aligned, row.size());
    for (std::size_t r = 0; r < row.size(); ++r)
      front[r] = y[row[r]];
    d.with_strips([&](const auto& strips) { strips.substitute(s, front); });
    std::copy_n(front, d.n_columns(s), y.data() + d.first_column(s));
  }
  Eigen::VectorXd x(y.size());
  for (Eigen::Index i = 0; i < x.size(); ++i)
    x[i] = y[d.position[i]];
  return x;
}

std::span<const int> SupernodalFactor::supernode_starts() const
{
  return {data_->super(), std::size_t(data_->n_supernodes()) + 1};
}

long SupernodalFactor::n_nonzeros() const
{
  return long(data_->common.lnz);
}

} // namespace dem
