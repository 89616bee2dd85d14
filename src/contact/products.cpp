#include "manycontact/contact/products.hpp"

#include "manycontact/contact/derivatives.hpp"
#include "manycontact/spatial/explog.hpp"

namespace manycontact {

namespace {

using V3 = Vec3<double>;
using V6 = Vec6<double>;

bool turns(const Contact& c) { return c.reference_frame != ReferenceFrame::kLocal; }

}  // namespace

void contact_tangent(const Contact& c, const ContactData<double>& d, const BodyVariation& a, const BodyVariation& b,
                     const Eigen::Ref<const Eigen::VectorXd>& f, Eigen::Ref<Eigen::VectorXd> dr2, V6& dF) {
  const V6 xi = d.aMA.act_inverse(a.xi), relative = xi - d.bMA.act_inverse(b.xi);
  // what is seen from A turns back as A is displaced
  const V6 dvA = d.aMA.act_inverse(a.v) - cross_motion(xi, d.vA), dvB = d.bMA.act_inverse(b.v) - cross_motion(xi, d.vB);
  const V6 daA = d.aMA.act_inverse(a.a) - cross_motion(xi, d.aA), daB = d.bMA.act_inverse(b.a) - cross_motion(xi, d.aB);
  const V6 dnu = dvA - dvB;
  const V6 dnudot = daA - daB - cross_motion(dvA, d.nu) - cross_motion(d.vA, dnu);
  V6 dx = V6::Zero();
  if (c.type == ContactType::k6D) {
    dx = dnudot + c.beta * dnu;
    if (c.alpha != 0) dx += c.alpha * (Jlog6<double>(log6<double>(d.G)) * relative);
  } else {
    const V3 e = d.G.R.transpose() * d.G.p;
    const V3 lin = d.nu.head<3>(), ang = d.nu.tail<3>();
    dx.head<3>() = dnudot.head<3>() + dnu.tail<3>().cross(lin) + ang.cross(dnu.head<3>()) + c.beta * dnu.head<3>() +
                   c.alpha * (relative.head<3>() - relative.tail<3>().cross(e));
  }
  const V6 F = d.W.transpose() * f;
  dF = cross_force(xi, F);
  if (turns(c)) {
    dx += turned<double>(xi.tail<3>(), d.x);
    dF -= turned<double>(xi.tail<3>(), F);
  }
  dr2.noalias() = d.W * dx;
}

void contact_adjoint(const Contact& c, const ContactData<double>& d, const V6& uA_tree, const V6& uB_tree,
                     const Eigen::Ref<const Eigen::VectorXd>& f, const Eigen::Ref<const Eigen::VectorXd>& l,
                     BodyVariation& a, BodyVariation& b) {
  const V6 uA = d.aMA.act_inverse(uA_tree), uB = d.bMA.act_inverse(uB_tree);
  const V6 F = d.W.transpose() * f, N = d.W.transpose() * l;  // N: gradient with respect to x, and nudot
  V6 gnu, relative;
  if (c.type == ContactType::k6D) {
    gnu = c.beta * N;
    relative.setZero();
    if (c.alpha != 0) relative = c.alpha * (Jlog6<double>(log6<double>(d.G)).transpose() * N);
  } else {  // N has no angular part: W has none
    const V3 n = N.head<3>(), e = d.G.R.transpose() * d.G.p;
    gnu << c.beta * n + n.cross(d.nu.tail<3>()), d.nu.head<3>().cross(n);
    relative << c.alpha * n, -c.alpha * e.cross(n);
  }
  gnu += cross_force(d.vA, N);
  const V6 gvA = gnu - cross_force(d.nu, N);
  V6 xi = relative - cross_force(d.vA, gvA) + cross_force(d.vB, gnu) - cross_force(d.aA, N) + cross_force(d.aB, N) +
          cross_force(uA, F) - cross_force(uB, F);
  if (turns(c)) {
    const V6 U = uA - uB;
    xi.tail<3>() += F.head<3>().cross(U.head<3>()) + F.tail<3>().cross(U.tail<3>()) - N.head<3>().cross(d.x.head<3>()) -
                    N.tail<3>().cross(d.x.tail<3>());
  }
  a.xi += d.aMA.act_force(xi);
  a.u -= d.aMA.act_force(F);
  a.v += d.aMA.act_force(gvA);
  a.a += d.aMA.act_force(N);
  b.xi -= d.bMA.act_force(relative);
  b.u += d.bMA.act_force(F);
  b.v -= d.bMA.act_force(gnu);
  b.a -= d.bMA.act_force(N);
}

}  // namespace manycontact
