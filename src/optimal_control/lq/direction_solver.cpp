#include "manycontact/lq/direction_solver.hpp"

#include <cmath>
#include <stdexcept>

#include "manycontact/lq/kkt.hpp"
#include "manycontact/sparse/refine.hpp"

namespace manycontact::lq {
namespace {

void add(const Point& dz, Point& z) {
  for (auto part : {&Point::x, &Point::u, &Point::w, &Point::lambda, &Point::mu})
    for (std::size_t k = 0; k < (z.*part).size(); ++k) (z.*part)[k] += (dz.*part)[k];
}

bool same_sizes(const Point& a, const Point& b) {
  for (auto part : {&Point::x, &Point::u, &Point::w, &Point::lambda, &Point::mu}) {
    if ((a.*part).size() != (b.*part).size()) return false;
    for (std::size_t k = 0; k < (a.*part).size(); ++k)
      if ((a.*part)[k].size() != (b.*part)[k].size()) return false;
  }
  return true;
}

}  // namespace

void DirectionSolver::analyse(const Problem& problem) {
  check(problem);
  factorized_ = false;
  layout_ = Layout(problem);
  nx_ = problem.nx;
  nu_ = problem.nu;
  groups_.clear();
  couplings_.clear();
  for (const Knot& knot : problem.knots) {
    groups_.emplace_back();
    for (const Group& g : knot.groups) groups_.back().push_back({g.blocks, g.couplings});
    couplings_.push_back(knot.couplings);
  }
  residual_ = scale_ = correction_ = Point(problem, layout_);
  do_analyse(problem);
}

void DirectionSolver::expect_same_structure(const Problem& problem) const {
  const auto expect = [](bool same) {
    if (!same)
      throw std::invalid_argument("lq::DirectionSolver: the problem does not have the structure that was analysed");
  };
  expect(problem.nx == nx_ && problem.nu == nu_ && problem.knots.size() == groups_.size());
  for (std::size_t k = 0; k < groups_.size(); ++k) {
    const Knot& knot = problem.knots[k];
    expect(knot.groups.size() == groups_[k].size() && knot.couplings.size() == couplings_[k].size());
    for (std::size_t b = 0; b < couplings_[k].size(); ++b)
      expect(knot.couplings[b].size == couplings_[k][b].size && knot.couplings[b].rows == couplings_[k][b].rows);
    for (std::size_t g = 0; g < groups_[k].size(); ++g)
      expect(knot.groups[g].blocks == groups_[k][g].blocks && knot.groups[g].couplings == groups_[k][g].couplings);
  }
}

Outcome DirectionSolver::factorize(const Problem& problem, const Regularisation& reg) {
  expect_same_structure(problem);
  reg_ = reg;
  const Outcome outcome = do_factorize(problem, reg);
  factorized_ = outcome.status == Status::kOk;
  return outcome;
}

Outcome DirectionSolver::solve(const Problem& problem, Point& z) {
  if (!factorized_) throw std::logic_error("lq::DirectionSolver: there is no factor, call factorize first");
  expect_same_structure(problem);
  if (!same_sizes(z, residual_)) z = Point(problem, layout_);
  linear_terms(problem, layout_, residual_);
  do_solve(problem, residual_, z, true);

  const auto judge = [&] { return kkt_residual(problem, layout_, reg_, z, residual_, scale_); };
  const auto correct = [&] {
    do_solve(problem, residual_, correction_, false);
    add(correction_, z);
  };
  const auto refined = sparse::refine(max_refinements + extra_refinements_, kRefineAbove, judge, correct);
  Outcome outcome;
  outcome.kkt_error = refined.backward_error;
  outcome.refinements = refined.steps;
  if (!std::isfinite(outcome.kkt_error))
    outcome.status = Status::kNotFinite;
  else if (outcome.kkt_error > kAccurate)
    outcome.status = Status::kInaccurate;
  return outcome;
}

}  // namespace manycontact::lq
