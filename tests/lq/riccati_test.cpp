#include <gtest/gtest.h>

#include "manycontact/lq/bond_schur.hpp"
#include "manycontact/lq/kkt.hpp"
#include "random_problem.hpp"

namespace manycontact::test {
namespace {
TEST(Riccati, First) {
  std::mt19937 rng(3);
  LqOptions options;
  options.groups = [](int k) {
    if (k < 4) return std::vector<std::vector<int>>{{2, 0}};
    if (k < 8) return std::vector<std::vector<int>>{{1, 3}};
    return std::vector<std::vector<int>>{};
  };
  for (bool bonds : {false, true}) {
    if (bonds)
      options.bonds = [](int k) {
        return k < 6 ? std::vector<std::vector<int>>{{2, 1}} : std::vector<std::vector<int>>{};
      };
    const lq::Problem problem = random_lq(rng, options);
    lq::Riccati dense(lq::Join::kAll), islands(lq::Join::kIslands);
    lq::BondSchur schur;
    for (lq::DirectionSolver* s : std::initializer_list<lq::DirectionSolver*>{&dense, &islands, &schur}) {
      lq::DirectionSolver& solver = *s;
      solver.analyse(problem);
      lq::Outcome o = solver.factorize(problem);
      ASSERT_EQ(o.status, lq::Status::kOk) << o.knot;
      lq::Point z;
      solver.max_refinements = 0;
      o = solver.solve(problem, z);
      Eigen::VectorXd h;
      const Eigen::MatrixXd H = dense_kkt(problem, {}, h);
      const Eigen::VectorXd truth = H.fullPivLu().solve(-h);
      std::printf("%s: kkt error %g, %g sym %g flops %g\n", solver.name(), o.kkt_error,
                  (flat(z) - truth).norm() / truth.norm(), (H - H.transpose()).norm(), solver.flops());
    }
  }
}
}  // namespace
}  // namespace manycontact::test
