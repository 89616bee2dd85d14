#pragma once
// `manycontact solve`: what it computes, and the two ways of showing it.

#include <optional>

#include "manycontact/dynamics/differentiate.hpp"
#include "manycontact/dynamics/solve.hpp"
#include "manycontact/io/scene_file.hpp"

namespace manycontact::cli {

/// Medians, us.
struct Times {
  double symbolic = 0, solve = 0, derivatives = 0;
};

struct Solution {
  const SceneFile& file;
  SceneData data;  // solved, with the condition estimated
  Times time;
  int repeat = 1;
  std::optional<Eigen::VectorXd> quasi_static_u;
  bool derivatives = false;  // data.derivatives holds them
};

/// Analyses and solves `repeat` times after a warm-up, and differentiates likewise when asked to.
Solution solve_scene(const SceneFile& file, const Options& options, int repeat, bool derivatives = false);

/// The JSON of design.md, section 6, to `path`, "-" is standard output. Throws InputError when it cannot be written.
void write_json(const Solution& solution, const std::string& path);

void print_summary(std::ostream& out, const Solution& solution);
/// Its parts, in the order of the summary.
void print_report(std::ostream& out, const Solution& solution);
void print_accelerations(std::ostream& out, const Solution& solution);
void print_forces(std::ostream& out, const Solution& solution);
void print_derivatives(std::ostream& out, const Solution& solution);
void print_quasi_static(std::ostream& out, const Solution& solution);
/// Solves again with the dense oracle and compares answers and times.
void print_against_dense(std::ostream& out, const Solution& solution);

}  // namespace manycontact::cli
