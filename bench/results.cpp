#include "results.hpp"

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "../src/program/files/csv_file.hpp"

namespace manycontact::bench {

namespace {

using Json = nlohmann::ordered_json;

Json to_json(const Result& r) {
  Json j = {{"name", r.name}, {"us", r.us}};
  if (r.bytes > 0) j["bytes"] = r.bytes;
  if (r.difference >= 0) j["difference"] = r.difference;
  return j;
}

Result result_of(const Json& j) {
  return {j.at("name"), j.at("us"), j.value("bytes", 0.0), j.value("difference", -1.0)};
}

// The parts of a name sweep/SCENE/SIZE/TASK; size 0: another name.
struct Name {
  std::string scene, task;
  int size = 0;
};

Name split(const std::string& name) {
  const std::string prefix = "sweep/";
  if (!name.starts_with(prefix)) return {};
  const std::size_t a = name.find('/', prefix.size()), b = a == name.npos ? a : name.find('/', a + 1);
  if (b == name.npos) return {};
  return {name.substr(prefix.size(), a - prefix.size()), name.substr(b + 1), std::stoi(name.substr(a + 1, b - a - 1))};
}

}  // namespace

const Result* find(const Run& run, const std::string& name) {
  for (const Result& r : run.results)
    if (r.name == name) return &r;
  return nullptr;
}

void write_runs(const std::vector<Run>& runs, const std::string& path) {
  Json all = Json::array();
  for (const Run& run : runs) {
    Json results = Json::array();
    for (const Result& r : run.results) results.push_back(to_json(r));
    all.push_back({{"program", run.program},
                   {"version", run.version},
                   {"robot", run.robot},
                   {"machine", run.machine},
                   {"results", std::move(results)}});
  }
  std::ofstream out(path);
  out << all.dump(1) << "\n";
  if (!out.flush()) throw std::runtime_error(path + " cannot be written");
}

std::vector<Run> read_runs(const std::string& path) {
  std::ifstream in(path);
  if (!in) throw std::runtime_error(path + " cannot be read");
  try {
    std::vector<Run> runs;
    for (const Json& j : Json::parse(in)) {
      Run run{j.at("program"), j.at("version"), j.at("robot"), j.at("machine"), {}};
      for (const Json& r : j.at("results")) run.results.push_back(result_of(r));
      runs.push_back(std::move(run));
    }
    return runs;
  } catch (const nlohmann::json::exception& e) {
    throw std::runtime_error(path + ": " + e.what());
  }
}

void write_csv(const std::vector<Run>& runs, const std::string& path) {
  cli::CsvFile out(path);
  for (const char* title : {"program", "version", "robot", "name", "us", "bytes", "difference", "processor", "compiler",
                            "flags", "instructions", "date"})
    out << std::string(title);
  out.end_row();
  for (const Run& run : runs)
    for (const Result& r : run.results) {
      out << run.program << run.version << run.robot << r.name << r.us;
      r.bytes > 0 ? out << r.bytes : out << std::string();
      r.difference >= 0 ? out << r.difference : out << std::string();
      for (const char* key : {"processor", "compiler", "flags", "instructions", "date"}) {
        const auto at = run.machine.find(key);
        out << (at == run.machine.end() ? std::string() : at->second);
      }
      out.end_row();
    }
  out.close();
}

std::vector<Point> series(const Run& run, const std::string& scene, const std::string& task) {
  std::vector<Point> points;
  for (const Result& r : run.results) {
    const Name name = split(r.name);
    if (name.size > 0 && name.scene == scene && name.task == task) points.push_back({name.size, &r});
  }
  std::sort(points.begin(), points.end(), [](const Point& a, const Point& b) { return a.size < b.size; });
  return points;
}

std::vector<std::string> tasks(const Run& run, const std::string& scene) {
  std::vector<std::string> all;
  for (const Result& r : run.results) {
    const Name name = split(r.name);
    if (name.size > 0 && name.scene == scene && std::find(all.begin(), all.end(), name.task) == all.end())
      all.push_back(name.task);
  }
  return all;
}

}  // namespace manycontact::bench
