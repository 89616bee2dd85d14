#include "manycontact/action/residuals/centroidal_residuals.hpp"
#include "residual_parts.hpp"

namespace manycontact {

namespace {

struct CentroidalData : ResidualDataAbstract {
  using ResidualDataAbstract::ResidualDataAbstract;
  std::vector<std::vector<Vec6<double>>> h;  // momenta of the subtrees, per robot and joint, about the tree's origin
  Eigen::Vector3d c;                         // set by calc: centre of mass in the world
};

Eigen::Vector3d center_of_mass(const DataCollector& shared, int first, int last, double mass) {
  Eigen::Vector3d c = Eigen::Vector3d::Zero();
  for (int r = first; r < last; ++r) {
    const Kinematics<double>& kin = shared.kinematics(r);
    for (std::size_t i = 0; i < kin.Y.size(); ++i) c += kin.Y[i].m * kin.origin(static_cast<int>(i)) + kin.Y[i].h;
  }
  return c / mass;
}

// Returns the linear momentum of the subtree that moves with S_i: m dc/dq_i (m: total mass, c: centre of mass).
Eigen::Vector3d moved_mass(const Inertia<double>& Yc, const Vec6<double>& S) { return (Yc * S).head<3>(); }

}  // namespace

CentroidalResidual::CentroidalResidual(const char* name, std::shared_ptr<StateMultibody> state, std::size_t nr,
                                       std::size_t nu, Dependence on, int robot)
    : NamedResidual(name, std::move(state), nr, nu, on), robot_(robot), mass_(0) {
  const Scene& scene = internal::multibody(state_).get_model()->scene();
  require(robot >= -1 && robot < scene.nrobots(), name,
          "robot " + std::to_string(robot) + " does not exist, a number from -1 (all robots) to " +
              std::to_string(scene.nrobots() - 1) + " is expected");
  first_ = robot < 0 ? 0 : robot;
  last_ = robot < 0 ? scene.nrobots() : robot + 1;
  for (int r = first_; r < last_; ++r)
    for (const Joint& joint : scene.robots[r].model->joints) mass_ += joint.inertia.m;
  require(mass_ > 0, name,
          "the mass of the moving bodies is " + std::to_string(mass_) + ", a positive mass is expected");
}

std::shared_ptr<ResidualDataAbstract> CentroidalResidual::createData(DataCollector* shared) {
  internal::expect_motion("CentroidalResidual", shared);
  auto data = std::make_shared<CentroidalData>(this, shared);
  for (const Robot& robot : shared->scene.robots)
    data->h.emplace_back(robot.model->njoints(), Vec6<double>(Vec6<double>::Zero()));
  data->c.setZero();
  lay_out(*data);
  return data;
}

void CentroidalResidual::lay_out(ResidualDataAbstract& data) const {
  const std::vector<Robot>& robots = internal::multibody(state_).get_model()->scene().robots;
  const int first = robots[first_].idx_v, n = robots[last_ - 1].idx_v + robots[last_ - 1].model->nv - first;
  std::vector<int> columns = internal::range(first, n);
  if (get_v_dependent())
    for (int i = 0; i < n; ++i) columns.push_back(static_cast<int>(state_->get_nv()) + first + i);
  data.blocks.clear();
  data.blocks.emplace_back(internal::range(0, static_cast<int>(nr_)), columns, std::vector<int>{});
}

void ResidualModelCoMPosition::evaluate(ResidualDataAbstract& data, const ConstVectorRef&,
                                        const ConstVectorRef&) const {
  data.r = center_of_mass(*data.shared, first_, last_, mass_) - reference_;
}

void ResidualModelCoMPosition::fill_blocks(ResidualDataAbstract& data, const ConstVectorRef&,
                                           const ConstVectorRef&) const {
  const DataCollector& shared = *data.shared;
  Eigen::Index column = 0;
  for (int r = first_; r < last_; ++r) {
    const Model& model = *shared.scene.robots[r].model;
    const Kinematics<double>& kin = shared.kinematics(r);
    const std::span<const Inertia<double>> Yc = composite_inertias(shared.scene, shared.solution, r);
    for (int i = 0; i < model.nv; ++i)
      data.blocks[0].Rx.col(column++) = moved_mass(Yc[model.dof_joint[i]], kin.J.col(i)) / mass_;
  }
}

void ResidualModelCentroidalMomentum::evaluate(ResidualDataAbstract& data, const ConstVectorRef&,
                                               const ConstVectorRef&) const {
  auto& d = internal::own<CentroidalData>(data);
  d.c = center_of_mass(*d.shared, first_, last_, mass_);
  d.r = -reference_;
  for (int r = first_; r < last_; ++r) {
    const Kinematics<double>& kin = d.shared->kinematics(r);
    const std::vector<Joint>& joints = d.shared->scene.robots[r].model->joints;
    std::vector<Vec6<double>>& h = d.h[r];
    for (std::size_t j = 0; j < joints.size(); ++j) h[j] = kin.Y[j] * kin.v[j];
    for (std::size_t j = joints.size(); j-- > 0;) {
      if (joints[j].parent >= 0) {
        h[joints[j].parent] += h[j];
        continue;
      }
      const Eigen::Vector3d l = h[j].head<3>();
      d.r.head<3>() += l;
      d.r.tail<3>() += h[j].tail<3>() - (d.c - kin.origin(static_cast<int>(j))).cross(l);  // k - c x l
    }
  }
}

// The momentum of a subtree is h = [l; k]. With its inertia Yc and the velocity v_p of its parent body,
//     dh/dq_i = S x* h + Yc (v_p x S)        dh/dv_i = Yc S
// About the centre of mass c, the angular momentum changes by dk - dc x l - c x dl, where l is that of all robots.
void ResidualModelCentroidalMomentum::fill_blocks(ResidualDataAbstract& data, const ConstVectorRef&,
                                                  const ConstVectorRef&) const {
  auto& d = internal::own<CentroidalData>(data);
  const Eigen::Vector3d l = d.r.head<3>() + reference_.head<3>();
  RowMajorMatrix& Rx = d.blocks[0].Rx;
  const Eigen::Index n = Rx.cols() / 2;
  Eigen::Index column = 0;
  for (int r = first_; r < last_; ++r) {
    const Model& model = *d.shared->scene.robots[r].model;
    const Kinematics<double>& kin = d.shared->kinematics(r);
    const std::span<const Inertia<double>> composite = composite_inertias(d.shared->scene, d.shared->solution, r);
    for (int i = 0; i < model.nv; ++i, ++column) {
      const int joint = model.dof_joint[i], parent = model.joints[joint].parent;
      const Eigen::Vector3d c = d.c - kin.origin(joint);
      const Inertia<double>& Yc = composite[joint];
      const Vec6<double> S = kin.J.col(i), dv = Yc * S;
      Vec6<double> dq = cross_force(S, d.h[r][joint]);
      if (parent >= 0) dq += Yc * cross_motion(kin.v[parent], S);
      const Eigen::Vector3d dc = dv.head<3>() / mass_, dl_q = dq.head<3>(), dl_v = dv.head<3>();
      Rx.col(column) = dq;
      Rx.col(column).tail<3>() -= dc.cross(l) + c.cross(dl_q);
      Rx.col(n + column) = dv;
      Rx.col(n + column).tail<3>() -= c.cross(dl_v);
    }
  }
}

}  // namespace manycontact
