// LAPACK's dense solvers of symmetric indefinite systems: Bunch-Kaufman pivoting (dsysv), its bounded variant
// (dsysv_rook), and the expert driver with refinement (dsysvx).

#include <stdexcept>

#include "solver.hpp"

extern "C" {
void dsysv_(const char*, const int*, const int*, double*, const int*, int*, double*, const int*, double*, const int*,
            int*);
void dsysv_rook_(const char*, const int*, const int*, double*, const int*, int*, double*, const int*, double*,
                 const int*, int*);
void dsysvx_(const char*, const char*, const int*, const int*, const double*, const int*, double*, const int*, int*,
             const double*, const int*, double*, const int*, double*, double*, double*, double*, const int*, int*,
             int*);
void ilaver_(int*, int*, int*);
}

namespace manycontact::collection {

namespace {

constexpr int kLargest = 2500;  // unknowns; the cost is O(n^3)
constexpr int kOne = 1;

void check(int info, int n) {
  if (info > 0 && info <= n) throw std::runtime_error("a pivot is zero");  // n + 1 in dsysvx is a warning
}

struct Dense : Solver {
  explicit Dense(const System& s)
      : K(s.lower), b(s.b), n(s.size()), F(n, n), pivots(n), x(n), work(std::size_t(n) * 64 + 64) {}
  const Eigen::MatrixXd K;
  const Eigen::VectorXd b;
  int n;
  Eigen::MatrixXd F;
  std::vector<int> pivots;
  Eigen::VectorXd x;
  std::vector<double> work;
};

template <auto driver>
struct Sysv : Dense {
  using Dense::Dense;
  Eigen::VectorXd solve() override {
    F = K;
    x = b;
    const int length = static_cast<int>(work.size());
    int info = 0;
    driver("L", &n, &kOne, F.data(), &n, pivots.data(), x.data(), &n, work.data(), &length, &info);
    check(info, n);
    return x;
  }
};

struct Sysvx : Dense {
  explicit Sysvx(const System& s) : Dense(s), integers(n) {}
  Eigen::VectorXd solve() override {
    const int length = static_cast<int>(work.size());
    int info = 0;
    double rcond = 0, forward = 0, backward = 0;
    dsysvx_("N", "L", &n, &kOne, K.data(), &n, F.data(), &n, pivots.data(), b.data(), &n, x.data(), &n, &rcond,
            &forward, &backward, work.data(), &length, integers.data(), &info);
    check(info, n);
    return x;
  }
  std::vector<int> integers;
};

template <class S>
std::unique_ptr<Solver> make(const System& s) {
  return std::make_unique<S>(s);
}

}  // namespace

std::vector<Kind> lapack_kinds() {
  int major = 0, minor = 0, patch = 0;
  ilaver_(&major, &minor, &patch);
  const std::string version =
      "LAPACK " + std::to_string(major) + "." + std::to_string(minor) + "." + std::to_string(patch);
  return {{"dsysv", version, kLargest, make<Sysv<dsysv_>>},
          {"dsysv_rook", version, kLargest, make<Sysv<dsysv_rook_>>},
          {"dsysvx", version, kLargest, make<Sysvx>}};
}

}  // namespace manycontact::collection
