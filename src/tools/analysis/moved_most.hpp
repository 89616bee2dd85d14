#pragma once
#include <string>
#include <vector>

#include "manycontact/analysis/findings.hpp"
#include "manycontact/analysis/text.hpp"

namespace manycontact::internal {

/// Returns "; q changed most at r/knee, by 0.1" for what = "q", if the entry of x at r/knee is 0.1 and the
/// largest. Returns "" if all |x| are below kPlacementError.
inline std::string moved_most(const std::string& what, const std::vector<std::string>& names,
                              const Eigen::VectorXd& x) {
  Eigen::Index k = 0;
  const double most = x.size() == 0 ? 0 : x.cwiseAbs().maxCoeff(&k);
  if (!(most >= kPlacementError)) return "";
  return "; " + what + " changed most at " + names[k] + ", by " + text::number(x[k]);
}

}  // namespace manycontact::internal
