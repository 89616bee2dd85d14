// Options of a solve, and the status and accuracy of a solution.

#include "manycontact/analysis/remedy.hpp"
#include "objects.hpp"

namespace manycontact::python {

namespace {

void add_enumerations(py::module_& m) {
  enumeration<Status>(m, "Status");
  enumeration<Method>(m, "Method");
  enumeration<Order>(m, "Order");
  enumeration<Lanes>(m, "Lanes");
  enumeration<Precision>(m, "Precision");
  enumeration<Reason>(m, "Reason");
}

void add_how_to_solve(py::module_& m) {
  using Held = Handle<Options>;
  value<Held>(m, "Options")
      .from_members<Method, std::optional<Order>, Lanes, int, bool, Precision>()
      .fields("method", &Options::method, "order", &Options::order, "lanes", &Options::lanes, "threads",
              &Options::threads, "reduce_pairs", &Options::reduce_pairs, "precision", &Options::precision)
      .def("__repr__", [](const Held& h) {
        const Options& o = h.get();
        return "Options('" + to_string(o.method) + "'" + (o.order ? ", '" + to_string(*o.order) + "'" : "") +
               (o.lanes == Lanes::kAuto ? "" : ", lanes='" + to_string(o.lanes) + "'") +
               (o.threads == 1 ? "" : ", threads=" + std::to_string(o.threads)) +
               (o.reduce_pairs ? "" : ", reduce_pairs=False") +
               (o.precision == Precision::kDouble ? "" : ", precision='" + to_string(o.precision) + "'") + ")";
      });
}

void add_reports(py::module_& m) {
  using Island = std::shared_ptr<IslandReport>;
  using I = IslandReport;
  value<I, Island>(m, "IslandReport")
      .read("status", &I::status, "method", &I::method, "order", &I::order, "precision", &I::precision, "reason",
            &I::reason, "changed_order", &I::changed_order, "nv", &I::nv, "nc", &I::nc, "rank", &I::rank,
            "dependent_rows", &I::dependent_rows, "factor_nonzeros", &I::factor_nonzeros, "refinement_steps",
            &I::refinement_steps, "residual_dynamics", &I::residual_dynamics, "residual_contact", &I::residual_contact,
            "backward_error", &I::backward_error, "condition", &I::condition, "error_acceleration",
            &I::error_acceleration, "error_forces", &I::error_forces, "remedy", [](const I& r) { return remedy(r); });
  using Q = SystemQuality;
  value<Q>(m, "SystemQuality")
      .read("componentwise_backward_error", &Q::componentwise_backward_error, "normwise_backward_error",
            &Q::normwise_backward_error, "growth", &Q::growth, "condition", &Q::condition, "scaled_condition",
            &Q::scaled_condition, "positive", &Q::positive, "negative", &Q::negative, "zero", &Q::zero);
  value<SolveTimes>(m, "SolveTimes").read("setup", &SolveTimes::setup, "solve", &SolveTimes::solve);

  add_items<Island>(m, "IslandReportList", false);
  using Whole = std::shared_ptr<Report>;
  using R = Report;
  const auto islands = [](const Whole& r) {
    return Items<Island>{[r] { return r->islands.size(); }, [r](std::size_t k) { return Island(r, &r->islands[k]); }};
  };
  value<R, Whole>(m, "Report")
      .read("status", &R::status, "method", &R::method, "islands", islands, "nv", &R::nv, "nc", &R::nc, "rank",
            &R::rank, "factor_nonzeros", &R::factor_nonzeros, "refinement_steps", &R::refinement_steps,
            "residual_dynamics", &R::residual_dynamics, "residual_contact", &R::residual_contact, "backward_error",
            &R::backward_error, "condition", &R::condition, "error_acceleration", &R::error_acceleration,
            "error_forces", &R::error_forces, "times", &R::times, "remedy", [](const R& r) { return remedy(r); })
      .def("__repr__", [](const Report& r) {
        return "<Report: " + to_string(r.status) + ", " + std::to_string(r.islands.size()) +
               (r.islands.size() == 1 ? " island" : " islands") + ", nv = " + std::to_string(r.nv) +
               ", nc = " + std::to_string(r.nc) + ", rank = " + std::to_string(r.rank) + ">";
      });
}

}  // namespace

void add_options(py::module_& m) {
  add_enumerations(m);
  add_how_to_solve(m);
  add_reports(m);
}

}  // namespace manycontact::python
