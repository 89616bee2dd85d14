#pragma once
// The table of cases and outcomes, on a terminal and as the page README.md of this folder.

#include <map>
#include <string>
#include <vector>

#include "stability/judge.hpp"

namespace manycontact::test {

/// Returns one line per case: letters of all columns, the largest errors, faults.
std::string text_table(const std::string& cause, const std::vector<Row>& rows);

/// Returns how often each outcome was reached, "exact 1234, refined ...".
std::string counts(const std::vector<Row>& rows);

std::string page_path();
std::string errors_path();
/// Returns a line per case and precision, for auto: precision used, condition, errors of a and f relative to bounds.
std::string errors_by_precision(const std::vector<Row>& rows);
std::string page(const std::vector<std::pair<std::string, std::vector<Row>>>& causes);
/// Returns the letters on the committed page, by cause and case.
std::map<std::string, std::map<std::string, std::string>> read_page();

}  // namespace manycontact::test
