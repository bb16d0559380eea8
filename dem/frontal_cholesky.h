#pragma once
#include "dem/dense_front.h"
#include "dem/front_plan.h"

#include <functional>
#include <memory>

namespace dem {

/// Multifrontal Cholesky factorisation on one thread.
///
/// Each supernode gathers entries of the matrix and what its children left over in a dense front,
/// eliminates its columns there and leaves the rest of the front to its parent.
template <typename Number>
class FrontalCholesky {
public:
  explicit FrontalCholesky(std::shared_ptr<const FrontPlan> plan);

  /// Takes the columns of a supernode: the triangle and the rows below it, by columns.
  using Store = std::function<void(int supernode, const Number* columns, std::size_t stride)>;

  /// \return false if the matrix is not positive definite
  bool factorise(std::span<const double> values, const Store& store);

private:
  void gather(int s, std::span<const double> values, DenseFront<Number>& front) const;
  void gather_leftover(int child, DenseFront<Number>& front) const;
  void leave(int s, const DenseFront<Number>& front);

  std::shared_ptr<const FrontPlan> plan_;
  std::vector<Number> leftover_; ///< stack
  std::vector<Number> front_;
};

extern template class FrontalCholesky<double>;
extern template class FrontalCholesky<float>;

} // namespace dem
