#include "json_file.hpp"

#include "output_file.hpp"

namespace manycontact::cli {

namespace {

void print_members(std::ostream& out, const Json& json) {
  const char* before = "{\n";
  for (const auto& [key, value] : json.items()) {
    out << before << Json(key).dump() << ": " << value.dump(-1, ' ', false, Json::error_handler_t::replace);
    before = ",\n";
  }
  out << "\n}\n";
}

}  // namespace

Json json_of(const Eigen::VectorXd& x) { return Json(std::vector<double>(x.begin(), x.end())); }

Json json_of(const std::vector<Eigen::VectorXd>& list) {
  Json out = Json::array();
  for (const Eigen::VectorXd& x : list) out.push_back(json_of(x));
  return out;
}

void write_json_file(const Json& json, const std::string& path, const std::string& option) {
  OutputFile file(path, option);
  print_members(file.stream(), json);
  file.close();
}

}  // namespace manycontact::cli
