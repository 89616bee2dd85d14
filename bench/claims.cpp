#include "claims.hpp"

#include <cstdio>
#include <string>
#include <utility>
#include <vector>

#include "fit.hpp"

namespace manycontact::bench {

namespace {

struct Claim {
  const char *what, *numerator, *denominator;
  double divide_by;  // number of robots
  const char* wanted;
};

constexpr Claim kClaims[] = {
    {"one robot: scheduled LDL / ldl_numeric", "parts/ldl_scheduled", "parts/ldl_numeric", 1, "<= 0.5"},
    {"one robot: RNEA / ldl_numeric", "parts/rnea", "parts/ldl_numeric", 1, "<= 1.3"},
    {"one robot: ABA / ldl_numeric", "parts/aba", "parts/ldl_numeric", 1, "<= 3"},
    {"one robot: solve / ldl_numeric", "parts/solve", "parts/ldl_numeric", 1, "<= 1.9"},
    {"one robot: RNEA derivatives / ldl_numeric", "parts/rnea_derivatives", "parts/ldl_numeric", 1, "<= 4.5"},
    {"one robot: all derivatives after a solve / ldl_numeric", "parts/derivatives", "parts/ldl_numeric", 1, "<= 3.6"},
    {"16 separate: dense-schur / sparse-ldl", "solve/separate/16/dense-schur", "solve/separate/16/sparse-ldl", 1,
     ">= 10"},
    {"16 separate: dense-schur / Eigen's factors and solves", "solve/separate/16/dense-schur", "eigen/separate/16", 1,
     "<= 1.3"},
    {"sparse-ldl per robot, 256 / 1 separate", "solve/separate/256/sparse-ldl", "solve/separate/1/sparse-ldl", 256,
     "<= 1.3"},
    {"16 separate: derivatives, dense-schur / sparse-ldl", "derivatives/separate/16/dense-schur",
     "derivatives/separate/16/sparse-ldl", 1, ">= 20"},
    {"derivatives per robot, 256 / 1 separate", "derivatives/separate/256/sparse-ldl",
     "derivatives/separate/1/sparse-ldl", 256, "<= 1.3"},
    {"feet on corners: redundant / damped by 1e-6", "redundant/feet_on_corners/undamped",
     "redundant/feet_on_corners/damped", 1, "<= 1.5"},
    {"anymal's loop: redundant / damped by 1e-6", "redundant/anymal_loop/undamped", "redundant/anymal_loop/damped", 1,
     "<= 1.5"},
    {"one robot: action model's calc / ldl_numeric", "action/calc/1", "parts/ldl_numeric", 1, "18.0 / 3.7 Crocoddyl"},
    {"one robot: action model's calcDiff / ldl_numeric", "action/calcDiff/1", "parts/ldl_numeric", 1,
     "55.9 / 3.7 Crocoddyl"},
    {"herd of 256: solve after a contact was switched / solve", "switch/herd/256/one contact", "switch/herd/256/steady",
     1, "<= 1.2"},
    {"16 separate: vjp / solve", "vjp/separate/16", "solve/separate/16/auto", 1, "<= 3"},
    {"256 in lanes (avx2): solve per robot / ldl_numeric", "lanes/avx2/256/solve", "parts/ldl_numeric", 256, "<= 0.6"},
    {"256 in lanes (avx2): derivatives per robot / ldl_numeric", "lanes/avx2/256/derivatives", "parts/ldl_numeric", 256,
     "<= 1.4"},
    {"256 in lanes (avx512): solve per robot / ldl_numeric", "lanes/avx512/256/solve", "parts/ldl_numeric", 256,
     "<= 0.6"},
    {"256 in lanes (avx512): derivatives per robot / ldl_numeric", "lanes/avx512/256/derivatives", "parts/ldl_numeric",
     256, "<= 1.4"},
    {"1,024 / 16 in lanes (avx2): solve per robot", "lanes/avx2/1024/solve", "lanes/avx2/16/solve", 64, "<= 1.15"},
    {"1,024 / 16 in lanes (avx2): derivatives per robot", "lanes/avx2/1024/derivatives", "lanes/avx2/16/derivatives",
     64, "<= 1.15"},
    {"ring of 64: solve per robot / ldl_numeric", "sweep/ring/64/solve", "parts/ldl_numeric", 64, "<= 2.2"},
    {"ring, 1,024 / 16: solve per robot", "sweep/ring/1024/solve", "sweep/ring/16/solve", 64, "<= 1.15"},
    {"chain, 100,000 / 1,000: solve per link", "sweep/chain/100000/solve", "sweep/chain/1000/solve", 100, "<= 1.3"},
    {"chain of 1,000: solve / ABA without contacts", "sweep/chain/1000/solve", "sweep/chain/1000/ABA", 1, "<= 3"},
    {"16 separate, 50 knots: dense Riccati / by islands", "lq/dense_5_knots/16/factorize", "lq/separate/16/factorize",
     0.1, ">= 100"},
    {"chain of 16, 50 knots: dense Riccati / couplings' Schur", "lq/dense_5_knots/16/factorize",
     "lq/chain/16/factorize", 0.1, ">= 10"},
    {"Riccati by islands per robot, 64 / 1 separate", "lq/separate/64/factorize", "lq/separate/1/factorize", 64,
     "<= 1.3"},
    {"16 separate, 50 nodes: FDDP's direction, dense Riccati / by parts", "control/dense_5_nodes/16/backward",
     "control/separate/16/backward", 0.1, ">= 100"},
    {"FDDP's iteration by parts per robot, 64 / 1 separate", "control/separate/64/iteration",
     "control/separate/1/iteration", 64, "<= 1.3"},
    {"chain of 16, 50 nodes: FDDP's iteration, dense / by couplings", "control/dense_chain_5_nodes/16/iteration",
     "control/chain/16/iteration", 0.1, ">= 10"},
    {"64 states, solve: a batch / a scene of 64 copies", "batch/solve/separate/1/threads:1/real_time",
     "batch/solve/scene_of_64/real_time", 1, "<= 1.15"},
    {"64 states, vjp: a batch / a scene of 64 copies", "batch/vjp/separate/1/threads:1/real_time",
     "batch/vjp/scene_of_64/real_time", 1, "<= 1.15"},
    {"64 states, solve: two threads / one", "batch/solve/separate/1/threads:2/real_time",
     "batch/solve/separate/1/threads:1/real_time", 1, "<= 0.55"},
    {"64 states, derivatives: two threads / one", "batch/differentiate/separate/1/threads:2/real_time",
     "batch/differentiate/separate/1/threads:1/real_time", 1, "<= 0.55"},
    {"64 states, vjp: two threads / one", "batch/vjp/separate/1/threads:2/real_time",
     "batch/vjp/separate/1/threads:1/real_time", 1, "<= 0.55"},
};

// Exponents of time in the number of robots; the names of the times are `before`, this number, `after`.
struct Growth {
  const char *what, *before, *after, *wanted;
};
constexpr Growth kGrowths[] = {
    {"FDDP's iteration by parts, separate robots", "control/separate/", "/iteration", "1"},
    {"FDDP's iteration by couplings, chain", "control/chain/", "/iteration", "1"},
    {"FDDP's iteration on the whole scene, chain", "control/dense_chain_5_nodes/", "/iteration", "3, once large"},
    {"couplings' Schur, chain: factorize", "lq/chain/", "/factorize", "1"},
};

void print_exponent(const Run& run, const Growth& growth) {
  const std::string before = growth.before, after = growth.after;
  std::vector<std::pair<double, double>> points;
  for (const Result& r : run.results)
    if (r.name.starts_with(before) && r.name.ends_with(after))
      points.emplace_back(std::stod(r.name.substr(before.size())), r.us);
  if (points.size() > 1)
    std::printf("%-64s %10.2f   %s\n", (std::string(growth.what) + ": exponent").c_str(), exponent(points),
                growth.wanted);
}

}  // namespace

void print_claims(const Run& run) {
  if (!find(run, kClaims[0].denominator)) return;
  std::printf("\n%-64s %10s   %s\n", "ratio (wanted: of a Talos)", "measured", "wanted");
  for (const Claim& c : kClaims) {
    const Result *a = find(run, c.numerator), *b = find(run, c.denominator);
    if (a && b) std::printf("%-64s %10.2f   %s\n", c.what, a->us / b->us / c.divide_by, c.wanted);
  }
  for (const Growth& growth : kGrowths) print_exponent(run, growth);
}

}  // namespace manycontact::bench
