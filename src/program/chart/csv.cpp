#include "../files/csv_file.hpp"
#include "chart.hpp"

namespace manycontact::cli {

void write_csv(const std::vector<Chart>& charts, const std::string& path) {
  CsvFile csv(path);
  for (const char* name : {"scene", "method", "order", "regularisation", "status", "time_us", "error_acceleration",
                           "error_forces", "error_derivatives", "front"})
    csv << name;
  csv.end_row();
  const auto number_or_nothing = [&csv](const std::optional<double>& x) {
    if (x)
      csv << *x;
    else
      csv << "";
  };
  for (const Chart& chart : charts)
    for (const ChartRow& row : chart.rows) {
      csv << chart.scene << to_string(row.method) << (row.order ? to_string(*row.order) : "none")
          << row.regularisation() << (row.outcome == Outcome::kSkipped ? "skipped" : to_string(row.status));
      for (const auto& x : {row.time, row.error_acceleration, row.error_forces, row.error_derivatives})
        number_or_nothing(x);
      csv << (row.front ? "yes" : "no");
      csv.end_row();
    }
  csv.close();
}

}  // namespace manycontact::cli
