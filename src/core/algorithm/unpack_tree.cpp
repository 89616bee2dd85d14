#include "manycontact/detail/algorithm/rnea_derivatives.hpp"

namespace manycontact {

void unpack_tree(const Model& model, std::span<const double> lower, std::span<const double> upper,
                 Eigen::Ref<Eigen::MatrixXd> out) {
  out.setZero();
  for (int i = 0; i < model.nv; ++i) {
    int at = model.M_begin[i];
    for (int j = i; j >= 0; j = model.dof_parent[j], ++at) {
      out(j, i) = upper[at];
      out(i, j) = lower[at];
    }
  }
}

}  // namespace manycontact
