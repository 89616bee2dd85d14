// Nodes of parts that hold each other: structure and values.

#include "manycontact/control/joined.hpp"

#include <ostream>

#include "coordinates.hpp"
#include "joined_parts.hpp"
#include "manycontact/action/contact_fwddyn.hpp"
#include "manycontact/kkt/island.hpp"

namespace manycontact {

using Eigen::Index;
using Eigen::VectorXd;
using DataPtr = std::shared_ptr<ActionDataAbstract>;

namespace {

constexpr const char* kActionModelJoined = "ActionModelJoined";
constexpr int kRows = 6;  // of a bond, and numbers of its wrench, whatever the contact's type

std::vector<int> part_of_robots(const Scene& scene, const std::vector<std::vector<int>>& robots) {
  std::vector<int> out(scene.robots.size(), -1);
  for (std::size_t i = 0; i < robots.size(); ++i)
    for (const int r : robots[i]) {
      require(r >= 0 && r < scene.nrobots() && out[static_cast<std::size_t>(r)] < 0, kActionModelJoined,
              "a robot that does not exist or is another part's, one part's is expected");
      out[static_cast<std::size_t>(r)] = static_cast<int>(i);
    }
  for (const int i : out) require(i >= 0, kActionModelJoined, "a robot is no part's");
  return out;
}

std::vector<std::vector<int>> robots_of(const std::vector<JoinedPart>& parts) {
  std::vector<std::vector<int>> out;
  for (const JoinedPart& part : parts) out.push_back(part.robots);
  return out;
}

const DifferentialActionModelContactFwdDynamics& dynamics_of(const ActionPart& part) {
  const auto* augmented = dynamic_cast<const ActionModelAugmentedLagrangian*>(part.model.get());
  const ActionModelAbstract* node = augmented ? augmented->get_model().get() : part.model.get();
  const auto* euler = dynamic_cast<const IntegratedActionModelEuler*>(node);
  const auto* model =
      euler ? dynamic_cast<const DifferentialActionModelContactFwdDynamics*>(euler->get_differential().get()) : nullptr;
  require(
      model != nullptr, kActionModelJoined,
      "a part's model is an IntegratedActionModelEuler of DifferentialActionModelContactFwdDynamics, others are not "
      "supported");
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

std::vector<JoinedBond> bonds_between(const Scene& scene, const std::vector<std::vector<int>>& robots) {
  const std::vector<int> part = part_of_robots(scene, robots);
  std::vector<JoinedBond> out;
  for (std::size_t c = 0; c < scene.contacts.size(); ++c) {
    const Contact& contact = scene.contacts[c];
    if (!contact.active || contact.A.robot < 0 || contact.B.robot < 0) continue;
    const int a = part[static_cast<std::size_t>(contact.A.robot)], b = part[static_cast<std::size_t>(contact.B.robot)];
    if (a == b) continue;
    require(joins_robots(contact), kActionModelJoined,
            "contact " + contact.name + " is between parts, and one of its bodies does not move");
    out.push_back({static_cast<int>(c), a, b});
  }
  return out;
}

std::vector<WrenchEnd> wrench_ends(const Scene& scene, const std::vector<JoinedBond>& bonds,
                                   const std::vector<std::vector<int>>& robots, int part) {
  const std::vector<int>& own = robots[static_cast<std::size_t>(part)];
  const auto end = [&](const Attachment& at, double sign) {
    const auto found = std::find(own.begin(), own.end(), at.robot);
    return WrenchEnd{static_cast<int>(found - own.begin()), at.joint, sign};
  };
  std::vector<WrenchEnd> out;
  for (const JoinedBond& bond : bonds) {
    const Contact& contact = scene.contacts[static_cast<std::size_t>(bond.contact)];
    if (bond.part_a == part) out.push_back(end(contact.A, 1));
    if (bond.part_b == part) out.push_back(end(contact.B, -1));
  }
  return out;
}

// ---- data -------------------------------------------------------------------------------------------------------

ActionDataJoined::ActionDataJoined(const ActionModelJoined* model, std::vector<DataPtr> datas)
    : ActionDataAbstract(model), parts(std::move(datas)), solution(model->get_scene()) {
  make_work(*model);
}
ActionDataJoined::ActionDataJoined(const ActionModelJoined* model, std::vector<DataPtr> datas, WithoutMatrices none)
    : ActionDataAbstract(model, none), parts(std::move(datas)), solution(model->get_scene()) {
  make_work(*model);
}

void ActionDataJoined::make_work(const ActionModelJoined& model) {
  const Scene& scene = model.get_scene();
  for (std::size_t i = 0; i < model.get_parts().size(); ++i) {
    const ActionPart& part = model.get_parts()[i];
    const Index nu = static_cast<Index>(part.model->get_nu());
    const Index rows = static_cast<Index>(kRows * model.bonds_of_parts()[i].size());
    x.emplace_back(VectorXd::Zero(static_cast<Index>(part.x.size())));
    u.emplace_back(VectorXd::Zero(nu));
    C.emplace_back(Eigen::MatrixXd::Zero(rows, static_cast<Index>(part.dx.size())));
    D.emplace_back(Eigen::MatrixXd::Zero(rows, nu));
  }
  robots.resize(scene.robots.size());
  for (const JoinedBond& bond : model.get_bonds()) {
    const Contact& contact = scene.contacts[static_cast<std::size_t>(bond.contact)];
    for (const int r : {contact.A.robot, contact.B.robot})
      if (!robots[static_cast<std::size_t>(r)])
        robots[static_cast<std::size_t>(r)] =
            std::make_unique<OfRobot>(*scene.robots[static_cast<std::size_t>(r)].model);
    names_.push_back(contact.name);
    contacts_.push_back(bond.contact);
    rows_.push_back(contact.rows());
    const ContactSupport support = contact_support(scene, contact);
    bonds.push_back({support, {contact, support}, {scene, contact, support}});
  }
}

// ---- the model --------------------------------------------------------------------------------------------------

ActionModelJoined::ActionModelJoined(std::shared_ptr<StateMultibody> state, Scene scene, std::vector<JoinedPart> parts)
    : ActionModelAbstract(state, static_cast<std::size_t>(scene.nu), 0,
                          internal::total(kActionModelJoined, parts, &ActionModelAbstract::get_ng),
                          internal::total(kActionModelJoined, parts, &ActionModelAbstract::get_nh),
                          internal::total(kActionModelJoined, parts, &ActionModelAbstract::get_ng_T),
                          internal::total(kActionModelJoined, parts, &ActionModelAbstract::get_nh_T)),
      scene_(std::move(scene)),
      parts_(std::move(parts)),
      bonds_(bonds_between(scene_, robots_of(parts_))),
      bonds_of_(parts_.size()),
      local_robot_(scene_.robots.size()) {
  for (std::size_t b = 0; b < bonds_.size(); ++b)
    for (const int i : {bonds_[b].part_a, bonds_[b].part_b})
      bonds_of_[static_cast<std::size_t>(i)].push_back(static_cast<int>(b));
  for (const JoinedPart& part : parts_)
    for (std::size_t l = 0; l < part.robots.size(); ++l)
      local_robot_[static_cast<std::size_t>(part.robots[l])] = static_cast<int>(l);
  check_size(kActionModelJoined, "the scene's q and v", scene_.nq + scene_.nv, state_->get_nx());
  check_parts();
  const VectorXd& effort = static_cast<const StateMultibody&>(*state_).get_model()->effortLimit;
  for (const Robot& robot : scene_.robots)
    for (int k = 0; k < robot.model->nu(); ++k)
      u_ub_[robot.idx_u + k] = effort[robot.idx_v + robot.model->actuated[static_cast<std::size_t>(k)]];
  u_lb_ = -u_ub_;
  update_has_control_limits();
  internal::stack_bounds(parts_, &ActionModelAbstract::get_g_lb, g_lb_);
  internal::stack_bounds(parts_, &ActionModelAbstract::get_g_ub, g_ub_);
  internal::stack_bounds(parts_, &ActionModelAbstract::get_g_lb_T, g_lb_T_);
  internal::stack_bounds(parts_, &ActionModelAbstract::get_g_ub_T, g_ub_T_);
}

void ActionModelJoined::check_parts() const {
  const std::vector<std::vector<int>> robots = robots_of(parts_);
  for (std::size_t i = 0; i < parts_.size(); ++i) {
    const JoinedPart& part = parts_[i];
    const auto& dynamics = dynamics_of(part);
    const auto* actuation = dynamic_cast<const ActuationModelWrenches*>(dynamics.get_actuation().get());
    require(actuation && same(actuation->ends(), wrench_ends(scene_, bonds_, robots, static_cast<int>(i))),
            kActionModelJoined, "a part is expected to be actuated by ActuationModelWrenches of its wrench_ends");
    check_size(kActionModelJoined, "a part's robots", static_cast<Index>(part.robots.size()),
               static_cast<std::size_t>(dynamics.get_model().scene().nrobots()));
    check_size(kActionModelJoined, "a part's x", static_cast<Index>(part.x.size()), part.model->get_state()->get_nx());
    check_size(kActionModelJoined, "a part's dx", static_cast<Index>(part.dx.size()),
               part.model->get_state()->get_ndx());
    check_size(kActionModelJoined, "a part's u", static_cast<Index>(part.u.size()), actuation->nu_own());
  }
  internal::check_cover(kActionModelJoined, "x", state_->get_nx(), parts_, &ActionPart::x);
  internal::check_cover(kActionModelJoined, "dx", state_->get_ndx(), parts_, &ActionPart::dx);
  internal::check_cover(kActionModelJoined, "u", nu_, parts_, &ActionPart::u);
}

void ActionModelJoined::set_storage(MatrixStorage storage) {
  require(storage == MatrixStorage::kDense || storage == MatrixStorage::kSparse, "ActionModelJoined::set_storage",
          "kDense or kSparse is expected");
  storage_ = storage;
}

DataPtr ActionModelJoined::createData() {
  std::vector<DataPtr> parts;
  for (const JoinedPart& part : parts_) parts.push_back(part.model->createData());
  return createData(std::move(parts));
}

DataPtr ActionModelJoined::createData(std::vector<DataPtr> parts) {
  check_size("ActionModelJoined::createData", "the parts' data", parts.size(), parts_.size());
  for (std::size_t i = 0; i < parts_.size(); ++i)
    require(parts_[i].model->checkData(parts[i]) && parts[i]->has_matrices(), kActionModelJoined,
            "data of the parts' createData() are expected, with matrices");
  if (storage_ == MatrixStorage::kDense) return std::make_shared<ActionDataJoined>(this, std::move(parts));
  return std::make_shared<ActionDataJoined>(this, std::move(parts), WithoutMatrices{});
}

bool ActionModelJoined::checkData(const DataPtr& data) {
  const auto* own = dynamic_cast<const ActionDataJoined*>(data.get());
  if (!own || own->parts.size() != parts_.size() || own->bonds.size() != bonds_.size()) return false;
  for (std::size_t i = 0; i < parts_.size(); ++i)
    if (!parts_[i].model->checkData(own->parts[i])) return false;
  return true;
}

// Dynamics of the whole scene, and from it the bonds' wrenches.
void ActionModelJoined::solve_bonds(ActionDataJoined& d, const ConstVectorRef& x, const ConstVectorRef& u) const {
  const auto q = x.head(scene_.nq), v = x.tail(scene_.nv);
  (void)solve(scene_, q, v, u, d.solution);
  for (std::size_t r = 0; r < d.robots.size(); ++r) {
    if (!d.robots[r]) continue;
    const Robot& robot = scene_.robots[r];
    Kinematics<double>& kin = d.robots[r]->kin;
    forward_kinematics<double>(*robot.model, robot.base, q.segment(robot.idx_q, robot.model->nq), kin);
    forward_accelerations<double>(*robot.model, v.segment(robot.idx_v, robot.model->nv),
                                  d.solution.a.data() + robot.idx_v, scene_.gravity, kin);
  }
  for (std::size_t b = 0; b < bonds_.size(); ++b) {
    const Contact& contact = scene_.contacts[static_cast<std::size_t>(bonds_[b].contact)];
    ActionDataJoined::OfBond& bond = d.bonds[b];
    const Kinematics<double>& A = d.robots[static_cast<std::size_t>(contact.A.robot)]->kin;
    contact_rows<double>(scene_, contact, bond.support, A, &d.robots[static_cast<std::size_t>(contact.B.robot)]->kin,
                         bond.rows);
    const Mat3<double>& R = bond.rows.aMA.R;
    const Vec6<double> F =
        bond.rows.W.transpose() *
        d.solution.f.segment(d.solution.f_offset[static_cast<std::size_t>(bonds_[b].contact)], contact.rows());
    for (const int i : {bonds_[b].part_a, bonds_[b].part_b}) {
      const std::vector<int>& of_part = bonds_of_[static_cast<std::size_t>(i)];
      const auto k = std::find(of_part.begin(), of_part.end(), static_cast<int>(b)) - of_part.begin();
      const auto part = static_cast<std::size_t>(i);
      wrenches_of(*d.parts[part]).points[static_cast<std::size_t>(k)] = A.origin(contact.A.joint) + bond.rows.aMA.p;
      auto w = d.u[part].segment<kRows>(static_cast<Index>(parts_[part].u.size()) + kRows * k);
      w << R * F.head<3>(), R * F.tail<3>();
    }
  }
}

void ActionModelJoined::calc(const DataPtr& data, const ConstVectorRef& x, const ConstVectorRef& u) {
  check("ActionModelJoined::calc", x, u);
  auto& d = internal::own_data<ActionDataJoined>("ActionModelJoined::calc", data);
  solve_bonds(d, x, u);
  for (std::size_t i = 0; i < parts_.size(); ++i) {
    const ActionPart& part = parts_[i];
    internal::take(x, part.x, d.x[i]);
    internal::take(u, part.u, d.u[i].head(static_cast<Index>(part.u.size())));
    part.model->calc(d.parts[i], d.x[i], d.u[i]);
  }
  internal::collect_values(parts_, d.parts, d);
}

void ActionModelJoined::calc(const DataPtr& data, const ConstVectorRef& x) {
  check("ActionModelJoined::calc", x);
  auto& d = internal::own_data<ActionDataJoined>("ActionModelJoined::calc", data);
  for (std::size_t i = 0; i < parts_.size(); ++i) {
    internal::take(x, parts_[i].x, d.x[i]);
    parts_[i].model->calc(d.parts[i], d.x[i]);
  }
  internal::collect_values(parts_, d.parts, d);
}

void ActionModelJoined::collect(const DataPtr& data) const {
  auto& d = internal::own_data<ActionDataJoined>("ActionModelJoined::collect", data);
  internal::collect_values(parts_, d.parts, d);
}

void ActionModelJoined::print(std::ostream& os) const {
  os << kActionModelJoined << " {bonds=" << bonds_.size();
  for (const JoinedPart& part : parts_) os << ", " << *part.model;
  os << "}";
}

}  // namespace manycontact
