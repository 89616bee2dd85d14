#pragma once
// Controls that consist of torques u of some coordinates, followed by wrenches w_b on bodies b:
//
//     tau(q, [u; w_1; w_2; ...]) = S^T u + sum_b sign_b J_b(q)^T w_b.
//
// A wrench w = (force, torque) [N, N m] is in world axes about a point p fixed in the world. Its contribution to tau
// therefore depends on its own robot's q only. With S_k, S_j the motion subspaces in the world,
//
//     d tau_k / dq_j = (S_j x S_k)^T w     for a coordinate j of k's joint or of a joint above, else 0.

#include "manycontact/action/actuation.hpp"
#include "manycontact/detail/algorithm/kinematics.hpp"

namespace manycontact {

/// The body on which a wrench acts. With sign -1 the opposite wrench acts on the body.
struct WrenchEnd {
  int robot = 0, joint = 0;  // numbers in the state's scene
  double sign = 1;
};

struct ActuationDataWrenches : ActuationDataAbstract {  // Data of ActuationModelWrenches.
  /// Allocates the data of the model.
  explicit ActuationDataWrenches(const ActuationModelAbstract* model) : ActuationDataAbstract(model) {}
  std::vector<Vec3<double>> points;      // one per wrench: p in the world [m], initially zero; the caller sets it
  std::vector<Kinematics<double>> kins;  // one per wrench: its robot at q; set by calc
  std::vector<std::vector<int>> chains;  // one per wrench: the coordinates above its body, numbered within the robot
};

class ActuationModelWrenches : public ActuationModelAbstract {  // Torques of coordinates, and wrenches on bodies.
 public:
  /// own: an actuation that selects coordinates. Throws std::invalid_argument for other actuations or for an unknown
  /// body.
  ActuationModelWrenches(std::shared_ptr<StateMultibody> state, std::shared_ptr<ActuationModelAbstract> own,
                         std::vector<WrenchEnd> ends);

  void calc(const DataPtr& data, const ConstVectorRef& x, const ConstVectorRef& u) override;
  /// Computes the derivatives at the x and u of the last calc.
  void calcDiff(const DataPtr& data, const ConstVectorRef& x, const ConstVectorRef& u) override;
  using ActuationModelAbstract::calc, ActuationModelAbstract::calcDiff;
  /// Throw std::logic_error, because these functions are not available for wrenches.
  void commands(const DataPtr&, const ConstVectorRef&, const ConstVectorRef&) override;
  void torqueTransform(const DataPtr&, const ConstVectorRef&, const ConstVectorRef&) override;
  std::shared_ptr<ActuationDataAbstract> createData() override;
  void print(std::ostream& os) const override;

  const std::vector<WrenchEnd>& ends() const { return ends_; }  // bodies on which the wrenches act
  std::size_t nu_own() const { return own_->get_nu(); }         // number of controls before the wrenches

 private:
  std::shared_ptr<StateMultibody> multibody_;
  std::shared_ptr<ActuationModelAbstract> own_;
  std::vector<WrenchEnd> ends_;
};

}  // namespace manycontact
