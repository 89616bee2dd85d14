#include "impact_actuation.hpp"

#include "manycontact/detail/algorithm/crba.hpp"
#include "manycontact/detail/algorithm/rnea.hpp"
#include "manycontact/detail/algorithm/rnea_derivatives.hpp"

namespace manycontact::internal {

namespace {

struct RobotWork {
  explicit RobotWork(const Model& model)
      : kin(model),
        derivatives(model),
        f(model.njoints(), Vec6<double>(Vec6<double>::Zero())),
        Yc(kin.Y),
        M(packed_size(model)),
        lower(M.size()),
        upper(M.size()) {}
  Kinematics<double> kin;
  RneaDerivatives derivatives;
  std::vector<Vec6<double>> f;
  std::vector<Inertia<double>> Yc;
  std::vector<double> M;
  // Places of (i, j) and (j, i) in the values of dtau_du, for each packed entry (i, its ancestor j); dtau_dx begins
  // with the same pattern.
  std::vector<int> lower, upper;
};

struct ImpactData : ActuationDataAbstract {
  using ActuationDataAbstract::ActuationDataAbstract;
  std::vector<RobotWork> robots;
};

const std::vector<Robot>& robots_of(const StateMultibody& state) { return state.get_model()->scene().robots; }

// Calls use(k, i, j) for each packed entry k: coordinate i, its ancestor (or itself) j, numbered within the robot.
template <class Use>
void each_entry(const Model& model, Use&& use) {
  for (int i = 0; i < model.nv; ++i) {
    int k = model.M_begin[i];
    for (int j = i; j >= 0; j = model.dof_parent[j]) use(k++, i, j);
  }
}

// Sets the motion that ID is evaluated at: at rest, without gravity, with accelerations u.
void move(const Robot& robot, const ConstVectorRef& x, const ConstVectorRef& u, RobotWork& w) {
  const Model& model = *robot.model;
  forward_kinematics<double>(model, robot.base, x.segment(robot.idx_q, model.nq), w.kin);
  forward_accelerations<double>(model, x.tail(u.size()).segment(robot.idx_v, model.nv), u.data() + robot.idx_v,
                                Vec3<double>(Vec3<double>::Zero()), w.kin);
}

}  // namespace

ImpactActuation::ImpactActuation(std::shared_ptr<StateMultibody> state)
    : ActuationModelAbstract(state, state->get_nv()),
      armature(state->get_model()->armature),
      multibody_(std::move(state)) {}

std::shared_ptr<ActuationDataAbstract> ImpactActuation::createData() {
  auto data = std::make_shared<ImpactData>(this);
  std::vector<Eigen::Triplet<double>> entries;
  for (const Robot& robot : robots_of(*multibody_)) {
    data->robots.emplace_back(*robot.model);
    each_entry(*robot.model, [&](int, int i, int j) {
      entries.emplace_back(robot.idx_v + i, robot.idx_v + j, 0);
      if (i != j) entries.emplace_back(robot.idx_v + j, robot.idx_v + i, 0);
    });
  }
  data->dtau_du.setFromTriplets(entries.begin(), entries.end());
  data->dtau_dx.setFromTriplets(entries.begin(), entries.end());
  double* first = data->dtau_du.valuePtr();
  for (std::size_t r = 0; r < data->robots.size(); ++r) {
    const Robot& robot = robots_of(*multibody_)[r];
    RobotWork& w = data->robots[r];
    each_entry(*robot.model, [&](int k, int i, int j) {
      w.lower[k] = static_cast<int>(&data->dtau_du.coeffRef(robot.idx_v + i, robot.idx_v + j) - first);
      w.upper[k] = static_cast<int>(&data->dtau_du.coeffRef(robot.idx_v + j, robot.idx_v + i) - first);
    });
  }
  return data;
}

// tau = (1 + e) ID(q, 0, u)
void ImpactActuation::calc(const DataPtr& data, const ConstVectorRef& x, const ConstVectorRef& u) {
  check("ImpactActuation::calc", x, u);
  ImpactData& d = static_cast<ImpactData&>(*data);
  for (std::size_t r = 0; r < d.robots.size(); ++r) {
    const Robot& robot = robots_of(*multibody_)[r];
    RobotWork& w = d.robots[r];
    move(robot, x, u, w);
    inverse_dynamics<double>(*robot.model, w.kin, nullptr, {}, w.f, d.tau.segment(robot.idx_v, robot.model->nv));
  }
  d.tau += armature.cwiseProduct(u);
  d.tau *= 1 + restitution;
}

// dtau/dq = (1 + e) dID/dq, dtau/du = (1 + e) M; at the last calc
void ImpactActuation::calcDiff(const DataPtr& data, const ConstVectorRef& x, const ConstVectorRef& u) {
  check("ImpactActuation::calcDiff", x, u);
  ImpactData& d = static_cast<ImpactData&>(*data);
  const double scale = 1 + restitution;
  double *by_x = d.dtau_dx.valuePtr(), *by_u = d.dtau_du.valuePtr();
  for (std::size_t r = 0; r < d.robots.size(); ++r) {
    const Robot& robot = robots_of(*multibody_)[r];
    const Model& model = *robot.model;
    RobotWork& w = d.robots[r];
    crba<double>(model, w.kin, w.Yc, w.M.data());
    rnea_derivatives<double>(model, w.kin, w.Yc, {}, w.derivatives);
    each_entry(model, [&](int k, int i, int j) {
      const double turned = i == j ? armature[robot.idx_v + i] - model.armature[i] : 0;
      by_u[w.lower[k]] = by_u[w.upper[k]] = scale * (w.M[k] + turned);
      by_x[w.upper[k]] = scale * w.derivatives.dq_upper[k];
      by_x[w.lower[k]] = scale * w.derivatives.dq_lower[k];  // the value that is valid on the diagonal
    });
  }
}

}  // namespace manycontact::internal
