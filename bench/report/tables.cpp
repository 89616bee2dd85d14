#include <algorithm>
#include <cmath>
#include <sstream>

#include "../../src/program/text/table.hpp"
#include "../fit.hpp"
#include "report.hpp"

namespace manycontact::bench {

namespace {

using cli::number;

const Run* ours(const std::vector<Run>& runs) {
  for (const Run& run : runs)
    if (run.program == "manycontact") return &run;
  return nullptr;
}

// Returns the time of plain ldl_numeric on the robot's K [us]; 0: not measured.
double unit(const std::vector<Run>& runs) {
  const Run* run = ours(runs);
  const Result* r = run ? find(*run, "parts/ldl_numeric") : nullptr;
  return r ? r->us : 0;
}

std::string with_units(double us, double unit) {
  return number(us) + (unit > 0 ? " (" + number(us / unit, 2) + ")" : "");
}

std::string heading(const std::vector<std::string>& titles) {
  std::string first = "|", second = "|";
  for (const std::string& title : titles) {
    first += " " + title + " |";
    second += second == "|" ? "---|" : "--:|";
  }
  return first + "\n" + second + "\n";
}

// Returns the exponent that theory predicts for manycontact; 0: none.
double theory(const Run& run, const std::string& scene, const std::string& task) {
  if (!run.program.starts_with("manycontact")) return 0;
  return task == "derivatives" && scene != "separate" ? 2 : 1;  // an island's derivatives are a dense block
}

}  // namespace

std::string table_of_robots(const std::vector<Run>& runs) {
  struct Column {
    std::string scene;
    int size;
  };
  std::vector<Column> columns;
  for (const int size : {1, 4, 16, 256, 1024}) columns.push_back({"separate", size});
  for (const int size : {8, 64, 1024}) columns.push_back({"ring", size});
  std::erase_if(columns, [&](const Column& c) {
    const std::string name = "sweep/" + c.scene + "/" + std::to_string(c.size) + "/";
    return std::none_of(runs.begin(), runs.end(), [&](const Run& run) {
      return std::any_of(run.results.begin(), run.results.end(),
                         [&](const Result& r) { return r.name.starts_with(name); });
    });
  });
  std::vector<std::string> titles = {"us per robot (units)"};
  for (const Column& c : columns) titles.push_back((c.scene == "ring" ? "ring of " : "") + number(c.size, 4));
  std::ostringstream out;
  out << heading(titles);
  for (const Run& run : runs) {
    std::vector<std::string> names = tasks(run, "separate");
    for (const std::string& task : names) {
      if (task == "set-up") continue;
      out << "| " << run.program << " " << task << " |";
      for (const Column& c : columns) {
        const Result* r = find(run, "sweep/" + c.scene + "/" + std::to_string(c.size) + "/" + task);
        out << " " << (r ? with_units(r->us / c.size, unit(runs)) : "") << " |";
      }
      out << "\n";
    }
  }
  return out.str();
}

std::string table_of_parts(const Run& run) {
  const Result* unit = find(run, "parts/ldl_numeric");
  if (!unit) return {};
  std::ostringstream out;
  out << heading({"one " + run.robot + ", both feet in 6D", "us", "units"});
  for (const Result& r : run.results)
    if (r.name.starts_with("parts/"))
      out << "| `" << r.name.substr(6) << "` | " << number(r.us) << " | " << number(r.us / unit->us, 2) << " |\n";
  return out.str();
}

std::string table_of_one(const std::vector<Run>& runs) {
  std::vector<const Run*> with;
  for (const Run& run : runs)
    if (!tasks(run, "one").empty()) with.push_back(&run);
  if (with.empty()) return {};
  std::vector<std::string> titles = {"one " + with.front()->robot + ", us"};
  for (const Run* run : with) titles.push_back(run->program);
  std::ostringstream out;
  out << heading(titles);
  for (const std::string& task : tasks(*with.front(), "one")) {
    out << "| `" << task << "` |";
    for (const Run* run : with) {
      const Result* r = find(*run, "sweep/one/1/" + task);
      out << " " << (r ? number(r->us) : "") << " |";
    }
    out << "\n";
  }
  return out.str();
}

std::string table_of_exponents(const std::vector<Run>& runs) {
  std::ostringstream out;
  out << heading({"time ~ size^p", "sizes", "p", "p from 16 robots or 100 links on", "theory"});
  for (const char* scene : {"separate", "ring", "chain"})
    for (const Run& run : runs) {
      if (run.program.ends_with(" native")) continue;
      for (const std::string& task : tasks(run, scene)) {
        std::vector<std::pair<double, double>> all, large;
        const int from = std::string(scene) == "chain" ? 100 : 16;
        for (const Point& p : series(run, scene, task)) {
          all.emplace_back(p.size, p.result->us);
          if (p.size >= from) large.push_back(all.back());
        }
        if (all.size() < 3) continue;
        const double p = theory(run, scene, task);
        out << "| " << scene << ": " << run.program << " " << task << " | " << number(all.front().first, 6) << " to "
            << number(all.back().first, 6) << " | " << number(exponent(all), 3) << " | "
            << (large.size() > 1 ? number(exponent(large), 3) : "") << " | " << (p > 0 ? number(p) : "") << " |\n";
      }
    }
  return out.str();
}

}  // namespace manycontact::bench
