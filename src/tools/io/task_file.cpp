#include "manycontact/io/task_file.hpp"

#include <filesystem>
#include <map>

#include "task_parts.hpp"

namespace manycontact {

const char* to_string(TaskSolver solver) {
  constexpr const char* kSolvers[] = {"fddp", "box-fddp", "sparse", "auto"};
  return kSolvers[static_cast<int>(solver)];
}

int TaskFile::nodes() const {
  int sum = 0;
  for (const TaskPhase& phase : phases) sum += phase.nodes + phase.impact;
  return sum;
}

namespace io {

namespace {

constexpr int kMostNodes = 1000000;

// Returns whether an element changes an external wrench. <push> is an alias of <wrench>.
bool is_wrench(const Element& e) { return e.name() == "wrench" || e.name() == "push"; }

// Reads <cost> and <constraint> children, whose names must be unique in each phase.
void read_terms(const Element& e, bool terminal, TermReader& reader, TaskPhase& phase) {
  std::map<std::string, int> names;
  for (const Element& child : e.children()) {
    if (is_wrench(child)) continue;
    TaskTerm term = reader.read(child, phase.active, terminal);
    const auto [at, is_new] = names.emplace(term.name, term.line);
    if (!is_new)
      child.where("name").fail("a cost or constraint named " + quote(term.name) + " exists already on line " +
                               std::to_string(at->second) + ", expected names used once in a phase");
    (child.name() == "cost" ? phase.costs : phase.constraints).push_back(std::move(term));
  }
}

// Returns the indices of the external wrenches called `name`: one wrench, or the wrenches of all copies of an element.
std::vector<int> wrenches_called(const Scene& scene, const std::string& name) {
  if (const auto found = scene.wrench_index.find(name); found != scene.wrench_index.end()) return {found->second};
  std::vector<int> out;
  for (int k = 0;; ++k) {
    const auto copy = scene.wrench_index.find(name + std::to_string(k));
    if (copy == scene.wrench_index.end()) return out;
    out.push_back(copy->second);
  }
}

// Reads `<wrench>` children, which change external wrenches in this phase.
void read_wrenches(const Element& e, const Scene& scene, TaskPhase& phase) {
  for (const ExternalWrench& push : scene.wrenches) phase.wrenches.push_back(push.wrench);
  for (const Element& child : e.children()) {
    if (!is_wrench(child)) continue;
    child.allow({"name", "force", "torque"});
    const std::string name = child.required("name");
    const std::vector<int> numbers = wrenches_called(scene, name);
    if (numbers.empty()) {
      std::vector<std::string> known;
      for (const ExternalWrench& push : scene.wrenches) known.push_back(push.name);
      child.where("name").fail("there is no external wrench " + quote(name) + " in the scene, " +
                               suggestion(name, known));
    }
    std::optional<Vec3<double>> force, torque;
    child.read("force", force), child.read("torque", torque);
    for (const int k : numbers) {
      if (force) phase.wrenches[k].head<3>() = *force;
      if (torque) phase.wrenches[k].tail<3>() = *torque;
    }
  }
}

// Reads `impact`, which requires a contact that is open in the phase `before` (null: none) and active in `phase`.
void read_impact(const Element& e, const TaskPhase* before, TaskPhase& phase) {
  phase.impact = e.flag("impact", false);
  if (!phase.impact) return;
  if (!before) e.refuse("impact", " is true in the first phase, expected an impact in later phases only");
  for (std::size_t c = 0; c < phase.active.size(); ++c)
    if (phase.active[c] && !before->active[c]) return;
  e.refuse("impact", " is true, and all contacts of the phase were closed before, expected a contact that closes");
}

TaskPhase read_phase(const Element& e, const Scene& scene, const TaskPhase* before, TermReader& reader) {
  e.allow({"nodes", "contacts", "impact", "at"}, {"cost", "constraint", "wrench", "push"});
  TaskPhase phase;
  phase.line = e.line();
  phase.nodes = e.count("nodes", 1, kMostNodes);
  phase.active.assign(scene.contacts.size(), false);
  const std::string contacts = scene.contacts.empty() ? e.optional("contacts", "") : e.required("contacts");
  for (const std::string_view name : words(contacts))
    for (const int c : reader.contacts(e.where("contacts"), e.label("contacts"), std::string(name))) {
      if (phase.active[c]) e.refuse("contacts", " names " + quote(name) + " twice, expected each contact once");
      phase.active[c] = true;
    }
  phase.at_scene = e.choice("at", {"closing", "scene"}, 0) == 1;
  read_impact(e, before, phase);
  read_wrenches(e, scene, phase);
  read_terms(e, false, reader, phase);
  return phase;
}

void read_solver(const Element& e, TaskFile& out) {
  e.allow({"type", "iterations", "tolerance", "guess"});
  out.solver_line = e.line();
  out.solver = static_cast<TaskSolver>(e.choice("type", {"fddp", "box-fddp", "sparse", "auto"}, 3));
  if (e.has("iterations")) {
    const std::string text = e.required("iterations");
    out.iterations = parse_count(text);
    if (out.iterations < 1) e.refuse("iterations", " is " + quote(text) + ", expected a whole number above 0");
  }
  out.tolerance = e.positive("tolerance", out.tolerance);
  out.guess = static_cast<TaskGuess>(e.choice("guess", {"quasi_static", "zero"}, 0));
}

// Returns the only child called `name`, if there is one. Throws InputError for a second child of this name.
std::optional<Element> only_child(const Element& e, const char* name) {
  const std::vector<Element> all = e.children(name);
  if (all.size() > 1)
    all[1].fail("<" + e.name() + "> has a second <" + name + ">, the first is on line " +
                std::to_string(all[0].line()) + ", expected only one");
  return e.child(name);
}

void read_head(const Element& root, TaskFile& out) {
  root.allow({"name", "scene", "step", "integrator"}, {"phase", "terminal", "solver"});
  const std::filesystem::path path(out.path);
  out.name = root.optional("name", path.stem().string());
  out.step = root.positive("step");
  out.integrator =
      static_cast<TaskIntegrator>(root.choice("integrator", {"euler", "rk2", "rk3", "rk4", "symplectic"}, 0));

  const std::string scene = root.not_empty("scene", "a scene file");
  const std::string scene_path = (path.parent_path() / scene).string();
  const std::string problem = file_problem(scene_path, true);
  if (!problem.empty())
    root.where("scene").fail("scene of <task>: " + quote(scene_path) + " " + problem + ", expected a scene file");
  out.scene = read_scene(scene_path);
  if (out.scene.scene.nv == 0)
    root.where("scene").fail("the scene of <task> has nothing that moves, expected a robot that moves");
}

}  // namespace

}  // namespace io

TaskFile read_task(const std::string& path) {
  const io::XmlFile file(path, io::read_file_of(path, "a task file"), "task");
  const io::Element root = file.root();
  TaskFile out;
  out.path = path;
  io::read_head(root, out);

  io::TermReader reader(out.scene);
  for (const io::Element& e : root.children("phase")) {
    const TaskPhase* before = out.phases.empty() ? nullptr : &out.phases.back();
    out.phases.push_back(io::read_phase(e, out.scene.scene, before, reader));
    if (out.nodes() > io::kMostNodes)
      e.fail("<task> has more than 1000000 nodes up to this phase, expected fewer nodes");
  }
  if (out.phases.empty()) root.fail("<task> has no <phase>, expected at least one <phase>");

  out.terminal.active = out.phases.back().active;
  if (const auto e = io::only_child(root, "terminal")) {
    e->allow({}, {"cost", "constraint"});
    out.terminal.line = e->line();
    io::read_terms(*e, true, reader, out.terminal);
  }
  if (const auto e = io::only_child(root, "solver")) io::read_solver(*e, out);
  return out;
}

}  // namespace manycontact
