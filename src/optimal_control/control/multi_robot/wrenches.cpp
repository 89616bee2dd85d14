#include "manycontact/detail/control/wrenches.hpp"

#include <ostream>
#include <stdexcept>

#include "manycontact/detail/contact/rows.hpp"

namespace manycontact {

using Eigen::Index;

namespace {

constexpr const char* kActuationModelWrenches = "ActuationModelWrenches";

const Robot& robot_of_end(const StateMultibody& state, const WrenchEnd& end) {
  return state.get_model()->scene().robots[end.robot];
}

// Moves the wrench w from a point at r to the origin of the tree frame: (force, torque + r x force).
Vec6<double> moved(const ConstVectorRef& w, const Vec3<double>& r) {
  Vec6<double> out = w;
  out.tail<3>() += r.cross(Vec3<double>(w.head<3>()));
  return out;
}

// Returns whether coordinate j moves the motion subspace S_k of coordinate k, where one of their joints is an ancestor
// of the other, or both are one joint. It does unless j's joint is a descendant of k's.
bool moves_subspace(const Model& model, int j, int k) {
  if (j <= k) return true;  // j then belongs to an ancestor or to the same joint
  for (const Joint& joint : model.joints)
    if (k >= joint.idx_v && k < joint.idx_v + joint.nv()) return j < joint.idx_v + joint.nv();
  return false;
}

}  // namespace

ActuationModelWrenches::ActuationModelWrenches(std::shared_ptr<StateMultibody> state,
                                               std::shared_ptr<ActuationModelAbstract> own, std::vector<WrenchEnd> ends)
    : ActuationModelAbstract(internal::given(kActuationModelWrenches, state, "the state"),
                             internal::given(kActuationModelWrenches, own, "an actuation")->get_nu() + 6 * ends.size()),
      multibody_(std::move(state)),
      own_(std::move(own)),
      ends_(std::move(ends)) {
  require(own_->selection().size() == own_->get_nu(), kActuationModelWrenches,
          "an actuation that selects coordinates is expected");
  const Scene& scene = multibody_->get_model()->scene();
  for (const WrenchEnd& end : ends_)
    require(end.robot >= 0 && end.robot < scene.nrobots() && end.joint >= 0 &&
                end.joint < robot_of_end(*multibody_, end).model->njoints(),
            kActuationModelWrenches,
            "a wrench acts on a body that does not exist, a body of the state's robots is expected");
}

std::shared_ptr<ActuationDataAbstract> ActuationModelWrenches::createData() {
  auto data = std::make_shared<ActuationDataWrenches>(this);
  std::vector<Eigen::Triplet<double>> by_u, by_x;
  const std::vector<int>& selection = own_->selection();
  for (std::size_t k = 0; k < selection.size(); ++k) by_u.emplace_back(selection[k], static_cast<int>(k), 1);
  for (std::size_t b = 0; b < ends_.size(); ++b) {
    const Robot& robot = robot_of_end(*multibody_, ends_[b]);
    data->points.emplace_back(Vec3<double>::Zero());
    data->kins.emplace_back(*robot.model);
    data->chains.push_back(dof_chain(*robot.model, ends_[b].joint));
    for (const int k : data->chains.back()) {
      for (int i = 0; i < 6; ++i) by_u.emplace_back(robot.idx_v + k, static_cast<int>(nu_own() + 6 * b) + i, 0);
      for (const int j : data->chains.back())
        if (moves_subspace(*robot.model, j, k)) by_x.emplace_back(robot.idx_v + k, robot.idx_v + j, 0);
    }
  }
  data->dtau_du.setFromTriplets(by_u.begin(), by_u.end());
  data->dtau_dx.setFromTriplets(by_x.begin(), by_x.end());
  return data;
}

void ActuationModelWrenches::calc(const DataPtr& data, const ConstVectorRef& x, const ConstVectorRef& u) {
  check("ActuationModelWrenches::calc", x, u);
  auto& d = internal::own_data<ActuationDataWrenches>("ActuationModelWrenches::calc", data);
  d.tau.setZero();
  const std::vector<int>& selection = own_->selection();
  for (std::size_t k = 0; k < selection.size(); ++k) d.tau[selection[k]] = u[k];
  for (std::size_t b = 0; b < ends_.size(); ++b) {
    const Robot& robot = robot_of_end(*multibody_, ends_[b]);
    Kinematics<double>& kin = d.kins[b];
    forward_kinematics<double>(*robot.model, robot.base, x.segment(robot.idx_q, robot.model->nq), kin);
    const Vec6<double> w = ends_[b].sign * moved(u.segment<6>(static_cast<Index>(nu_own() + 6 * b)),
                                                 d.points[b] - kin.origin(ends_[b].joint));
    for (const int k : d.chains[b]) d.tau[robot.idx_v + k] += kin.J.col(k).dot(w);
  }
}

void ActuationModelWrenches::calcDiff(const DataPtr& data, const ConstVectorRef& x, const ConstVectorRef& u) {
  check("ActuationModelWrenches::calcDiff", x, u);
  auto& d = internal::own_data<ActuationDataWrenches>("ActuationModelWrenches::calcDiff", data);
  Eigen::Map<Eigen::VectorXd>(d.dtau_dx.valuePtr(), d.dtau_dx.nonZeros()).setZero();
  for (std::size_t b = 0; b < ends_.size(); ++b) {
    const Robot& robot = robot_of_end(*multibody_, ends_[b]);
    const Kinematics<double>& kin = d.kins[b];
    const int column = static_cast<int>(nu_own() + 6 * b);
    const double sign = ends_[b].sign;
    const Vec3<double> r = d.points[b] - kin.origin(ends_[b].joint);
    const Vec6<double> w = sign * moved(u.segment<6>(column), r);
    for (const int k : d.chains[b]) {
      const Vec6<double> s = kin.J.col(k);
      const Vec3<double> at_p = s.head<3>() + s.tail<3>().cross(r);  // velocity of p
      for (int i = 0; i < 3; ++i) {
        d.dtau_du.coeffRef(robot.idx_v + k, column + i) = sign * at_p[i];
        d.dtau_du.coeffRef(robot.idx_v + k, column + 3 + i) = sign * s[3 + i];
      }
      for (const int j : d.chains[b])
        if (moves_subspace(*robot.model, j, k))
          d.dtau_dx.coeffRef(robot.idx_v + k, robot.idx_v + j) += cross_motion(Vec6<double>(kin.J.col(j)), s).dot(w);
    }
  }
}

void ActuationModelWrenches::commands(const DataPtr&, const ConstVectorRef&, const ConstVectorRef&) {
  throw std::logic_error("ActuationModelWrenches::commands: the actuation does not support commands");
}
void ActuationModelWrenches::torqueTransform(const DataPtr&, const ConstVectorRef&, const ConstVectorRef&) {
  throw std::logic_error("ActuationModelWrenches::torqueTransform: the actuation does not support torqueTransform");
}

void ActuationModelWrenches::print(std::ostream& os) const {
  os << kActuationModelWrenches << " {nu=" << nu_ << ", wrenches=" << ends_.size() << "}";
}

}  // namespace manycontact
