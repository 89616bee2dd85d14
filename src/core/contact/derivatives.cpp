#include "manycontact/detail/contact/derivatives.hpp"

#include "manycontact/contact/pair_motion.hpp"
#include "spatial/pack_explog.hpp"

namespace manycontact {

template <class S>
ContactDerivativesOf<S>::ContactDerivativesOf(const Scene& scene, const Contact& contact, const ContactSupport& support)
    : dx_dq(6, support.cols()), dx_dv(6, support.cols()) {
  chain_a = dof_chain(*scene.robots[contact.A.robot].model, contact.A.joint);
  if (contact.B.robot >= 0) chain_b = dof_chain(*scene.robots[contact.B.robot].model, contact.B.joint);
  turn.resize(3, static_cast<Eigen::Index>(chain_a.size()));
  S_b.resize(6, static_cast<Eigen::Index>(chain_b.size()));
}

namespace {

// Computes column i of dx_dq and dx_dv, the derivatives of a contact's x (the rows before selection by W), from the
// column s = s_i of J_l. P1, P2, P3 are defined in detail/contact/derivatives.hpp.
template <class S>
struct Column {
  using V3 = Vec3<S>;
  using V6 = Vec6<S>;
  const Contact& c;
  const ContactData<S>& d;
  const S alpha, beta;
  Mat6<S> Jlog;
  V3 e, lin, ang, n, m;
  PairSlopes<S> pair;

  Column(const Contact& contact, const ContactData<S>& data)
      : c(contact), d(data), alpha(contact.alpha), beta(contact.beta) {
    if (c.pair) {
      pair = pair_slopes<S>(c, d);
      return;
    }
    if (c.type == ContactType::k6D && c.alpha != 0) Jlog = log6_derivative(d.G);
    e = d.G.R.transpose() * d.G.p;
    lin = d.nu.template head<3>();
    ang = d.nu.template tail<3>();
    n = c.axis.template cast<S>();
    m = d.G.R.transpose() * n;
  }

  V6 dq(const V6& s, const V6& P1, const V6& P2) const {
    const V6 s_vB = cross_motion(s, d.vB);
    const V6 dnu = P1 + s_vB;
    const V6 dnudot = P2 - cross_motion(d.vA + d.vB, P1) + cross_motion(s, d.aB) - cross_motion(d.vA, s_vB);
    if (c.pair) return dnudot + pair.by_motion * dnu + pair.by_displacement * s;
    if (c.type == ContactType::k6D && c.alpha == 0) return dnudot + beta * dnu;
    if (c.type == ContactType::k6D) return dnudot + alpha * (Jlog * s) + beta * dnu;
    V6 out = V6::Zero();
    out.template head<3>() =
        dnudot.template head<3>() + point_terms(dnu) + alpha * (s.template head<3>() - s.template tail<3>().cross(e));
    if (c.type == ContactType::k5D) {
      const V3 w = s.template tail<3>();  // the axis m of B' changes by dm = m x w
      out.template tail<3>() =
          dnudot.template tail<3>() + beta * dnu.template tail<3>() + alpha * (m.dot(n) * w - w.dot(n) * m);
    }
    return out;
  }
  V6 dv(const V6& s, const V6& P3) const {
    const V6 dnudot = P3 - cross_motion(d.vA + d.vB, s);
    if (c.pair) return dnudot + pair.by_motion * s;
    if (c.type == ContactType::k6D) return dnudot + beta * s;
    V6 out = V6::Zero();
    out.template head<3>() = dnudot.template head<3>() + point_terms(s);
    if (c.type == ContactType::k5D) out.template tail<3>() = dnudot.template tail<3>() + beta * s.template tail<3>();
    return out;
  }

 private:
  V3 point_terms(const V6& dnu) const {  // derivative of nu_ang x nu_lin + beta nu_lin
    return dnu.template tail<3>().cross(lin) + ang.cross(dnu.template head<3>()) + beta * dnu.template head<3>();
  }
};

}  // namespace

template <class S>
void contact_derivatives(const Contact& c, const ContactSupport& support, const Kinematics<S>& kinA,
                         const Kinematics<S>* kinB, const RneaDerivativesOf<S>& termsA,
                         const RneaDerivativesOf<S>* termsB, const ConstVecRef<S>& f, const ContactData<S>& data,
                         ContactDerivativesOf<S>& d) {
  d.turns = rows_turn(c);
  d.x = data.x;
  d.F.noalias() = data.W.transpose() * f;
  using V6 = Vec6<S>;
  const Column<S> column(c, data);
  int k = 0;
  for (int i : support.a) {
    const V6 s = data.Jl.col(k);
    d.dx_dq.col(k) = column.dq(s, data.aMA.act_inverse(termsA.Psid.col(i)), data.aMA.act_inverse(termsA.Psidd.col(i)));
    d.dx_dv.col(k) = column.dv(s, data.aMA.act_inverse(termsA.Sv.col(i)));
    ++k;
  }
  for (int i : support.b) {
    const V6 s = data.Jl.col(k);
    d.dx_dq.col(k) =
        column.dq(s, -data.bMA.act_inverse(termsB->Psid.col(i)), -data.bMA.act_inverse(termsB->Psidd.col(i)));
    d.dx_dv.col(k) = column.dv(s, -data.bMA.act_inverse(termsB->Sv.col(i)));
    ++k;
  }
  if (d.turns)
    for (std::size_t j = 0; j < d.chain_a.size(); ++j)
      d.turn.col(j).noalias() = data.aMA.R.transpose() * kinA.J.col(d.chain_a[j]).template tail<3>();
  for (std::size_t j = 0; j < d.chain_b.size(); ++j) d.S_b.col(j) = data.bMA.act_inverse(kinB->J.col(d.chain_b[j]));
}

using Real = InstantiatedScalar;
template struct ContactDerivativesOf<Real>;
template void contact_derivatives<Real>(const Contact&, const ContactSupport&, const Kinematics<Real>&,
                                        const Kinematics<Real>*, const RneaDerivativesOf<Real>&,
                                        const RneaDerivativesOf<Real>*, const ConstVecRef<Real>&,
                                        const ContactData<Real>&, ContactDerivativesOf<Real>&);

}  // namespace manycontact
