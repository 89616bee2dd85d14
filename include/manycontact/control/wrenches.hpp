#pragma once
// Controls that are torques of some coordinates and, behind them, wrenches on bodies:
//
//     tau(q, [u; w_1; w_2; ...]) = S^T u + sum_b sign_b J_b(q)^T w_b.
//
// A wrench w = (force, torque) [N, N m] is in world axes about a point p fixed in the world, whatever the body does, so
// that its share in tau depends on its own robot's q alone: with S_k, S_j motion subspaces in the world,
//
//     d tau_k / dq_j = (S_j x S_k)^T w     for j a coordinate of k's joint or of one above it, else 0.

#include "manycontact/action/actuation.hpp"
#include "manycontact/algorithm/kinematics.hpp"

namespace manycontact {

/// The body that a wrench acts on; sign -1: it is the reaction that does.
struct WrenchEnd {
  int robot = 0, joint = 0;  // of the state's scene
  double sign = 1;
};

struct ActuationDataWrenches : ActuationDataAbstract {  // with the wrenches' bodies
  explicit ActuationDataWrenches(const ActuationModelAbstract* model) : ActuationDataAbstract(model) {}
  std::vector<Vec3<double>> points;      // per wrench: p in the world [m], zero at first. The caller's
  std::vector<Kinematics<double>> kins;  // per wrench: its robot at q; by calc
  std::vector<std::vector<int>> chains;  // per wrench: the coordinates above its body, numbered within the robot
};

class ActuationModelWrenches : public ActuationModelAbstract {  // torques of coordinates, and wrenches on bodies
 public:
  /// own: a selection of coordinates. Throws std::invalid_argument where it is not, or a body does not exist.
  ActuationModelWrenches(std::shared_ptr<StateMultibody> state, std::shared_ptr<ActuationModelAbstract> own,
                         std::vector<WrenchEnd> ends);

  void calc(const std::shared_ptr<ActuationDataAbstract>& data, const ConstVectorRef& x,
            const ConstVectorRef& u) override;
  using ActuationModelAbstract::calc;
  /// At the last calc.
  void calcDiff(const std::shared_ptr<ActuationDataAbstract>& data, const ConstVectorRef& x,
                const ConstVectorRef& u) override;
  using ActuationModelAbstract::calcDiff;
  /// Not offered: std::logic_error.
  void commands(const std::shared_ptr<ActuationDataAbstract>&, const ConstVectorRef&, const ConstVectorRef&) override;
  void torqueTransform(const std::shared_ptr<ActuationDataAbstract>&, const ConstVectorRef&,
                       const ConstVectorRef&) override;
  std::shared_ptr<ActuationDataAbstract> createData() override;
  void print(std::ostream& os) const override;

  const std::vector<WrenchEnd>& ends() const { return ends_; }
  std::size_t nu_own() const { return own_->get_nu(); }

 private:
  std::shared_ptr<StateMultibody> multibody_;
  std::shared_ptr<ActuationModelAbstract> own_;
  std::vector<WrenchEnd> ends_;
};

}  // namespace manycontact
