// Misuse of the action layer throws, in every build, and the message names the given and the expected value.

#include "action/walker.hpp"

namespace manycontact::test {
namespace {

template <class Exception, class Call>
void expect_refused(const char* file, int line, Call&& call, const std::vector<std::string>& words) {
  testing::ScopedTrace trace(file, line, "");
  try {
    call();
    ADD_FAILURE() << "nothing was thrown";
  } catch (const Exception& e) {
    for (const std::string& word : words)
      EXPECT_NE(std::string(e.what()).find(word), std::string::npos) << "\"" << word << "\" is not in: " << e.what();
  } catch (const std::exception& e) {
    ADD_FAILURE() << "another exception: " << e.what();
  }
}
#define EXPECT_INVALID(call, ...) \
  expect_refused<std::invalid_argument>(__FILE__, __LINE__, [&] { call; }, {__VA_ARGS__})

std::string n(std::size_t number) { return std::to_string(number); }

class Misuse : public testing::Test {
 protected:
  Walker w;
  std::shared_ptr<ActionModel> model;
  DataPtr data;
  Eigen::VectorXd u;

  Misuse() {
    w.add_costs();
    w.constraints->addConstraint("com", w.com_within(-1, 1));
    model = w.model();
    data = model->createData();
    u = w.u;
  }
};

TEST_F(Misuse, SizesOfTheState) {
  const std::size_t nx = w.state->get_nx();
  for (std::size_t given : {std::size_t(0), nx - 1, nx + 1, w.state->get_ndx()}) {
    const Eigen::VectorXd x = Eigen::VectorXd::Zero(given);
    const std::string what = "x has " + n(given) + " numbers, expected " + n(nx);
    EXPECT_INVALID(model->calc(data, x, u), "::calc", what);
    EXPECT_INVALID(model->calc(data, x), "::calc", what);
    EXPECT_INVALID(model->quasiStatic(data, u, x), "::quasiStatic", what);
    EXPECT_INVALID(model->quasiStatic_x(data, x), "::quasiStatic", what);
    model->calc(data, w.x, u);
    EXPECT_INVALID(model->calcDiff(data, x, u), "::calcDiff", what);
    model->calc(data, w.x);
    EXPECT_INVALID(model->calcDiff(data, x), "::calcDiff", what);
    const DataPtr numbers = DifferentialActionModelNumDiff(model).createData();
    EXPECT_INVALID(DifferentialActionModelNumDiff(model).calc(numbers, x, u), what);
    EXPECT_INVALID(w.actuation->calc(w.actuation->createData(), x, u), what);
    EXPECT_INVALID(w.actuation->calcDiff(w.actuation->createData(), x, u), what);
    EXPECT_INVALID(w.costs->calc(as_fwddyn(data).costs, x, u), what);
    EXPECT_INVALID(w.constraints->calc(as_fwddyn(data).constraints, x, u), what);
  }
}

TEST_F(Misuse, SizesOfTheControl) {
  for (std::size_t given : {std::size_t(0), w.nu - 1, w.nu + 1, w.state->get_nv()}) {
    Eigen::VectorXd other = Eigen::VectorXd::Zero(given);
    const std::string what = "u has " + n(given) + " numbers, expected " + n(w.nu);
    EXPECT_INVALID(model->calc(data, w.x, other), "::calc", what);
    EXPECT_INVALID(model->quasiStatic(data, other, w.x_rest), "::quasiStatic", what);
    model->calc(data, w.x, u);
    EXPECT_INVALID(model->calcDiff(data, w.x, other), "::calcDiff", what);
    EXPECT_INVALID(w.actuation->calc(w.actuation->createData(), w.x, other), what);
    EXPECT_INVALID(w.costs->calc(as_fwddyn(data).costs, w.x, other), what);
    EXPECT_INVALID(w.constraints->calc(as_fwddyn(data).constraints, w.x, other), what);
  }
}

TEST_F(Misuse, SizesInSetters) {
  const Eigen::VectorXd two = Eigen::Vector2d::Zero();
  EXPECT_INVALID(model->set_u_lb(two), "u_lb has 2 numbers, expected " + n(w.nu));
  EXPECT_INVALID(model->set_u_ub(two), "u_ub has 2 numbers, expected " + n(w.nu));
  EXPECT_INVALID(model->set_g_lb(two), "g_lb has 2 numbers, expected 3");
  EXPECT_INVALID(model->set_g_ub(two), "g_ub has 2 numbers, expected 3");
  EXPECT_INVALID(model->set_armature(two), "armature has 2 numbers, expected " + n(w.state->get_nv()));
  EXPECT_INVALID(w.state->set_lb(two), "lb has 2 numbers, expected " + n(w.state->get_nx()));
  EXPECT_INVALID(ResidualModelState(w.state, two, w.nu), "2 numbers, expected " + n(w.state->get_nx()));
  EXPECT_INVALID(ResidualModelControl(w.state, w.nu).set_reference(two), "2 numbers, expected " + n(w.nu));
}

TEST_F(Misuse, NumbersOutOfRange) {
  EXPECT_INVALID(model->set_damping_factor(-1), "set_damping_factor", "-1.0", "not negative is expected");
  EXPECT_INVALID(model->set_damping_factor(NAN), "nan", "not negative is expected");
  EXPECT_INVALID(ActionModel(w.state, w.actuation, w.contacts, w.costs, -0.5), "-0.5", "not negative is expected");
  EXPECT_INVALID(ActionModel(w.state, w.actuation, w.contacts, w.costs, w.constraints, -0.5), "-0.5");
  Eigen::VectorXd armature = model->get_armature();
  armature[7] = -2;
  EXPECT_INVALID(model->set_armature(armature), "set_armature", "-2.0", "not negative are expected");
  armature[7] = NAN;
  EXPECT_INVALID(model->set_armature(armature), "nan", "finite");
  EXPECT_INVALID(w.left_contact->set_gains(Eigen::Vector2d(1, INFINITY)), "beta = inf", "finite numbers are expected");
  EXPECT_INVALID(model->quasiStatic_x(data, w.x), "the velocity is not zero", "at rest is expected");
  EXPECT_INVALID(w.com_within(1, -1), "lower 1.0", "upper -1.0", "lower <= upper is expected");
}

TEST_F(Misuse, DataOfAnotherModel) {
  const auto other = w.model();
  const DataPtr base = std::make_shared<DifferentialActionDataAbstract>(model.get());
  for (const DataPtr& wrong : {other->createData(), base, DifferentialActionModelNumDiff(model).createData()}) {
    const std::string what = "created by another model, data of this model's createData() are expected";
    EXPECT_INVALID(model->calc(wrong, w.x, u), "::calc", what);
    EXPECT_INVALID(model->calc(wrong, w.x), "::calc", what);
    EXPECT_INVALID(model->calcDiff(wrong, w.x, u), "::calcDiff", what);
    EXPECT_INVALID(model->calcDiff(wrong, w.x), "::calcDiff", what);
    EXPECT_INVALID(model->quasiStatic(wrong, u, w.x_rest), "::quasiStatic", what);
    EXPECT_INVALID(model->quasiStatic_x(wrong, w.x_rest), "::quasiStatic", what);
  }
  EXPECT_INVALID(DifferentialActionModelNumDiff(model).calc(data, w.x, u), "another model");
}

// A new model may have the address of a destroyed one; a copy shares the parts, and so the data.
TEST_F(Misuse, DataOfAModelThatIsGone) {
  alignas(ActionModel) std::byte place[sizeof(ActionModel)];
  auto* first = new (place) ActionModel(*w.model());
  const DataPtr old = first->createData();
  ActionModel copy = *first;
  EXPECT_TRUE(copy.checkData(old));
  EXPECT_EQ(difference_of(*evaluated(copy, w.x, u, old), *evaluated(*model, w.x, u)), 0);
  first->~ActionModel();
  auto* second =
      new (place) ActionModel(w.state, w.actuation, w.contacts, std::make_shared<CostModelSum>(w.state, w.nu));
  EXPECT_FALSE(second->checkData(old));
  EXPECT_INVALID(second->calc(old, w.x, u), "created by another model");
  second->~ActionModel();
}

TEST_F(Misuse, NullData) {
  const std::string what = "the data are a null pointer, data of createData() are expected";
  EXPECT_INVALID(model->calc(nullptr, w.x, u), "::calc", what);
  EXPECT_INVALID(model->calc(nullptr, w.x), "::calc", what);
  EXPECT_INVALID(model->calcDiff(nullptr, w.x, u), "::calcDiff", what);
  EXPECT_INVALID(model->calcDiff(nullptr, w.x), "::calcDiff", what);
  EXPECT_INVALID(model->quasiStatic(nullptr, u, w.x_rest), "::quasiStatic", what);
  EXPECT_INVALID(model->quasiStatic_x(nullptr, w.x_rest), "::quasiStatic", what);
  EXPECT_INVALID(w.actuation->calc(nullptr, w.x, u), "ActuationModel::calc", what);
  EXPECT_INVALID(w.actuation->commands(nullptr, w.x, model->get_armature()), "ActuationModel::commands", what);
  EXPECT_INVALID(w.costs->calc(nullptr, w.x, u), "CostModelSum::calc", what);
  EXPECT_INVALID(w.costs->calc(nullptr, w.x), "CostModelSum::calc", what);
  EXPECT_INVALID(w.costs->calcDiff(nullptr, w.x, u), "CostModelSum::calcDiff", what);
  EXPECT_INVALID(w.costs->calcDiff(nullptr, w.x), "CostModelSum::calcDiff", what);
  EXPECT_INVALID(w.constraints->calc(nullptr, w.x, u), "ConstraintModelManager::calc", what);
  EXPECT_INVALID(w.constraints->calc(nullptr, w.x), "ConstraintModelManager::calc", what);
  EXPECT_INVALID(w.constraints->calcDiff(nullptr, w.x, u), "ConstraintModelManager::calcDiff", what);
  EXPECT_INVALID(w.constraints->calcDiff(nullptr, w.x), "ConstraintModelManager::calcDiff", what);
  EXPECT_INVALID(DifferentialActionModelNumDiff(model).calc(nullptr, w.x, u), "null pointer");
}

TEST_F(Misuse, NullParts) {
  EXPECT_INVALID(ActionModel(nullptr, w.actuation, w.contacts, w.costs), "the state is expected, not a null pointer");
  EXPECT_INVALID(ActionModel(w.state, nullptr, w.contacts, w.costs), "the actuation is expected, not a null pointer");
  EXPECT_INVALID(ActionModel(w.state, w.actuation, nullptr, w.costs),
                 "the stack of contacts is expected, not a null pointer");
  EXPECT_INVALID(ActionModel(w.state, w.actuation, w.contacts, nullptr),
                 "the stack of costs is expected, not a null pointer");
  EXPECT_INVALID(ActionModel(w.state, w.actuation, nullptr, w.costs, w.constraints),
                 "contacts is expected, not a null pointer");
  EXPECT_NO_THROW(ActionModel(w.state, w.actuation, w.contacts, w.costs, nullptr, 0.1));  // no constraints
  EXPECT_INVALID(w.contacts->addContact("c", nullptr), "\"c\" is a null pointer, a model is expected");
  EXPECT_INVALID(w.costs->addCost("c", nullptr, 1), "\"c\" is a null pointer, a model is expected");
  EXPECT_INVALID(w.constraints->addConstraint("c", nullptr), "\"c\" is a null pointer, a model is expected");
  EXPECT_INVALID(CostModelResidual(w.state, nullptr), "null pointer");
  EXPECT_INVALID(ConstraintModelResidual(w.state, nullptr), "null pointer");
  EXPECT_INVALID(DifferentialActionModelNumDiff(nullptr), "a model is expected, not a null pointer");
  EXPECT_INVALID(StateMultibody(std::shared_ptr<const Multibody>()), "a model is expected, not a null pointer");
  EXPECT_INVALID(StateMultibody(std::shared_ptr<const Model>()), "a model is expected, not a null pointer");
}

TEST_F(Misuse, NullState) {
  const std::shared_ptr<StateMultibody> none;
  const std::string what = "a state is expected, not a null pointer";
  EXPECT_INVALID(ActuationModelFull{none}, what);
  EXPECT_INVALID(ActuationModelFloatingBase{none}, what);
  EXPECT_INVALID(ContactModelMultiple{none}, what);
  EXPECT_INVALID(CostModelSum{none}, what);
  EXPECT_INVALID(ConstraintModelManager{none}, what);
  EXPECT_INVALID(ContactModel6D(none, 0, SE3<double>(), LOCAL), what);
  EXPECT_INVALID(ContactModel3D(none, 0, Eigen::Vector3d::Zero(), LOCAL), what);
  EXPECT_INVALID(ContactModel2D(none, 0, Eigen::Vector2d::Zero()), what);
  EXPECT_INVALID(ContactModel1D(none, 0, 0., LOCAL), what);
  EXPECT_INVALID(ResidualModelState{none}, what);
  EXPECT_INVALID(ResidualModelState(none, w.x), what);
  EXPECT_INVALID(ResidualModelControl{none}, what);
  EXPECT_INVALID(ResidualModelControl(none, w.u), what);
  EXPECT_INVALID(ResidualModelJointAcceleration{none}, what);
  EXPECT_INVALID(ResidualModelJointEffort(none, w.actuation), what);
  EXPECT_INVALID(ResidualModelControlGrav{none}, what);
  EXPECT_INVALID(ResidualModelContactControlGrav(none, w.nu), what);
  EXPECT_INVALID(ResidualModelCoMPosition(none, Eigen::Vector3d::Zero()), what);
  EXPECT_INVALID(ResidualModelCentroidalMomentum(none, Vec6<double>::Zero()), what);
  EXPECT_INVALID(ResidualModelFramePlacement(none, 0, SE3<double>()), what);
  EXPECT_INVALID(ResidualModelFrameTranslation(none, 0, Eigen::Vector3d::Zero()), what);
  EXPECT_INVALID(ResidualModelFrameRotation(none, 0, Eigen::Matrix3d::Identity()), what);
  EXPECT_INVALID(ResidualModelFrameVelocity(none, 0, Vec6<double>::Zero(), LOCAL), what);
  EXPECT_INVALID(ResidualModelContactForce(none, 0, Vec6<double>::Zero(), 6), what);
  EXPECT_INVALID(ResidualModelContactFrictionCone(none, 0, FrictionCone()), what);
  EXPECT_INVALID(ResidualModelContactWrenchCone(none, 0, WrenchCone()), what);
  EXPECT_INVALID(ResidualModelContactCoPPosition(none, 0, CoPSupport()), what);
}

TEST_F(Misuse, PartsOfAnotherState) {
  const Walker o;
  const std::string what = " differs from the model's state", one = "belongs to another state, the ";
  EXPECT_INVALID(ActionModel(w.state, o.actuation, w.contacts, w.costs), "the state of the actuation" + what);
  EXPECT_INVALID(ActionModel(w.state, w.actuation, o.contacts, w.costs), "the state of the contacts" + what);
  EXPECT_INVALID(ActionModel(w.state, w.actuation, w.contacts, o.costs), "the state of the costs" + what);
  EXPECT_INVALID(ActionModel(w.state, w.actuation, w.contacts, w.costs, o.constraints),
                 "the state of the constraints" + what);
  EXPECT_INVALID(w.contacts->addContact("c", o.left_contact), "\"c\" " + one);
  const auto residual = std::make_shared<ResidualModelControl>(o.state, o.nu);
  EXPECT_INVALID(w.costs->addCost("c", std::make_shared<CostModelResidual>(o.state, residual), 1), "\"c\" " + one);
  EXPECT_INVALID(w.constraints->addConstraint("c", o.com_within(-1, 1)), "\"c\" " + one);
  EXPECT_INVALID(CostModelResidual(w.state, residual), one);
  EXPECT_INVALID(ConstraintModelResidual(w.state, residual), one);
}

TEST_F(Misuse, PartsOfAnotherNu) {
  const std::string expected = "the actuation's nu = " + n(w.nu) + " is expected", given = " is 5";
  EXPECT_INVALID(ActionModel(w.state, w.actuation, std::make_shared<ContactModelMultiple>(w.state, 5), w.costs),
                 "nu of the contacts" + given, expected);
  EXPECT_INVALID(ActionModel(w.state, w.actuation, w.contacts, std::make_shared<CostModelSum>(w.state, 5)),
                 "nu of the costs" + given, expected);
  EXPECT_INVALID(
      ActionModel(w.state, w.actuation, w.contacts, w.costs, std::make_shared<ConstraintModelManager>(w.state, 5)),
      "nu of the constraints" + given, expected);
  const std::string has = "\"c\" has nu = 5, nu = " + n(w.nu) + " is expected";
  EXPECT_INVALID(w.contacts->addContact("c", std::make_shared<ContactModel6D>(w.state, w.left, w.left_pref, 5)), has);
  const auto residual = std::make_shared<ResidualModelControl>(w.state, 5);
  EXPECT_INVALID(w.costs->addCost("c", std::make_shared<CostModelResidual>(w.state, residual), 1), has);
  EXPECT_INVALID(w.constraints->addConstraint("c", std::make_shared<ConstraintModelResidual>(w.state, residual)), has);
  EXPECT_INVALID(ResidualModelJointEffort(w.state, w.actuation, 5), "nu is 5", n(w.nu));
  EXPECT_INVALID(CostModelResidual(w.state, std::make_shared<ActivationModelQuad>(4), residual), "nr = 4",
                 "5 is expected");
}

TEST_F(Misuse, Names) {
  EXPECT_INVALID(w.contacts->addContact("left", w.left_contact), "\"left\" exists already, a new name is expected");
  EXPECT_INVALID(w.costs->addCost("com", w.costs->get_costs().at("com")->cost, 1), "\"com\" exists already");
  EXPECT_INVALID(w.constraints->addConstraint("com", w.com_within(-1, 1)), "\"com\" exists already");
  const std::string what = "is called \"hand\"; the known names are: ";
  EXPECT_INVALID(w.contacts->removeContact("hand"), "no contact " + what + "left, right");
  EXPECT_INVALID(w.contacts->changeContactStatus("hand", true), "no contact " + what + "left, right");
  EXPECT_INVALID(w.contacts->getContactStatus("hand"), "no contact " + what + "left, right");
  EXPECT_INVALID(w.costs->removeCost("foot"), "no cost is called \"foot\"; the known names are: com, control");
  EXPECT_INVALID(w.costs->changeCostStatus("foot", true), "no cost is called \"foot\"");
  EXPECT_INVALID(w.costs->getCostStatus("foot"), "no cost is called \"foot\"");
  EXPECT_INVALID(w.constraints->removeConstraint("hand"), "no constraint " + what + "com");
  EXPECT_INVALID(w.constraints->changeConstraintStatus("hand", true), "no constraint " + what + "com");
  EXPECT_INVALID(w.constraints->getConstraintStatus("hand"), "no constraint " + what + "com");
  w.constraints->removeConstraint("com");
  EXPECT_INVALID(w.constraints->removeConstraint("com"), "the known names are: none");
}

// If parts come or go after createData, new data are needed: old data throw, also after a swap of equal size.
TEST_F(Misuse, PartsAddedAfterCreateData) {
  const std::string what = "were added or removed since the data were created, new data are expected";
  w.contacts->addContact("again", w.left_contact, false);
  EXPECT_INVALID(model->calc(data, w.x, u), "contacts " + what);
  EXPECT_INVALID(model->calc(data, w.x), "contacts " + what);
  EXPECT_INVALID(model->quasiStatic(data, u, w.x_rest), "contacts " + what);
  EXPECT_NO_THROW(evaluated(*model, w.x, u));
  w.contacts->removeContact("again");
  EXPECT_INVALID(model->calc(data, w.x, u), "contacts " + what);

  data = model->createData();
  const auto com = w.costs->get_costs().at("com")->cost;
  w.costs->removeCost("com");
  EXPECT_INVALID(model->calc(data, w.x, u), "costs " + what);
  EXPECT_INVALID(model->calc(data, w.x), "costs " + what);
  w.costs->addCost("com", com, 1);
  EXPECT_INVALID(model->calc(data, w.x, u), "costs " + what);

  data = model->createData();
  w.constraints->addConstraint("more", w.com_within(-2, 2));
  EXPECT_INVALID(model->calc(data, w.x, u), "constraints " + what);
  EXPECT_INVALID(model->calc(data, w.x), "constraints " + what);
  expect_refused<std::logic_error>(__FILE__, __LINE__, [&] { model->calcDiff(data, w.x); },
                                   {"call calc(data, x) before calcDiff"});
  EXPECT_NO_THROW(evaluated(*model, w.x, u));
}

TEST_F(Misuse, CostsAddedAndAContactSwitched) {
  w.add_cost("more", std::make_shared<ResidualModelControl>(w.state, w.nu));
  w.contacts->changeContactStatus("left", false);
  EXPECT_INVALID(model->calc(data, w.x, u), "costs were added or removed");
  EXPECT_INVALID(model->quasiStatic(data, u, w.x_rest), "costs were added or removed");
}

// The items of the stacks are Crocoddyl's: their members are writable.
TEST_F(Misuse, ItemsWritten) {
  w.costs->get_costs().at("com")->active = false;
  EXPECT_EQ(evaluated(*model, w.x, u, data)->r.size(), static_cast<Eigen::Index>(w.costs->get_nr()) - 3);
  w.costs->get_costs().at("com")->active = true;
  EXPECT_EQ(evaluated(*model, w.x, u, data)->r.size(), static_cast<Eigen::Index>(w.costs->get_nr()));

  w.constraints->get_constraints().at("com")->active = false;
  EXPECT_INVALID(model->calc(data, w.x, u), "status of a constraint", "call changeConstraintStatus instead");
  w.constraints->get_constraints().at("com")->active = true;

  const auto point = std::make_shared<ContactModel3D>(w.state, w.left, w.left_pref.p, LOCAL, w.nu);
  w.contacts->get_contacts().at("left")->contact = point;
  EXPECT_LT(difference_of(*evaluated(*model, w.x, u, data), *evaluated(*model, w.x, u)), 1e-12);

  const auto velocity = std::make_shared<ResidualModelFrameVelocity>(w.state, w.left, Motion::Zero(), LOCAL, w.nu);
  w.costs->get_costs().at("com")->cost = std::make_shared<CostModelResidual>(w.state, velocity);
  EXPECT_INVALID(model->calc(data, w.x, u), "created by another residual");
  w.costs->get_costs().at("com")->cost =
      std::make_shared<CostModelResidual>(w.state, std::make_shared<ResidualModelState>(w.state, w.nu));
  EXPECT_INVALID(model->calc(data, w.x, u), "created by another cost");
}

TEST_F(Misuse, ConstraintsReplaced) {
  w.constraints->get_constraints().at("com")->constraint =
      std::make_shared<ConstraintModelResidual>(w.state, std::make_shared<ResidualModelState>(w.state, w.nu));
  EXPECT_INVALID(model->calc(data, w.x, u), "the data of \"com\" belong to another constraint, new data are expected");
  EXPECT_INVALID(model->calc(data, w.x), "the data of \"com\" belong to another constraint");
}

TEST_F(Misuse, SwitchedBeforeCalcDiff) {
  const auto expect_calc = [&](int line) {
    expect_refused<std::logic_error>(__FILE__, line, [&] { model->calcDiff(data, w.x, u); },
                                     {"call calc(data, x, u)", "with the same data, costs and constraints"});
    EXPECT_NO_THROW(evaluated(*model, w.x, u, data));
  };
  for (bool active : {false, true}) {
    model->calc(data, w.x, u);
    w.costs->changeCostStatus("com", active);
    expect_calc(__LINE__);
    model->calc(data, w.x, u);
    w.constraints->changeConstraintStatus("com", active);
    expect_calc(__LINE__);
  }
}

TEST_F(Misuse, StatesThatAreNone) {
  for (double bad : {std::numeric_limits<double>::quiet_NaN(), 2.0}) {
    Eigen::VectorXd x = w.x_rest;
    x[3] = bad;  // of the quaternion
    EXPECT_TRUE(model->quasiStatic_x(data, x).array().isNaN().all());
    model->calc(data, x, u);
    EXPECT_EQ(as_fwddyn(data).report().status, Status::kFailed);
    EXPECT_TRUE(data->xout.array().isNaN().all());
    EXPECT_EQ(difference_of(*evaluated(*model, w.x, u, data), *evaluated(*model, w.x, u)), 0);
  }
}

TEST_F(Misuse, ContactsGoneBeforeCalcDiff) {
  model->calc(data, w.x, u);
  w.contacts->removeContact("right");
  expect_refused<std::logic_error>(
      __FILE__, __LINE__, [&] { model->calcDiff(data, w.x, u); },
      {"::calcDiff", "calcDiff uses the values of the last calc", "call calc(data, x, u)"});
}

TEST_F(Misuse, Frames) {
  const Multibody& m = *w.state->get_model();
  const FrameIndex bad = m.frames.size();
  const std::string given = "frame " + n(bad);
  EXPECT_INVALID(m.getFrameId("nose"), "\"nose\"", "the name of a link is expected");
  EXPECT_INVALID(ContactModel6D(w.state, bad, SE3<double>(), LOCAL, w.nu), given, "below " + n(bad));
  EXPECT_INVALID(ContactModel1D(w.state, bad, 0., LOCAL), given, "below " + n(bad));
  EXPECT_INVALID(w.left_contact->set_id(bad), given, "below " + n(bad));
  EXPECT_INVALID(ResidualModelFramePlacement(w.state, bad, SE3<double>(), w.nu), given, "below " + n(bad));
  EXPECT_INVALID(ResidualModelFrameVelocity(w.state, bad, Vec6<double>::Zero(), LOCAL, w.nu), given, "below " + n(bad));
  EXPECT_INVALID(ResidualModelContactForce(w.state, bad, Vec6<double>::Zero(), 6, w.nu), given, "below " + n(bad));
  EXPECT_EQ(w.left_contact->get_id(), w.left);
  EXPECT_INVALID(ContactModelBetweenBodies(w.state, ContactType::k3D, w.left, m.getFrameId("left_foot"), SE3<double>(),
                                           LOCAL, w.nu),
                 "same body", "two different bodies are expected");
}

TEST_F(Misuse, ResidualsWithoutTheirContact) {
  const FrameIndex hand = w.state->get_model()->getFrameId("left_hand");
  const auto force = [&](FrameIndex id, std::size_t nc) {
    return std::make_shared<ResidualModelContactForce>(w.state, id, Vec6<double>(Vec6<double>::Zero()), nc, w.nu);
  };
  w.add_cost("force", force(hand, 6));
  EXPECT_INVALID(model->createData(), "frame " + n(hand) + " has no contact, a contact is expected");
  w.costs->removeCost("force");
  w.add_cost("force", force(w.left, 3));
  EXPECT_INVALID(model->createData(), "is 6D", "nc = 3 is expected");
  w.costs->removeCost("force");
  w.add_cost("force", force(w.left, 6));
  w.contacts->addContact("twice", w.left_contact, false);
  EXPECT_INVALID(model->createData(), "several contacts (left, twice), exactly one contact is expected");
  EXPECT_INVALID(ResidualModelContactForce(w.state, w.left, Vec6<double>::Zero(), 4, w.nu), "nc is 4",
                 "1, 2, 3, 5 or 6");
  EXPECT_INVALID(ResidualModelContactFrictionCone(w.state, w.left, FrictionCone(), w.nu, false), "fwddyn is false",
                 "true is expected");
}

}  // namespace
}  // namespace manycontact::test
