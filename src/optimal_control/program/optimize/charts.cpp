// The charts of `manycontact optimize`, drawn by gnuplot: convergence, torques against limits, contact forces against
// cones.

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <sstream>

#include "program/files/gnuplot.hpp"
#include "program/text/table.hpp"
#include "manycontact/analysis/findings.hpp"
#include "optimize.hpp"

namespace manycontact::cli {

namespace {

constexpr std::size_t kMostCurves = 8;
constexpr const char* kCurves[] = {"#1f77b4", "#d62728", "#2ca02c", "#ff7f0e",
                                   "#9467bd", "#8c564b", "#17becf", "#7f7f7f"};
constexpr const char* kGrid = "set grid lt 1 lw 1 lc rgb '#dddddd'\n";
constexpr const char* kKey =
    "set key outside below Left reverse maxrows 4 samplen 2 font ',10' noenhanced\n";  // space for long names

// A curve over nodes, NaN where it has no value; of them those with the largest weights are drawn.
struct Curve {
  std::string name;
  double weight = 0;
  std::vector<double> y;
};

template <class Item, class Weight>
void keep_largest(std::vector<Item>& items, Weight weight) {
  const std::size_t kept = std::min(kMostCurves, items.size());
  std::partial_sort(items.begin(), items.begin() + static_cast<std::ptrdiff_t>(kept), items.end(),
                    [&](const Item& a, const Item& b) { return weight(a) > weight(b); });
  items.erase(items.begin() + static_cast<std::ptrdiff_t>(kept), items.end());
}

void block(const std::string& name, const std::vector<double>& y, double step, std::ostream& out) {
  out << "$" << name << " << EOD\nNaN NaN\n";
  for (std::size_t k = 0; k < y.size(); ++k)
    if (std::isfinite(y[k]))
      out << static_cast<double>(k) * step << " " << y[k] << "\n";
    else
      out << "\n";
  out << "EOD\n";
}

// One panel of curves over time; `extra` follows them in the plot command.
void panel(const std::vector<Curve>& curves, const std::string& prefix, const std::string& ylabel,
           const std::string& extra, std::ostream& out) {
  out << kGrid << kKey << "set xlabel 'time (s)' offset 0,0.5\nset ylabel " << quoted(ylabel) << "\nplot ";
  for (std::size_t k = 0; k < curves.size(); ++k)
    out << "$" << prefix << k << " with lines lw 2 lc rgb '" << kCurves[k] << "' title " << quoted(curves[k].name)
        << ", ";
  out << (extra.empty() ? "NaN notitle" : extra) << "\n";
}

void blocks(const std::vector<Curve>& curves, const std::string& prefix, double step, std::ostream& out) {
  for (std::size_t k = 0; k < curves.size(); ++k) block(prefix + std::to_string(k), curves[k].y, step, out);
}

std::string title(const OptimizedTask& motion, const std::string& what) {
  return "set title " + quoted(motion.task.name + ": " + what) + " noenhanced\n";
}

void draw_convergence(const OptimizedTask& motion, const std::string& base) {
  const auto& iterations = motion.solution.iterations;
  std::vector<double> cost, stop, gaps;
  for (const TaskIteration& i : iterations) {
    cost.push_back(i.cost);
    stop.push_back(i.stop > 0 ? i.stop : NAN);
    gaps.push_back(i.gaps > 1e-16 ? i.gaps : NAN);
  }
  std::ostringstream out;
  block("cost", cost, 1, out);
  block("stop", stop, 1, out);
  block("gaps", gaps, 1, out);
  out << title(motion, motion.solution.reason + " after " + count(static_cast<long>(iterations.size()), "iteration"))
      << kGrid << kKey << "set xlabel 'iteration' offset 0,0.5\nset ylabel 'cost'\nset ytics nomirror\n"
      << "set y2label 'stopping value, gaps'\nset logscale y2\nset format y2 '10^{%T}'\nset y2tics\n"
      << "set xrange [-0.5:" << static_cast<double>(iterations.size()) - 0.5 << "]\n"
      << "plot $cost with linespoints lw 2 pt 7 ps 0.5 lc rgb '" << kCurves[0] << "' title 'cost', "
      << "$stop axes x1y2 with linespoints lw 2 pt 7 ps 0.5 lc rgb '" << kCurves[1] << "' title 'stopping value', "
      << "$gaps axes x1y2 with linespoints lw 2 pt 7 ps 0.5 lc rgb '" << kCurves[2]
      << "' title 'gaps (before the iteration)', " << motion.task.tolerance
      << " axes x1y2 with lines dt 3 lc rgb '#555555' title 'tolerance'\n";
  cli::draw(out.str(), 900, 560, base);
}

// Torques in units of their limits if any has a limit, otherwise in N m or N.
void draw_torques(const OptimizedTask& motion, const std::string& base) {
  const std::vector<TaskNode> nodes = timeline(motion.task);
  const Eigen::VectorXd& limits = motion.problem.models.front()->get_u_ub();
  const std::vector<std::string> names = torque_names(motion.task.scene.scene);
  const bool limited = limits.array().isFinite().any();
  std::vector<Curve> curves;
  for (Eigen::Index i = 0; i < limits.size(); ++i) {
    if (limited && !(std::isfinite(limits[i]) && limits[i] > 0)) continue;
    Curve curve{names[static_cast<std::size_t>(i)], 0, {}};
    for (std::size_t t = 0; t + 1 < nodes.size(); ++t) {
      if (nodes[t].impact) continue;
      const double u = motion.solution.us[t][i];
      curve.y.push_back(limited ? 100 * u / limits[i] : u);
      curve.weight = std::max(curve.weight, std::abs(curve.y.back()));
    }
    curves.push_back(std::move(curve));
  }
  if (curves.empty()) return;
  keep_largest(curves, [](const Curve& curve) { return curve.weight; });
  std::ostringstream out;
  blocks(curves, "u", motion.task.step, out);
  out << title(motion, "largest torques");
  if (limited) out << "set yrange [*<-115:115<*]\n";
  panel(curves, "u", limited ? "of the limit (%)" : "Nm or N",
        limited ? "100 with lines dt 3 lc rgb 'black' title 'limits', -100 with lines dt 3 lc rgb 'black' notitle" : "",
        out);
  cli::draw(out.str(), 900, 560, base);
}

// Per contact: the normal force, and tangential over normal.
void draw_forces(const OptimizedTask& motion, const std::string& base) {
  const auto& contacts = motion.task.scene.scene.contacts;
  const std::vector<TaskNode> nodes = timeline(motion.task);
  std::vector<Curve> normal(contacts.size()), ratio(contacts.size());
  double mu = INFINITY;
  for (std::size_t t = 0; t + 1 < nodes.size(); ++t) {
    if (nodes[t].impact) continue;
    const auto forces = contact_forces(motion.task, motion.problem, t);
    const auto q = motion.solution.xs[t].head(motion.task.scene.scene.nq);
    for (std::size_t c = 0; c < contacts.size(); ++c) {
      const Eigen::VectorXd& f = forces[c];
      const bool bears = f.size() >= 3;
      const Eigen::Vector2d p =
          bears ? contact_pressure(motion.task.scene.scene, static_cast<int>(c), q, f) : Eigen::Vector2d(NAN, NAN);
      normal[c].y.push_back(p[0]);
      ratio[c].y.push_back(p[0] > 0 ? p[1] / p[0] : NAN);
      if (!bears) continue;
      normal[c].weight = std::max(normal[c].weight, std::abs(p[0]));
      mu = std::min(mu, friction_of(phase_at(motion.task, nodes[t]), static_cast<int>(c)));
    }
  }
  std::vector<std::pair<Curve, Curve>> both;
  for (std::size_t c = 0; c < contacts.size(); ++c) {
    normal[c].name = ratio[c].name = contacts[c].name;
    if (normal[c].weight > 0) both.emplace_back(std::move(normal[c]), std::move(ratio[c]));
  }
  if (both.empty()) return;
  keep_largest(both, [](const auto& pair) { return pair.first.weight; });
  normal.clear();
  ratio.clear();
  for (auto& [n, r] : both) normal.push_back(std::move(n)), ratio.push_back(std::move(r));
  std::ostringstream out, cone;
  blocks(normal, "n", motion.task.step, out);
  blocks(ratio, "r", motion.task.step, out);
  if (std::isfinite(mu)) cone << mu << " with lines dt 3 lc rgb 'black' title 'smallest cone'";
  out << "set multiplot layout 1,2 title " << quoted(motion.task.name + ": contact forces") << " noenhanced\n";
  panel(normal, "n", "normal force (N)", "0 with lines lc rgb 'black' notitle", out);
  panel(ratio, "r", "tangential / normal", cone.str(), out);
  out << "unset multiplot\n";
  cli::draw(out.str(), 1200, 560, base);
}

}  // namespace

void draw_charts(const OptimizedTask& motion, const std::string& folder) {
  const auto base = [&](const char* name) { return (std::filesystem::path(folder) / name).string(); };
  if (!motion.solution.iterations.empty()) draw_convergence(motion, base("convergence"));
  if (!motion.solution.us.empty()) draw_torques(motion, base("torques"));
  draw_forces(motion, base("forces"));
}

}  // namespace manycontact::cli
