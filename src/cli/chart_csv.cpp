#include <cmath>
#include <fstream>

#include "chart.hpp"
#include "table.hpp"

namespace manycontact::cli {

namespace {

// As RFC 4180 has it.
std::string quoted(const std::string& text) {
  if (text.find_first_of(",\"\n\r") == std::string::npos) return text;
  std::string out = "\"";
  for (char c : text) out += c == '"' ? "\"\"" : std::string(1, c);
  return out + "\"";
}

std::string cell(const std::optional<double>& x) { return x && std::isfinite(*x) ? number(*x, kDigits) : ""; }

std::string status_of(const ChartRow& row) {
  return row.outcome == Outcome::kSkipped ? "skipped" : to_string(row.status);
}

}  // namespace

void write_csv(const std::vector<Chart>& charts, const std::string& path) {
  std::ofstream out(path);
  out << "scene,method,order,regularisation,status,time_us,error_acceleration,error_forces,error_derivatives,front\n";
  for (const Chart& chart : charts)
    for (const ChartRow& row : chart.rows)
      out << quoted(chart.scene) << ',' << to_string(row.method) << ',' << (row.order ? to_string(*row.order) : "none")
          << ',' << row.regularisation() << ',' << status_of(row) << ',' << cell(row.time) << ','
          << cell(row.error_acceleration) << ',' << cell(row.error_forces) << ',' << cell(row.error_derivatives) << ','
          << (row.front ? "yes" : "no") << '\n';
  if (!out.flush()) throw InputError(path, 1, "cannot be written");
}

}  // namespace manycontact::cli
