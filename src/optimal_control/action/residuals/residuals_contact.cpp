#include <algorithm>

#include "../contacts/contact_columns.hpp"
#include "manycontact/action/residuals/contact_residuals.hpp"
#include "manycontact/detail/algorithm/frames.hpp"
#include "residual_parts.hpp"

namespace manycontact {

namespace {

struct ContactResidualData : ResidualDataAbstract {
  using ResidualDataAbstract::ResidualDataAbstract;
  FrameIndex id = 0;
  std::string name;                                     // name of the requested contact
  const ContactDataAbstract* contact = nullptr;         // set by lay_out: data of the contact
  Eigen::Matrix<double, 6, Eigen::Dynamic, 0, 6, 6> P;  // set by lay_out: unit wrenches of the contact's rows
  Eigen::MatrixXd B;                                    // set by calc: r = B f - b with the contact force f
  Eigen::VectorXd b;                                    // set by calc: b in r = B f - b
  // The following members are used if the cone's axes are not kContact.
  // set by lay_out: column of Rx for each velocity coordinate of A's robot, then of B's robot
  std::vector<int> columns;
  Mat3<double> oRX, oRF;  // set by calc: rotations to the world of the cone's axes X and the force's axes F
  Eigen::Matrix<double, 6, Eigen::Dynamic, 0, 6, 6> turned;  // 6 x 3: derivative of the wrench in X by a rotation
  Eigen::MatrixXd B_turned;                                  // nr x 3: derivative of r by a rotation
  Mat6X<double> J;                                           // workspace: frame Jacobian of A or of B'
};

// Returns the rotation from the frame of an attachment (A or B') to the world.
Mat3<double> axes_of(const DataCollector& shared, const Attachment& at) {
  if (at.robot < 0) return at.placement.R;
  const SE3<double>& base = shared.scene.robots[at.robot].base;
  return frame_placement<double>(shared.kinematics(at.robot), base, at.joint, at.placement).R;
}

// Computes the rotations oRX of the cone's axes and oRF of the force's axes.
void find_axes(const Contact& contact, ConeAxes axes, ContactResidualData& d) {
  const bool local = contact.reference_frame == ReferenceFrame::kLocal;
  const Mat3<double> oRA = axes_of(*d.shared, contact.A);
  d.oRF = local ? oRA : Mat3<double>(Mat3<double>::Identity());
  d.oRX = axes == ConeAxes::kFoot    ? oRA
          : axes == ConeAxes::kOther ? axes_of(*d.shared, contact.B)
                                     : Mat3<double>(Mat3<double>::Identity());
}

// Appends the column of Rx for each coordinate of the robot's q, or -1 if Rx has no such column.
void find_columns(const DataCollector& shared, int robot, const std::vector<int>& x_columns, std::vector<int>& out) {
  const Robot& r = shared.scene.robots[robot];
  for (int i = 0; i < r.model->nv; ++i) {
    const auto at = std::find(x_columns.begin(), x_columns.end(), r.idx_v + i);
    out.push_back(at == x_columns.end() ? -1 : static_cast<int>(at - x_columns.begin()));
  }
}

// Adds sign B_turned th_i to the column of Rx for each coordinate i of the attachment's robot, where th_i is the
// angular velocity of the attachment per velocity of this coordinate.
void add_turning(const Attachment& at, double sign, const int* columns, ContactResidualData& d, RowMajorMatrix& Rx) {
  const Robot& robot = d.shared->scene.robots[at.robot];
  auto J = d.J.leftCols(robot.model->nv);
  frame_jacobian<double>(*robot.model, d.shared->kinematics(at.robot), robot.base, at.joint, at.placement,
                         ReferenceFrame::kLocalWorldAligned, J);
  for (int i = 0; i < robot.model->nv; ++i)
    if (columns[i] >= 0) Rx.col(columns[i]) += sign * d.B_turned.lazyProduct(J.col(i).tail<3>());
}

// Computes out = B df. Zero entries of B, of which there are many, are skipped.
void multiply(const Eigen::MatrixXd& B, const PanelView& df, RowMajorMatrix& out) {
  out.setZero();
  for (Eigen::Index i = 0; i < B.rows(); ++i)
    for (Eigen::Index k = 0; k < B.cols(); ++k)
      if (B(i, k) != 0) out.row(i) += B(i, k) * df.row(k);
}

std::string dimension(ContactType type) { return std::to_string(contact_rows(type)) + "D"; }

}  // namespace

ContactResidual::ContactResidual(const char* name, std::shared_ptr<StateMultibody> state, FrameIndex id, std::size_t nr,
                                 std::size_t nu, bool fwddyn)
    : FrameResidual(name, std::move(state), id, nr, nu, {.forces = true}) {
  require(fwddyn, name, "fwddyn is false, true is expected: contact forces are results of the forward dynamics");
}

std::string ContactResidual::misfit(ContactType type) const {
  return type == ContactType::k6D ? "" : dimension(type) + ", a 6D contact is expected";
}

void ContactResidual::set_axes(ConeAxes axes) {
  require(axes == ConeAxes::kContact || is_cone(), name_,
          "only cones may have other axes than the contact, ConeAxes::kContact is expected");
  axes_ = axes;
}

std::shared_ptr<ResidualDataAbstract> ContactResidual::createData(DataCollector* shared) {
  internal::expect_motion(name_, shared);
  auto data = std::make_shared<ContactResidualData>(this, shared);
  lay_out(*data);
  return data;
}

void ContactResidual::lay_out(ResidualDataAbstract& data) const {
  auto& d = internal::own<ContactResidualData>(data);
  d.id = id_;
  d.name = contact_;
  d.contact = &d.shared->contact_on(d.id, name_, contact_);
  const Contact& contact = *d.contact->contact;
  const std::string why = misfit(contact.type);
  require(why.empty(), name_,
          "the contact on " + internal::multibody(state_).get_model()->frames[d.id].name + " is " + why);
  internal::unit_wrenches(contact.type, contact.axis, d.P);
  d.B.setZero(nr_, contact.rows());
  d.b.setZero(nr_);
  d.blocks.clear();
  if (d.contact->active && d.contact->f_x_columns && d.contact->f_u_columns)
    d.blocks.emplace_back(internal::range(0, static_cast<int>(nr_)), *d.contact->f_x_columns, *d.contact->f_u_columns);
  d.columns.clear();
  if (d.blocks.empty()) return;
  int nv = d.shared->scene.robots[contact.A.robot].model->nv;
  if (contact.B.robot >= 0) nv = std::max(nv, d.shared->scene.robots[contact.B.robot].model->nv);
  d.J.resize(6, nv);
  find_columns(*d.shared, contact.A.robot, *d.contact->f_x_columns, d.columns);
  if (contact.B.robot >= 0) find_columns(*d.shared, contact.B.robot, *d.contact->f_x_columns, d.columns);
}

bool ContactResidual::fits(const ResidualDataAbstract& data) const {
  const auto* d = dynamic_cast<const ContactResidualData*>(&data);
  require(d, name_, "the data were created by another residual, data of this residual's createData() are expected");
  return d->id == id_ && d->name == contact_;
}

void ContactResidual::evaluate(ResidualDataAbstract& data, const ConstVectorRef&, const ConstVectorRef&) const {
  auto& d = internal::own<ContactResidualData>(data);
  if (!d.contact->active) {
    d.r.setZero();
    return;
  }
  const Contact& contact = *d.contact->contact;
  internal::unit_wrenches(contact.type, contact.axis, d.P);  // again: the contact's axis may have changed since lay_out
  if (axes_ != ConeAxes::kContact) {
    find_axes(contact, axes_, d);
    const Mat3<double> turn = d.oRX.transpose() * d.oRF;
    d.P.topRows<3>() = turn * d.P.topRows<3>().eval();
    d.P.bottomRows<3>() = turn * d.P.bottomRows<3>().eval();
  }
  form(d.P, d.B, d.b);
  d.r.noalias() = d.B.lazyProduct(d.contact->f);
  d.r -= d.b;
}

void ContactResidual::fill_blocks(ResidualDataAbstract& data, const ConstVectorRef&, const ConstVectorRef&) const {
  auto& d = internal::own<ContactResidualData>(data);
  multiply(d.B, d.contact->df_dx, d.blocks[0].Rx);
  multiply(d.B, d.contact->df_du, d.blocks[0].Ru);
  if (axes_ == ConeAxes::kContact) return;
  // The wrench in world axes is w = oRF P f. Rotations th_F, th_X of the axes F and X change r = A oRX^T w by A oRX^T
  // (th_F - th_X) x w.
  const Contact& contact = *d.contact->contact;
  const Vec6<double> in_cone = d.P * d.contact->f;
  const Vec3<double> force = d.oRX * in_cone.head<3>(), moment = d.oRX * in_cone.tail<3>();
  d.turned.resize(6, 3);
  d.turned << d.oRX.transpose() * -skew<double>(force), d.oRX.transpose() * -skew<double>(moment);
  d.B_turned.resize(nr_, 3);
  form(d.turned, d.B_turned, d.b);
  const bool force_turns = contact.reference_frame == ReferenceFrame::kLocal;
  const double of_A = (force_turns ? 1 : 0) - (axes_ == ConeAxes::kFoot ? 1 : 0);
  if (of_A != 0 && contact.A.joint >= 0) add_turning(contact.A, of_A, d.columns.data(), d, d.blocks[0].Rx);
  if (axes_ == ConeAxes::kOther && moves(contact.B))
    add_turning(contact.B, -1, d.columns.data() + d.shared->scene.robots[contact.A.robot].model->nv, d, d.blocks[0].Rx);
}

ResidualModelContactForce::ResidualModelContactForce(std::shared_ptr<StateMultibody> state, FrameIndex id,
                                                     const Vec6<double>& fref, std::size_t nc, std::size_t nu,
                                                     bool fwddyn)
    : ResidualWithReference(fref, "ResidualModelContactForce", std::move(state), id, nc, nu, fwddyn) {
  require(nc == 1 || nc == 2 || nc == 3 || nc == 5 || nc == 6, name_,
          "nc is " + std::to_string(nc) + ", but 1, 2, 3, 5 or 6 is expected");
}

std::string ResidualModelContactForce::misfit(ContactType type) const {
  if (contact_rows(type) == static_cast<int>(nr_)) return "";
  return dimension(type) + ", a contact with nc = " + std::to_string(nr_) + " is expected";
}

void ResidualModelContactForce::form(const Wrenches& P, Eigen::MatrixXd& B, Eigen::VectorXd& b) const {
  B.setIdentity();
  b.noalias() = P.transpose().lazyProduct(reference_);
}

void ResidualModelContactFrictionCone::form(const Wrenches& P, Eigen::MatrixXd& B, Eigen::VectorXd&) const {
  B.noalias() = reference_.get_A().lazyProduct(P.topRows<3>());
}

void ResidualModelContactWrenchCone::form(const Wrenches& P, Eigen::MatrixXd& B, Eigen::VectorXd&) const {
  B.noalias() = reference_.get_A().lazyProduct(P);
}

void ResidualModelContactCoPPosition::form(const Wrenches& P, Eigen::MatrixXd& B, Eigen::VectorXd&) const {
  B.noalias() = reference_.get_A().lazyProduct(P);
}

}  // namespace manycontact
