#pragma once
// Names that code written for Crocoddyl expects, and functions that check arguments.

#include <Eigen/Core>
#include <limits>
#include <memory>
#include <numeric>
#include <ostream>
#include <stdexcept>
#include <string>

#include "manycontact/model/scene.hpp"

namespace manycontact {

using FrameIndex = std::size_t;  // number of a frame of a Multibody, over all its robots

inline constexpr ReferenceFrame LOCAL = ReferenceFrame::kLocal;
inline constexpr ReferenceFrame WORLD = ReferenceFrame::kWorld;
inline constexpr ReferenceFrame LOCAL_WORLD_ALIGNED = ReferenceFrame::kLocalWorldAligned;

inline constexpr ContactType Contact1D = ContactType::k1D;
inline constexpr ContactType Contact2D = ContactType::k2D;
inline constexpr ContactType Contact3D = ContactType::k3D;
inline constexpr ContactType Contact6D = ContactType::k6D;

/// An argument nu with this value means the number of controls of the actuation, if there is one, otherwise nv.
inline constexpr std::size_t kDefaultNu = static_cast<std::size_t>(-1);

using Motion = Vec6<double>;  // [linear; angular]
using Force = Vec6<double>;

/// Crocoddyl's names of matrix types.
struct MathBase {
  using Scalar = double;
  using Vector2s = Eigen::Vector2d;
  using Vector3s = Eigen::Vector3d;
  using Vector6s = Vec6<double>;
  using VectorXs = Eigen::VectorXd;
  using Matrix3s = Eigen::Matrix3d;
  using Matrix6s = Mat6<double>;
  using MatrixXs = Eigen::MatrixXd;
  using Quaternions = Eigen::Quaterniond;
};

/// The common base of classes that are printed with <<.
class Printable {
 public:
  virtual ~Printable() = default;
  virtual void print(std::ostream& os) const = 0;  // prints type and sizes
};
/// Prints an object as its `print` does.
inline std::ostream& operator<<(std::ostream& os, const Printable& x) {
  x.print(os);
  return os;
}

using MatrixRef = Eigen::Ref<Eigen::MatrixXd>;
using RowMajorMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
using PanelView = Eigen::Map<const RowMajorMatrix, 0, Eigen::OuterStride<>>;

/// Throws std::invalid_argument "where: what has 3 numbers, 7 expected" unless given equals expected.
inline void check_size(const char* where, const char* what, Eigen::Index given, std::size_t expected) {
  if (given != static_cast<Eigen::Index>(expected))
    throw std::invalid_argument(std::string(where) + ": " + what + " has " + std::to_string(given) +
                                " numbers, expected " + std::to_string(expected));
}

/// Throws std::invalid_argument if `data` is null.
template <class Data>
Data& check_data(const char* where, const std::shared_ptr<Data>& data) {
  if (data == nullptr)
    throw std::invalid_argument(std::string(where) +
                                ": the data are a null pointer, data of createData() are expected");
  return *data;
}

/// Throws std::invalid_argument "where: what" if the condition is false. The first overload allocates nothing.
inline void require(bool condition, const char* where, const char* what) {
  if (!condition) throw std::invalid_argument(std::string(where) + ": " + what);
}
inline void require(bool condition, const std::string& where, const std::string& what) {
  if (!condition) throw std::invalid_argument(where + ": " + what);
}

namespace internal {

/// A range of allowed values of a setting, and its description in messages.
struct Range {
  double low;
  bool has_low;  // whether the range includes `low`; it always includes `high`
  double high;
  const char* what;
  /// Sets `to`; throws std::invalid_argument "where: what" if the number is not in the range.
  void set(double& to, double number, const char* where) const {
    require((has_low ? number >= low : number > low) && number <= high, where, what);
    to = number;
  }
};
inline constexpr double kAnySize = std::numeric_limits<double>::infinity();
inline constexpr Range kPositive{0, false, kAnySize, "a positive number is expected"};
inline constexpr Range kTolerance{0, false, kAnySize, "a positive tolerance is expected"};
inline constexpr Range kNotNegative{0, true, kAnySize, "a number that is not negative is expected"};
inline constexpr Range kAboveOne{1, false, kAnySize, "a number above 1 is expected"};
inline constexpr Range kShare{0, false, 1, "a number in (0, 1] is expected"};

/// Returns the n numbers first, first + 1, ...
inline std::vector<int> range(int first, int n) {
  std::vector<int> numbers(static_cast<std::size_t>(n));
  std::iota(numbers.begin(), numbers.end(), first);
  return numbers;
}

/// Casts data to the model's own type Data; throws std::invalid_argument if data are null or of another type.
template <class Data, class Base>
Data& own_data(const char* where, const std::shared_ptr<Base>& data) {
  Data* own = dynamic_cast<Data*>(&check_data(where, data));
  require(own != nullptr, where,
          "the data were created by another model, data of this model's createData() are expected");
  return *own;
}

/// Returns part; throws std::invalid_argument if part is null. what: its description in the message, "a model".
template <class Part>
const std::shared_ptr<Part>& given(const char* where, const std::shared_ptr<Part>& part, const char* what = "a model") {
  if (part == nullptr)
    throw std::invalid_argument(std::string(where) + ": " + what + " is expected, not a null pointer");
  return part;
}

}  // namespace internal

}  // namespace manycontact
