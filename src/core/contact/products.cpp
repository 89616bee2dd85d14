#include "manycontact/contact/products.hpp"

#include "manycontact/contact/pair_motion.hpp"
#include "manycontact/detail/contact/derivatives.hpp"
#include "spatial/pack_explog.hpp"

namespace manycontact {

template <class S>
void contact_tangent(const Contact& c, const ContactData<S>& d, const BodyVariationOf<S>& a,
                     const BodyVariationOf<S>& b, const ConstVecRef<S>& f, VecRef<S> dr2, Vec6<S>& dF) {
  using V3 = Vec3<S>;
  using V6 = Vec6<S>;
  const V6 xi = d.aMA.act_inverse(a.xi), relative = xi - d.bMA.act_inverse(b.xi);
  // If A moves by xi, a vector that is constant in the tree frame changes in A's axes by -xi x vector.
  const V6 dvA = d.aMA.act_inverse(a.v) - cross_motion(xi, d.vA), dvB = d.bMA.act_inverse(b.v) - cross_motion(xi, d.vB);
  const V6 daA = d.aMA.act_inverse(a.a) - cross_motion(xi, d.aA), daB = d.bMA.act_inverse(b.a) - cross_motion(xi, d.aB);
  const V6 dnu = dvA - dvB;
  const V6 dnudot = daA - daB - cross_motion(dvA, d.nu) - cross_motion(d.vA, dnu);
  V6 dx = V6::Zero();
  if (c.pair) {
    const PairSlopes<S> slopes = pair_slopes<S>(c, d);
    dx = dnudot + slopes.by_motion * dnu + slopes.by_displacement * relative;
  } else if (c.type == ContactType::k6D) {
    dx = dnudot + S(c.beta) * dnu;
    if (c.alpha != 0) dx += S(c.alpha) * (log6_derivative(d.G) * relative);
  } else {
    const V3 e = d.G.R.transpose() * d.G.p;
    const V3 lin = d.nu.template head<3>(), ang = d.nu.template tail<3>();
    dx.template head<3>() = dnudot.template head<3>() + dnu.template tail<3>().cross(lin) +
                            ang.cross(dnu.template head<3>()) + S(c.beta) * dnu.template head<3>() +
                            S(c.alpha) * (relative.template head<3>() - relative.template tail<3>().cross(e));
    if (c.type == ContactType::k5D) {
      const V3 n = c.axis.cast<S>(), m = d.G.R.transpose() * n, w = relative.template tail<3>();
      dx.template tail<3>() =
          dnudot.template tail<3>() + S(c.beta) * dnu.template tail<3>() + S(c.alpha) * (m.dot(n) * w - w.dot(n) * m);
    }
  }
  const V6 F = d.W.transpose() * f;
  dF = cross_force(xi, F);
  if (rows_turn(c)) {
    dx += turned<S>(xi.template tail<3>(), d.x);
    dF -= turned<S>(xi.template tail<3>(), F);
  }
  dr2.noalias() = d.W * dx;
}

template <class S>
void contact_adjoint(const Contact& c, const ContactData<S>& d, const Vec6<S>& uA_tree, const Vec6<S>& uB_tree,
                     const ConstVecRef<S>& f, const ConstVecRef<S>& l, BodyVariationOf<S>& a, BodyVariationOf<S>& b) {
  using V3 = Vec3<S>;
  using V6 = Vec6<S>;
  const V6 uA = d.aMA.act_inverse(uA_tree), uB = d.bMA.act_inverse(uB_tree);
  const V6 F = d.W.transpose() * f, N = d.W.transpose() * l;  // N: gradient with respect to x and nudot
  V6 gnu, relative;
  if (c.pair) {
    const PairSlopes<S> slopes = pair_slopes<S>(c, d);
    gnu = slopes.by_motion.transpose() * N;
    relative = slopes.by_displacement.transpose() * N;
  } else if (c.type == ContactType::k6D) {
    gnu = S(c.beta) * N;
    relative.setZero();
    if (c.alpha != 0) relative = S(c.alpha) * (log6_derivative(d.G).transpose() * N);
  } else {  // 1D, 2D, 3D and 5D, of which only 5D has an angular part of N
    const V3 n = N.template head<3>(), e = d.G.R.transpose() * d.G.p;
    gnu << S(c.beta) * n + n.cross(d.nu.template tail<3>()), d.nu.template head<3>().cross(n);
    relative << S(c.alpha) * n, -S(c.alpha) * e.cross(n);
    if (c.type == ContactType::k5D) {
      const V3 t = N.template tail<3>(), axis = c.axis.cast<S>(), m = d.G.R.transpose() * axis;
      gnu.template tail<3>() += S(c.beta) * t;
      relative.template tail<3>() += S(c.alpha) * (m.dot(axis) * t - m.dot(t) * axis);
    }
  }
  gnu += cross_force(d.vA, N);
  const V6 gvA = gnu - cross_force(d.nu, N);
  V6 xi = relative - cross_force(d.vA, gvA) + cross_force(d.vB, gnu) - cross_force(d.aA, N) + cross_force(d.aB, N) +
          cross_force(uA, F) - cross_force(uB, F);
  if (rows_turn(c)) {
    const V6 U = uA - uB;
    xi.template tail<3>() +=
        F.template head<3>().cross(U.template head<3>()) + F.template tail<3>().cross(U.template tail<3>()) -
        N.template head<3>().cross(d.x.template head<3>()) - N.template tail<3>().cross(d.x.template tail<3>());
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

using Scalar = InstantiatedScalar;
template void contact_tangent<Scalar>(const Contact&, const ContactData<Scalar>&, const BodyVariationOf<Scalar>&,
                                      const BodyVariationOf<Scalar>&, const ConstVecRef<Scalar>&, VecRef<Scalar>,
                                      Vec6<Scalar>&);
template void contact_adjoint<Scalar>(const Contact&, const ContactData<Scalar>&, const Vec6<Scalar>&,
                                      const Vec6<Scalar>&, const ConstVecRef<Scalar>&, const ConstVecRef<Scalar>&,
                                      BodyVariationOf<Scalar>&, BodyVariationOf<Scalar>&);

}  // namespace manycontact
