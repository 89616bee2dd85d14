#include "manycontact/analysis/remedy.hpp"
#include "objects.hpp"

namespace manycontact::python {

namespace {

void add_enumerations(py::module_& m) {
  enumeration<Status>(m);
  enumeration<Method>(m);
  enumeration<Order>(m);
  enumeration<SimdLevel>(m);
  enumeration<Precision>(m);
  enumeration<Reason>(m);
}

void add_how_to_solve(py::module_& m) {
  using Held = Handle<Options>;
  value<Held>(m)
      .from_members<Method, std::optional<Order>, SimdLevel, int, bool, Precision>()
      .fields<&Options::method, &Options::order, &Options::simd_level, &Options::threads, &Options::reduce_pairs,
              &Options::precision>()
      .def("__repr__", [](const Held& h) {
        const Options& o = h.get();
        return "Options('" + to_string(o.method) + "'" + (o.order ? ", '" + to_string(*o.order) + "'" : "") +
               (o.simd_level == SimdLevel::kAuto ? "" : ", simd_level='" + to_string(o.simd_level) + "'") +
               (o.threads == 1 ? "" : ", threads=" + std::to_string(o.threads)) +
               (o.reduce_pairs ? "" : ", reduce_pairs=False") +
               (o.precision == Precision::kDouble ? "" : ", precision='" + to_string(o.precision) + "'") + ")";
      });
}

void add_reports(py::module_& m) {
  using Island = std::shared_ptr<IslandReport>;
  using I = IslandReport;
  value<I, Island>(m)
      .read<&I::status, &I::method, &I::order, &I::precision, &I::reason, &I::changed_order, &I::nv, &I::nc, &I::rank,
            &I::dependent_rows, &I::factor_nonzeros, &I::refinement_steps, &I::residual_dynamics, &I::residual_contact,
            &I::backward_error, &I::condition, &I::error_acceleration, &I::error_forces>()
      .read("remedy", [](const I& r) { return remedy(r); });
  using Q = SystemQuality;
  value<Q>(m)
      .read<&Q::componentwise_backward_error, &Q::normwise_backward_error, &Q::growth, &Q::condition,
            &Q::scaled_condition, &Q::positive, &Q::negative, &Q::zero>();
  value<SolveTimes>(m).read<&SolveTimes::setup, &SolveTimes::solve>();

  add_items<Island>(m, "IslandReportList", false);
  using Whole = std::shared_ptr<Report>;
  using R = Report;
  const auto islands = [](const Whole& r) {
    return Items<Island>{[r] { return r->islands.size(); }, [r](std::size_t k) { return Island(r, &r->islands[k]); }};
  };
  value<R, Whole>(m)
      .read<&R::status, &R::method, &R::nv, &R::nc, &R::rank, &R::factor_nonzeros, &R::refinement_steps,
            &R::residual_dynamics, &R::residual_contact, &R::backward_error, &R::condition, &R::error_acceleration,
            &R::error_forces, &R::times>()
      .read("islands", islands, "ok", &R::ok, "remedy", [](const R& r) { return remedy(r); })
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
