#include "dem/supernodal_factor.h"

#include "dem/factor_strips.h"
#include "dem/one_thread.h"

#include <cholmod.h>

#include <algorithm>
#include <optional>
#include <stdexcept>
#include <variant>

namespace dem {

namespace {

/// What CHOLMOD finds out about a pattern.
struct Analysis {
  std::vector<int> position; ///< of each unknown in the order of the factor
  Supernodes nodes;
  long n_nonzeros;
};

cholmod_sparse matrix_of(const SymmetricPattern& pattern)
{
  cholmod_sparse a{};
  a.nrow = a.ncol = std::size_t(pattern.size());
  a.nzmax = pattern.row.size();
  a.p = const_cast<int*>(pattern.column_start.data());
  a.i = const_cast<int*>(pattern.row.data());
  a.stype = -1;
  a.itype = CHOLMOD_INT;
  a.xtype = CHOLMOD_PATTERN;
  a.dtype = CHOLMOD_DOUBLE;
  a.sorted = a.packed = 1;
  return a;
}

Analysis copy_of(const cholmod_factor& factor, const cholmod_common& common)
{
  Analysis result;
  const auto n = int(factor.n), n_supernodes = int(factor.nsuper);
  result.n_nonzeros = long(common.lnz);
  result.position.resize(std::size_t(n));
  for (int k = 0; k < n; ++k)
    result.position[static_cast<const int*>(factor.Perm)[k]] = k;
  const int* super = static_cast<const int*>(factor.super);
  const int* first_row = static_cast<const int*>(factor.pi);
  const int* row = static_cast<const int*>(factor.s);
  Supernodes& nodes = result.nodes;
  nodes.first_column.assign(super, super + n_supernodes + 1);
  nodes.first_row.assign(first_row, first_row + n_supernodes + 1);
  nodes.row.assign(row, row + first_row[n_supernodes]);
  std::vector<int> supernode_of(std::size_t(n), 0);
  for (int s = 0; s < n_supernodes; ++s)
    std::fill(supernode_of.begin() + super[s], supernode_of.begin() + super[s + 1], s);
  nodes.parent.assign(std::size_t(n_supernodes), -1);
  for (int s = 0; s < n_supernodes; ++s)
    if (const auto rows = nodes.rows(s); int(rows.size()) > nodes.n_columns(s))
      nodes.parent[s] = supernode_of[rows[nodes.n_columns(s)]];
  return result;
}

/// \throws std::runtime_error if memory does not suffice
Analysis analyse(const SymmetricPattern& pattern)
{
  const OneThread one_thread;
  cholmod_common common;
  cholmod_start(&common);
  common.supernodal = CHOLMOD_SUPERNODAL;
  common.nmethods = 1;
  common.method[0].ordering = CHOLMOD_NESDIS;
  common.postorder = 1;
  common.print = 0;
  common.error_handler = nullptr;
  cholmod_sparse a = matrix_of(pattern);
  cholmod_factor* factor = cholmod_analyze(&a, &common);
  std::optional<Analysis> result;
  if (factor)
    result = copy_of(*factor, common);
  cholmod_free_factor(&factor, &common);
  cholmod_finish(&common);
  if (!result)
    throw std::runtime_error("the symbolic factorisation failed: not enough memory");
  return std::move(*result);
}

std::vector<int> counts(std::span<const int> first)
{
  std::vector<int> result;
  for (std::size_t s = 0; s + 1 < first.size(); ++s)
    result.push_back(first[s + 1] - first[s]);
  return result;
}

} // namespace

struct SupernodalFactor::Data {
  std::vector<int> position; ///< of each unknown in the order of the factor
  std::shared_ptr<const FrontPlan> plan;
  const Supernodes& nodes;
  long n_nonzeros;
  std::vector<int> supernode_of; ///< of each column of the factor
  std::optional<FrontalCholesky<float>> in_single;
  std::optional<FrontalCholesky<double>> in_double; ///< made when it is needed
  std::variant<std::monostate, FactorStrips<double>, FactorStrips<float>> strips;
  mutable std::vector<Lanes> work; ///< scratch, zero between calls

  Data(const SymmetricPattern& pattern, Analysis&& analysis, FactorPrecision precision)
      : position(std::move(analysis.position)),
        plan(std::make_shared<FrontPlan>(pattern, position, std::move(analysis.nodes))),
        nodes(plan->nodes()), n_nonzeros(analysis.n_nonzeros), supernode_of(position.size())
  {
    for (int s = 0; s < nodes.size(); ++s)
      std::fill(supernode_of.begin() + nodes.first_column[s],
                supernode_of.begin() + nodes.first_column[s + 1], s);
    if (precision == FactorPrecision::full)
      strips.emplace<FactorStrips<double>>(counts(nodes.first_column), counts(nodes.first_row));
    else {
      in_single.emplace(plan);
      strips.emplace<FactorStrips<float>>(counts(nodes.first_column), counts(nodes.first_row));
    }
  }

