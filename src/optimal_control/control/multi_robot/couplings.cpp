#include "manycontact/detail/control/couplings.hpp"

#include <algorithm>

#include "../integrators/euler_steps.hpp"
#include "manycontact/action/contact_fwddyn.hpp"
#include "manycontact/detail/kkt/island.hpp"

namespace manycontact {

using Eigen::Index;
using Eigen::VectorXd;

namespace {

constexpr const char* kCouplings = "ActionModelParts";
constexpr int kRows = 6;  // number of equations of a coupling and size of its wrench, for every contact type

std::vector<int> part_of_robots(const Scene& scene, const std::vector<std::vector<int>>& robots) {
  std::vector<int> out(scene.robots.size(), -1);
  for (std::size_t i = 0; i < robots.size(); ++i)
    for (const int r : robots[i]) {
      require(r >= 0 && r < scene.nrobots() && out[r] < 0, kCouplings,
              "a part has a robot that does not exist or belongs to another part, each robot in one part is expected");
      out[r] = static_cast<int>(i);
    }
  for (const int i : out) require(i >= 0, kCouplings, "a robot belongs to no part, each robot in one part is expected");
  return out;
}

std::vector<std::vector<int>> robots_of(const std::vector<ActionPart>& parts) {
  std::vector<std::vector<int>> out;
  for (const ActionPart& part : parts) out.push_back(part.robots);
  return out;
}

const DifferentialActionModelContactFwdDynamics& dynamics_of(const ActionPart& part) {
  const auto* augmented = dynamic_cast<const ActionModelAugmentedLagrangian*>(part.model.get());
  const ActionModelAbstract* node = augmented ? augmented->get_model().get() : part.model.get();
  const auto* euler = dynamic_cast<const IntegratedActionModelEuler*>(node);
  const auto* model =
      euler ? dynamic_cast<const DifferentialActionModelContactFwdDynamics*>(euler->get_differential().get()) : nullptr;
  require(model != nullptr, kCouplings,
          "the model of a part is not supported, an IntegratedActionModelEuler of "
          "DifferentialActionModelContactFwdDynamics is expected");
  return *model;
}

ActuationDataWrenches& wrenches_of(ActionDataAbstract& part) {
  auto& dynamics = static_cast<DifferentialActionDataContactFwdDynamics&>(*internal::euler_of(part).differential);
  return static_cast<ActuationDataWrenches&>(*dynamics.multibody->actuation);
}

bool same(const std::vector<WrenchEnd>& a, const std::vector<WrenchEnd>& b) {
  bool out = a.size() == b.size();
  for (std::size_t i = 0; out && i < a.size(); ++i)
    out = a[i].robot == b[i].robot && a[i].joint == b[i].joint && a[i].sign == b[i].sign;
  return out;
}

}  // namespace

std::vector<Coupling> couplings_between(const Scene& scene, const std::vector<std::vector<int>>& robots) {
  const std::vector<int> part = part_of_robots(scene, robots);
  std::vector<Coupling> out;
  for (std::size_t c = 0; c < scene.contacts.size(); ++c) {
    const Contact& contact = scene.contacts[c];
    if (!contact.active || contact.A.robot < 0 || contact.B.robot < 0) continue;
    const int a = part[contact.A.robot], b = part[contact.B.robot];
    if (a == b) continue;
    require(joins_robots(contact), kCouplings,
            "contact " + contact.name +
                " is between parts, and a body of the contact does not move: two bodies that "
                "move are expected");
    out.push_back({static_cast<int>(c), a, b});
  }
  return out;
}

std::vector<WrenchEnd> wrench_ends(const Scene& scene, const std::vector<Coupling>& couplings,
                                   const std::vector<std::vector<int>>& robots, int part) {
  const std::vector<int>& own = robots[part];
  const auto end = [&](const Attachment& at, double sign) {
    const auto found = std::find(own.begin(), own.end(), at.robot);
    return WrenchEnd{static_cast<int>(found - own.begin()), at.joint, sign};
  };
  std::vector<WrenchEnd> out;
  for (const Coupling& coupling : couplings) {
    const Contact& contact = scene.contacts[coupling.contact];
    if (coupling.part_a == part) out.push_back(end(contact.A, 1));
    if (coupling.part_b == part) out.push_back(end(contact.B, -1));
  }
  return out;
}

Couplings::Couplings(Scene scene, const std::vector<ActionPart>& parts)
    : scene_(std::move(scene)),
      couplings_(couplings_between(scene_, robots_of(parts))),
      couplings_of_(parts.size()),
      local_robot_(scene_.robots.size()) {
  for (std::size_t b = 0; b < couplings_.size(); ++b)
    for (const int i : {couplings_[b].part_a, couplings_[b].part_b}) couplings_of_[i].push_back(static_cast<int>(b));
  const std::vector<std::vector<int>> robots = robots_of(parts);
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const ActionPart& part = parts[i];
    for (std::size_t l = 0; l < part.robots.size(); ++l) local_robot_[part.robots[l]] = static_cast<int>(l);
    const auto& dynamics = dynamics_of(part);
    const auto* actuation = dynamic_cast<const ActuationModelWrenches*>(dynamics.get_actuation().get());
    require(actuation && same(actuation->ends(), wrench_ends(scene_, couplings_, robots, static_cast<int>(i))),
            kCouplings,
            "the actuation of a part is not the expected ActuationModelWrenches with the part's wrench_ends");
    check_size(kCouplings, "a part's robots", part.robots.size(),
               static_cast<std::size_t>(dynamics.get_model().scene().nrobots()));
    check_size(kCouplings, "a part's u", part.u.size(), actuation->nu_own());
  }
}

