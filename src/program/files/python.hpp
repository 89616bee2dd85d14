#pragma once
// Runs the Python scripts that draw the charts and write the pages about measurements.

#include <string>
#include <vector>

namespace manycontact::cli {

struct Python {      // the first python3 in PATH that has matplotlib, or, if none has it, the first python3
  std::string path;  // empty if there is no python3
  bool draws = false;
};
Python find_python();
inline constexpr const char* kNoCharts =
    "python3 with matplotlib is not installed (Debian: python3-matplotlib), no charts are drawn";

/// Returns the path of a script of src/program/charts, which is installed as share/manycontact/charts.
std::string script_path(const std::string& name);

/// Runs a script with these arguments and `input` on its standard input, and returns its output. Throws InputError if
/// the script cannot write a file, and std::runtime_error if Python cannot be started or fails.
std::string run_python(const Python& python, const std::string& script, const std::vector<std::string>& arguments,
                       const std::string& input = "");

}  // namespace manycontact::cli
