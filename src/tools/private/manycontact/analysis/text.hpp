#pragma once
// Functions that put counts, lists and numbers in words, without line breaks or terminal codes.

#include <string>
#include <vector>

namespace manycontact::text {

/// Returns a count with its noun, such as "1 robot", "3 robots", "2 velocities".
std::string count(long n, const std::string& noun);

/// Returns a list such as "a, b, c and 5 more" of at most `most` names. A single remaining name is listed too.
std::string join(const std::vector<std::string>& names, std::size_t most = 12, const std::string& between = ", ",
                 const std::string& before_rest = " and ");

std::string number(double x, int digits = 3);  // formats `x` with `digits` significant digits

/// Returns a text such as "5 m and 0.1 rad". Sizes below `negligible` are left out.
std::string two_sizes(double first, const char* unit, double second, const char* unit_of_second, double negligible);

}  // namespace manycontact::text
