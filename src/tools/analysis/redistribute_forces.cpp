#include "manycontact/analysis/redistribute_forces.hpp"

#include <stdexcept>

#include "at_rest.hpp"
#include "manycontact/model/expect_state.hpp"
#include "manycontact/sparse/decompositions.hpp"

namespace manycontact {

namespace {

/// The part of the null-space basis N of J^T that belongs to an island: the rows of f, and N in these rows.
struct IslandBasis {
  std::vector<int> rows;
  Eigen::MatrixXd N;
};

int nullity(const IslandReport& report) { return report.status == Status::kFailed ? 0 : report.nc - report.rank; }

/// Returns orthonormal columns that span the columns of W.
Eigen::MatrixXd orthonormal(const Eigen::MatrixXd& W) {
  return Eigen::HouseholderQR<Eigen::MatrixXd>(W).householderQ() * Eigen::MatrixXd::Identity(W.rows(), W.cols());
}

/// Projects column k of every island's N on the null space of J^T, in one solve of the scene with zero velocity.
void project_column(internal::AtRest& rest, const ConstVectorRef& q, int k, std::vector<IslandBasis>& bases) {
  Eigen::VectorXd w = Eigen::VectorXd::Zero(rest.rows());
  for (const IslandBasis& basis : bases)
    if (k < basis.N.cols()) w(basis.rows) = basis.N.col(k);
  w = rest.null_component(q, std::move(w));
  for (IslandBasis& basis : bases)
    if (k < basis.N.cols()) basis.N.col(k) = w(basis.rows);
}

/// Computes null-space bases for all islands with redundant rows by projection and orthonormalisation of test vectors.
/// The second pass removes rounding errors that the first orthonormalisation amplified.
std::vector<IslandBasis> bases_of(const Scene& scene, const ConstVectorRef& q, const SceneData& data) {
  std::vector<IslandBasis> bases;
  int most = 0;
  for (std::size_t i = 0; i < data.report.islands.size(); ++i) {
    const int n = nullity(data.report.islands[i]);
    if (n <= 0) continue;
    IslandBasis basis{internal::rows_of(scene, data, i), {}};
    basis.N.resize(static_cast<Eigen::Index>(basis.rows.size()), n);
    for (int k = 0; k < n; ++k) basis.N.col(k) = internal::mixed(basis.N.rows(), k);
    bases.push_back(std::move(basis));
    most = std::max(most, n);
  }
  if (bases.empty()) return bases;
  Scene in_newtons = scene;  // moment_length 1 gives an orthogonal projection in the units of f
  in_newtons.moment_length = 1;
  internal::AtRest rest(in_newtons, internal::active_of(data), data.options);
  for (int pass = 0; pass < 2; ++pass) {
    for (int k = 0; k < most; ++k) project_column(rest, q, k, bases);
    for (IslandBasis& basis : bases) basis.N = orthonormal(basis.N);
  }
  return bases;
}

void expect_solved(const char* function, const Scene& scene, const ConstVectorRef& q, const SceneData& data) {
  if (data.serial == 0) throw std::logic_error(std::string(function) + ": there is no solution, call solve first");
  expect_configuration(function, "q", q, scene);
}

/// Returns x, or a vector of n entries `otherwise` if x is empty. name: the name of x in error messages.
Eigen::VectorXd given(const char* name, const Eigen::VectorXd& x, Eigen::Index n, double otherwise) {
  if (x.size() == 0) return Eigen::VectorXd::Constant(n, otherwise);
  if (x.size() != n)
    throw std::invalid_argument("redistribute_forces: " + std::string(name) + " has " + std::to_string(x.size()) +
                                " numbers, " + std::to_string(n) + " are expected, one per row of f");
  if (!x.allFinite())
    throw std::invalid_argument("redistribute_forces: " + std::string(name) +
                                " contains a number that is not finite, finite numbers are expected");
  return x;
}

}  // namespace

Eigen::SparseMatrix<double> force_null_space(const Scene& scene, const ConstVectorRef& q, const SceneData& data) {
  expect_solved("force_null_space", scene, q, data);
  std::vector<Eigen::Triplet<double>> entries;
  Eigen::Index cols = 0;
  for (const IslandBasis& basis : bases_of(scene, q, data)) {
    for (Eigen::Index j = 0; j < basis.N.cols(); ++j)
      for (Eigen::Index i = 0; i < basis.N.rows(); ++i) entries.emplace_back(basis.rows[i], cols + j, basis.N(i, j));
    cols += basis.N.cols();
  }
  Eigen::SparseMatrix<double> N(data.f.size(), cols);
  N.setFromTriplets(entries.begin(), entries.end());
  return N;
}

Eigen::VectorXd redistribute_forces(const Scene& scene, const ConstVectorRef& q, const SceneData& data,
                                    const Eigen::VectorXd& reference, const Eigen::VectorXd& weights) {
  expect_solved("redistribute_forces", scene, q, data);
  const Eigen::VectorXd towards = given("reference", reference, data.f.size(), 0);
  const Eigen::VectorXd root = given("weights", weights, data.f.size(), 1).cwiseSqrt();
  if (!(root.array() > 0).all())
    throw std::invalid_argument(
        "redistribute_forces: weights contains a number that is not above 0, numbers above 0 are expected");
  Eigen::VectorXd f = data.f;
  for (const IslandBasis& basis : bases_of(scene, q, data)) {
    const Eigen::VectorXd w = root(basis.rows);
    const Eigen::VectorXd missing = w.cwiseProduct(towards(basis.rows) - f(basis.rows));
    const Eigen::MatrixXd A = w.asDiagonal() * basis.N;
    f(basis.rows) += basis.N * A.householderQr().solve(missing);
  }
  return f;
}

}  // namespace manycontact
