#include "export.hpp"

#include <iostream>

#include "../files/output_file.hpp"
#include "../program/command.hpp"
#include "../program/progress.hpp"
#include "../text/table.hpp"
#include "manycontact/analysis/load_scene.hpp"
#include "manycontact/dynamics/differentiate.hpp"
#include "manycontact/dynamics/solve.hpp"
#include "manycontact/dynamics/views.hpp"

namespace manycontact::cli {

namespace {

namespace fs = std::filesystem;

struct ExportPlan {
  std::string folder, scene;  // the scene's name, for headers
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
  std::vector<std::string> files{"README.md"};
  for (std::size_t i = 0; i < islands; ++i)
    for (const std::string& kind : kinds_of(plan)) files.push_back(name_of(i) + kind);
  return files;
}

void write_names(const Scene& scene, const SceneData& data, const Island& island, const std::string& path) {
  const std::vector<std::string> v = velocity_names(scene), f = force_names(scene, data);
  std::vector<std::string> names(static_cast<std::size_t>(island.size()));
  each_velocity_block(scene, island, [&](int from, int to, int n) {
    for (int i = 0; i < n; ++i) names[to + i] = v[from + i];
  });
  each_force_block(scene, data.f_offset, island, [&](int from, int to, int n) {
    for (int i = 0; i < n; ++i) names[island.nv + to + i] = f[from + i];
  });
  OutputFile file(path);
  for (const std::string& name : names) file.stream() << printable(name) << "\n";
  file.close();
}

std::vector<std::string> header(const ExportPlan& plan, const std::string& what, const ExportedPage& page) {
  return {
      what + " of " + printable(plan.scene) + ", " + page.name,
      "nv " + std::to_string(page.nv) + ", nc " + std::to_string(page.nc) + ", rank of J " + std::to_string(page.rank)};
}

// Solutions of the island's systems into their files.
void write_truth(const ExportPlan& plan, const ExactSolution& of_scene, const ExportedSystem& s, ExportedPage& page) {
  page.of_scene = page.rank < page.nc;
  if (!page.of_scene && of_scene.x.cols() > 0)
    write_dense(plan.path(page.name + "_scene_x.mtx"), of_scene.x, header(plan, "x = [a; -f] of the scene", page));
  const ExactSolution x = page.of_scene ? of_scene : solve_exactly(s, s.b);
  page.solution = x.x.cols() > 0;
  page.digits = x.digits;
  if (page.solution) write_dense(plan.path(page.name + "_x.mtx"), x.x, header(plan, "x = [a; -f]", page));
  if (s.db.size() == 0 || page.of_scene) return;
  const ExactSolution dx = solve_exactly(s, s.db);
  page.derivatives = dx.x.cols() > 0;
  page.derivative_digits = dx.digits;
  if (page.derivatives) write_dense(plan.path(page.name + "_dx.mtx"), dx.x, header(plan, "dx = [da; -df]", page));
}

ExportedPage write_island(const ExportPlan& plan, const SceneFile& file, const SceneData& data,
                          const Truth<Quad>& truth, std::size_t i) {
  const ExportedSystem s = system_of(file.scene, data, i, plan.derivatives);
  const IslandReport& report = data.report.islands[i];
  ExportedPage page;
  page.name = name_of(i);
  page.nv = s.island.nv;
  page.nc = s.island.nc;
  page.rank = report.rank;
  page.nonzeros = s.K.nonZeros();
  page.columns = s.db.cols();
  page.status = report.status;
  page.condition = report.condition;
  write_symmetric(plan.path(page.name + ".mtx"), s.K, header(plan, "K = [M J^T; J -delta I]", page));
  write_dense(plan.path(page.name + "_b.mtx"), Eigen::MatrixXd(s.b), header(plan, "b = [tau - h; -a0]", page));
  write_names(file.scene, data, s.island, plan.path(page.name + "_names.txt"));
  if (s.db.size() > 0) write_sparse(plan.path(page.name + "_db.mtx"), s.db, header(plan, "db = -[dr1; dr2]", page));
  if (plan.truth) write_truth(plan, of_island(truth, file.scene, data, s.island, i), s, page);
  return page;
}

std::string command_of(const ExportPlan& plan) {
  return std::string("manycontact export SCENE --out DIR") + (plan.truth ? " --truth" : "") +
         (plan.derivatives ? " --derivatives" : "");
}

void make_folder(const std::string& folder) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (!fs::is_directory(folder)) throw InputError(folder, 1, "is not a folder and cannot be made one");
}

std::string summary(const SceneFile& file, const std::vector<ExportedPage>& islands, const ExportPlan& plan) {
  long known = 0;
  for (const ExportedPage& page : islands) known += page.solution;
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
  complete(file.scene, data);
  if (plan.derivatives) (void)differentiate(file.scene, data);
  estimate_condition(file.scene, data);

  const Truth<Quad> truth = plan.truth ? solve_scene(file, data) : Truth<Quad>{};
  std::vector<ExportedPage> pages;
  Progress progress("islands", static_cast<double>(island_count(data)));
  for (std::size_t i = 0; i < island_count(data); ++i) {
    pages.push_back(write_island(plan, file, data, truth, i));
    progress.update(static_cast<double>(i + 1));
  }
  progress.clear();
  write_export_page(plan.path("README.md"), file, pages, command_of(plan));
  std::cout << summary(file, pages, plan) << "\n";
  return kExitOk;
}

}  // namespace manycontact::cli
