#include "manycontact/kkt/options.hpp"

namespace manycontact {

std::string to_string(Method method) {
  switch (method) {
    case Method::kDense:
      return "dense";
    case Method::kDenseSchur:
      return "dense-schur";
    case Method::kSparseLdl:
      return "sparse-ldl";
    case Method::kSuiteSparseLdl:
      return "suitesparse-ldl";
    case Method::kSparseCholmod:
      return "sparse-cholmod";
    case Method::kSparseBodies:
      return "sparse-bodies";
    case Method::kAuto:
      return "auto";
  }
  return "?";
}

std::string to_string(Order order) {
  switch (order) {
    case Order::kLeafToRoot:
      return "leaf-to-root";
    case Order::kContactsEarly:
      return "contacts-early";
    case Order::kCamd:
      return "camd";
  }
  return "?";
}

std::string to_string(Lanes lanes) {
  switch (lanes) {
    case Lanes::kAuto:
      return "auto";
    case Lanes::kOff:
      return "off";
    case Lanes::kBaseline:
      return "baseline";
    case Lanes::kAvx2:
      return "avx2";
    case Lanes::kAvx512:
      return "avx512";
  }
  return "?";
}

std::string to_string(Precision precision) {
  switch (precision) {
    case Precision::kSingle:
      return "single";
    case Precision::kDouble:
      return "double";
    case Precision::kExtended:
      return "extended";
  }
  return "?";
}

namespace {
template <class T, std::size_t N>
std::optional<T> called(const std::string& name, const T (&all)[N]) {
  for (T x : all)
    if (to_string(x) == name) return x;
  return std::nullopt;
}
}  // namespace

std::optional<Method> method_from_string(const std::string& name) { return called(name, kMethods); }
std::optional<Order> order_from_string(const std::string& name) { return called(name, kOrders); }
std::optional<Lanes> lanes_from_string(const std::string& name) { return called(name, kLanes); }
std::optional<Precision> precision_from_string(const std::string& name) { return called(name, kPrecisions); }

}  // namespace manycontact
