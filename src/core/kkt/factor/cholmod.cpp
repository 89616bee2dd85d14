#include "manycontact/sparse/cholmod.hpp"

#include <optional>

#include "manycontact/kkt/factor/factors.hpp"
#include "pivots.hpp"

namespace manycontact {

namespace {

// Calls copy(x, b) for each entry x in columns of a row-major panel X, with its entry b of B, a column-major panel with
// rows in elimination order.
template <class Copy>
void each_entry(const KktPattern& p, double* X, int ld, int first, int cols, std::vector<double>& B, Copy&& copy) {
  const std::size_t n = p.size();
  B.resize(std::max(B.size(), n * cols));
  for (std::size_t k = 0; k < n; ++k) {
    double* row = X + static_cast<std::ptrdiff_t>(p.perm[k]) * ld + first;
    for (int c = 0; c < cols; ++c) copy(row[c], B[c * n + k]);
  }
}

class CholmodFactor final : public Factor {
 public:
  explicit CholmodFactor(std::shared_ptr<IslandShape> shape) : shape_(std::move(shape)) {}

  Method method() const override { return Method::kSparseCholmod; }

  Reason factorize(const KktMatrix& K, FactorScratch& scratch) override {
    if (!cholmod_ || pattern_ != K.pattern) cholmod_.emplace(shape_->cholmod(K.pattern->order));
    pattern_ = K.pattern;
    D_.resize(K.size());
    scratch.scale.resize(std::max<std::size_t>(scratch.scale.size(), K.size()));
    if (!cholmod_->factorize(K.values.data())) return Reason::kZeroPivot;
    cholmod_->pivots(D_.data());
    cholmod_->pivot_terms(K.values.data(), scratch.scale.data());
    growth_ = internal::growth_of(K, scratch.scale.data());
    return internal::judge_pivots(K, nullptr, D_.data(), scratch);
  }

  void solve(double* x) override { cholmod_->solve(x, 1); }

  void solve_panel(double* X, int ld, int first, int cols, char*) override {
    each_entry(*pattern_, X, ld, first, cols, columns_, [](double x, double& b) { b = x; });
    cholmod_->solve(columns_.data(), cols);
    each_entry(*pattern_, X, ld, first, cols, columns_, [](double& x, double b) { x = b; });
  }

  double growth() const override { return growth_; }
  int rank() const override { return pattern_->nc; }
  int nonzeros() const override { return cholmod_->symbolic().factor_nonzeros(); }

 private:
  std::shared_ptr<IslandShape> shape_;
  std::shared_ptr<const KktPattern> pattern_;
  std::optional<sparse::Cholmod> cholmod_;
  std::vector<double> D_, columns_;
  double growth_ = 1;
};

}  // namespace

std::unique_ptr<Factor> make_cholmod_factor(std::shared_ptr<IslandShape> shape) {
  return std::make_unique<CholmodFactor>(std::move(shape));
}

}  // namespace manycontact
