// Changes after the data were created take effect: contacts switched, gains, references, axes, frames, weights.

#include <chrono>

#include "action/walker.hpp"

namespace manycontact::test {
namespace {

constexpr double kOrderTolerance = 1e-9;  // the order of elimination may differ

void expect_same(const DataPtr& mine, const DataPtr& truth) {
  EXPECT_LT(difference_of(*mine, *truth), kOrderTolerance);
  for (const auto& [name, contact] : as_fwddyn(truth).multibody->contacts->contacts) {
    const ContactDataAbstract& c = contact_data(mine, name);
    EXPECT_LT(error_of(c.f, contact->f), kOrderTolerance) << name;
    EXPECT_LT(error_of(c.Jc, contact->Jc), kOrderTolerance) << name;
    EXPECT_LT(error_of(c.a0, contact->a0), kOrderTolerance) << name;
    EXPECT_LT(error_of(Eigen::MatrixXd(c.df_dx), Eigen::MatrixXd(contact->df_dx)), kOrderTolerance) << name;
    EXPECT_LT(error_of(Eigen::MatrixXd(c.df_du), Eigen::MatrixXd(contact->df_du)), kOrderTolerance) << name;
  }
}

// With the contact switched off, the solution is that of a model built without it.
TEST(Switching, AContact) {
  Walker two, one(Actuated::kFloatingBase, false);
  for (Walker* w : {&two, &one}) {
    w->add_costs();
    w->constraints->addConstraint("friction", w->left_friction());
  }
  const auto model = two.model(), single = one.model();
  const DataPtr data = evaluated(*model, two.x, two.u), both = evaluated(*model, two.x, two.u);
  EXPECT_EQ(two.contacts->get_nc(), 12u);
  two.contacts->changeContactStatus("right", false);
  EXPECT_FALSE(two.contacts->getContactStatus("right"));
  EXPECT_EQ(two.contacts->get_nc(), 6u);
  EXPECT_EQ(two.contacts->get_nc_total(), 12u);
  EXPECT_TRUE(two.contacts->get_active_set() == std::set<std::string>{"left"});
  EXPECT_TRUE(two.contacts->get_inactive_set() == std::set<std::string>{"right"});
  model->calcDiff(data, two.x, two.u);  // still that of the last calc
  EXPECT_EQ(difference_of(*data, *both), 0);
  evaluated(*model, two.x, two.u, data);
  expect_same(data, evaluated(*single, one.x, one.u));
  EXPECT_GT(difference_of(*data, *both), 1e-3);
  EXPECT_EQ(as_fwddyn(data).report().nc, 6);
  EXPECT_EQ(size_of(contact_data(data, "right").f), 0);
  EXPECT_EQ(contact_data(data, "right").df_dx.size(), 0);
  two.contacts->changeContactStatus("right", true);
  evaluated(*model, two.x, two.u, data);
  expect_same(data, both);
  EXPECT_EQ(two.contacts->get_nc(), 12u);
  two.contacts->changeContactStatus("left", false);
  two.contacts->changeContactStatus("right", false);  // none: free fall; the friction of the left foot is zero
  evaluated(*model, two.x, two.u, data);
  EXPECT_EQ(as_fwddyn(data).report().nc, 0);
  EXPECT_EQ(size_of(data->g), 0);
  EXPECT_EQ(size_of(data->Gx), 0);
}

// Contacts between robots are switched: islands come and go.
TEST(Switching, IslandsOfTheBeam) {
  SceneFile file = load_scene(MANYCONTACT_SOURCE_DIR "/models/two_humanoids_carry_beam.xml");
  std::mt19937 rng(6);
  disturb(file, rng);
  const Problem p = make_problem(file);
  const auto model = p.model();
  const DataPtr data = evaluated(*model, p.x, p.u);
  const std::size_t islands = as_fwddyn(data).multibody->islands.size();
  Scene loose = file.scene;
  for (const auto& [name, item] : p.contacts->get_contacts()) {
    if (item->contact->get_contact().B.robot < 0) continue;
    p.contacts->changeContactStatus(name, false);
    loose.contacts[loose.contact_index.at(name)].active = false;
  }
  evaluated(*model, p.x, p.u, data);
  EXPECT_GT(as_fwddyn(data).multibody->islands.size(), islands);
  expect_same(data, evaluated(*make_problem(loose, file.q, file.v, file.u).model(), p.x, p.u));
}

// Each change takes effect in existing data, and gives the solution of a model built that way.
struct Change {
  const char* name;
  void (*apply)(Walker&);
};

void PrintTo(const Change& change, std::ostream* os) { *os << change.name; }

class Changes : public testing::TestWithParam<Change> {};

TEST_P(Changes, TakeEffect) {
  Walker w, built;
  for (Walker* each : {&w, &built}) {
    each->add_costs();
    each->add_cost("state2", std::make_shared<ResidualModelState>(each->state, each->nu));
  }
  const auto model = w.model();
  const DataPtr data = evaluated(*model, w.x, w.u), before = evaluated(*model, w.x, w.u);
  GetParam().apply(built);
  const DataPtr expected = evaluated(*built.model(), w.x, w.u);
  GetParam().apply(w);
  evaluated(*model, w.x, w.u, data);
  expect_same(data, expected);
  const double f = error_of(contact_data(data, "left").f, contact_data(before, "left").f);
  EXPECT_GT(std::max(difference_of(*data, *before), f), 1e-6) << "it changes nothing";
}

INSTANTIATE_TEST_SUITE_P(
    All, Changes,
    testing::Values(Change{"gains",
                           [](Walker& w) {
                             w.left_contact->set_gains({30, 5});
                           }},
                    Change{"reference",
                           [](Walker& w) {
                             SE3<double> pref = w.left_pref;
                             pref.p.z() += 0.1;
                             w.left_contact->set_reference(pref);
                           }},
                    Change{"type", [](Walker& w) { w.left_contact->set_type(LOCAL_WORLD_ALIGNED); }},
                    Change{"type_world", [](Walker& w) { w.left_contact->set_type(WORLD); }},
                    Change{"id",
                           [](Walker& w) { w.left_contact->set_id(w.state->get_model()->getFrameId("left_shank")); }},
                    Change{"id_on_the_same_body",
                           [](Walker& w) { w.left_contact->set_id(w.state->get_model()->getFrameId("left_foot")); }},
                    Change{"status_of_a_cost", [](Walker& w) { w.costs->changeCostStatus("com", false); }},
                    Change{"weight", [](Walker& w) { w.costs->get_costs().at("com")->weight = 3; }},
                    Change{"id_of_a_residual",
                           [](Walker& w) {
                             auto& residual = *w.costs->get_costs().at("hand")->cost->get_residual();
                             dynamic_cast<ResidualModelFramePlacement&>(residual).set_id(w.right);
                           }},
                    Change{"reference_of_a_cost",
                           [](Walker& w) {
                             auto& residual = *w.costs->get_costs().at("state2")->cost->get_residual();
                             dynamic_cast<ResidualModelState&>(residual).set_reference(w.x_rest);
                           }}),
    [](const auto& info) { return info.param.name; });

TEST(Switching, GettersOfTheContact) {
  Walker w;
  w.left_contact->set_gains({3, 4});
  EXPECT_TRUE(w.left_contact->get_gains() == Eigen::Vector2d(3, 4));
  w.left_contact->set_type(WORLD);
  EXPECT_EQ(w.left_contact->get_type(), WORLD);
  w.left_contact->set_id(w.right);
  EXPECT_EQ(w.left_contact->get_id(), w.right);
  EXPECT_EQ(w.left_contact->get_nc(), 6u);
  EXPECT_EQ(w.left_contact->get_nu(), w.nu);
  EXPECT_EQ(w.left_contact->get_state(), w.state);
}

// A residual of a contact's force stays with its frame: it is an error if the contact leaves it.
TEST(Switching, AContactThatLeavesItsResidual) {
  for (const char* frame : {"left_shank", "left_foot"}) {
    Walker w;
    w.add_cost("force", std::make_shared<ResidualModelContactForce>(w.state, w.left, Vec6<double>(Vec6<double>::Zero()),
                                                                    6, w.nu));
    const auto model = w.model();
    const DataPtr data = evaluated(*model, w.x, w.u);
    w.left_contact->set_id(w.state->get_model()->getFrameId(frame));
    EXPECT_THROW(model->calc(data, w.x, w.u), std::invalid_argument) << frame;
    w.left_contact->set_id(w.left);
    EXPECT_NO_THROW(evaluated(*model, w.x, w.u, data)) << frame;
  }
}

// Numbers and names of many costs are updated when one is added, switched or removed. If they were made from scratch
// each time, 20,000 would take half a minute.
TEST(Switching, ManyCosts) {
  Walker w;
  CostModelSum sum(w.state, w.nu);
  const auto cost = std::make_shared<CostModelResidual>(w.state, std::make_shared<ResidualModelControl>(w.state, w.nu));
  constexpr int kCosts = 20000;
  const auto start = std::chrono::steady_clock::now();
  for (int k = 0; k < kCosts; ++k) sum.addCost("c" + std::to_string(k), cost, 1, k % 2 == 0);
  for (int k = 0; k < kCosts; k += 4) sum.changeCostStatus("c" + std::to_string(k), false);
  for (int k = 1; k < kCosts; k += 4) sum.removeCost("c" + std::to_string(k));
  EXPECT_LT(std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count(), 2);
  EXPECT_EQ(sum.get_nr(), kCosts / 4 * w.nu);
  EXPECT_EQ(sum.get_nr_total(), 3 * kCosts / 4 * w.nu);
  EXPECT_EQ(sum.get_active_set().size(), kCosts / 4u);
  EXPECT_EQ(sum.get_inactive_set().size(), kCosts / 2u);
}

}  // namespace
}  // namespace manycontact::test