CouplingData::CouplingData(const Couplings& of, const std::vector<ActionPart>& parts) : solution(of.scene()) {
  const Scene& scene = of.scene();
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const Index rows = static_cast<Index>(kRows * of.couplings_of_parts()[i].size());
    C.emplace_back(Eigen::MatrixXd::Zero(rows, parts[i].dx.size()));
    D.emplace_back(Eigen::MatrixXd::Zero(rows, parts[i].model->get_nu()));
  }
  robots.resize(scene.robots.size());
  for (const Coupling& coupling : of.couplings()) {
    const Contact& contact = scene.contacts[coupling.contact];
    for (const int r : {contact.A.robot, contact.B.robot})
      if (!robots[r]) robots[r] = std::make_unique<OfRobot>(*scene.robots[r].model);
    const ContactSupport support = contact_support(scene, contact);
    couplings.push_back({support, {contact, support}, {scene, contact, support}});
  }
}

VectorXd Couplings::force(std::size_t coupling, const CouplingData& data) const {
  const auto c = static_cast<std::size_t>(couplings_[coupling].contact);
  return data.solution.f.segment(data.solution.f_offset[c], scene_.contacts[c].rows());
}

// Solves the dynamics of the whole scene, and computes the couplings' wrenches from the contact forces.
void Couplings::solve(const std::vector<ActionPart>& parts, const ConstVectorRef& x, const ConstVectorRef& u,
                      ActionDataParts& d) const {
  CouplingData& own = *d.couplings;
  const auto q = x.head(scene_.nq), v = x.tail(scene_.nv);
  (void)manycontact::solve(scene_, q, v, u, own.solution);
  for (std::size_t r = 0; r < own.robots.size(); ++r) {
    if (!own.robots[r]) continue;
    const Robot& robot = scene_.robots[r];
    Kinematics<double>& kin = own.robots[r]->kin;
    forward_kinematics<double>(*robot.model, robot.base, q.segment(robot.idx_q, robot.model->nq), kin);
    forward_accelerations<double>(*robot.model, v.segment(robot.idx_v, robot.model->nv),
                                  own.solution.a.data() + robot.idx_v, scene_.gravity, kin);
  }
  for (std::size_t b = 0; b < couplings_.size(); ++b) {
    const Contact& contact = scene_.contacts[couplings_[b].contact];
    CouplingData::OfCoupling& coupling = own.couplings[b];
    const Kinematics<double>& A = own.robots[contact.A.robot]->kin;
    contact_rows<double>(scene_, contact, coupling.support, A, &own.robots[contact.B.robot]->kin, coupling.rows);
    const Mat3<double>& R = coupling.rows.aMA.R;
    const Vec6<double> F = coupling.rows.W.transpose() *
                           own.solution.f.segment(own.solution.f_offset[couplings_[b].contact], contact.rows());
    for (const int i : {couplings_[b].part_a, couplings_[b].part_b}) {
      const std::vector<int>& of_part = couplings_of_[i];
      const auto k = std::find(of_part.begin(), of_part.end(), static_cast<int>(b)) - of_part.begin();
      const auto part = static_cast<std::size_t>(i);
      wrenches_of(*d.parts[part]).points[k] = A.origin(contact.A.joint) + coupling.rows.aMA.p;
      auto w = d.u[part].segment<kRows>(static_cast<Index>(parts[part].u.size()) + kRows * k);
      w << R * F.head<3>(), R * F.tail<3>();
    }
  }
}

}  // namespace manycontact
