#pragma once

#include <memory>
#include <new>

#include "manycontact/spatial/scalar.hpp"

namespace manycontact {

/// A row-major matrix of doubles, aligned to 64 bytes for any alignment that Eigen is compiled with. If the number of
/// columns is a multiple of eight, every row is aligned.
class AlignedPanel : public Eigen::Map<Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>> {
 public:
  using Matrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  using View = Eigen::Map<Matrix>;

  /// Constructs a panel without rows.
  AlignedPanel() : View(nullptr, 0, 0) {}
  /// Copies the numbers of the other panel into its own memory.
  AlignedPanel(const AlignedPanel& other) : AlignedPanel() {
    resize(other.rows(), other.cols());
    View::operator=(other);
  }
  /// Takes the memory of the other panel, which then has no rows.
  AlignedPanel(AlignedPanel&& other) noexcept : AlignedPanel() { swap(other); }
  AlignedPanel& operator=(AlignedPanel other) noexcept {
    swap(other);
    return *this;
  }

  /// Changes the size; new entries are uninitialised if the size differs. Throws std::bad_alloc if there is no memory;
  /// the panel is then empty.
  void resize(Eigen::Index rows, Eigen::Index cols) {
    if (rows == this->rows() && cols == this->cols()) return;
    memory_.reset();
    look_at(0, 0);
    memory_.reset(static_cast<double*>(::operator new(sizeof(double) * static_cast<std::size_t>(rows * cols), kLine)));
    look_at(rows, cols);
  }
  /// Exchanges the memory of the two panels. No numbers are copied.
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
