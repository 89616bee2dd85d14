#pragma once
// The table of cases and outcomes: as lines of a terminal, and as the page README.md of this folder.

#include <map>
#include <string>
#include <vector>

#include "stability/judge.hpp"

namespace manycontact::test {

/// One line per case: letters of all columns, the largest errors, what went wrong.
std::string text_table(const std::string& cause, const std::vector<Row>& rows);

/// How often each outcome was reached, "exact 1234, refined ...".
std::string counts(const std::vector<Row>& rows);

std::string page_path();
std::string errors_path();
/// A line per case and precision, by auto: precision that solved it, condition, errors of a and f, and over their bound.
std::string errors_by_precision(const std::vector<Row>& rows);
/// The page for these causes and rows.
std::string page(const std::vector<std::pair<std::string, std::vector<Row>>>& causes);
/// Letters by case, cause by cause, of the page as committed.
std::map<std::string, std::map<std::string, std::string>> read_page();

}  // namespace manycontact::test
