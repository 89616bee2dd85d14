#include "choice.hpp"

namespace manycontact::cli {

std::string why_changed(const Choice& choice, const IslandReport& report) {
  const std::string reason = to_string(report.reason);
  if (report.status == Status::kFailed) return "no answer: " + reason;
  if (!report.dependent_rows.empty() && report.method == Method::kSparseLdl)
    return "rows depend on each other, so sparse-ldl in leaf-to-root order answered without them";
  if (report.changed_order)
    return to_string(choice.order) + " order was unsound (" + reason + "), " + to_string(report.order) + " answered";
  if (report.method != choice.method)
    return to_string(choice.method) + " gave up (" + reason + "), " + to_string(report.method) + " answered";
  return "";
}

long nonzeros_of_K(const KktPattern& pattern, double damping) {
  return 2L * pattern.K.nonzeros() - pattern.size() - (damping == 0 ? pattern.nc : 0);
}

}  // namespace manycontact::cli
