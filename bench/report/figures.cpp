#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "report.hpp"

namespace manycontact::bench {

namespace {

bool is_native(const Run& run) { return run.program.ends_with(" native"); }
bool is_ours(const Run& run) { return run.program == "manycontact"; }

// Returns the task's number, the same in every figure.
int number_of(const Run& run, const std::string& task) {
  const std::vector<std::string> all = tasks(run, "separate");
  return static_cast<int>(std::find(all.begin(), all.end(), task) - all.begin());
}

// Draws y(point) for each point of every task that `wanted` accepts.
template <class Wanted, class Y>
Panel panel(const std::vector<Run>& runs, const std::string& scene, Panel p, const Wanted& wanted, const Y& y) {
  for (const Run& run : runs) {
    if (is_native(run)) continue;
    for (const std::string& task : tasks(run, scene)) {
      Line line{run.program + " " + task, &run, number_of(run, task), {}};
      if (!wanted(run, task)) continue;
      for (const Point& at : series(run, scene, task)) {
        const double value = y(run, task, at);
        if (value > 0) line.points.emplace_back(at.size, value);
      }
      if (!line.points.empty()) p.lines.push_back(std::move(line));
    }
  }
  return p;
}

const auto any = [](const Run&, const std::string&) { return true; };
const auto answers = [](const Run&, const std::string& task) { return task != "set-up"; };
const auto solves = [](const Run&, const std::string& task) {
  return task != "set-up" && task != "derivatives" && task != "vjp";
};
const auto per_size = [](const Run&, const std::string&, const Point& p) { return p.result->us / p.size; };
const auto whole = [](const Run&, const std::string&, const Point& p) { return p.result->us; };
const auto memory = [](const Run&, const std::string&, const Point& p) { return p.result->bytes / p.size / 1024; };
const auto of_memory = [](const Run&, const std::string& task) { return task != "set-up" && task != "vjp"; };

// Returns a peer's time divided by that of our counterpart: all derivatives for derivatives, otherwise a solve.
Panel ratios(const std::vector<Run>& runs, const std::string& scene, Panel p) {
  const Run* ours = nullptr;
  for (const Run& run : runs)
    if (is_ours(run)) ours = &run;
  if (!ours) return p;
  return panel(
      runs, scene, std::move(p), [](const Run& run, const std::string&) { return !is_ours(run); },
      [&](const Run&, const std::string& task, const Point& at) {
        const std::string name = "sweep/" + scene + "/" + std::to_string(at.size) + "/";
        const Result* mine = find(*ours, name + (task == "derivatives" ? task : "solve"));
        return mine ? at.result->us / mine->us : 0.0;
      });
}

}  // namespace

std::string otherwise(const std::string& program) {
  if (program == "MuJoCo") return "MuJoCo: soft contacts, dJ/dt v left out, no warm start; no derivatives of contacts";
  if (program == "DART")
    return "DART: contacts between velocities over a step of 1 ms, and the step itself; no derivatives";
  if (program == "Simbody") return "Simbody: the same solution; no derivatives";
  if (program == "Pinocchio")
    return "Pinocchio: the same solution; one iteration, iterated: 3 with mu 1e-6; constrainedABA: 5, no contacts between "
           "bodies";
  if (program == "Crocoddyl")
    return "Crocoddyl: the same solution; one dense system for all robots, no contacts between bodies, none that are "
           "redundant";
  return {};
}

std::vector<Figure> figures(const std::vector<Run>& runs) {
  const std::string robot = runs.at(0).robot;
  std::vector<Figure> all = {
      {"robots",
       "Time per robot: " + robot + ", both feet in 6D contact",
       {panel(runs, "separate", {"separate", "robots", "us per robot", {}}, answers, per_size),
        panel(runs, "ring", {"hand in hand in a ring", "robots", "us per robot", {}}, answers, per_size)}},
      {"links",
       "Time per link of a chain, every tenth link in 6D contact",
       {panel(runs, "chain", {"", "links", "us per link", {}}, any, per_size)}},
      {"piles",
       "Time per box, fixed at points",
       {panel(runs, "tower", {"tower, four points a face", "boxes", "us per box", {}}, solves, per_size),
        panel(runs, "table", {"on a table, four points a face", "boxes", "us per box", {}}, solves, per_size),
        panel(runs, "wall", {"wall, bonded by points, a sixth redundant", "boxes", "us per box", {}}, solves,
              per_size)}},
      {"contacts",
       "Time over contacts",
       {panel(runs, "feet", {"16 quadrupeds, on so many of their 64 feet", "contacts in 3D", "us", {}}, answers, whole),
        panel(runs, "points", {robot + " on points of its soles, redundant from 3 on", "contacts in 3D", "us", {}},
              answers, whole)}},
      {"memory",
       "Memory per robot after the first call, on the heap: " + robot,
       {panel(runs, "separate", {"separate", "robots", "KiB per robot", {}}, of_memory, memory),
        panel(runs, "ring", {"hand in hand in a ring", "robots", "KiB per robot", {}}, of_memory, memory)}},
      {"ratios",
       "Peers' time / ours (of a solve; derivatives of derivatives): " + robot,
       {ratios(runs, "separate", {"separate", "robots", "times ours", {}}),
        ratios(runs, "ring", {"hand in hand in a ring", "robots", "times ours", {}})}}};
  std::erase_if(all, [](const Figure& f) {
    std::size_t lines = 0;
    for (const Panel& p : f.panels) lines += p.lines.size();
    return lines == 0;
  });
  return all;
}

void write_figures(const std::vector<Figure>& figures, const std::vector<Run>& runs, const std::string& path) {
  using nlohmann::json;
  json list = json::array(), differences = json::array();
  for (const Figure& figure : figures) {
    json panels = json::array();
    for (const Panel& p : figure.panels) {
      json lines = json::array();
      for (const Line& line : p.lines)
        lines.push_back(
            {{"label", line.label}, {"program", line.run->program}, {"task", line.task}, {"points", line.points}});
      panels.push_back({{"title", p.title}, {"x", p.x}, {"y", p.y}, {"lines", lines}});
    }
    list.push_back({{"file", figure.file}, {"title", figure.title}, {"panels", panels}});
  }
  const auto& machine = runs.at(0).machine;
  if (machine.contains("processor") && machine.contains("date"))
    differences.push_back(machine.at("processor") + ", " + machine.at("date"));
  for (const Run& run : runs)
    if (const std::string text = otherwise(run.program); !text.empty()) differences.push_back(text);
  std::ofstream out(path);
  out << json{{"figures", list}, {"differences", differences}} << "\n";
  if (!out.flush()) throw std::runtime_error(path + " cannot be written");
}

}  // namespace manycontact::bench
