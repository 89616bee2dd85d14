#include "chart.hpp"

#include <algorithm>
#include <iostream>
#include <set>

#include "../command/command.hpp"
#include "../files/python.hpp"
#include "../text/table.hpp"
#include "manycontact/analysis/load_scene.hpp"

namespace manycontact::cli {

namespace {

// Makes a file name from the scene's name that differs from all names in `taken`.
std::string file_name(const std::string& scene, std::set<std::string>& taken) {
  std::string name;
  for (char c : scene) name += std::isalnum(static_cast<unsigned char>(c)) || c == '-' || c == '_' ? c : '_';
  if (name.empty()) name = "scene";
  std::string unique = name;
  for (int k = 2; !taken.insert(unique).second; ++k) unique = name + "_" + std::to_string(k);
  return unique;
}

std::vector<std::string> picture_names(const std::vector<SceneFile>& files) {
  if (files.size() == 1) return {"chart"};
  std::vector<std::string> names;
  std::set<std::string> taken;
  for (const SceneFile& file : files) names.push_back(file_name(file.scene.name, taken));
  return names;
}

std::vector<std::string> files_written(const std::vector<std::string>& pictures) {
  std::vector<std::string> files{"chart.csv", "chart.json"};
  if (pictures.size() > 1) files.push_back("README.md");
  for (const std::string& picture : pictures)
    for (const char* kind : {".svg", ".png"}) files.push_back(picture + kind);
  return files;
}

// Returns the scene's name, followed by its path if several scenes have this name.
std::string label_of(const SceneFile& file, const std::vector<SceneFile>& all) {
  const auto namesakes =
      std::ranges::count_if(all, [&](const SceneFile& other) { return other.scene.name == file.scene.name; });
  return file.scene.name + (namesakes > 1 ? " (" + file.path + ")" : "");
}

}  // namespace

int run_chart(const Arguments& arguments) {
  if (arguments.rest().empty()) throw UsageError("SCENE is missing");
  const auto out = arguments.value("--out");
  if (!out) throw UsageError("--out DIR is missing");
  const ChartLimits limits{double(arguments.integer("--seconds", 0, 100000, 16)),
                           double(arguments.integer("--longest", 0, 100000, 20))};
  std::vector<SceneFile> files;
  for (const std::string& path : arguments.rest()) files.push_back(load_scene(path));
  const std::vector<std::string> names = picture_names(files);
  for (const SceneFile& file : files) check_folder("--out", *out, files_written(names), file.files);
  make_folder(*out);

  const Python python = find_python();
  std::vector<Chart> charts;
  for (const SceneFile& file : files) {
    std::cerr << "manycontact: chart of " << printable(file.path) << " (" << charts.size() + 1 << "/" << files.size()
              << ")" << std::endl;
    charts.push_back(make_chart(file, limits));
    const std::size_t last = charts.size() - 1;
    charts.back().scene = label_of(file, files);
    charts.back().picture = names[last];
    write_csv(charts, *out + "/chart.csv");
    write_json(charts, files.size(), *out + "/chart.json");
    if (!python.path.empty())
      std::cout << run_python(python, script_path("chart.py"), {*out, std::to_string(last)}) << std::flush;
  }
  if (!python.draws)
    std::cerr << "manycontact: " << kNoCharts << "; chart.csv and chart.json are in " << printable(*out) << "\n";
  return kExitOk;
}

}  // namespace manycontact::cli
