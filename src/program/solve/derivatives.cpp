// Prints the derivatives in the summary, with their time, and each matrix's largest entry and error bound.

#include <cmath>

#include "../text/places.hpp"
#include "../text/table.hpp"
#include "manycontact/dynamics/views.hpp"
#include "solve.hpp"

namespace manycontact::cli {

namespace {

std::vector<std::string> chosen(const std::vector<std::string>& names, const std::vector<int>& places) {
  std::vector<std::string> out;
  for (const int i : places) out.push_back(names[i]);
  return out;
}

struct Largest {
  double value = 0, error = 0;  // largest entry of a matrix of derivatives; largest error bound of all islands
  std::string row, column;

  template <class Block>
  void look(const Block& block, double bound, const std::vector<std::string>& rows,
            const std::vector<std::string>& columns) {
    if (block.size() == 0) return;
    error = std::max(error, bound);
    Eigen::Index i, j;
    const double largest = block.cwiseAbs().maxCoeff(&i, &j);
    if (!(largest > std::abs(value))) return;
    value = block(i, j);
    row = rows[i];
    column = columns[j];
  }
};

}  // namespace

void print_derivatives(std::ostream& out, const SolvedScene& s) {
  out << "\nDerivatives, in " << number(s.time.derivatives) << " us"
      << (s.repeat > 1 ? " (median of " + std::to_string(s.repeat) + ")" : "")
      << "; the largest entry of each (per rad, m, rad/s, m/s, N m, N)\n";
  Largest a[3], f[3];
  std::size_t unknown = 0;  // number of solved islands without derivatives
  const DerivativeData& dd = derivatives(s.data);
  const Scene& scene = s.file.scene;
  const auto v_names = velocity_names(scene), u_names = torque_names(scene), f_names = force_names(scene, s.data);
  for (std::size_t i = 0; i < dd.islands.size(); ++i) {
    if (s.data.report.islands[i].status == Status::kFailed) continue;
    const Places places(scene, s.data.f_offset, solved_island(s.data, i));
    const auto v = chosen(v_names, places.v), u = chosen(u_names, places.u), row = chosen(f_names, places.f);
    const IslandDerivatives& d = dd.islands[i];
    const DerivativeBounds& of = s.derivative_errors[i];
    if (d.X.hasNaN()) {
      ++unknown;
      continue;
    }
    a[0].look(d.da_dq(), of.da_dq, v, v);
    a[1].look(d.da_dv(), of.da_dv, v, v);
    a[2].look(d.da_du(), of.da_du, v, u);
    f[0].look(d.dforces_dq(), of.dforces_dq, row, v);
    f[1].look(d.dforces_dv(), of.dforces_dv, row, v);
    f[2].look(d.dforces_du(), of.dforces_du, row, u);
  }
  Table table("of<|entry|relative error|row<36|column<36");
  const char* by[] = {"dq", "dv", "du"};
  std::string rounding;
  const auto add = [&](const char* of, const Largest& x, const char* by) {
    const std::string name = std::string(of) + by;
    if (x.row.empty()) return;
    table.add({name, number(x.value, 4), std::isfinite(x.error) ? number(x.error, 2) : "-", x.row, x.column});
    if (x.error >= 1 && std::isfinite(x.error)) rounding += (rounding.empty() ? "" : ", ") + name;
  };
  for (int k = 0; k < 3; ++k) add("da/", a[k], by[k]);
  for (int k = 0; k < 3; ++k) add("df/", f[k], by[k]);
  if (!table.empty())
    table.print(out);
  else if (unknown == 0)
    out << "  none: every island failed\n";
  if (!rounding.empty())
    wrap(out,
         rounding + " of some island may consist of rounding errors: K is nearly singular (error bounds of 1 or more)",
         2);
  const auto& changes = s.findings.rank_changes;
  for (std::size_t k = 0; k < changes.size() && k < 2; ++k)
    wrap(out,
         "derivatives assume that the rank is constant, but " +
             in_words(s.file.scene, s.findings.velocity_names, changes[k]),
         2);
  if (changes.size() > 2) out << "  and in " << changes.size() - 2 << " more islands\n";
  if (unknown > 0)
    out << "  not known (NaN) of " << count(unknown, "solved island")
        << ": the equations of the derivatives could not be solved\n";
}

}  // namespace manycontact::cli
