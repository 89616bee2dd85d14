#include "export.hpp"

#include <iostream>

#include "../command/command.hpp"
#include "../command/progress.hpp"
#include "../files/json_file.hpp"
#include "../files/output_file.hpp"
#include "../files/python.hpp"
#include "../text/places.hpp"
#include "../text/table.hpp"
#include "manycontact/analysis/load_scene.hpp"
#include "manycontact/dynamics/differentiate.hpp"
#include "manycontact/dynamics/solve.hpp"
#include "manycontact/dynamics/views.hpp"
#include "manycontact/version.hpp"

namespace manycontact::cli {

namespace {

namespace fs = std::filesystem;

struct ExportPlan {
  std::string folder, scene;  // scene: its name, for the headers
  bool truth = false, derivatives = false;

  std::string path(const std::string& name) const { return (fs::path(folder) / name).string(); }
};

std::vector<std::string> kinds_of(const ExportPlan& plan) {
  std::vector<std::string> kinds{".mtx", "_b.mtx", "_names.txt"};
  if (plan.truth) kinds.insert(kinds.end(), {"_x.mtx", "_scene_x.mtx"});
  if (plan.derivatives) kinds.push_back("_db.mtx");
  if (plan.derivatives && plan.truth) kinds.push_back("_dx.mtx");
  return kinds;
}

std::string name_of(std::size_t island) { return "island_" + std::to_string(island); }

std::vector<std::string> files_written(const ExportPlan& plan, std::size_t islands) {
  std::vector<std::string> files{"README.md", "export.json"};
  for (std::size_t i = 0; i < islands; ++i)
    for (const std::string& kind : kinds_of(plan)) files.push_back(name_of(i) + kind);
  return files;
}

void write_names(const Scene& scene, const SceneData& data, const Island& island, const std::string& path) {
  const std::vector<std::string> v = velocity_names(scene), f = force_names(scene, data);
  const Places places(scene, data.f_offset, island);
  OutputFile file(path);
  for (const int i : places.v) file.stream() << printable(v[i]) << "\n";
  for (const int i : places.f) file.stream() << printable(f[i]) << "\n";
  file.close();
}

// Returns the comment lines at the top of a file. page: the entry of the island in export.json.
std::vector<std::string> header(const ExportPlan& plan, const std::string& what, const Json& page) {
  return {what + " of " + printable(plan.scene) + ", " + page["name"].get<std::string>(),
          "nv " + page["nv"].dump() + ", nc " + page["nc"].dump() + ", rank of J " + page["rank"].dump()};
}

void write_truth(const ExportPlan& plan, const ExactSolution& of_scene, const ExportedSystem& s, Json& page) {
  const auto write = [&](const std::string& kind, const std::string& what, const ExactSolution& x) {
    if (x.x.cols() > 0) write_dense(plan.path(page["name"].get<std::string>() + kind), x.x, header(plan, what, page));
    return x.x.cols() > 0 ? Json(x.digits) : Json();
  };
  const bool dependent = page["rank"] < page["nc"];
  page["x_is_of_the_scene"] = dependent;
  if (!dependent) write("_scene_x.mtx", "x = [a; -f] of the scene", of_scene);
  page["digits"] = write("_x.mtx", "x = [a; -f]", dependent ? of_scene : solve_exactly(s, s.b));
  if (s.db.size() > 0 && !dependent)
    page["derivative_digits"] = write("_dx.mtx", "dx = [da; -df]", solve_exactly(s, s.db));
}

// Writes the files of island i. Returns its entry in export.json.
Json write_island(const ExportPlan& plan, const SceneFile& file, const SceneData& data, const Truth<Quad>& truth,
                  std::size_t i) {
  const ExportedSystem s = system_of(file.scene, data, i, plan.derivatives);
  const IslandReport& report = data.report.islands[i];
  const std::string name = name_of(i);
  Json page = {{"name", name},
               {"nv", s.island.nv},
               {"nc", s.island.nc},
               {"rank", report.rank},
               {"nonzeros", s.K.nonZeros()},
               {"status", to_string(report.status)},
               {"condition", report.condition},
               {"x_is_of_the_scene", false},
               {"digits", nullptr},
               {"derivative_columns", s.db.cols()},
               {"derivative_digits", nullptr}};
  write_sparse(plan.path(name + ".mtx"), s.K, true, header(plan, "K = [M J^T; J -delta I]", page));
  write_dense(plan.path(name + "_b.mtx"), Eigen::MatrixXd(s.b), header(plan, "b = [tau - h; -a0]", page));
  write_names(file.scene, data, s.island, plan.path(name + "_names.txt"));
  if (s.db.size() > 0)
    write_sparse(plan.path(name + "_db.mtx"), s.db.sparseView(), false, header(plan, "db = -[dr1; dr2]", page));
  if (plan.truth) write_truth(plan, of_island(truth, file.scene, data, s.island, i), s, page);
  return page;
}

std::string command_of(const ExportPlan& plan) {
  return std::string("manycontact export SCENE --out DIR") + (plan.truth ? " --truth" : "") +
         (plan.derivatives ? " --derivatives" : "");
}

// Writes export.json, which lists the systems, and README.md, which explains the files.
void write_list(const ExportPlan& plan, const SceneFile& file, const Json& islands) {
  write_json_file({{"scene", file.scene.name},
                   {"file", file.path},
                   {"version", MANYCONTACT_VERSION},
                   {"command", command_of(plan)},
                   {"robots", file.scene.nrobots()},
                   {"islands", islands}},
                  plan.path("export.json"), "--out");
  const Python python = find_python();
  if (python.path.empty())
    std::cerr << "manycontact: python3 is not installed, so README.md is not written; export.json has the numbers\n";
  else
    run_python(python, script_path("export.py"), {plan.folder});
}

std::string summary(const SceneFile& file, const Json& islands, const ExportPlan& plan) {
  long known = 0;
  for (const Json& page : islands) known += !page["digits"].is_null();
  const long all = static_cast<long>(islands.size());
  std::string text = printable(file.scene.name) + ": " + count(all, "system");
  if (plan.truth) text += ", " + (known == all ? "all" : std::to_string(known)) + " with solutions";
  return text + ", in " + printable(plan.folder);
}

}  // namespace

int run_export(const Arguments& arguments) {
  const std::string path = scene_operand(arguments);
  const auto folder = arguments.value("--out");
  if (!folder) throw UsageError("--out DIR is missing");
  const SceneFile file = load_scene(path);
  const ExportPlan plan{*folder, file.scene.name, arguments.has("--truth"), arguments.has("--derivatives")};

  SceneData data(file.scene, export_options());
  prepare(file.scene, data);
  check_folder("--out", plan.folder, files_written(plan, island_count(data)), file.files);
  make_folder(plan.folder);
  (void)solve(file.scene, file.q, file.v, file.u, data);
  if (plan.derivatives) (void)differentiate(file.scene, data);
  estimate_condition(file.scene, data);

  const Truth<Quad> truth = plan.truth ? solve_scene(file, data) : Truth<Quad>{};
  Json pages = Json::array();
  Progress progress("islands", static_cast<double>(island_count(data)));
  for (std::size_t i = 0; i < island_count(data); ++i) {
    pages.push_back(write_island(plan, file, data, truth, i));
    progress.update(static_cast<double>(i + 1));
  }
  progress.clear();
  write_list(plan, file, pages);
  std::cout << summary(file, pages, plan) << "\n";
  return kExitOk;
}

}  // namespace manycontact::cli
