#include "manycontact/action/residuals/impulse_residuals.hpp"
#include "residual_parts.hpp"

namespace manycontact {

namespace {

struct ImpulseCoMData : ResidualDataAbstract {
  using ResidualDataAbstract::ResidualDataAbstract;
  std::vector<std::vector<Vec6<double>>> v, h;  // body velocities, subtree momenta for w, per robot and joint
  Eigen::VectorXd w;                            // velocity jump v+ - v (nv)
  Eigen::MatrixXd Jcom;                         // 3 x nv: Jacobian of the centre of mass
};

}  // namespace

std::shared_ptr<ResidualDataAbstract> ResidualModelImpulseCoM::createData(DataCollector* shared) {
  require(shared && shared->impact != nullptr, "ResidualModelImpulseCoM",
          "the action model is no impulse, an ActionModelImpulseFwdDynamics is expected");
  auto data = std::make_shared<ImpulseCoMData>(this, shared);
  for (const Robot& robot : shared->scene.robots)
    data->v.emplace_back(robot.model->njoints(), Vec6<double>(Vec6<double>::Zero()));
  data->h = data->v;
  data->w.setZero(shared->scene.nv);
  data->Jcom.setZero(3, shared->scene.nv);
  lay_out(*data);
  return data;
}

void ResidualModelImpulseCoM::evaluate(ResidualDataAbstract& data, const ConstVectorRef& x,
                                       const ConstVectorRef&) const {
  auto& d = internal::own<ImpulseCoMData>(data);
  const DataCollector& shared = *d.shared;
  d.w = shared.impact->vnext - x.tail(shared.scene.nv);
  for (int r = first_; r < last_; ++r) {
    const Robot& robot = shared.scene.robots[r];
    const std::span<const Inertia<double>> Yc = composite_inertias(shared.scene, shared.solution, r);
    for (int i = 0; i < robot.model->nv; ++i)
      d.Jcom.col(robot.idx_v + i) = (Yc[robot.model->dof_joint[i]] * shared.kinematics(r).J.col(i)).head<3>() / mass_;
  }
  d.r.noalias() = d.Jcom.lazyProduct(d.w);
}

// Computes m d(J_com w)/dq_i at constant w: the linear part of S x* h + Yc (v_p x S), with v and h for velocities w.
void ResidualModelImpulseCoM::fill_blocks(ResidualDataAbstract& data, const ConstVectorRef&,
                                          const ConstVectorRef&) const {
  auto& d = internal::own<ImpulseCoMData>(data);
  const DataCollector& shared = *d.shared;
  const Eigen::Index nv = shared.scene.nv;
  RowMajorMatrix& Rx = d.blocks[0].Rx;
  Rx.noalias() = d.Jcom * shared.impact->dvnext_dx;
  Rx.rightCols(nv) -= d.Jcom;
  for (int r = first_; r < last_; ++r) {
    const Robot& robot = shared.scene.robots[r];
    const Model& model = *robot.model;
    const Kinematics<double>& kin = shared.kinematics(r);
    const std::span<const Inertia<double>> Yc = composite_inertias(shared.scene, shared.solution, r);
    std::vector<Vec6<double>>&v = d.v[r], &h = d.h[r];
    for (int j = 0; j < model.njoints(); ++j) {
      const Joint& joint = model.joints[j];
      v[j].noalias() =
          kin.J.middleCols(joint.idx_v, joint.nv()).lazyProduct(d.w.segment(robot.idx_v + joint.idx_v, joint.nv()));
      if (joint.parent >= 0) v[j] += v[joint.parent];
      h[j] = kin.Y[j] * v[j];
    }
    for (int j = model.njoints(); j-- > 0;)
      if (const int parent = model.joints[j].parent; parent >= 0) h[parent] += h[j];
    for (int i = 0; i < model.nv; ++i) {
      const int j = model.dof_joint[i], parent = model.joints[j].parent;
      const Vec6<double> S = kin.J.col(i);
      Vec6<double> dh = cross_force(S, h[j]);
      if (parent >= 0) dh += Yc[j] * cross_motion(v[parent], S);
      Rx.col(robot.idx_v + i) += dh.head<3>() / mass_;
    }
  }
}

}  // namespace manycontact
