#pragma once
// The command `manycontact export` writes the systems K x = b of a scene's islands, with exact solutions, as Matrix
// Market files.

#include <Eigen/SparseCore>
#include <string>
#include <vector>

#include "manycontact/detail/kkt/island.hpp"
#include "manycontact/dynamics/data.hpp"
#include "manycontact/dynamics/truth.hpp"
#include "manycontact/io/scene_file.hpp"

namespace manycontact::cli {

/// The system K x = b of one island, with x = [a; -f], and the right-hand sides db of K dx = db for the derivatives dx.
struct ExportedSystem {
  Island island;
  Eigen::SparseMatrix<double> K;  // [M J^T; J -delta I], both triangles
  Eigen::VectorXd b;              // [tau_b; -a0]
  Eigen::MatrixXd db;             // nv + nc rows, columns [q | v | u]; empty unless derivatives were requested

  int size() const { return island.size(); }
};

/// Returns the solver options of an export, with which no contact rows are merged and equal robots share no results.
Options export_options();

/// Returns the system of island i after a solve with export_options. `derivatives` requires a call of differentiate,
/// whose result dx gives db = K dx. Entries of db below rounding errors are zero. db is empty if dx is not finite.
ExportedSystem system_of(const Scene& scene, const SceneData& data, std::size_t i, bool derivatives);

struct ExactSolution {
  MatX<Quad> x;       // empty if the solution is not known
  double digits = 0;  // correct digits of the worst column, relative to the column's largest entry of a and of f;
                      // far fewer than 32 if a nearly vanishes
};

/// Solves K x = b by refinement with residuals in quadruple precision. The doubles in K and b count as exact. If the
/// refinement does not converge, uses the dense reference solver for at most kDenseUnknowns unknowns.
ExactSolution solve_exactly(const ExportedSystem& system, const Eigen::MatrixXd& b);
inline constexpr int kDenseUnknowns = 400;

/// Returns the scene's own solution in quadruple precision. If rows are redundant, the forces have least norm.
Truth<Quad> solve_scene(const SceneFile& file, SceneData& data);
/// Returns [a; -f] of an island from the result of solve_scene, or nothing if it is not known. That is the case if rows
/// are redundant and the island has more than kDenseUnknowns unknowns.
ExactSolution of_island(const Truth<Quad>& truth, const Scene& scene, const SceneData& data, const Island& island,
                        std::size_t i);

/// Write a matrix to a Matrix Market file, and only its lower triangle if `symmetric`. comments: lines of the header.
/// Throw InputError if the file cannot be written.
void write_sparse(const std::string& path, const Eigen::SparseMatrix<double>& A, bool symmetric,
                  const std::vector<std::string>& comments);
template <class S>
void write_dense(const std::string& path, const MatX<S>& x, const std::vector<std::string>& comments);

}  // namespace manycontact::cli
