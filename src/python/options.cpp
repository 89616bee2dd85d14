// How to solve, and what an answer is worth: floors kkt and dynamics.

#include "objects.hpp"

namespace manycontact::python {

namespace {

void add_enumerations(py::module_& m) {
  add_enumeration<Status>(m, "Status", "status", "What an answer is worth, from good to bad; int(status) is 0 ... 4.",
                          {{"OK", Status::kOk},
                           {"REDUNDANT", Status::kRedundant},
                           {"INCONSISTENT", Status::kInconsistent},
                           {"REGULARISED", Status::kRegularised},
                           {"FAILED", Status::kFailed}});
  add_enumeration<Method>(m, "Method", "method", "Ways of solving an island's system.",
                          {{"DENSE", Method::kDense},
                           {"DENSE_SCHUR", Method::kDenseSchur},
                           {"SPARSE_LDL", Method::kSparseLdl},
                           {"SUITE_SPARSE_LDL", Method::kSuiteSparseLdl},
                           {"SPARSE_CHOLMOD", Method::kSparseCholmod},
                           {"SPARSE_SUPERNODAL", Method::kSparseSupernodal},
                           {"SPARSE_BODIES", Method::kSparseBodies},
                           {"AUTO", Method::kAuto}});
  add_enumeration<Order>(
      m, "Order", "order", "Where the contact rows go among the joints.",
      {{"LEAF_TO_ROOT", Order::kLeafToRoot}, {"CONTACTS_EARLY", Order::kContactsEarly}, {"CAMD", Order::kCamd}});
  add_enumeration<Lanes>(m, "Lanes", "level of lanes", "Instructions for robots side by side in SIMD lanes.",
                         {{"AUTO", Lanes::kAuto},
                          {"OFF", Lanes::kOff},
                          {"BASELINE", Lanes::kBaseline},
                          {"AVX2", Lanes::kAvx2},
                          {"AVX512", Lanes::kAvx512}});
  add_enumeration<Reason>(m, "Reason", "reason", "Why an island was answered otherwise than asked for, or not at all.",
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
                           {"UNCERTAIN", Reason::kUncertain}});
}

void add_how_to_solve(py::module_& m) {
  using Held = Handle<Options>;
  py::class_<Held> c(m, "Options", "How to solve. data.options is the data's own: assigning to it changes them.");
  c.def(py::init([](Method method, std::optional<Order> order, Lanes lanes, int threads, bool reduce_pairs) {
          return Held(Options{method, order, lanes, threads, reduce_pairs});
        }),
        py::arg_v("method", Method::kAuto, "'auto'"), py::arg("order") = py::none(),
        py::arg_v("lanes", Lanes::kAuto, "'auto'"), py::arg("threads") = 1, py::arg("reduce_pairs") = true,
        "order: None for the order of least predicted cost. threads: inside a call; 0: as many as OpenMP would take.");
  handle_field(c, "method", &Options::method, "Method, or its name: 'sparse-ldl', 'dense', ...");
  handle_field(c, "order", &Options::order, "Order, or None: the one of least predicted cost.");
  handle_field(c, "lanes", &Options::lanes, "Lanes");
  handle_field(c, "threads", &Options::threads, "Of OpenMP, inside a call of solve, differentiate, jvp, vjp.");
  handle_field(c, "reduce_pairs", &Options::reduce_pairs,
               "Whether rows of several contacts between the same two bodies are reduced to six at most.");
  add_value(c).def("__repr__", [](const Held& h) {
    const Options& o = h.get();
    return "Options('" + to_string(o.method) + "'" + (o.order ? ", '" + to_string(*o.order) + "'" : "") +
           (o.lanes == Lanes::kAuto ? "" : ", lanes='" + to_string(o.lanes) + "'") +
           (o.threads == 1 ? "" : ", threads=" + std::to_string(o.threads)) +
           (o.reduce_pairs ? "" : ", reduce_pairs=False") + ")";
  });
}

void add_reports(py::module_& m) {
  using Island = std::shared_ptr<IslandReport>;
  py::class_<IslandReport, Island> island(m, "IslandReport", "What the answer of one island is worth.");
  add_value(island)
      .def_readonly("status", &IslandReport::status)
      .def_readonly("method", &IslandReport::method, "The one that answered.")
      .def_readonly("order", &IslandReport::order)
      .def_readonly("reason", &IslandReport::reason)
      .def_readonly("changed_order", &IslandReport::changed_order)
      .def_readonly("nv", &IslandReport::nv)
      .def_readonly("nc", &IslandReport::nc)
      .def_readonly("rank", &IslandReport::rank, "Of J; with damping, nc.")
      .def_readonly("dependent_rows", &IslandReport::dependent_rows, "Rows of data.f that depend on the others.")
      .def_readonly("factor_nonzeros", &IslandReport::factor_nonzeros)
      .def_readonly("refinement_steps", &IslandReport::refinement_steps)
      .def_readonly("residual_dynamics", &IslandReport::residual_dynamics, "Relative.")
      .def_readonly("residual_contact", &IslandReport::residual_contact, "Relative.")
      .def_readonly("backward_error", &IslandReport::backward_error, "Relative.")
      .def_readonly("condition", &IslandReport::condition, "1-norm, of K, by estimate_condition; else 0.")
      .def_readonly("error_acceleration", &IslandReport::error_acceleration, "Bound, relative, by estimate_errors.")
      .def_readonly("error_forces", &IslandReport::error_forces, "Bound, relative, by estimate_errors.");

  add_items<Island>(m, "IslandReportList", "A report's islands.", false);
  using Whole = std::shared_ptr<Report>;
  py::class_<Report, Whole> whole(m, "Report",
                                  "What an answer is worth: the worst island, sums and maxima over islands.");
  add_value(whole)
      .def_readonly("status", &Report::status)
      .def_readonly("method", &Report::method, "The one asked for.")
      .def_property_readonly("islands",
                             [](const Whole& r) {
                               return Items<Island>{[r] { return r->islands.size(); },
                                                    [r](std::size_t k) { return Island(r, &r->islands[k]); }};
                             })
      .def_readonly("nv", &Report::nv)
      .def_readonly("nc", &Report::nc)
      .def_readonly("rank", &Report::rank)
      .def_readonly("factor_nonzeros", &Report::factor_nonzeros)
      .def_readonly("refinement_steps", &Report::refinement_steps)
      .def_readonly("residual_dynamics", &Report::residual_dynamics, "Relative, largest.")
      .def_readonly("residual_contact", &Report::residual_contact, "Relative, largest.")
      .def_readonly("backward_error", &Report::backward_error, "Relative, largest.")
      .def_readonly("condition", &Report::condition, "Largest, by estimate_condition; else 0.")
      .def_readonly("error_acceleration", &Report::error_acceleration, "Bound, relative, by estimate_errors.")
      .def_readonly("error_forces", &Report::error_forces, "Bound, relative, by estimate_errors.")
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
