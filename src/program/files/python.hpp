#pragma once
// Runs Python scripts, which draw the charts and write the pages about measurements.

#include <string>
#include <vector>

namespace manycontact::cli {

/// The first python3 of PATH that has matplotlib, or else the first python3.
struct Python {
  std::string path;  // empty if there is no python3
  bool draws = false;
};
Python find_python();
inline constexpr const char* kNoCharts =
    "python3 with matplotlib is not installed (Debian: python3-matplotlib), no charts are drawn";

/// Returns the path of a script of src/program/charts, which is installed in share/manycontact/charts.
std::string script_path(const std::string& name);

/// Runs a script with these arguments and `input` on its standard input; returns what it prints. Throws InputError if
/// it cannot write a file, std::runtime_error if Python cannot be started or fails.
std::string run_python(const Python& python, const std::string& script, const std::vector<std::string>& arguments,
                       const std::string& input = "");

}  // namespace manycontact::cli
