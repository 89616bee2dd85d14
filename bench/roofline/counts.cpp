#include "counts.hpp"

#include "manycontact/contact/products.hpp"
#include "manycontact/detail/algorithm/crba.hpp"
#include "manycontact/detail/algorithm/rnea.hpp"
#include "manycontact/detail/algorithm/rnea_derivatives.hpp"
#include "manycontact/detail/contact/derivatives.hpp"

namespace {
double operations = 0;
}

// NOLINTBEGIN: names of the linker
extern "C" {
__float128 __real___addtf3(__float128, __float128);
__float128 __real___subtf3(__float128, __float128);
__float128 __real___multf3(__float128, __float128);
__float128 __real___divtf3(__float128, __float128);
__float128 __wrap___addtf3(__float128 a, __float128 b) { return ++operations, __real___addtf3(a, b); }
__float128 __wrap___subtf3(__float128 a, __float128 b) { return ++operations, __real___subtf3(a, b); }
__float128 __wrap___multf3(__float128 a, __float128 b) { return ++operations, __real___multf3(a, b); }
__float128 __wrap___divtf3(__float128 a, __float128 b) { return ++operations, __real___divtf3(a, b); }
}
// NOLINTEND

namespace manycontact::bench {

namespace {

// A scene's robots and contacts in quadruple precision.
struct State {
  VecX<Quad> q, v, a;
  std::vector<Kinematics<Quad>> kin;
  std::vector<std::vector<Inertia<Quad>>> Yc;
  std::vector<RneaDerivativesOf<Quad>> terms;
  std::vector<ContactSupport> supports;
  std::vector<ContactData<Quad>> rows;

  const Kinematics<Quad>* of(const Attachment& end) const { return end.robot < 0 ? nullptr : &kin[end.robot]; }
};

template <class Run>
double counted(Run&& run) {
  const double before = operations;
  run();
  return operations - before;
}

void move_robots(const Scene& scene, State& s) {
  for (const Robot& robot : scene.robots) {
    const Model& model = *robot.model;
    const int i = static_cast<int>(&robot - scene.robots.data());
    VecX<Quad> tau(model.nv);
    std::vector<Vec6<Quad>> f(model.njoints());
    std::vector<Quad> M(static_cast<std::size_t>(packed_size(model)));
    rnea<Quad>(model, robot.base, s.q.segment(robot.idx_q, model.nq), s.v.segment(robot.idx_v, model.nv),
               s.a.segment(robot.idx_v, model.nv), scene.gravity, {}, s.kin[i], f, tau);
    crba<Quad>(model, s.kin[i], s.Yc[i], M.data());
  }
}

void take_rows(const Scene& scene, State& s) {
  for (std::size_t c = 0; c < scene.contacts.size(); ++c) {
    const Contact& contact = scene.contacts[c];
    contact_rows<Quad>(scene, contact, s.supports[c], *s.of(contact.A), s.of(contact.B), s.rows[c]);
  }
}

void differentiate(const Scene& scene, State& s) {
  for (int i = 0; i < scene.nrobots(); ++i)
    rnea_derivatives<Quad>(*scene.robots[i].model, s.kin[i], s.Yc[i], {}, s.terms[i]);
  for (std::size_t c = 0; c < scene.contacts.size(); ++c) {
    const Contact& contact = scene.contacts[c];
    ContactDerivativesOf<Quad> d(scene, contact, s.supports[c]);
    const VecX<Quad> f = VecX<Quad>::Ones(contact.rows());
    contact_derivatives<Quad>(contact, s.supports[c], *s.of(contact.A), s.of(contact.B), s.terms[contact.A.robot],
                              contact.B.robot < 0 ? nullptr : &s.terms[contact.B.robot], f, s.rows[c], d);
  }
}

void multiply(const Scene& scene, State& s) {
  std::vector<std::vector<Vec6<Quad>>> u;
  std::vector<std::vector<BodyVariationOf<Quad>>> adjoint;
  for (int i = 0; i < scene.nrobots(); ++i) {
    const Model& model = *scene.robots[i].model;
    u.emplace_back(model.njoints(), Vec6<Quad>::Zero());
    const Vec6<Quad> none = Vec6<Quad>::Zero();
    adjoint.emplace_back(model.njoints(), BodyVariationOf<Quad>{none, none, none, none});
    virtual_velocities<Quad>(model, s.kin[i], s.a.data() + scene.robots[i].idx_v, u[i]);
    add_body_adjoints<Quad>(model, s.kin[i], u[i], adjoint[i]);
  }
  for (std::size_t c = 0; c < scene.contacts.size(); ++c) {
    const Contact& contact = scene.contacts[c];
    const VecX<Quad> f = VecX<Quad>::Ones(contact.rows());
    Vec6<Quad> no_motion = Vec6<Quad>::Zero();
    BodyVariationOf<Quad> ground{no_motion, no_motion, no_motion, no_motion};
    const bool moving = contact.B.robot >= 0;
    contact_adjoint<Quad>(contact, s.rows[c], u[contact.A.robot][contact.A.joint],
                          moving ? u[contact.B.robot][contact.B.joint] : no_motion, f, f,
                          adjoint[contact.A.robot][contact.A.joint],
                          moving ? adjoint[contact.B.robot][contact.B.joint] : ground);
  }
  for (int i = 0; i < scene.nrobots(); ++i) {
    const Robot& robot = scene.robots[i];
    VecX<Quad> wq = VecX<Quad>::Zero(robot.model->nv), wv = wq;
    pull_back<Quad>(*robot.model, s.kin[i], s.a.data() + robot.idx_v, u[i], adjoint[i], wq.data(), wv.data());
  }
}

}  // namespace

Operations count_operations(const Scene& scene, const Eigen::VectorXd& q, const Eigen::VectorXd& v,
                            const Eigen::VectorXd& a) {
  State s;
  s.q = q.cast<Quad>();
  s.v = v.cast<Quad>();
  s.a = a.cast<Quad>();
  for (const Robot& robot : scene.robots) {
    s.kin.emplace_back(*robot.model);
    s.Yc.emplace_back(robot.model->njoints());
    s.terms.emplace_back(*robot.model);
  }
  for (const Contact& contact : scene.contacts) {
    s.supports.push_back(contact_support(scene, contact));
    s.rows.emplace_back(contact, s.supports.back());
  }
  Operations out;
  out.motion = counted([&] { move_robots(scene, s); }) + counted([&] { take_rows(scene, s); });
  out.derivatives = counted([&] { differentiate(scene, s); });
  out.product = counted([&] { multiply(scene, s); });
  return out;
}

}  // namespace manycontact::bench
