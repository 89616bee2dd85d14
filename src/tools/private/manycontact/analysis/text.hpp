#pragma once
// Words for counts, lists and numbers, without line breaks or terminal codes.

#include <string>
#include <vector>

namespace manycontact::text {

/// Returns "1 robot", "3 robots", "2 velocities".
std::string count(long n, const std::string& noun);

/// Returns "a, b, c and 5 more": at most `most` names, or all of them if only one more is left.
std::string join(const std::vector<std::string>& names, std::size_t most = 12, const std::string& between = ", ",
                 const std::string& before_rest = " and ");

/// Formats `x` with `digits` significant digits.
std::string number(double x, int digits = 3);

/// Returns "5 m and 0.1 rad", without sizes below `negligible`.
std::string two_sizes(double first, const char* unit, double second, const char* unit_of_second, double negligible);

}  // namespace manycontact::text
