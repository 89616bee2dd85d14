// calc and calcDiff do not allocate on the heap after the first call, in running and terminal nodes.

#include <gtest/gtest.h>

#include "action/problem.hpp"
#include "action/residual_factory.hpp"
#include "support/allocations.hpp"
#include "support/scenes.hpp"

namespace manycontact::test {
namespace {

class Allocations : public testing::TestWithParam<std::string> {};

TEST_P(Allocations, NoneAfterTheFirstCall) {
  if (!MANYCONTACT_COUNTS_ALLOCATIONS) GTEST_SKIP() << "malloc cannot be counted here";
  SceneFile file = load_small(GetParam());
  std::mt19937 rng(31);
  disturb(file, rng);
  Problem p = make_problem(file);
  for (const NamedResidual& r : all_residuals(p.state, p.actuation, *p.contacts, 5)) {
    p.costs->addCost(r.name, std::make_shared<CostModelResidual>(p.state, r.residual), 0.5);
    p.constraints->addConstraint(r.name, std::make_shared<ConstraintModelResidual>(p.state, r.residual));
  }
  const auto model = p.model();
  const auto data = model->createData();
  model->calc(data, p.x, p.u);
  const bool derivatives = as_fwddyn(data).report().status == Status::kOk;  // redundant contacts allocate in theirs
  model->calcDiff(data, p.x, p.u);
  for (int again = 0; again < 2; ++again) {
    p.x = p.state->integrate_x(p.x, random_vector(static_cast<int>(p.state->get_ndx()), rng, 0.01));
    EXPECT_EQ(allocations([&] { model->calc(data, p.x, p.u); }), 0u);
    const std::size_t count = allocations([&] { model->calcDiff(data, p.x, p.u); });
    if (derivatives) {
      EXPECT_EQ(count, 0u);
    }
  }
  model->calc(data, p.x);
  model->calcDiff(data, p.x);
  EXPECT_EQ(allocations([&] { model->calc(data, p.x); }), 0u);
  EXPECT_EQ(allocations([&] { model->calcDiff(data, p.x); }), 0u);
}

INSTANTIATE_TEST_SUITE_P(Models, Allocations, testing::ValuesIn(model_scenes()), scene_title);

}  // namespace
}  // namespace manycontact::test
