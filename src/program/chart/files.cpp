#include "../files/csv_file.hpp"
#include "../files/json_file.hpp"
#include "chart.hpp"

namespace manycontact::cli {

namespace {

std::string status_of(const ChartRow& row) {
  return row.outcome == Outcome::kSkipped ? "skipped" : to_string(row.status);
}

Json json_of(const std::optional<double>& x) { return x ? Json(*x) : Json(); }

Json json_of(const ChartRow& row) {
  return {{"method", to_string(row.method)},
          {"order", row.order ? Json(to_string(*row.order)) : Json()},
          {"regularisation", row.regularisation()},
          {"guessed", row.guessed},
          {"status", status_of(row)},
          {"answered_by", row.answered_by},
          {"fallback", row.fallback},
          {"time_us", json_of(row.time)},
          {"time_derivatives_us", json_of(row.time_derivatives)},
          {"error_acceleration", json_of(row.error_acceleration)},
          {"error_forces", json_of(row.error_forces)},
          {"error_derivatives", json_of(row.error_derivatives)},
          {"front", row.front}};
}

}  // namespace

void write_csv(const std::vector<Chart>& charts, const std::string& path) {
  CsvFile csv(path);
  csv.header({"scene", "method", "order", "regularisation", "status", "time_us", "error_acceleration", "error_forces",
              "error_derivatives", "front"});
  const auto number_or_nothing = [&csv](const std::optional<double>& x) {
    if (x)
      csv << *x;
    else
      csv << "";
  };
  for (const Chart& chart : charts)
    for (const ChartRow& row : chart.rows) {
      csv << chart.scene << to_string(row.method) << (row.order ? to_string(*row.order) : "none")
          << row.regularisation() << status_of(row);
      for (const auto& x : {row.time, row.error_acceleration, row.error_forces, row.error_derivatives})
        number_or_nothing(x);
      csv << (row.front ? "yes" : "no");
      csv.end_row();
    }
  csv.close();
}

void write_json(const std::vector<Chart>& charts, std::size_t scenes, const std::string& path) {
  Json list = Json::array();
  for (const Chart& chart : charts) {
    Json rows = Json::array();
    for (const ChartRow& row : chart.rows) rows.push_back(json_of(row));
    list.push_back({{"scene", chart.scene},
                    {"title", chart.title},
                    {"picture", chart.picture},
                    {"condition", chart.condition},
                    {"allowed", chart.allowed},
                    {"notes", chart.notes},
                    {"rows", rows}});
  }
  write_json_file({{"scenes", scenes}, {"charts", list}}, path, "--out");
}

}  // namespace manycontact::cli
