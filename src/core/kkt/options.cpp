#include "manycontact/kkt/options.hpp"

#include "manycontact/model/named.hpp"

namespace manycontact {

namespace {

constexpr Named<Method> kMethodNames[] = {
    {Method::kDense, "dense"},
    {Method::kDenseSchur, "dense-schur"},
    {Method::kSparseLdl, "sparse-ldl"},
    {Method::kSuiteSparseLdl, "suitesparse-ldl"},
    {Method::kSparseCholmod, "sparse-cholmod"},
    {Method::kSparseBodies, "sparse-bodies"},
    {Method::kAuto, "auto"},
};
constexpr Named<Order> kOrderNames[] = {
    {Order::kLeafToRoot, "leaf-to-root"},
    {Order::kContactsEarly, "contacts-early"},
    {Order::kCamd, "camd"},
};
constexpr Named<SimdLevel> kSimdLevelNames[] = {
    {SimdLevel::kAuto, "auto"}, {SimdLevel::kOff, "off"},       {SimdLevel::kBaseline, "baseline"},
    {SimdLevel::kAvx2, "avx2"}, {SimdLevel::kAvx512, "avx512"},
};
constexpr Named<Precision> kPrecisionNames[] = {
    {Precision::kSingle, "single"},
    {Precision::kDouble, "double"},
    {Precision::kExtended, "extended"},
};

}  // namespace

std::string to_string(Method method) { return name_of(kMethodNames, method); }
std::string to_string(Order order) { return name_of(kOrderNames, order); }
std::string to_string(SimdLevel lanes) { return name_of(kSimdLevelNames, lanes); }
std::string to_string(Precision precision) { return name_of(kPrecisionNames, precision); }

std::optional<Method> method_from_string(const std::string& name) { return called(kMethodNames, name); }
std::optional<Order> order_from_string(const std::string& name) { return called(kOrderNames, name); }
std::optional<SimdLevel> simd_level_from_string(const std::string& name) { return called(kSimdLevelNames, name); }
std::optional<Precision> precision_from_string(const std::string& name) { return called(kPrecisionNames, name); }

}  // namespace manycontact
