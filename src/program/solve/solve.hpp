#pragma once
// The command `manycontact solve` writes the solution of a scene, as a summary or as JSON.

#include <optional>

#include "../text/findings.hpp"
#include "manycontact/dynamics/differentiate.hpp"
#include "manycontact/dynamics/solve.hpp"
#include "manycontact/io/scene_file.hpp"

namespace manycontact::cli {

struct Times {          // medians [us]
  double symbolic = 0;  // symbolic analysis of every shape of island, with empty caches
  double setup = 0;     // construction of SceneData: memory, islands, symbolic analysis
  double solve = 0;
  double derivatives = 0;  // 0 unless derivatives were requested
};

struct SolvedScene {
  const SceneFile& file;
  SceneData data;  // solved, with condition and errors estimated
  Times time;
  int repeat = 1;
  std::optional<Eigen::VectorXd> quasi_static_u;
  bool derivatives = false;                              // whether derivatives(data) are available
  std::vector<DerivativeBounds> derivative_errors = {};  // one entry per island, or empty
  std::vector<SystemQuality> quality = {};               // one entry per island, or empty
  Findings findings = {};
  std::vector<Unbalanced> unbalanced = {};  // robots that quasi_static_u does not keep at rest
  std::vector<char> unique = {};  // result of unique_forces, one entry per row of data.f; empty if not requested
  bool compare = false;           // whether to compare with the dense reference solver even if it is slow
};

/// Solves the scene, and measures set-up, analysis, solve and, if requested, derivatives `repeat` times each. Solve and
/// derivatives run once before, to warm up.
SolvedScene solve_scene(const SceneFile& file, const Options& options, int repeat, bool derivatives = false);

void write_json(const SolvedScene& solved, const std::string& path);

void print_summary(std::ostream& out, const SolvedScene& solved);
/// The functions below print the parts of the summary, in the summary's order.
void print_report(std::ostream& out, const SolvedScene& solved);
void print_accelerations(std::ostream& out, const SolvedScene& solved);
void print_forces(std::ostream& out, const SolvedScene& solved);
void print_derivatives(std::ostream& out, const SolvedScene& solved);
void print_quasi_static(std::ostream& out, const SolvedScene& solved);
/// Solves again with the dense reference solver, and prints differences of solutions and times.
void print_against_dense(std::ostream& out, const SolvedScene& solved);

}  // namespace manycontact::cli
