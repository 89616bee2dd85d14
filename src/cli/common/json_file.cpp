#include "json_file.hpp"

#include <cerrno>
#include <cstring>
#include <fstream>
#include <iostream>

#include "manycontact/io/input_error.hpp"

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

void write_json_file(const Json& json, const std::string& path) {
  if (path == "-") return print_members(std::cout, json);
  errno = 0;
  std::ofstream out(path);
  if (out) print_members(out, json);
  if (!out.flush())
    throw InputError(path, 1,
                     std::string("cannot be written") + (errno ? std::string(": ") + std::strerror(errno) : "") +
                         ", expected a file that --json may create");
}

}  // namespace manycontact::cli
