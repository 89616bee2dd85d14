#include "manycontact/contact/derivatives.hpp"

#include "manycontact/spatial/explog.hpp"

namespace manycontact {

namespace {
using V3 = Vec3<double>;
using V6 = Vec6<double>;
}  // namespace

ContactDerivatives::ContactDerivatives(const Scene& scene, const Contact& contact, const ContactSupport& support)
    : dx_dq(6, support.cols()), dx_dv(6, support.cols()) {
  chain_a = dof_chain(*scene.robots[contact.A.robot].model, contact.A.joint);
  if (contact.B.robot >= 0) chain_b = dof_chain(*scene.robots[contact.B.robot].model, contact.B.joint);
  turn.resize(3, static_cast<Eigen::Index>(chain_a.size()));
  S_b.resize(6, static_cast<Eigen::Index>(chain_b.size()));
}

namespace {

// One column: s = J_l's, P1, P2, P3 as in the header.
struct Column {
  const Contact& c;
  const ContactData<double>& d;
  Mat6<double> Jlog;
  V3 e, lin, ang;

  Column(const Contact& contact, const ContactData<double>& data) : c(contact), d(data) {
    if (c.type == ContactType::k6D) Jlog = c.alpha != 0 ? Jlog6<double>(log6<double>(d.G)) : Mat6<double>::Zero();
    e = d.G.R.transpose() * d.G.p;
    lin = d.nu.head<3>();
    ang = d.nu.tail<3>();
  }

  V6 dq(const V6& s, const V6& P1, const V6& P2) const {
    const V6 s_vB = cross_motion(s, d.vB);
    const V6 dnu = P1 + s_vB;
    const V6 dnudot = P2 - cross_motion(d.vA + d.vB, P1) + cross_motion(s, d.aB) - cross_motion(d.vA, s_vB);
    if (c.type == ContactType::k6D) return dnudot + c.alpha * (Jlog * s) + c.beta * dnu;
    V6 out = V6::Zero();
    out.head<3>() = dnudot.head<3>() + point_terms(dnu) + c.alpha * (s.head<3>() - s.tail<3>().cross(e));
    return out;
  }
  V6 dv(const V6& s, const V6& P3) const {
    const V6 dnudot = P3 - cross_motion(d.vA + d.vB, s);
    if (c.type == ContactType::k6D) return dnudot + c.beta * s;
    V6 out = V6::Zero();
    out.head<3>() = dnudot.head<3>() + point_terms(s);
    return out;
  }

 private:
  // d (nu_ang x nu_lin + beta nu_lin)
  V3 point_terms(const V6& dnu) const {
    return dnu.tail<3>().cross(lin) + ang.cross(dnu.head<3>()) + c.beta * dnu.head<3>();
  }
};

}  // namespace

void contact_derivatives(const Contact& c, const ContactSupport& support, const Kinematics<double>& kinA,
                         const Kinematics<double>* kinB, const RneaDerivatives& termsA, const RneaDerivatives* termsB,
                         const Eigen::Ref<const Eigen::VectorXd>& f, const ContactData<double>& data,
                         ContactDerivatives& d) {
  d.turns = c.reference_frame != ReferenceFrame::kLocal;
  d.x = data.x;
  d.F.noalias() = data.W.transpose() * f;
  const Column column(c, data);
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
      d.turn.col(j).noalias() = data.aMA.R.transpose() * kinA.J.col(d.chain_a[j]).tail<3>();
  for (std::size_t j = 0; j < d.chain_b.size(); ++j) d.S_b.col(j) = data.bMA.act_inverse(kinB->J.col(d.chain_b[j]));
}

}  // namespace manycontact