  /// Calls a function with the strips, whatever they are stored in.
  template <typename Work>
  void with_strips(Work&& use) const
  {
    if (const auto* full = std::get_if<FactorStrips<double>>(&strips))
      use(*full);
    else
      use(std::get<FactorStrips<float>>(strips));
  }
};

SupernodalFactor::SupernodalFactor(const SymmetricPattern& pattern, FactorPrecision precision)
    : data_(std::make_unique<Data>(pattern, analyse(pattern), precision))
{
}

SupernodalFactor::~SupernodalFactor() = default;
SupernodalFactor::SupernodalFactor(SupernodalFactor&&) noexcept = default;
SupernodalFactor& SupernodalFactor::operator=(SupernodalFactor&&) noexcept = default;

bool SupernodalFactor::factorise(std::span<const double> values)
{
  Data& d = *data_;
  const auto store_in = [](auto& strips) {
    return [&strips](int s, const auto* columns, std::size_t stride) {
      strips.store(s, columns, stride);
    };
  };
  const auto in_double = [&](const auto& store) {
    if (!d.in_double)
      d.in_double.emplace(d.plan);
    return d.in_double->factorise(values, store);
  };
  if (auto* full = std::get_if<FactorStrips<double>>(&d.strips))
    return in_double(store_in(*full));
  const auto store = store_in(std::get<FactorStrips<float>>(d.strips));
  return d.in_single->factorise(values, store) || in_double(store);
}

SupernodalFactor::SparseColumns
SupernodalFactor::half_solve(std::span<const Index> rows,
                             const Eigen::Ref<const Eigen::MatrixXd>& entries) const
{
  const Data& d = *data_;
  SparseColumns result;
  result.n_columns = int(entries.cols());
  for (const Index row : rows)
    for (int s = d.supernode_of[d.position[row]]; s >= 0; s = d.nodes.parent[s])
      result.supernode.push_back(s);
  std::ranges::sort(result.supernode);
  result.supernode.erase(std::unique(result.supernode.begin(), result.supernode.end()),
                         result.supernode.end());
  std::vector<Lanes>& work = d.work;
  work.resize(d.position.size(), no_lanes());
  for (std::size_t r = 0; r < rows.size(); ++r)
    for (Eigen::Index c = 0; c < entries.cols(); ++c)
      work[d.position[rows[r]]][c] += entries(Eigen::Index(r), c);
  std::vector<Lanes> front;
  for (const int s : result.supernode) {
    const std::span<const int> row = d.nodes.rows(s);
    front.assign(row.size() + front_padding, no_lanes());
    for (std::size_t r = 0; r < row.size(); ++r)
      front[r] = work[row[r]];
    d.with_strips([&](const auto& strips) { strips.eliminate(s, front.data()); });
    const int n = d.nodes.n_columns(s);
    result.first_row.push_back(int(result.row.size()));
    result.row.insert(result.row.end(), front.begin(), front.begin() + n);
    std::fill_n(work.begin() + d.nodes.first_column[s], n, no_lanes());
    for (std::size_t r = std::size_t(n); r < row.size(); ++r)
      work[row[r]] = front[r];
  }
  return result;
}

namespace {

/// The front of these rows with its padding, on the boundary of a register.
double* gather(std::span<const int> rows, const double* y, std::vector<Lanes>& memory)
{
  memory.resize(std::max(memory.size(), (rows.size() + front_padding) / n_lanes + 1));
  double* front = reinterpret_cast<double*>(memory.data());
  for (std::size_t r = 0; r < rows.size(); ++r)
    front[r] = y[rows[r]];
  std::fill_n(front + rows.size(), front_padding, 0.0);
  return front;
}

} // namespace

Eigen::VectorXd SupernodalFactor::half_solve(const Eigen::VectorXd& b) const
{
  const Data& d = *data_;
  Eigen::VectorXd y(b.size());
  for (Eigen::Index i = 0; i < b.size(); ++i)
    y[d.position[i]] = b[i];
  std::vector<Lanes> memory;
  for (int s = 0; s < d.nodes.size(); ++s) {
    const std::span<const int> row = d.nodes.rows(s);
    double* front = gather(row, y.data(), memory);
    d.with_strips([&](const auto& strips) { strips.eliminate(s, front); });
    for (std::size_t r = 0; r < row.size(); ++r)
      y[row[r]] = front[r];
  }
  return y;
}

Eigen::VectorXd SupernodalFactor::back_solve(Eigen::VectorXd y) const
{
  const Data& d = *data_;
  std::vector<Lanes> memory;
  for (int s = d.nodes.size() - 1; s >= 0; --s) {
    const std::span<const int> row = d.nodes.rows(s);
    double* front = gather(row, y.data(), memory);
    d.with_strips([&](const auto& strips) { strips.substitute(s, front); });
    std::copy_n(front, d.nodes.n_columns(s), y.data() + d.nodes.first_column[s]);
  }
  Eigen::VectorXd x(y.size());
  for (Eigen::Index i = 0; i < x.size(); ++i)
    x[i] = y[d.position[i]];
  return x;
}

std::span<const int> SupernodalFactor::supernode_starts() const
{
  return data_->nodes.first_column;
}

long SupernodalFactor::n_nonzeros() const
{
  return data_->n_nonzeros;
}

} // namespace dem
