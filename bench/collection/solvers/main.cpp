// manycontact_collection: runs one solver on one system. run.py calls it.
//
//     manycontact_collection --list                        a line "NAME VERSION" per solver
//     manycontact_collection SOLVER K.mtx b.mtx x.txt      writes x, prints the median time of one solve [us]
//
// SOLVER is NAME, NAME:DELTA for K - [0 0; 0 DELTA I] instead of K, or sparse-ldl:DELTA:STEPS (sparse_ldl.cpp).

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <fstream>
#include <iostream>
#include <sstream>
#include <stdexcept>

#include "solver.hpp"

namespace manycontact::collection {

const std::vector<Kind>& kinds() {
  static const std::vector<Kind> all = [] {
    std::vector<Kind> out = lapack_kinds();
    for (const auto& more : {mumps_kinds(), suitesparse_kinds(), sparse_ldl_kinds()})
      out.insert(out.end(), more.begin(), more.end());
    return out;
  }();
  return all;
}

namespace {

// Returns the first line after the comments, and leaves `in` after it. Sets nv from a comment "% nv 38, nc 12".
std::istringstream sizes_of(std::ifstream& in, const std::string& path, int& nv) {
  std::string line;
  while (std::getline(in, line) && line.starts_with("%")) std::sscanf(line.c_str(), "%% nv %d", &nv);
  if (!in) throw std::runtime_error(path + " is no Matrix Market file");
  return std::istringstream(line);
}

System read(const std::string& K, const std::string& b) {
  System out;
  std::ifstream in(K), rhs(b);
  std::istringstream sizes = sizes_of(in, K, out.nv);
  int n = 0, columns = 0;
  long entries = 0;
  sizes >> n >> columns >> entries;
  std::vector<Eigen::Triplet<double>> triplets;
  int i = 0, j = 0;
  double value = 0;
  for (long k = 0; k < entries && in >> i >> j >> value; ++k) triplets.emplace_back(i - 1, j - 1, value);
  out.lower.resize(n, n);
  out.lower.setFromTriplets(triplets.begin(), triplets.end());
  sizes_of(rhs, b, out.nv);
  out.b.resize(n);
  for (int k = 0; k < n && rhs >> value; ++k) out.b[k] = value;
  if (!in || !rhs) throw std::runtime_error(K + " or " + b + " ends early");
  return out;
}

// Replaces K by K - [0 0; 0 delta I].
void damp(System& s) {
  std::vector<Eigen::Triplet<double>> diagonal;
  for (int i = s.nv; i < s.size(); ++i) diagonal.emplace_back(i, i, -s.damping);
  Eigen::SparseMatrix<double> D(s.size(), s.size());
  D.setFromTriplets(diagonal.begin(), diagonal.end());
  s.lower = Eigen::SparseMatrix<double>(s.lower + D);
}

// Returns the median time of at least a few solves, and of half a second of them.
double median_time(Solver& solver, Eigen::VectorXd& x) {
  using Clock = std::chrono::steady_clock;
  constexpr int kLeast = 3, kMost = 1001;
  constexpr double kEnough = 5e5;  // us
  std::vector<double> times;
  double sum = 0;
  while (static_cast<int>(times.size()) < kMost && (static_cast<int>(times.size()) < kLeast || sum < kEnough)) {
    const Clock::time_point start = Clock::now();
    x = solver.solve();
    times.push_back(std::chrono::duration<double, std::micro>(Clock::now() - start).count());
    sum += times.back();
  }
  std::nth_element(times.begin(), times.begin() + static_cast<long>(times.size() / 2), times.end());
  return times[times.size() / 2];
}

struct Dials {
  std::string name;
  double damping = 0;
  int steps = 0;
};

Dials read_dials(const std::string& word) {
  std::istringstream in(word);
  Dials out;
  std::string damping, steps;
  std::getline(in, out.name, ':');
  if (std::getline(in, damping, ':')) out.damping = std::stod(damping);
  if (std::getline(in, steps)) out.steps = std::stoi(steps);
  return out;
}

int run(const std::vector<std::string>& words) {
  if (words.size() == 1 && words[0] == "--list") {
    for (const Kind& kind : kinds()) std::cout << kind.name << " " << kind.version << "\n";
    return 0;
  }
  if (words.size() != 4) throw std::runtime_error("expected --list, or SOLVER K.mtx b.mtx x.txt");
  const Dials dials = read_dials(words[0]);
  const auto kind = std::find_if(kinds().begin(), kinds().end(), [&](const Kind& k) { return k.name == dials.name; });
  if (kind == kinds().end()) throw std::runtime_error("no solver '" + words[0] + "', expected one of --list");
  System system = read(words[1], words[2]);
  system.damping = dials.damping;
  system.steps = dials.steps;
  if (kind->largest > 0 && system.size() > kind->largest)
    throw std::runtime_error("larger than " + std::to_string(kind->largest) + " unknowns");
  if (kind->name != "sparse-ldl" && system.damping > 0) damp(system);
  const std::unique_ptr<Solver> solver = kind->make(system);
  Eigen::VectorXd x;
  const double time = median_time(*solver, x);
  std::ofstream out(words[3]);
  out.precision(17);
  for (double value : x) out << value << "\n";
  if (!out.flush()) throw std::runtime_error(words[3] + " cannot be written");
  std::cout << time << "\n";
  return 0;
}

}  // namespace

}  // namespace manycontact::collection

int main(int argc, char** argv) try {
  return manycontact::collection::run({argv + std::min(argc, 1), argv + argc});
} catch (const std::exception& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 1;
}
