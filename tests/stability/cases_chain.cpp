// Chains of 10 to 1000 links that hang by one end or both.

#include <stdexcept>

#include "manycontact/algorithm/aba.hpp"
#include "stability/cases.hpp"

namespace manycontact::test {

namespace {

// Adds the solution that ABA computes without contacts, at a cost linear in the links.
void know_by_aba(Problem& p) {
  const Model& model = *p.scene.robots[0].model;
  Kinematics<Quad> kin(model);
  AbaData<Quad> data(model);
  KnownAnswer known{VecX<Quad>(model.nv), VecX<Quad>(0), Eigen::VectorXd::Ones(model.nv), Eigen::VectorXd(0)};
  const VecX<Quad> q = p.q.cast<Quad>(), v = p.v.cast<Quad>(), u = p.u.cast<Quad>();
  if (!aba<Quad>(model, p.scene.robots[0].base, q, v, u, p.scene.gravity, {}, kin, data, known.a))
    throw std::logic_error("aba");
  p.known = known;
}

}  // namespace

void add_chains(Cases& cases) {
  using enum ContactType;
  for (int n : {10, 20, 50, 100, 200, 500, 1000}) {
    const std::string name = "chain of " + std::to_string(n);
    const bool small = n <= 100;
    const bool fewer = n > 200;
    cases
        .add(name + " by one end",
             [=] {
               Problem p = chain(n, false);
               move(p, 0.1);
               know_by_aba(p);
               return p;
             })
        .small = small;
    for (ContactType type : {k3D, k6D}) {
      if (fewer && type == k6D) continue;
      cases
          .add(name + " by both ends " + to_string(type),
               [=] {
                 Problem p = chain(n, false);
                 hold(p, type, "tip");
                 move(p, 0.1);
                 return p;
               })
          .small = small;
    }
    if (fewer) continue;
    cases
        .add("floating " + name + " held 3d at both ends",
             [=] {
               Problem p = chain(n, true);
               hold(p, k3D, "link0");
               hold(p, k3D, "tip");
               return p;
             })
        .small = small;
    if (n > 100) continue;
    cases
        .add("straight " + name + " by both ends 3d",
             [=] {
               Problem p = chain(n, false);
               p.q.setZero();
               hold(p, k3D, "tip");
               return p;
             })
        .small = small;
    if (n > 50) continue;
    cases
        .add(name + ", every fourth link held 3d",
             [=] {
               Problem p = chain(n, false);
               for (int k = 3; k < n; k += 4) hold(p, k3D, "link" + std::to_string(k));
               return p;
             })
        .small = small;
    cases
        .add(name + ", tip held 6d twice",
             [=] {
               Problem p = chain(n, false);
               hold(p, k6D, "tip");
               hold(p, k6D, "tip");
               return p;
             })
        .small = small;
  }
}

}  // namespace manycontact::test
