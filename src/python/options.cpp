// Options of a solve, and the status and accuracy of a solution.

#include "manycontact/analysis/remedy.hpp"
#include "objects.hpp"

namespace manycontact::python {

namespace {

void add_enumerations(py::module_& m) {
  add_enumeration<Status>(m, "Status", "status", "The status of a solution, from good to bad; int(status) is 0 ... 4.",
                          {{"OK", Status::kOk},
                           {"REDUNDANT", Status::kRedundant},
                           {"INCONSISTENT", Status::kInconsistent},
                           {"REGULARISED", Status::kRegularised},
                           {"FAILED", Status::kFailed}});
  add_enumeration<Method>(m, "Method", "method", "Methods for an island's system.",
                          {{"DENSE", Method::kDense},
                           {"DENSE_SCHUR", Method::kDenseSchur},
                           {"SPARSE_LDL", Method::kSparseLdl},
                           {"SUITE_SPARSE_LDL", Method::kSuiteSparseLdl},
                           {"SPARSE_CHOLMOD", Method::kSparseCholmod},
                           {"SPARSE_BODIES", Method::kSparseBodies},
                           {"AUTO", Method::kAuto}});
  add_enumeration<Order>(
      m, "Order", "order", "The place of the constraint rows in the elimination order.",
      {{"LEAF_TO_ROOT", Order::kLeafToRoot}, {"CONTACTS_EARLY", Order::kContactsEarly}, {"CAMD", Order::kCamd}});
  add_enumeration<Lanes>(m, "Lanes", "level of SIMD instructions", "SIMD instructions for batches of robots.",
                         {{"AUTO", Lanes::kAuto},
                          {"OFF", Lanes::kOff},
                          {"BASELINE", Lanes::kBaseline},
                          {"AVX2", Lanes::kAvx2},
                          {"AVX512", Lanes::kAvx512}});
  add_enumeration<Precision>(
      m, "Precision", "precision", "The arithmetic of a solve.",
      {{"SINGLE", Precision::kSingle}, {"DOUBLE", Precision::kDouble}, {"EXTENDED", Precision::kExtended}});
  add_enumeration<Reason>(m, "Reason", "reason",
                          "Why another method than the requested one was used, or why there is no solution.",
                          {{"NONE", Reason::kNone},
                           {"ZERO_PIVOT", Reason::kZeroPivot},
                           {"WRONG_INERTIA", Reason::kWrongInertia},
                           {"SMALL_PIVOT", Reason::kSmallPivot},
                           {"LARGE_RESIDUAL", Reason::kLargeResidual},
                           {"NOT_FINITE", Reason::kNotFinite},
                           {"DAMPING_LOST", Reason::kDampingLost},
                           {"BAD_DAMPING", Reason::kBadDamping},
                           {"BAD_QUATERNION", Reason::kBadQuaternion},
                           {"SINGULAR_INERTIA", Reason::kSingularInertia},
                           {"SPRING_WITHOUT_DIRECTION", Reason::kSpringWithoutDirection},
                           {"BAD_MOMENT_LENGTH", Reason::kBadMomentLength},
                           {"UNCERTAIN", Reason::kUncertain},
                           {"LOW_PRECISION", Reason::kLowPrecision}});
}

void add_how_to_solve(py::module_& m) {
  using Held = Handle<Options>;
  py::class_<Held> c(m, "Options",
                     "Options of a solve. Assigning to the attributes of data.options changes those of the data.");
  c.def(py::init([](Method method, std::optional<Order> order, Lanes lanes, int threads, bool reduce_pairs,
                    Precision precision) {
          return Held(Options{method, order, lanes, threads, reduce_pairs, precision});
        }),
        py::arg_v("method", Method::kAuto, "'auto'"), py::arg("order") = py::none(),
        py::arg_v("lanes", Lanes::kAuto, "'auto'"), py::arg("threads") = 1, py::arg("reduce_pairs") = true,
        py::arg_v("precision", Precision::kDouble, "'double'"), "Make options; see the attributes.");
  handle_field(c, "method", &Options::method, "Method, or its name: 'sparse-ldl', 'dense', ...");
  handle_field(c, "order", &Options::order, "Order, or None: the order of least predicted cost.");
  handle_field(c, "lanes", &Options::lanes, "SIMD instructions for batches of robots, a member of `Lanes`.");
  handle_field(
      c, "threads", &Options::threads,
      "Number of OpenMP threads inside a call of solve, differentiate, jvp or vjp; 0: as many as OpenMP offers.");
  handle_field(c, "reduce_pairs", &Options::reduce_pairs,
               "Whether rows of several contacts between the same two bodies are reduced to at most six.");
  handle_field(c, "precision", &Options::precision,
               "The arithmetic: 'single', 'double' or 'extended', or a member of `Precision`.");
  add_value(c).def("__repr__", [](const Held& h) {
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
  py::class_<IslandReport, Island> island(m, "IslandReport", "Status and accuracy of the solution of one island.");
  add_value(island)
      .def_readonly("status", &IslandReport::status, "Status of the island's solution.")
      .def_readonly("method", &IslandReport::method, "Method that computed the solution.")
      .def_readonly("order", &IslandReport::order, "Elimination order of that method, if it has one.")
      .def_readonly("precision", &IslandReport::precision, "Precision of the solution.")
      .def_readonly("reason", &IslandReport::reason, "Reason of the last change of order or method, or of the failure.")
      .def_readonly("changed_order", &IslandReport::changed_order,
                    "Whether the chosen order was not accurate, and leaf-to-root was used instead.")
      .def_readonly("nv", &IslandReport::nv, "Number of velocity coordinates.")
      .def_readonly("nc", &IslandReport::nc, "Number of constraint rows.")
      .def_readonly("rank", &IslandReport::rank, "Rank of J; with damping nc; 0 if failed.")
      .def_readonly("dependent_rows", &IslandReport::dependent_rows,
                    "Rows of data.f that depend on the others, ascending.")
      .def_readonly("factor_nonzeros", &IslandReport::factor_nonzeros, "Number of nonzeros of the factor L.")
      .def_readonly("refinement_steps", &IslandReport::refinement_steps, "Number of steps of iterative refinement.")
      .def_readonly("residual_dynamics", &IslandReport::residual_dynamics,
                    "Relative residual of M a + h = tau + J^T f.")
      .def_readonly("residual_contact", &IslandReport::residual_contact, "Relative residual of J a + a0 + delta f = 0.")
      .def_readonly("backward_error", &IslandReport::backward_error,
                    "Relative change of K and the right-hand side that makes the solution exact.")
      .def_readonly("condition", &IslandReport::condition,
                    "1-norm condition number of K, set by estimate_condition; NaN before.")
      .def_readonly("error_acceleration", &IslandReport::error_acceleration,
                    "Bound of the relative error of the accelerations, set by estimate_errors; NaN before.")
      .def_readonly("error_forces", &IslandReport::error_forces,
                    "Bound of the relative error of the forces, set by estimate_errors; NaN before.");

  island.def_property_readonly(
      "remedy", [](const IslandReport& r) { return remedy(r); }, "Advice about the status, in words; empty for ok.");
  py::class_<SystemQuality> quality(m, "SystemQuality", "How well an island's equations K x = b are solved.");
  add_value(quality)
      .def_readonly("componentwise_backward_error", &SystemQuality::componentwise_backward_error,
                    "Largest |r_k| / (|K| |x| + |b|)_k.")
      .def_readonly("normwise_backward_error", &SystemQuality::normwise_backward_error,
                    "|r| / (|K| |x| + |b|) in the maximum norm.")
      .def_readonly("growth", &SystemQuality::growth, "Largest term of a pivot over the largest diagonal entry of K.")
      .def_readonly("condition", &SystemQuality::condition, "1-norm condition number of K.")
      .def_readonly("scaled_condition", &SystemQuality::scaled_condition,
                    "The same where the largest entry of each row and column is scaled to 1.")
      .def_readonly("positive", &SystemQuality::positive, "Number of positive eigenvalues of K.")
      .def_readonly("negative", &SystemQuality::negative, "Number of negative eigenvalues of K.")
      .def_readonly("zero", &SystemQuality::zero, "Number of dependent rows.");
  py::class_<SolveTimes> times(m, "SolveTimes", "Times of a solve.");
  add_value(times)
      .def_readonly("setup", &SolveTimes::setup, "Time to find islands and analyse new ones [us].")
      .def_readonly("solve", &SolveTimes::solve, "Time of the solve itself [us].");

  add_items<Island>(m, "IslandReportList", "A report's islands.", false);
  using Whole = std::shared_ptr<Report>;
  py::class_<Report, Whole> whole(m, "Report",
                                  "Status and accuracy of a solution: the worst island, sums and maxima over islands.");
  add_value(whole)
      .def_readonly("status", &Report::status, "Status of the worst island.")
      .def_readonly("method", &Report::method, "Method that was requested.")
      .def_property_readonly(
          "islands",
          [](const Whole& r) {
            return Items<Island>{[r] { return r->islands.size(); },
                                 [r](std::size_t k) { return Island(r, &r->islands[k]); }};
          },
          "One IslandReport per island.")
      .def_readonly("nv", &Report::nv, "Number of velocity coordinates.")
      .def_readonly("nc", &Report::nc, "Number of constraint rows of the active contacts.")
      .def_readonly("rank", &Report::rank, "Sum of the ranks of the islands.")
      .def_readonly("factor_nonzeros", &Report::factor_nonzeros, "Sum over the islands.")
      .def_readonly("refinement_steps", &Report::refinement_steps, "Sum over the islands.")
      .def_readonly("residual_dynamics", &Report::residual_dynamics,
                    "Largest relative residual of M a + h = tau + J^T f.")
      .def_readonly("residual_contact", &Report::residual_contact,
                    "Largest relative residual of J a + a0 + delta f = 0.")
      .def_readonly("backward_error", &Report::backward_error, "Largest backward error of the islands.")
      .def_readonly("condition", &Report::condition,
                    "Largest 1-norm condition number of the islands, set by estimate_condition; NaN before.")
      .def_readonly("error_acceleration", &Report::error_acceleration,
                    "Largest bound of the islands, set by estimate_errors; NaN before.")
      .def_readonly("error_forces", &Report::error_forces,
                    "Largest bound of the islands, set by estimate_errors; NaN before.")
      .def_readonly("times", &Report::times, "SolveTimes of the last solve; comparisons of reports ignore them.")
      .def_property_readonly(
          "remedy", [](const Report& r) { return remedy(r); }, "Advice about the status, in words; empty for ok.")
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
