#include "choice.hpp"

namespace manycontact::cli {

std::string why_changed(const Choice& choice, const IslandReport& report) {
  if (report.status == Status::kFailed) return "no solution: " + to_string(report.reason);
  // the reason is no longer known if the solution was checked since
  const std::string reason = report.reason == Reason::kUncertain ? "" : " (" + to_string(report.reason) + ")";
  if (!report.dependent_rows.empty() && report.method == Method::kSparseLdl)
    return report.reason == Reason::kNone ? ""
                                          : "rows are dependent: sparse-ldl in " + to_string(report.order) +
                                                " order computed the forces of least norm";
  if (report.changed_order)
    return to_string(choice.order) + " order was not accurate" + reason + ", " + to_string(report.order) + " solved it";
  if (report.method != choice.method)
    return to_string(choice.method) + " gave up" + reason + ", " + to_string(report.method) + " solved it";
  return "";
}

}  // namespace manycontact::cli
