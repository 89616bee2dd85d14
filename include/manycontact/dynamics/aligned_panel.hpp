#pragma once
// A row-major matrix whose rows start where cache lines do.

#include <memory>
#include <new>

#include "manycontact/spatial/scalar.hpp"

namespace manycontact {

/// With a multiple of eight columns every row does, whatever alignment Eigen is compiled for.
class AlignedPanel : public Eigen::Map<Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>> {
 public:
  using Matrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  using View = Eigen::Map<Matrix>;

  /// Of no rows.
  AlignedPanel() : View(nullptr, 0, 0) {}
  /// A copy, in memory of its own.
  AlignedPanel(const AlignedPanel& other) : AlignedPanel() {
    resize(other.rows(), other.cols());
    View::operator=(other);
  }
  /// The other is left with no rows.
  AlignedPanel(AlignedPanel&& other) noexcept : AlignedPanel() { swap(other); }
  AlignedPanel& operator=(AlignedPanel other) noexcept {
    swap(other);
    return *this;
  }

  /// Memory of another size holds any numbers; where there is none, std::bad_alloc and the panel is empty.
  void resize(Eigen::Index rows, Eigen::Index cols) {
    if (rows == this->rows() && cols == this->cols()) return;
    memory_.reset();
    look_at(0, 0);
    memory_.reset(static_cast<double*>(::operator new(sizeof(double) * static_cast<std::size_t>(rows * cols), kLine)));
    look_at(rows, cols);
  }
  /// The memory changes hands.
  void swap(AlignedPanel& other) noexcept {
    const Eigen::Index rows = this->rows(), cols = this->cols();
    memory_.swap(other.memory_);
    look_at(other.rows(), other.cols());
    other.look_at(rows, cols);
  }

 private:
  static constexpr std::align_val_t kLine{64};
  struct Free {
    void operator()(double* x) const { ::operator delete(x, kLine); }
  };
  void look_at(Eigen::Index rows, Eigen::Index cols) { new (static_cast<View*>(this)) View(memory_.get(), rows, cols); }

  std::unique_ptr<double, Free> memory_;
};

}  // namespace manycontact
