#include <cmath>

#include "manycontact/action/residuals/centroidal_residuals.hpp"
#include "manycontact/action/residuals/contact_residuals.hpp"
#include "manycontact/action/residuals/frame_residuals.hpp"
#include "manycontact/action/residuals/gravity_residuals.hpp"
#include "manycontact/action/residuals/state_residuals.hpp"
#include "manycontact/spatial/explog.hpp"
#include "manycontact/task/parts.hpp"
#include "manycontact/task/rows.hpp"
#include "nodes.hpp"

namespace manycontact::task {

namespace {

struct Residual {    // one residual of a term, for one copy of a robot or contact, or for all copies
  std::string name;  // the term's name, followed by the copy's number if there are several
  std::shared_ptr<ResidualModelAbstract> model;
  int copies = 1;                // number of repetitions of the term's weights and bounds
  Eigen::VectorXd lower, upper;  // bounds of a cone
};

// Returns the motion of a term's references from the original robot to its copy `to`; the identity if not copied.
SE3<double> move(const SceneFile& file, const TaskTerm& term, int to) {
  return term.copied ? file.moved[to] : SE3<double>{};
}

Vec6<double> turned(const Mat3<double>& R, const Vec6<double>& m) {
  Vec6<double> out;
  out << R * m.head<3>(), R * m.tail<3>();
  return out;
}

Vec6<double> six(const Eigen::VectorXd& given) {
  return given.size() == 6 ? Vec6<double>(given) : Vec6<double>(Vec6<double>::Zero());
}

// Returns whether the cost depends only on |r|, so that the axes of r have no effect.
bool is_isotropic(const TaskTerm& term) {
  return term.activation == TaskActivation::kQuad && term.lower.size() == 0 && term.upper.size() == 0;
}

// Expresses a residual along the axes of its copy, to which weights and bounds apply. R rotates world axes to these.
std::shared_ptr<ResidualModelAbstract> in_own_axes(const TaskTerm& term, std::shared_ptr<ResidualModelAbstract> model,
                                                   const Mat3<double>& R) {
  const Eigen::Index nr = static_cast<Eigen::Index>(model->get_nr());
  if (nr < 3 || is_isotropic(term) || R == Mat3<double>::Identity()) return model;
  Eigen::MatrixXd X = Eigen::MatrixXd::Identity(nr, nr);
  for (Eigen::Index i = 0; i + 3 <= nr; i += 3) X.block<3, 3>(i, i) = R.transpose();
  return std::make_shared<ResidualModelTurned>(std::move(model), X);
}

// Returns the matrix of T^-1 that acts on twists [linear; angular].
Eigen::MatrixXd inverse_action(const SE3<double>& T) {
  Eigen::MatrixXd X(6, 6);
  for (int i = 0; i < 6; ++i) X.col(i) = T.act_inverse(Vec6<double>(Vec6<double>::Unit(i)));
  return X;
}

// ---- single coordinates of the scene, or of the robots

// Returns the reference for the whole scene. Coordinates that the term does not set are 0, or for a state those of x0.
Eigen::VectorXd reference_of(const TaskTerm& term, const SceneFile& file) {
  const Scene& scene = file.scene;
  const bool state = term.residual == TaskResidual::kState;
  if (!term.poses.empty() && term.reference.size() == 0)
    throw std::logic_error("a reference that is given by poses is not known yet: call fit_state first");
  if (term.reference.size() > 0 && (term.robots.empty() || !term.poses.empty())) return term.reference;
  Eigen::VectorXd out = state ? x0_of(file)
                              : Eigen::VectorXd(Eigen::VectorXd::Zero(
                                    term.residual == TaskResidual::kJointAcceleration ? scene.nv : scene.nu));
  if (term.reference.size() == 0) return out;
  for (const int r : term.robots) {
    scatter(term.reference, state ? coordinates_of(scene, {r}).x : rows_of(term.residual, scene, {r}), out);
    const Robot& robot = scene.robots[r];
    if (state && robot.model->floating_base)
      out.segment<7>(robot.idx_q) =
          pose_of_placement(move(file, term, r) * placement_of_pose(term.reference.head<7>()));
  }
  return out;
}

std::shared_ptr<ResidualModelAbstract> whole(const TaskTerm& term, const Parts& p) {
  const Eigen::VectorXd reference = reference_of(term, p.task.scene);
  switch (term.residual) {
    case TaskResidual::kState:
      return std::make_shared<ResidualModelState>(p.state, reference, p.nu());
    case TaskResidual::kJointAcceleration:
      return std::make_shared<ResidualModelJointAcceleration>(p.state, reference, p.nu());
    case TaskResidual::kJointEffort:
      return std::make_shared<ResidualModelJointEffort>(p.state, p.actuation, reference, p.nu());
    // Controls of blocks may contain wrenches of couplings after the torques.
    default: {
      Eigen::VectorXd of_all = Eigen::VectorXd::Zero(p.nu());
      of_all.head(reference.size()) = reference;
      return std::make_shared<ResidualModelControl>(p.state, of_all);
    }
  }
}

Residual of_coordinates(const TaskTerm& term, const Parts& p) {
  Residual out{term.name, whole(term, p), 1, {}, {}};
  const Scene& scene = p.task.scene.scene;
  const bool all = term.residual != TaskResidual::kControl || static_cast<int>(p.nu()) == scene.nu;
  if (term.robots.empty() || (scene.nrobots() == 1 && term.robots.size() == 1)) {
    if (!all) out.model = std::make_shared<ResidualModelRows>(out.model, internal::range(0, scene.nu));
    return out;
  }
  std::vector<int> rows;
  // There is one residual per robot, because the term's numbers are repeated for each robot.
  for (const int r : term.robots) {
    const std::vector<int> own = rows_of(term.residual, scene, {r});
    rows.insert(rows.end(), own.begin(), own.end());
  }
  out.model = std::make_shared<ResidualModelRows>(out.model, std::move(rows));
  out.copies = static_cast<int>(term.robots.size());
  return out;
}

// ---- the whole scene or a robot; a frame; a contact

std::shared_ptr<ResidualModelAbstract> of_robot(const TaskTerm& term, const Parts& p, int robot) {
  const SE3<double> T = robot < 0 ? SE3<double>{} : move(p.task.scene, term, robot);
  if (term.residual == TaskResidual::kCom)
    return in_own_axes(
        term,
        std::make_shared<ResidualModelCoMPosition>(p.state, T.R * Vec3<double>(term.reference) + T.p, p.nu(), robot),
        T.R);
  return in_own_axes(
      term, std::make_shared<ResidualModelCentroidalMomentum>(p.state, turned(T.R, six(term.reference)), p.nu(), robot),
      T.R);
}

std::shared_ptr<ResidualModelAbstract> of_frame(const TaskTerm& term, const Parts& p, int robot) {
  const Multibody& model = *p.state->get_model();
  const FrameIndex id = model.getFrameId(model.scene().robots[robot].name + "/" + term.frame);
  const SE3<double> T = move(p.task.scene, term, robot);
  switch (term.residual) {
    case TaskResidual::kFramePlacement:
      return std::make_shared<ResidualModelFramePlacement>(p.state, id, T * term.placement, p.nu());
    case TaskResidual::kFrameTranslation:
      return in_own_axes(
          term, std::make_shared<ResidualModelFrameTranslation>(p.state, id, T.R * term.placement.p + T.p, p.nu()),
          T.R);
    case TaskResidual::kFrameRotation:
      return std::make_shared<ResidualModelFrameRotation>(p.state, id, T.R * term.placement.R, p.nu());
    default: {
      const Vec6<double> twist = six(term.reference);
      const auto of = [&](const Vec6<double>& reference) {
        return std::make_shared<ResidualModelFrameVelocity>(p.state, id, reference, term.reference_frame, p.nu());
      };
      if (term.reference_frame == ReferenceFrame::kLocal) return of(twist);
      if (term.reference_frame == ReferenceFrame::kLocalWorldAligned || T.p.isZero(0))
        return in_own_axes(term, of(turned(T.R, twist)), T.R);
      return std::make_shared<ResidualModelTurned>(of(T.act(twist)), inverse_action(T));  // T also moves the origin
    }
  }
}

// Axes of a cone on a contact, and the rotation R of the cone in these, with z along the normal (contact/normal.hpp).
struct Cone {
  ConeAxes axes;
  Eigen::Matrix3d R = Eigen::Matrix3d::Identity();
};

Cone cone_of(const TaskTerm& term, const Parts& p, const Contact& contact) {
  const bool in_world = contact.B.robot < 0;
  const Mat3<double> turn =  // rotation of the copy; the scene's normals are already rotated with the copies
      term.copied && in_world ? move(p.task.scene, term, robot_of(contact)).R : Mat3<double>(Mat3<double>::Identity());
  Cone out{holds_turning(contact.type) ? ConeAxes::kFoot : ConeAxes::kWorld};
  if (term.normal || contact.normal) {
    const Vec3<double> n = term.normal ? *term.normal : Vec3<double>(turn.transpose() * *contact.normal);
    out.axes = in_world ? ConeAxes::kWorld : ConeAxes::kOther;
    out.R = turn * Eigen::Quaterniond::FromTwoVectors(Vec3<double>::UnitZ(), n).toRotationMatrix();
  } else if (out.axes == ConeAxes::kWorld) {
    out.R = turn;
  }
  const bool local = contact.reference_frame == ReferenceFrame::kLocal;
  if (out.axes == (local ? ConeAxes::kFoot : ConeAxes::kWorld)) out.axes = ConeAxes::kContact;
  return out;
}

// Returns the wrench with the numbers of the term, in the contact's reference frame. R: rotation of the copied robot.
Vec6<double> force_of(const Eigen::VectorXd& numbers, const Contact& contact, const Mat3<double>& R) {
  Vec6<double> force = Vec6<double>::Zero();
  if (numbers.size() == 0) return force;
  if (contact.type == ContactType::k1D)
    force.head<3>() = numbers[0] * contact.axis;
  else if (contact.type == ContactType::k2D)
    force[0] = numbers[0], force[2] = numbers[1];
  else if (contact.type == ContactType::k5D)
    force << R * numbers.head<3>(), across(contact.axis).transpose() * numbers.tail<2>();
  else
    force.head(numbers.size()) = numbers, force = turned(R, force);
  return force;
}

// Makes the residual A f of a cone on a contact, with its bounds.
template <class Model, class ConeOfForces>
Residual in_cone(const ConeOfForces& cone, const Parts& p, FrameIndex id, ConeAxes axes, const std::string& contact) {
  auto model = std::make_shared<Model>(p.state, id, cone, p.nu());
  model->set_axes(axes);
  model->set_contact(contact);
  return {{}, std::move(model), 1, cone.get_lb(), cone.get_ub()};
}

// Makes the residual of a contact. References, facets, weights and bounds in world axes rotate with the copy.
Residual of_contact(const TaskTerm& term, const Parts& p, int c) {
  const Contact& contact = p.task.scene.scene.contacts[c];
  const FrameIndex id = p.contacts->get_contacts().at(contact.name)->contact->get_id();
  const auto [axes, R] = cone_of(term, p, contact);
  switch (term.residual) {
    case TaskResidual::kFrictionCone:
      return in_cone<ResidualModelContactFrictionCone>(FrictionCone(R, term.mu, 4, false), p, id, axes, contact.name);
    case TaskResidual::kWrenchCone:
      return in_cone<ResidualModelContactWrenchCone>(WrenchCone(R, term.mu, term.box, 4, false), p, id, axes,
                                                     contact.name);
    case TaskResidual::kCop:
      return in_cone<ResidualModelContactCoPPosition>(CoPSupport(R, term.box), p, id, axes, contact.name);
    default: {
      Mat3<double> turn = Mat3<double>::Identity();
      if (contact.reference_frame != ReferenceFrame::kLocal) turn = move(p.task.scene, term, robot_of(contact)).R;
      auto model = std::make_shared<ResidualModelContactForce>(p.state, id, force_of(term.reference, contact, turn),
                                                               contact.rows(), p.nu());
      model->set_contact(contact.name);
      return {{}, in_own_axes(term, std::move(model), turn), 1, {}, {}};
    }
  }
}

std::vector<Residual> residuals_of(const TaskTerm& term, const Parts& p) {
  const auto one = [&](std::shared_ptr<ResidualModelAbstract> model) {
    return Residual{term.name, std::move(model), 1, {}, {}};
  };
  const auto each = [&](const std::vector<int>& copies, auto&& make) {  // make(number of the robot or contact)
    std::vector<Residual> out;
    for (std::size_t i = 0; i < copies.size(); ++i) {
      out.push_back(make(copies[i]));
      out.back().name = copies.size() > 1 ? term.name + std::to_string(i) : term.name;
    }
    return out;
  };
  switch (term.residual) {
    case TaskResidual::kState:
    case TaskResidual::kControl:
    case TaskResidual::kJointEffort:
    case TaskResidual::kJointAcceleration:
      return {of_coordinates(term, p)};
    case TaskResidual::kControlGrav:
      return {one(std::make_shared<ResidualModelControlGrav>(p.state, p.nu()))};
    case TaskResidual::kContactControlGrav:
      return {one(std::make_shared<ResidualModelContactControlGrav>(p.state, p.nu()))};
    case TaskResidual::kCom:
    case TaskResidual::kCentroidalMomentum:
      if (term.robots.empty()) return {one(of_robot(term, p, -1))};
      return each(term.robots, [&](int robot) { return one(of_robot(term, p, robot)); });
    case TaskResidual::kFramePlacement:
    case TaskResidual::kFrameTranslation:
    case TaskResidual::kFrameRotation:
    case TaskResidual::kFrameVelocity:
      return each(term.robots, [&](int robot) { return one(of_frame(term, p, robot)); });
    default:
      return each(term.contacts, [&](int contact) { return of_contact(term, p, contact); });
  }
}

Eigen::VectorXd repeated(const Eigen::VectorXd& x, int copies) { return x.replicate(copies, 1); }

Eigen::VectorXd lower_of(const TaskTerm& term, const Residual& r) {
  return term.lower.size() > 0 ? repeated(term.lower, r.copies) : r.lower;
}
Eigen::VectorXd upper_of(const TaskTerm& term, const Residual& r) {
  return term.upper.size() > 0 ? repeated(term.upper, r.copies) : r.upper;
}

std::shared_ptr<ActivationModelAbstract> activation_of(const TaskTerm& term, const Residual& r) {
  switch (term.activation) {
    case TaskActivation::kQuad:
      return std::make_shared<ActivationModelQuad>(r.model->get_nr());
    case TaskActivation::kWeightedQuad:
      return std::make_shared<ActivationModelWeightedQuad>(repeated(term.weights, r.copies));
    case TaskActivation::kSmooth1Norm:
      return std::make_shared<ActivationModelSmooth1Norm>(r.model->get_nr(), term.eps);
    case TaskActivation::kQuadraticBarrier:
      return std::make_shared<ActivationModelQuadraticBarrier>(ActivationBounds(lower_of(term, r), upper_of(term, r)));
    case TaskActivation::kWeightedQuadraticBarrier:
      return std::make_shared<ActivationModelWeightedQuadraticBarrier>(
          ActivationBounds(lower_of(term, r), upper_of(term, r)), repeated(term.weights, r.copies));
  }
  return nullptr;
}

}  // namespace

Eigen::VectorXd x0_of(const SceneFile& file) {
  Eigen::VectorXd x0(file.scene.nq + file.scene.nv);
  x0 << file.q, file.v;
  return x0;
}

void add_cost(const TaskTerm& term, const Parts& p, CostModelSum& costs) {
  for (const Residual& r : residuals_of(term, p))
    costs.addCost(r.name, std::make_shared<CostModelResidual>(p.state, activation_of(term, r), r.model), term.weight);
}

// Adds one constraint for each residual of the term. Rows without a finite bound are left out.
void add_constraint(const TaskTerm& term, const Parts& p, ConstraintModelManager& constraints) {
  for (Residual& r : residuals_of(term, p)) {
    const Eigen::VectorXd lower = lower_of(term, r), upper = upper_of(term, r);
    std::vector<int> bounded;
    for (Eigen::Index i = 0; i < lower.size(); ++i)
      if (std::isfinite(lower[i]) || std::isfinite(upper[i])) bounded.push_back(static_cast<int>(i));
    if (bounded.empty()) continue;
    const bool all = static_cast<Eigen::Index>(bounded.size()) == lower.size();
    const std::shared_ptr<ResidualModelAbstract> model =
        all ? r.model : std::make_shared<ResidualModelRows>(r.model, bounded);
    constraints.addConstraint(
        r.name, std::make_shared<ConstraintModelResidual>(p.state, model, lower(bounded), upper(bounded)));
  }
}

}  // namespace manycontact::task
