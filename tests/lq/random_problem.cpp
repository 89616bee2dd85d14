#include "random_problem.hpp"

#include "manycontact/lq/kkt.hpp"

namespace manycontact::test {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

MatrixXd random_matrix(Eigen::Index rows, Eigen::Index cols, std::mt19937& rng) {
  std::normal_distribution<double> normal;
  return MatrixXd::NullaryExpr(rows, cols, [&] { return normal(rng); });
}

// Completes the groups: blocks in no list become groups of their own.
std::vector<std::vector<int>> complete(std::vector<std::vector<int>> groups, int blocks) {
  std::vector<bool> seen(blocks);
  for (const auto& g : groups)
    for (int i : g) seen[i] = true;
  for (int i = 0; i < blocks; ++i)
    if (!seen[i]) groups.push_back({i});
  return groups;
}

MatrixXd dense(const lq::BlockDiagonal& D, Eigen::Index n) {
  MatrixXd out = D.scale * MatrixXd::Identity(n, n);
  for (const auto& part : D.parts) out.block(part.first, part.first, part.block.rows(), part.block.cols()) = part.block;
  return out;
}

// Makes the upper halves of A and B follow from the lower ones.
void step(lq::Group& g, int part, std::mt19937& rng) {
  const auto n = g.A.rows() / 2;
  g.steps.emplace();
  for (lq::BlockDiagonal* D : {&g.steps->J, &g.steps->G}) {
    D->scale = D == &g.steps->J ? 0.9 : 0.1;
    if (part > n) continue;
    D->parts.push_back({static_cast<int>(n) - part,
                        D->scale * (MatrixXd::Identity(part, part) + 0.3 * random_matrix(part, part, rng))});
  }
  const MatrixXd G = dense(g.steps->G, n);
  g.A.topRows(n) = G * g.A.bottomRows(n);
  g.A.topLeftCorner(n, n) += dense(g.steps->J, n);
  g.B.topRows(n) = G * g.B.bottomRows(n);
}

void fill(lq::Group& g, const lq::Knot& knot, int nu, std::mt19937& rng, const LqOptions& options) {
  const auto nx = g.Q.rows(), nv = g.R.rows(), nw = nv - nu;
  // [Q S; S^T R] = weighted G^T G, of full rank where both weights are positive.
  MatrixXd G = random_matrix(nx + nv + 2, nx + nv, rng) / std::sqrt(nx + nv + 2.);
  G.leftCols(nx) *= std::sqrt(options.state_weight);
  G.middleCols(nx, nu) *= std::sqrt(options.control_weight);
  G.rightCols(nw) *= std::sqrt(options.coupling_weight);
  const MatrixXd H = G.transpose() * G;
  g.Q = H.topLeftCorner(nx, nx);
  g.S = H.topRightCorner(nx, nv);
  g.R = H.bottomRightCorner(nv, nv);
  g.q = random_matrix(nx, 1, rng) * options.state_weight;
  g.r = random_matrix(nv, 1, rng) * options.control_weight;
  if (g.A.size() > 0) {
    g.A = options.growth * (MatrixXd::Identity(nx, nx) + 0.3 / std::sqrt(nx) * random_matrix(nx, nx, rng));
    g.B = 0.3 * random_matrix(nx, nv, rng);
    g.f = 0.1 * random_matrix(nx, 1, rng);
    if (options.steps && g.blocks.size() == 1 && nx % 2 == 0) step(g, *options.steps, rng);
  }
  g.C = random_matrix(g.C.rows(), nx, rng) / std::sqrt(nx);
  g.D = random_matrix(g.D.rows(), nv, rng) / std::sqrt(std::max<double>(nv, 1));
  g.d = 0.1 * random_matrix(g.d.rows(), 1, rng);
  // Rows move when w does, as contacts do under forces.
  Eigen::Index row = 0, w = nu;
  for (int b : g.couplings) {
    const lq::Coupling& coupling = knot.couplings[b];
    g.D.block(row, w, coupling.rows, coupling.size) += MatrixXd::Identity(coupling.rows, coupling.size);
    row += coupling.rows;
    w += coupling.size;
  }
}

}  // namespace

void refill(lq::Problem& problem, std::mt19937& rng, const LqOptions& options) {
  for (lq::Knot& knot : problem.knots)
    for (lq::Group& g : knot.groups) {
      int nw = 0;
      for (int b : g.couplings) nw += knot.couplings[b].size;
      fill(g, knot, static_cast<int>(g.R.rows()) - nw, rng, options);
    }
  problem.x0 = random_matrix(problem.x0.size(), 1, rng);
}

lq::Problem random_lq(std::mt19937& rng, const LqOptions& options) {
  lq::Problem problem;
  problem.nx = options.nx;
  problem.nu = options.nu;
  for (int k = 0; k <= options.horizon; ++k) {
    lq::Knot knot;
    for (const auto& blocks : complete(options.groups(k), problem.blocks())) knot.groups.emplace_back().blocks = blocks;
    for (const auto& touched : options.couplings(k)) {
      const int b = static_cast<int>(knot.couplings.size());
      knot.couplings.push_back({options.coupling_size, options.coupling_rows});
      for (lq::Group& g : knot.groups)
        for (int i : touched)
          if (std::find(g.blocks.begin(), g.blocks.end(), i) != g.blocks.end()) {
            g.couplings.push_back(b);
            break;
          }
    }
    problem.knots.push_back(knot);
  }
  lq::set_zero(problem);
  lq::check(problem);
  refill(problem, rng, options);
  return problem;
}

VectorXd flat(const lq::Point& z) {
  VectorXd all;
  for (auto part : {&lq::Point::x, &lq::Point::u, &lq::Point::w, &lq::Point::lambda, &lq::Point::mu})
    for (const VectorXd& v : z.*part) {
      all.conservativeResize(all.size() + v.size());
      all.tail(v.size()) = v;
    }
  return all;
}

void unflatten(const VectorXd& all, lq::Point& z) {
  Eigen::Index at = 0;
  for (auto part : {&lq::Point::x, &lq::Point::u, &lq::Point::w, &lq::Point::lambda, &lq::Point::mu})
    for (VectorXd& v : z.*part) {
      v = all.segment(at, v.size());
      at += v.size();
    }
}

MatrixXd dense_kkt(const lq::Problem& problem, const lq::Regularisation& reg, VectorXd& h) {
  const lq::Layout layout(problem);
  lq::Point z(problem, layout), residual = z, scale = z;
  lq::kkt_residual(problem, layout, reg, z, residual, scale);
  h = flat(residual);
  MatrixXd H(h.size(), h.size());
  for (Eigen::Index j = 0; j < h.size(); ++j) {
    unflatten(VectorXd::Unit(h.size(), j), z);
    lq::kkt_residual(problem, layout, reg, z, residual, scale);
    H.col(j) = flat(residual) - h;
  }
  return H;
}

lq::Problem chain_of_robots(int robots, int horizon, std::mt19937& rng, int nx, int nu, int m) {
  LqOptions options;
  options.nx.assign(robots, nx);
  options.nu.assign(robots, nu);
  options.horizon = horizon;
  options.coupling_size = options.coupling_rows = m;
  options.couplings = [=](int k) {
    std::vector<std::vector<int>> couplings;
    for (int i = 0; k < horizon && i + 1 < robots; ++i) couplings.push_back({i, i + 1});
    return couplings;
  };
  return random_lq(rng, options);
}

}  // namespace manycontact::test
