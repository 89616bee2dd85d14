#pragma once
// The solution of a scene and its derivatives in quadruple precision, and the errors of results relative to it.

#include "manycontact/detail/kkt/island.hpp"
#include "manycontact/dynamics/differentiate.hpp"
#include "manycontact/dynamics/truth.hpp"
#include "manycontact/io/scene_file.hpp"

namespace manycontact::cli {

struct ChartTruth {
  VecX<Quad> a, f;            // accelerations and forces, ordered as in SceneData
  Eigen::VectorXd a_free;     // accelerations without contacts
  std::vector<char> at_rest;  // one flag per robot: whether a nearly vanishes, so that errors are relative to a_free

  // Derivatives of [a; f] of an island along the columns of `along` (rows [q | v | u]), which are unit vectors or four
  // random vectors in each of q, v, u. `first` contains the first columns of q, v and u, and the number of columns.
  struct OfIsland {
    Island island;
    Eigen::MatrixXd along;
    MatX<Quad> derivatives;
    int first[4] = {0, 0, 0, 0};
    bool known = true, derivatives_known = true;
  };
  std::vector<OfIsland> islands;
  int unknown = 0;  // number of islands without a reference solution
  int unknown_derivatives = 0;
  int sampled = 0;  // number of islands whose derivatives are along random vectors
};

/// Computes the reference. `data` must be solved by sparse-ldl at the scene's state.
ChartTruth find_truth(const SceneFile& file, SceneData& data);

/// Return the largest relative error of all robots, or NaN if the result contains NaN or there is no reference.
double acceleration_error(const Scene& scene, const SceneData& data, const ChartTruth& truth);
double force_error(const Scene& scene, const SceneData& data, const ChartTruth& truth);
/// Returns the largest relative error of all robots and of the six blocks of derivatives (a, f w.r.t. q, v, u).
double derivative_error(const Scene& scene, const SceneData& data, const ChartTruth& truth);

}  // namespace manycontact::cli
