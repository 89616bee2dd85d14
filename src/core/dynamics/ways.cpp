#include "internal.hpp"
#include "manycontact/dynamics/shapes.hpp"

namespace manycontact {

namespace {

std::string text_of(const internal::Attempt& by, Method chosen) {
  const std::string order = " in " + to_string(by.order) + " order", ldl = "sparse-ldl" + order;
  switch (by.kind) {
    case internal::FactorKind::kWaiting:
      return ldl;
    case internal::FactorKind::kProximal:
      return ldl + " with proximal steps";
    case internal::FactorKind::kDense:
      return to_string(Method::kDense);
    case internal::FactorKind::kChosen:
      break;
  }
  const bool by_ldl = chosen == Method::kSparseLdl || chosen == Method::kSparseBodies;
  return by_ldl ? ldl + (by.damping == 0 ? " with all rows" : "")
                : to_string(chosen) + (has_order(chosen) ? order : "");
}

}  // namespace

std::string ways_of(const Scene& scene, const SceneData& data, std::size_t i) {
  const IslandWork& d = *data_solved(data).workspace->islands.at(i);
  std::string out;
  const auto add = [&out](const std::string& way) { out += (out.empty() ? "" : "; ") + way; };
  if (d.alone.group && !is_inexact(scene, d)) add("in a SIMD batch");
  if (d.robots && d.robots->solves && !is_inexact(scene, d)) add("robot by robot in SIMD batches");
  if (d.bodies && !is_inexact(scene, d)) add(to_string(Method::kSparseBodies));
  const internal::Attempts attempts = internal::attempts_of(scene, d.matrix);
  for (int k = 0; k < attempts.count; ++k) add(text_of(attempts.list[k], d.choice.method));
  return out;
}

}  // namespace manycontact
