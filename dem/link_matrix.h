#pragma once
#include "dem/link_mechanics.h"
#include "dem/network.h"

#include <Eigen/Core>

namespace dem {

/// Unknowns of a quasi-static step: for each free particle its displacement and its turn times its
/// radius; the last one is the displacement of the upper platen, if its force is prescribed.
struct LinkDofs {
  std::vector<Index> first_dof; ///< of each body, or -1 if it is held
  std::vector<double> radius;
  std::vector<Support> support;
  Index platen_dof = -1;
  Index n_dofs = 0;
};
LinkDofs make_dofs(const Bodies& bodies, bool platen_is_free);

/// The links of each body.
struct BodyLinks {
  std::vector<Index> start; ///< of each body in `link`, and the end
  std::vector<Index> link;
};
BodyLinks body_links(const Links& links, std::size_t n_bodies);

/// Tangent of all links, and a stiffness that holds bodies where they are.
struct LinkMatrix {
  std::vector<std::array<Index, 2>> ends;
  std::vector<LinkTangent> tangent;
  std::vector<double> hold; ///< of each body, on all its dofs [N/m]
};

/// Stiffness of one link in the scaled dofs of its two bodies; a radius of 0 is that of a platen.
using LinkStiffness = Eigen::Matrix<double, 12, 12>;
LinkStiffness link_stiffness(const LinkTangent& tangent, double radius_first, double radius_second);

/// K x, each body's row by itself: the same bits on any number of threads.
Eigen::VectorXd product(const LinkMatrix& matrix, const BodyLinks& body_links, const LinkDofs& dofs,
                        const Eigen::VectorXd& x, int n_threads);

} // namespace dem
