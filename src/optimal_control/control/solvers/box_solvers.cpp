#include "manycontact/control/box_solvers.hpp"

#include "manycontact/control/riccati_direction.hpp"

namespace manycontact {

// The terminal gap closes by the step length, as in Crocoddyl.
void SolverBoxDDP::forwardPass(double steplength) { rollOut(steplength, false, !is_feasible_ && steplength != 1); }

const std::vector<Eigen::MatrixXd>& SolverBoxDDP::get_Quu_inv() const {
  return static_cast<const BoxDirection&>(*directions_[0]).get_Quu_inv();
}
const std::vector<Eigen::MatrixXd>& SolverBoxFDDP::get_Quu_inv() const {
  return static_cast<const BoxDirection&>(*directions_[0]).get_Quu_inv();
}

}  // namespace manycontact
