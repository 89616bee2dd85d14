// Piles of up to 36 bodies are compared with quadruple precision.

#include <gtest/gtest.h>

#include "manycontact/dynamics/solve.hpp"
#include "support/piles.hpp"
#include "support/truth.hpp"

namespace manycontact::test {
namespace {

double relative_error(const Eigen::VectorXd& x, const Eigen::VectorXd& truth) {
  return (x - truth).cwiseAbs().maxCoeff() / truth.cwiseAbs().maxCoeff();
}

TEST(PilesInQuad, AreTrue) {
  for (const auto& [name, pile] :
       {std::pair("tower", tower(30)), std::pair("pyramid", pyramid(8)),
        std::pair("wall", grid(6, ContactType::k3D, true)), std::pair("grid", grid(6, ContactType::k6D, false))}) {
    SCOPED_TRACE(name);
    SceneData data(pile.scene);
    (void)solve(pile.scene, pile.q, pile.v, pile.u, data);
    const Truth<Quad> truth =
        solve_truth<Quad>(pile.scene, data.active, pile.q.cast<Quad>(), pile.v.cast<Quad>(), pile.u.cast<Quad>());
    EXPECT_EQ(data.report.rank, truth.rank[0]);
    EXPECT_LE(relative_error(data.a, truth.a.cast<double>()), 1e-10);
    EXPECT_LE(relative_error(data.f, truth.f.cast<double>()), 1e-10);
  }
}

}  // namespace
}  // namespace manycontact::test
