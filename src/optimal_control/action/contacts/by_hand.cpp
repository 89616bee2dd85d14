// Evaluates contacts and impulses standalone, without an action model, at a given motion (as in Crocoddyl).

#include "../named.hpp"
#include "contact_columns.hpp"
#include "manycontact/action/impulse.hpp"
#include "manycontact/detail/action/collector.hpp"
#include "manycontact/detail/algorithm/frames.hpp"

namespace manycontact {

namespace {

MultibodyData& motion_of(const char* where, const ContactDataAbstract& data) {
  require(
      data.pinocchio != nullptr, where,
      "the data belong to an action model, which evaluates the data; data of createData(MultibodyData*) are expected");
  return *data.pinocchio;
}

const Kinematics<double>* of_B(const Contact& contact, const std::vector<Kinematics<double>>& motion) {
  return contact.B.robot >= 0 ? &motion[contact.B.robot] : nullptr;
}

internal::EndColumns columns_of(const Scene& scene, const Contact& contact) {
  return {scene.robots[contact.A.robot].idx_v, contact.B.robot >= 0 ? scene.robots[contact.B.robot].idx_v : 0};
}

struct Rows {  // The constraint rows of a contact at a motion.
  Rows(const Scene& scene, const Contact& contact, const std::vector<Kinematics<double>>& motion)
      : support(contact_support(scene, contact)), at(contact, support) {
    contact_rows<double>(scene, contact, support, motion[contact.A.robot], of_B(contact, motion), at);
  }
  ContactSupport support;
  ContactData<double> at;
};

// Computes the constraint rows of a contact at the motion m, and stores J in the data.
Rows take_rows(const MultibodyData& m, const Contact& contact, ContactDataAbstract& data) {
  data.own_contact = contact;
  Rows rows(m.scene, contact, m.motion);
  data.Jc.setZero();
  internal::each_column(columns_of(m.scene, contact), rows.support,
                        [&](int to, int k) { data.Jc.col(to) += rows.at.J.col(k); });
  return rows;
}

// Computes d(J a + a0)/d[q | v] at the motion. terms: derivatives of the inverse dynamics (RNEA) at this motion.
void differentiate_rows(const Scene& scene, const Contact& contact, const std::vector<Kinematics<double>>& motion,
                        const std::vector<RneaDerivatives>& terms, Eigen::MatrixXd& out) {
  const Rows rows(scene, contact, motion);
  ContactDerivatives d(scene, contact, rows.support);
  const auto a = static_cast<std::size_t>(contact.A.robot);
  contact_derivatives<double>(contact, rows.support, motion[a], of_B(contact, motion), terms[a],
                              contact.B.robot >= 0 ? &terms[contact.B.robot] : nullptr,
                              Eigen::VectorXd::Zero(contact.rows()), rows.at, d);
  internal::set_drift_derivatives(columns_of(scene, contact), rows.support, rows.at, d, out);
}

void make_room(const Contact& contact, std::size_t nv, std::size_t nu, ContactDataAbstract& data) {
  const Eigen::Index nc = contact.rows(), n = static_cast<Eigen::Index>(nv);
  data.own_contact = contact;
  data.contact = &data.own_contact;
  data.Jc.setZero(nc, n);
  data.a0.setZero(nc);
  data.da0_dx.setZero(nc, 2 * n);
  data.dv0_dq.setZero(nc, n);
  data.f.setZero(nc);
  data.f.type = contact.type;
  data.f.axis = contact.axis;
  data.v_columns = internal::range(0, static_cast<int>(n));
  data.own_x_columns = internal::range(0, static_cast<int>(2 * n));
  data.own_u_columns = internal::range(0, static_cast<int>(nu));
  data.f_x_columns = &data.own_x_columns;
  data.f_u_columns = &data.own_u_columns;
  data.own_df_dx.setZero(nc, 2 * n);
  data.own_df_du.setZero(nc, nu);
  const auto view = [](const RowMajorMatrix& own, PanelView& out) {
    new (&out) PanelView(own.data(), own.rows(), own.cols(), Eigen::OuterStride<>(own.cols()));
  };
  view(data.own_df_dx, data.df_dx);
  view(data.own_df_du, data.df_du);
}

std::shared_ptr<ContactDataAbstract> create(const ContactModelAbstract& model, std::size_t nu, MultibodyData* motion) {
  require(motion != nullptr, "createData", "the motion is a null pointer, a MultibodyData is expected");
  auto data = std::make_shared<ContactDataAbstract>();
  make_room(model.get_contact(), model.get_state()->get_nv(), nu, *data);
  data->pinocchio = motion;
  data->frame = model.get_id();
  return data;
}

void copy_matrix(const char* where, const Eigen::MatrixXd& from, RowMajorMatrix& to) {
  check_size(where, "a derivative's rows", from.rows(), static_cast<std::size_t>(to.rows()));
  check_size(where, "a derivative's columns", from.cols(), static_cast<std::size_t>(to.cols()));
  to = from;
}

const ContactModelAbstract& model_of(const ContactItem& item) { return *item.contact; }
const ImpulseModelAbstract& model_of(const ImpulseItem& item) { return *item.impulse; }

// Calls use(model, data, first row in the stack, number of rows) for each active contact or impulse of a stack.
template <class Parts, class Data, class Use>
void each_active(const char* where, const Parts& parts, const std::shared_ptr<Data>& data, Use&& use) {
  require(parts.size() == check_data(where, data).contacts.size(), where,
          "parts were added or removed since the data were created, new data are expected");
  Eigen::Index row = 0;
  internal::for_each_part(
      parts, data->contacts, [](const auto& item) { return item.active; },
      [&](const auto& item, const auto& d) {
        use(model_of(item), d, row, d->Jc.rows());
        row += d->Jc.rows();
      });
}

template <class Parts, class Data>
void set_zero_of_inactive(const Parts& parts, Data& data) {
  internal::for_each_part(
      parts, data, [](const auto& item) { return !item.active; },
      [](const auto&, const auto& d) {
        d->f.setZero();
        d->fext.setZero();
        d->own_df_dx.setZero();
        d->own_df_du.setZero();
      });
}

void sum_forces(ContactDataMultiple& data) {
  for (SpatialForce& f : data.fext) f.setZero();
  for (const auto& [name, contact] : data.contacts) {
    const Attachment& A = contact->contact->A;
    if (A.joint < 0) continue;
    std::size_t first = 0;
    for (int r = 0; r < A.robot; ++r) first += contact->pinocchio->motion[r].oMi.size();
    data.fext[first + static_cast<std::size_t>(A.joint)] += contact->fext;
  }
}

// Creates the data of all contacts or impulses of a stack, and allocates the stack's matrices for nc rows.
template <class Parts, class Data>
void make_room_for_all(const Parts& parts, std::size_t nc, std::size_t nv, MultibodyData* motion, Data& data) {
  for (const auto& [name, item] : parts) data.contacts[name] = model_of(*item).createData(motion);
  const auto rows = static_cast<Eigen::Index>(nc), n = static_cast<Eigen::Index>(nv);
  data.Jc.setZero(rows, n);
  data.a0.setZero(rows);
  data.da0_dx.setZero(rows, 2 * n);
  data.dv.setZero(n);
  data.ddv_dx.setZero(n, 2 * n);
  std::size_t joints = 0;
  for (const Kinematics<double>& kin : motion->motion) joints += kin.oMi.size();
  data.fext.resize(joints);
}

// Sets the forces of active contacts (nc rows in all), zeroes those of inactive contacts, and sums them for each body.
template <class Parts, class Data>
void update_forces(const char* where, const char* what, const Parts& parts, std::size_t nc,
                   const std::shared_ptr<Data>& data, const Eigen::VectorXd& force) {
  check_size(where, what, force.size(), nc);
  each_active(where, parts, data, [&](const auto& model, const auto& d, Eigen::Index row, Eigen::Index n) {
    model.updateForce(d, force.segment(row, n));
  });
  set_zero_of_inactive(parts, data->contacts);
  sum_forces(*data);
}

}  // namespace

Vec6<double> ContactForce::toVector() const {
  Eigen::Matrix<double, 6, Eigen::Dynamic, 0, 6, 6> P;
  internal::unit_wrenches(type, axis, P);
  return P * *this;
}

std::shared_ptr<ContactDataAbstract> ContactModelAbstract::createData(MultibodyData* data) const {
  return create(*this, nu_, data);
}

void ContactModelAbstract::calc(const DataPtr& data, const ConstVectorRef&) const {
  const MultibodyData& m = motion_of("ContactModel::calc", check_data("ContactModel::calc", data));
  data->a0 = take_rows(m, contact_, *data).at.a0;
}

void ContactModelAbstract::calcDiff(const DataPtr& data, const ConstVectorRef&) const {
  const MultibodyData& m = motion_of("ContactModel::calcDiff", check_data("ContactModel::calcDiff", data));
  differentiate_rows(m.scene, contact_, m.motion, m.terms, data->da0_dx);
}

void ContactModelAbstract::updateForce(const DataPtr& data, const Eigen::VectorXd& force) const {
  const MultibodyData& m = motion_of("ContactModel::updateForce", check_data("ContactModel::updateForce", data));
  check_size("ContactModel::updateForce", "force", force.size(), get_nc());
  data->own_contact = contact_;
  data->f = force;
  data->f.axis = contact_.axis;
  Vec6<double> on_A = data->f.toVector();  // wrench in A's axes
  if (rows_turn(contact_)) {
    const auto r = static_cast<std::size_t>(contact_.A.robot);
    const Mat3<double> R =
        frame_placement<double>(m.motion[r], m.scene.robots[r].base, contact_.A.joint, contact_.A.placement).R;
    on_A << R.transpose() * on_A.head<3>(), R.transpose() * on_A.tail<3>();
  }
  data->fext = contact_.A.placement.act_force(on_A);
}

void ContactModelAbstract::updateForceDiff(const DataPtr& data, const Eigen::MatrixXd& df_dx,
                                           const Eigen::MatrixXd& df_du) const {
  constexpr const char* kWhere = "ContactModel::updateForceDiff";
  (void)motion_of(kWhere, check_data(kWhere, data));
  copy_matrix(kWhere, df_dx, data->own_df_dx);
  copy_matrix(kWhere, df_du, data->own_df_du);
}

void ContactModelAbstract::setZeroForce(const DataPtr& data) const {
  check_data("ContactModel::setZeroForce", data).f.setZero();
  data->fext.setZero();
}

void ContactModelAbstract::setZeroForceDiff(const DataPtr& data) const {
  check_data("ContactModel::setZeroForceDiff", data).own_df_dx.setZero();
  data->own_df_du.setZero();
}

// ---- stack of contacts

std::shared_ptr<ContactDataMultiple> ContactModelMultiple::createData(MultibodyData* motion) const {
  auto data = std::make_shared<ContactDataMultiple>();
  make_room_for_all(parts_, nc_total_, state_->get_nv(), motion, *data);
  return data;
}

void ContactModelMultiple::calc(const DataPtr& data, const ConstVectorRef& x) const {
  each_active("ContactModelMultiple::calc", parts_, data,
              [&](const auto& contact, const auto& d, Eigen::Index row, Eigen::Index n) {
                contact.calc(d, x);
                data->Jc.middleRows(row, n) = d->Jc;
                data->a0.segment(row, n) = d->a0;
              });
}

void ContactModelMultiple::calcDiff(const DataPtr& data, const ConstVectorRef& x) const {
  each_active("ContactModelMultiple::calcDiff", parts_, data,
              [&](const auto& contact, const auto& d, Eigen::Index row, Eigen::Index n) {
                contact.calcDiff(d, x);
                data->da0_dx.middleRows(row, n) = d->da0_dx;
              });
}

void ContactModelMultiple::updateForce(const DataPtr& data, const Eigen::VectorXd& force) const {
  update_forces("ContactModelMultiple::updateForce", "force", parts_, nc_, data, force);
}

void ContactModelMultiple::updateForceDiff(const DataPtr& data, const Eigen::MatrixXd& df_dx,
                                           const Eigen::MatrixXd& df_du) const {
  constexpr const char* kWhere = "ContactModelMultiple::updateForceDiff";
  check_size(kWhere, "df_dx's rows", df_dx.rows(), nc_);
  check_size(kWhere, "df_du's rows", df_du.rows(), nc_);
  each_active(kWhere, parts_, data, [&](const auto& contact, const auto& d, Eigen::Index row, Eigen::Index n) {
    contact.updateForceDiff(d, df_dx.middleRows(row, n), df_du.middleRows(row, n));
  });
  set_zero_of_inactive(parts_, data->contacts);
}

void ContactModelMultiple::updateAcceleration(const DataPtr& data, const Eigen::VectorXd& dv) const {
  check_size("ContactModelMultiple::updateAcceleration", "dv", dv.size(), state_->get_nv());
  check_data("ContactModelMultiple::updateAcceleration", data).dv = dv;
}

void ContactModelMultiple::updateAccelerationDiff(const DataPtr& data, const Eigen::MatrixXd& ddv_dx) const {
  constexpr const char* kWhere = "ContactModelMultiple::updateAccelerationDiff";
  check_size(kWhere, "ddv_dx's rows", ddv_dx.rows(), state_->get_nv());
  check_size(kWhere, "ddv_dx's columns", ddv_dx.cols(), state_->get_ndx());
  check_data(kWhere, data).ddv_dx = ddv_dx;
}

// ---- impulses

std::shared_ptr<ImpulseDataAbstract> ImpulseModelAbstract::createData(MultibodyData* data) const {
  return create(*contact_, 0, data);
}

void ImpulseModelAbstract::calc(const DataPtr& data, const ConstVectorRef&) const {
  const MultibodyData& m = motion_of("ImpulseModel::calc", check_data("ImpulseModel::calc", data));
  (void)take_rows(m, contact_->get_contact(), *data);
}

// Computes d(J v)/dq as the derivative of a contact's J a + a0, at zero velocity, zero gravity and accelerations a = v.
void ImpulseModelAbstract::calcDiff(const DataPtr& data, const ConstVectorRef&) const {
  const MultibodyData& m = motion_of("ImpulseModel::calcDiff", check_data("ImpulseModel::calcDiff", data));
  std::vector<Kinematics<double>> motion = m.motion;
  std::vector<RneaDerivatives> terms = m.terms;
  const Eigen::VectorXd rest = Eigen::VectorXd::Zero(m.scene.nv);
  for (std::size_t r = 0; r < motion.size(); ++r) {
    const Robot& robot = m.scene.robots[r];
    const std::span<const Inertia<double>> Yc = composite_inertias(m.scene, m.solution, static_cast<int>(r));
    forward_accelerations<double>(*robot.model, rest.segment(robot.idx_v, robot.model->nv), m.v.data() + robot.idx_v,
                                  Vec3<double>::Zero(), motion[r]);
    rnea_derivatives<double>(*robot.model, motion[r], {Yc.begin(), Yc.end()}, {}, terms[r]);
  }
  Scene scene = m.scene;
  scene.gravity.setZero();
  Eigen::MatrixXd by_x(data->dv0_dq.rows(), 2 * data->dv0_dq.cols());
  differentiate_rows(scene, contact_->get_contact(), motion, terms, by_x);
  data->dv0_dq = by_x.leftCols(data->dv0_dq.cols());
}

void ImpulseModelAbstract::updateForceDiff(const DataPtr& data, const Eigen::MatrixXd& df_dx) const {
  contact_->updateForceDiff(data, df_dx, Eigen::MatrixXd(data->own_df_du));
}

std::shared_ptr<ImpulseDataMultiple> ImpulseModelMultiple::createData(MultibodyData* motion) const {
  auto data = std::make_shared<ImpulseDataMultiple>();
  const std::size_t nv = get_state()->get_nv();
  make_room_for_all(parts_, get_nc_total(), nv, motion, *data);
  const auto n = static_cast<Eigen::Index>(nv);
  data->dv0_dq.setZero(get_nc_total(), n);
  data->vnext.setZero(n);
  data->dvnext_dx.setZero(n, 2 * n);
  return data;
}

void ImpulseModelMultiple::calc(const DataPtr& data, const ConstVectorRef& x) const {
  each_active("ImpulseModelMultiple::calc", parts_, data,
              [&](const auto& impulse, const auto& d, Eigen::Index row, Eigen::Index n) {
                impulse.calc(d, x);
                data->Jc.middleRows(row, n) = d->Jc;
              });
}

void ImpulseModelMultiple::calcDiff(const DataPtr& data, const ConstVectorRef& x) const {
  each_active("ImpulseModelMultiple::calcDiff", parts_, data,
              [&](const auto& impulse, const auto& d, Eigen::Index row, Eigen::Index n) {
                impulse.calcDiff(d, x);
                data->dv0_dq.middleRows(row, n) = d->dv0_dq;
              });
}

void ImpulseModelMultiple::updateForce(const DataPtr& data, const Eigen::VectorXd& impulse) const {
  update_forces("ImpulseModelMultiple::updateForce", "impulse", parts_, get_nc(), data, impulse);
}

void ImpulseModelMultiple::updateForceDiff(const DataPtr& data, const Eigen::MatrixXd& df_dx) const {
  constexpr const char* kWhere = "ImpulseModelMultiple::updateForceDiff";
  check_size(kWhere, "df_dx's rows", df_dx.rows(), get_nc());
  each_active(kWhere, parts_, data, [&](const auto& impulse, const auto& d, Eigen::Index row, Eigen::Index n) {
    impulse.updateForceDiff(d, df_dx.middleRows(row, n));
  });
  set_zero_of_inactive(parts_, data->contacts);
}

void ImpulseModelMultiple::updateVelocity(const DataPtr& data, const Eigen::VectorXd& vnext) const {
  check_size("ImpulseModelMultiple::updateVelocity", "vnext", vnext.size(), get_state()->get_nv());
  check_data("ImpulseModelMultiple::updateVelocity", data).vnext = vnext;
}

void ImpulseModelMultiple::updateVelocityDiff(const DataPtr& data, const Eigen::MatrixXd& dvnext_dx) const {
  constexpr const char* kWhere = "ImpulseModelMultiple::updateVelocityDiff";
  check_size(kWhere, "dvnext_dx's rows", dvnext_dx.rows(), get_state()->get_nv());
  check_size(kWhere, "dvnext_dx's columns", dvnext_dx.cols(), get_state()->get_ndx());
  check_data(kWhere, data).dvnext_dx = dvnext_dx;
}

}  // namespace manycontact
