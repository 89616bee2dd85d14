#include "manycontact/kkt/schur.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "columns.hpp"
#include "manycontact/algorithm/inertia_factor.hpp"
#include "manycontact/kkt/factor/factors.hpp"
#include "manycontact/sparse/tolerances.hpp"
#include "pivots.hpp"

namespace manycontact {

namespace {

class SchurFactor final : public Factor {
 public:
  explicit SchurFactor(std::shared_ptr<IslandShape> shape) : shape_(std::move(shape)) {}

  Method method() const override { return Method::kSparseSupernodal; }

  Reason factorize(const KktMatrix& K, FactorScratch&) override {
    pattern_ = K.pattern;
    gather_inertia(K, M_);
    gather_rows(K, J_);
    const SchurPattern& p = *shape_->schur();
    if (!form_schur(shape_->scene(), shape_->island(), shape_->support(), p, M_, J_, K.damping, data_))
      return Reason::kSingularInertia;
    growth_ = 1;
    if (K.nc() == 0) return Reason::kNone;
    double largest_S = 0, largest_K = 0;
    for (int k = 0; k < K.nc(); ++k) largest_S = std::max(largest_S, data_.Sx[p.S.p[k + 1] - 1]);
    for (int k = 0; k < K.size(); ++k) largest_K = std::max(largest_K, K.values[K.pattern->K.p[k + 1] - 1]);
    growth_ = std::max(1.0, largest_S / largest_K);
    if (!cholmod_) cholmod_.emplace(shape_->cholmod_schur());
    if (!cholmod_->factorize(data_.Sx.data())) return Reason::kSmallPivot;
    if (K.damping == 0 && K.nc() > K.nv()) return Reason::kSmallPivot;  // whatever rounding makes of it
    left_.resize(K.nc());
    cholmod_->parts_left(left_.data());
    return lost(K.damping > 0) ? Reason::kSmallPivot : Reason::kNone;
  }

  // Whether a pivot of S may be rounding, of its own terms or of what those before it left.
  bool lost(bool damped) const {
    const double spread = inertia_spread();
    rank::PassedOn<double> passed_on;
    return std::any_of(left_.begin(), left_.end(), [&](double left) {
      return !(left >= tolerance::kPivotLeft * spread) || (!damped && !passed_on.accepts(false, left / spread));
    });
  }

  // sqrt(largest / smallest pivot of M): S = Z^T Z is formed of D^-1/2 L^-T J^T, whose rounding grows by about as much.
  double inertia_spread() const {
    double least = std::numeric_limits<double>::infinity(), largest = 0;
    for (std::size_t r = 0; r < data_.L.size(); ++r) {
      const Model& model = *shape_->scene().robots[r].model;
      for (int i = 0; i < model.nv; ++i) {
        least = std::min(least, data_.L[r][model.M_begin[i]]);
        largest = std::max(largest, data_.L[r][model.M_begin[i]]);
      }
    }
    return std::sqrt(largest / least);
  }

  void solve(double* x) override;

  void solve_panel(double* X, int ld, int first, int cols, char*) override {
    internal::take_columns(*pattern_, X, ld, first, cols, columns_);
    for (int c = 0; c < cols; ++c) solve(columns_.data() + static_cast<std::ptrdiff_t>(c) * pattern_->size());
    internal::put_columns(*pattern_, columns_, X, ld, first, cols);
  }

  double growth() const override { return growth_; }
  int rank() const override { return pattern_->nc; }
  int nonzeros() const override { return static_cast<int>(M_.size()) + (cholmod_ ? cholmod_->factor_nonzeros() : 0); }

 private:
  // use(row of S, row of the robot) for each row of J on robot r.
  template <class Use>
  void each_row(std::size_t r, Use&& use) const {
    const SchurPattern::OnRobot& on = shape_->schur()->robots[r];
    for (std::size_t k = 0; k < on.contacts.size(); ++k) {
      const int rows = shape_->scene().contacts[on.contacts[k]].rows();
      for (int i = 0; i < rows; ++i) use(shape_->island().row_offset[on.contacts[k]] + i, on.first_row[k] + i);
    }
  }

  std::shared_ptr<IslandShape> shape_;
  std::shared_ptr<const KktPattern> pattern_;
  std::vector<double> M_, J_, columns_, left_;
  SchurData data_;
  double growth_ = 1;
  std::optional<sparse::Cholmod> cholmod_;
};

// [a; y] <- K^-1 [b1; b2] by the Schur complement: with w = D^-1/2 L^-T b1 and Z = D^-1/2 L^-T J^T,
// S y = Z^T w - b2, a = L^-1 D^-1/2 (w - Z y). x is in elimination order.
void SchurFactor::solve(double* x) {
  const int* iperm = pattern_->iperm.data();
  const Island& island = shape_->island();
  Eigen::VectorXd& w = data_.w;
  Eigen::VectorXd& y = data_.y;
  w.resize(island.nv);
  y.resize(island.nc);
  for (int k = 0; k < island.nc; ++k) y[k] = -x[iperm[island.nv + k]];
  for (std::size_t r = 0; r < island.robots.size(); ++r) {
    const Model& model = *shape_->scene().robots[r].model;
    auto wr = w.segment(island.dof_offset[r], model.nv);
    const double* L = data_.L[r].data();
    for (int i = 0; i < model.nv; ++i) wr[i] = x[iperm[island.dof_offset[r] + i]];
    solve_inertia_transposed(model, L, 1, wr.data());
    for (int i = 0; i < model.nv; ++i) wr[i] /= std::sqrt(L[model.M_begin[i]]);
    each_row(r, [&](int row, int k) { y[row] += data_.Z[r].col(k).dot(wr); });
  }
  if (island.nc > 0) cholmod_->solve(y.data(), 1);
  for (std::size_t r = 0; r < island.robots.size(); ++r) {
    const Model& model = *shape_->scene().robots[r].model;
    auto wr = w.segment(island.dof_offset[r], model.nv);
    const double* L = data_.L[r].data();
    each_row(r, [&](int row, int k) { wr -= y[row] * data_.Z[r].col(k); });
    for (int i = 0; i < model.nv; ++i) wr[i] /= std::sqrt(L[model.M_begin[i]]);
    solve_inertia_unit(model, L, 1, wr.data());
    for (int i = 0; i < model.nv; ++i) x[iperm[island.dof_offset[r] + i]] = wr[i];
  }
  for (int k = 0; k < island.nc; ++k) x[iperm[island.nv + k]] = y[k];
}

}  // namespace

std::unique_ptr<Factor> make_schur_factor(std::shared_ptr<IslandShape> shape) {
  return std::make_unique<SchurFactor>(std::move(shape));
}

}  // namespace manycontact
