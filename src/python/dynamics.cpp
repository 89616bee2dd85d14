// Solutions, derivatives, products, batches: floors kkt and dynamics.

#include <mutex>

#include "data.hpp"
#include "manycontact/algorithm/frames.hpp"
#include "manycontact/dynamics/batch.hpp"
#include "manycontact/dynamics/differentiate.hpp"
#include "manycontact/dynamics/jvp.hpp"
#include "manycontact/dynamics/quasi_static.hpp"
#include "manycontact/dynamics/views.hpp"
#include "manycontact/model/suggestion.hpp"

namespace manycontact::python {

using Vector = Eigen::VectorXd;

py::array Data::export_block(const IslandDerivatives& island, const double* x, Eigen::Index rows,
                             Eigen::Index cols) const {
  std::weak_ptr<PanelKeeper>& known = state_->exported[&island];
  std::shared_ptr<PanelKeeper> keeper = known.lock();
  if (!keeper) known = keeper = std::make_shared<PanelKeeper>(PanelKeeper{data_, {}});
  const py::capsule owner(new std::shared_ptr<PanelKeeper>(std::move(keeper)),
                          [](void* p) { delete static_cast<std::shared_ptr<PanelKeeper>*>(p); });
  return view(x, {rows, cols}, {island.X.outerStride(), 1}, owner, false);
}

void Data::let_go_of_panels() const {
  for (const auto& [island, known] : state_->exported) {
    const std::shared_ptr<PanelKeeper> keeper = known.lock();
    if (!keeper) continue;
    auto& X = const_cast<IslandDerivatives*>(island)->X;
    keeper->panel = X;
    keeper->panel.swap(X);  // the arrays are on the memory, which changes hands
    keeper->data.reset();
  }
  state_->exported.clear();
}

namespace {

// ---- enumerations --------------------------------------------------------------------------------------------------

void add_enumerations(py::module_& m) {
  add_enumeration<Status>(m, "Status", "What an answer is worth, from good to bad; int(status) is 0 ... 4.",
                          {{"kOk", Status::kOk},
                           {"kRedundant", Status::kRedundant},
                           {"kInconsistent", Status::kInconsistent},
                           {"kRegularised", Status::kRegularised},
                           {"kFailed", Status::kFailed}});
  add_enumeration<Method>(m, "Method", "Ways of solving an island's system.",
                          {{"kDense", Method::kDense},
                           {"kDenseSchur", Method::kDenseSchur},
                           {"kSparseLdl", Method::kSparseLdl},
                           {"kSuiteSparseLdl", Method::kSuiteSparseLdl},
                           {"kSparseCholmod", Method::kSparseCholmod},
                           {"kSparseSupernodal", Method::kSparseSupernodal},
                           {"kSparseBodies", Method::kSparseBodies},
                           {"kAuto", Method::kAuto}});
  add_enumeration<Order>(
      m, "Order", "Where the contact rows go among the joints.",
      {{"kLeafToRoot", Order::kLeafToRoot}, {"kContactsEarly", Order::kContactsEarly}, {"kCamd", Order::kCamd}});
  add_enumeration<Lanes>(m, "Lanes", "Instructions for robots side by side in SIMD lanes.",
                         {{"kAuto", Lanes::kAuto},
                          {"kOff", Lanes::kOff},
                          {"kBaseline", Lanes::kBaseline},
                          {"kAvx2", Lanes::kAvx2},
                          {"kAvx512", Lanes::kAvx512}});
  add_enumeration<Reason>(m, "Reason", "Why an island was answered otherwise than asked for, or not at all.",
                          {{"kNone", Reason::kNone},
                           {"kZeroPivot", Reason::kZeroPivot},
                           {"kWrongInertia", Reason::kWrongInertia},
                           {"kSmallPivot", Reason::kSmallPivot},
                           {"kLargeResidual", Reason::kLargeResidual},
                           {"kNotFinite", Reason::kNotFinite},
                           {"kDampingLost", Reason::kDampingLost},
                           {"kBadDamping", Reason::kBadDamping},
                           {"kBadQuaternion", Reason::kBadQuaternion},
                           {"kSingularInertia", Reason::kSingularInertia}});

  py::class_<Options>(m, "Options", "How to solve.")
      .def(py::init(&options_of), py::arg("method") = "auto", py::arg("order") = py::none(), py::arg("lanes") = "auto",
           "method: a Method or its name ('sparse-ldl', 'dense', ...); order: an Order, its name, or None for the\n"
           "order of least predicted cost; lanes: a Lanes or its name.")
      .def_readwrite("method", &Options::method)
      .def_readwrite("order", &Options::order)
      .def_readwrite("lanes", &Options::lanes)
      .def_readwrite("threads", &Options::threads)
      .def("__eq__", [](const Options& a, const Options& b) { return a == b; })
      .def("__repr__", [](const Options& o) {
        return "Options('" + to_string(o.method) + "'" + (o.order ? ", '" + to_string(*o.order) + "'" : "") + ")";
      });
}

void add_reports(py::module_& m) {
  py::class_<IslandReport>(m, "IslandReport", "What the answer of one island is worth.")
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

  py::class_<Report>(m, "Report", "What an answer is worth: the worst island, sums and maxima over islands.")
      .def_readonly("status", &Report::status)
      .def_readonly("method", &Report::method, "The one asked for.")
      .def_property_readonly(
          "islands", [](const Report& r) { return r.islands; }, "List of IslandReport.")
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

// ---- data and solve ------------------------------------------------------------------------------------------------

// data.active: an array of bools on the flags, which are chars that hold 0 or 1.
py::array active_flags(const std::shared_ptr<Data>& data) {
  std::vector<char>& flags = data->at_rest().active;
  static_assert(sizeof(bool) == sizeof(char));
  return py::array(py::dtype::of<bool>(), {flags.size()}, {1}, flags.data(), py::cast(data));
}

// Bools, numpy's, or the whole numbers 0 and 1, one per contact.
void set_flags(const std::string& name, py::handle values, std::vector<char>& flags) {
  const py::array given = py::array::ensure(values);
  const char kind = given ? given.dtype().kind() : 'O';
  const bool whole = kind == 'b' || kind == 'i' || kind == 'u';
  if (!given || given.ndim() == 0 || (!whole && given.size() > 0))
    throw py::type_error(name + ": a sequence of bools is expected, one per contact");
  if (given.ndim() != 1 || given.size() != static_cast<py::ssize_t>(flags.size()))
    throw py::value_error(name + ": " + std::to_string(flags.size()) + " flags are expected, one per contact, not " +
                          shape_of(given));
  const auto numbers = py::array_t<std::int64_t, py::array::forcecast>::ensure(given);
  for (py::ssize_t k = 0; k < numbers.size(); ++k)
    if (numbers.at(k) != 0 && numbers.at(k) != 1)
      throw py::value_error(name + "[" + std::to_string(k) + "] is " + std::to_string(numbers.at(k)) +
                            ", a bool is expected");
  for (std::size_t k = 0; k < flags.size(); ++k) flags[k] = static_cast<char>(numbers.at(static_cast<py::ssize_t>(k)));
}

void add_data(py::module_& m) {
  py::class_<Data, std::shared_ptr<Data>>(
      m, "SceneData",
      "The variable part of a scene: what is asked, the answer, and the memory it is worked out in. One per thread.")
      .def(py::init([](const Scene& scene, const Options& options) {
             return Data(std::make_shared<SceneData>(scene, options));
           }),
           py::arg("scene"), py::arg_v("options", Options(), "Options()"))
      .def_property(
          "options", [](const Data& d) { return d.at_rest().options; },
          [](const Data& d, const Options& options) { d.at_rest().options = options; }, "A copy; assign.")
      .def_property(
          "active", &active_flags,
          [](const Data& d, py::handle values) { set_flags("SceneData.active", values, d.at_rest().active); },
          "One bool per contact of the scene: write data.active[i] = False to switch a contact.")
      .def_property_readonly(
          "a", [](const Data& d) { return d.at_rest().a; }, "Accelerations (nv) [m/s^2, rad/s^2]; a copy.")
      .def_property_readonly(
          "f", [](const Data& d) { return d.at_rest().f; },
          "Contact forces (rows of the active contacts) on A, in each contact's reference frame\n"
          "[N, N m]; a copy.")
      .def_property_readonly(
          "v", [](const Data& d) { return d.at_rest().v; }, "The velocity (nv) solved at; a copy.")
      .def_property_readonly(
          "tau", [](const Data& d) { return d.at_rest().tau; }, "The torques (nv) solved at; a copy.")
      .def_property_readonly(
          "serial", [](const Data& d) { return d.at_rest().serial; }, "Number of the solve; 0: there is no answer.")
      .def_property_readonly(
          "f_offset", [](const Data& d) { return d.at_rest().f_offset; },
          "Per contact its first row in f, -1 when not active.")
      .def_property_readonly(
          "report", [](const Data& d) { return d.at_rest().report; }, "Report; a copy.");

  m.def(
      "solve",
      [](const Scene& scene, const Raw& q, const Raw& v, const Raw& u, const Data& data) {
        check_numbers("q", q.array.data(), q.array.size());
        check_numbers("v", v.array.data(), v.array.size());
        check_numbers("u", u.array.data(), u.array.size());
        const auto Q = q.vector(), V = v.vector(), U = u.vector();
        return Report(data.use([&](SceneData& d) -> const Report& { return solve(scene, Q, V, U, d); }));
      },
      py::arg("scene"), py::arg("q"), py::arg("v"), py::arg("u"), py::arg("data"),
      "Contact forward dynamics: accelerations data.a (nv) and contact forces data.f of the scene at\n\n"
      "q: configuration (nq) [m, rad; unit quaternions x, y, z, w],\n"
      "v: velocity (nv) [m/s, rad/s; of floating bases in their own frames, linear first],\n"
      "u: torques of the actuated coordinates (nu) [N m; N for prismatic joints],\n\n"
      "    [ M  J^T     ] [  a ]   [ S^T u - h ]\n"
      "    [ J  -delta I] [ -f ] = [   -a0     ]\n\n"
      "per island, by data.options.method. Returns a Report, whose status says what the answer is worth; a and f of\n"
      "failed islands are NaN. Raises ValueError where sizes do not fit the scene, numbers are not finite, or the "
      "data\n"
      "are of another scene. Other Python threads run meanwhile.");
  m.def(
      "solve_tau",
      [](const Scene& scene, const Raw& q, const Raw& v, const Raw& tau, const Data& data) {
        check_numbers("q", q.array.data(), q.array.size());
        check_numbers("v", v.array.data(), v.array.size());
        check_numbers("tau", tau.array.data(), tau.array.size());
        const auto Q = q.vector(), V = v.vector(), T = tau.vector();
        return Report(data.use([&](SceneData& d) -> const Report& { return solve_tau(scene, Q, V, T, d); }));
      },
      py::arg("scene"), py::arg("q"), py::arg("v"), py::arg("tau"), py::arg("data"),
      "solve with torques tau (nv) on every velocity coordinate, floating bases included.");
  m.def(
      "prepare", [](const Scene& scene, const Data& data) { data.use([&](SceneData& d) { prepare(scene, d); }); },
      py::arg("scene"), py::arg("data"), "Finds the islands of data.active and sets up their systems; solve does it.");
  m.def(
      "estimate_condition",
      [](const Scene& scene, const Data& data) {
        return data.use([&](SceneData& d) {
          estimate_condition(scene, d);
          return d.report;
        });
      },
      py::arg("scene"), py::arg("data"),
      "After solve: the 1-norm condition number of each island's K, into the report, which is returned.");
  m.def(
      "estimate_errors",
      [](const Scene& scene, const Data& data) {
        return data.use([&](SceneData& d) {
          estimate_errors(scene, d);
          return d.report;
        });
      },
      py::arg("scene"), py::arg("data"),
      "After solve: bounds of the relative errors of each island's a and f, into the report, which is returned.");
  m.def(
      "quasi_static",
      [](const Scene& scene, const Raw& q, const std::shared_ptr<Data>& data) -> Vector {
        check_numbers("q", q.array.data(), q.array.size());
        const auto Q = q.vector();
        if (data) return data->use([&](SceneData& d) { return quasi_static(scene, Q, d); });
        const py::gil_scoped_release unlocked;
        return quasi_static(scene, Q);
      },
      py::arg("scene"), py::arg("q"), py::arg("data") = py::none(),
      "Torques u (nu) [N m, N] that hold the scene still at q (nq): the u part of the minimum-norm least-squares\n"
      "solution of [S^T J^T] [u; f] = h(q, 0). With data: their active contacts; a later derivative needs a new "
      "solve.");
  m.def("lanes_here", &lanes_here, "The levels of instructions that run on this processor, widest first.");
  m.def(
      "force_names", [](const Scene& scene, const Data& data) { return force_names(scene, data.at_rest()); },
      py::arg("scene"), py::arg("data"), "'left[0]' for each row of data.f.");
  m.def(
      "contact_force",
      [](const Scene& scene, const Data& data, const std::variant<int, std::string>& contact) -> Vector {
        return std::visit([&](const auto& c) -> Vector { return contact_force(scene, data.at_rest(), c); }, contact);
      },
      py::arg("scene"), py::arg("data"), py::arg("contact"),
      "What a contact, by its name or number, exerts on A, in its reference frame [N, N m]; a copy.");
}

// ---- derivatives ---------------------------------------------------------------------------------------------------

// DerivativeData and its islands: by the data, at the last differentiate.
struct Derivatives {
  std::shared_ptr<Data> data;
  const DerivativeData& get() const { return derivatives(data->at_rest()); }
};
struct IslandBlocks {
  std::shared_ptr<Data> data;
  std::size_t island;
  const IslandDerivatives& get() const {
    const DerivativeData& d = derivatives(data->at_rest());
    if (island >= d.islands.size()) throw py::value_error("derivatives of an island: there is no such island any more");
    return d.islands[island];
  }
};

template <class Block>
auto block_property(Block (IslandDerivatives::*block)() const) {
  return [block](const IslandBlocks& b) {
    const IslandDerivatives& d = b.get();
    const Block x = (d.*block)();
    return b.data->export_block(d, x.data(), x.rows(), x.cols());
  };
}

// K of one island, or of the whole scene (island < 0), as scipy's.
py::object kkt_matrix(const Scene& scene, const Data& data, int island) {
  data.use([&](SceneData& d) { complete(scene, d); });
  const SceneData& d = data.at_rest();
  const auto count = static_cast<int>(island_count(d));
  if (island < -1 || island >= count)
    throw py::value_error("matrix_of: there is no island " + std::to_string(island) + " of " + std::to_string(count));
  std::vector<int> rows, columns;
  std::vector<double> values;
  int size = 0;
  for (int i = std::max(0, island); i < (island < 0 ? count : island + 1); ++i) {
    const KktMatrix& K = matrix_of(d, i);
    const Island& at = island_of(d, i);
    std::vector<int> place(at.size());  // of the island's [a; f]
    for (int k = 0; k < at.size(); ++k) place[k] = k;
    if (island < 0) {
      each_velocity_block(scene, at, [&](int first, int local, int n) {
        for (int k = 0; k < n; ++k) place[local + k] = first + k;
      });
      each_force_block(scene, d.f_offset, at, [&](int first, int local, int n) {
        for (int k = 0; k < n; ++k) place[at.nv + local + k] = scene.nv + first + k;
      });
    }
    const KktPattern& p = *K.pattern;
    for (int j = 0; j < p.K.n; ++j)
      for (int s = p.K.p[j]; s < p.K.p[j + 1]; ++s) {
        const int r = place[p.perm[p.K.i[s]]], c = place[p.perm[j]];
        for (int mirrored = 0; mirrored < (r == c ? 1 : 2); ++mirrored) {
          rows.push_back(mirrored ? c : r);
          columns.push_back(mirrored ? r : c);
          values.push_back(K.values[s]);
        }
      }
    size += at.size();
  }
  const auto n = static_cast<py::ssize_t>(values.size());
  return py::module_::import("scipy.sparse")
      .attr("csc_matrix")(
          py::make_tuple(py::array_t<double>(n, values.data()),
                         py::make_tuple(py::array_t<int>(n, rows.data()), py::array_t<int>(n, columns.data()))),
          py::arg("shape") = py::make_tuple(size, size));
}

void add_derivative_classes(py::module_& m) {
  py::class_<DerivativeRequest>(m, "DerivativeRequest", "What to compute; what is not asked for costs nothing.")
      .def(py::init([](bool q, bool v, bool u, bool forces, bool tau) {
             return DerivativeRequest{q, v, u, forces, tau};
           }),
           py::kw_only(), py::arg("q") = true, py::arg("v") = true, py::arg("u") = true, py::arg("forces") = true,
           py::arg("tau") = false,
           "forces: dforces_*. tau: da_du and dforces_du by the torques on all nv coordinates, not the nu actuated.")
      .def_readwrite("q", &DerivativeRequest::q)
      .def_readwrite("v", &DerivativeRequest::v)
      .def_readwrite("u", &DerivativeRequest::u)
      .def_readwrite("forces", &DerivativeRequest::forces)
      .def_readwrite("tau", &DerivativeRequest::tau);

  py::class_<IslandBlocks>(
      m, "IslandDerivatives",
      "One island's blocks, in its order: robots ascending, contacts ascending (see island_of); q on the tangent\n"
      "space. Each is an array on the library's memory, not copied; arrays keep their numbers when the scene is "
      "solved\n"
      "and differentiated again. ValueError once the scene was solved again and not differentiated.")
      .def_property_readonly("da_dq", block_property(&IslandDerivatives::da_dq), "(nv, nv) of the island.")
      .def_property_readonly("da_dv", block_property(&IslandDerivatives::da_dv), "(nv, nv)")
      .def_property_readonly("da_du", block_property(&IslandDerivatives::da_du), "(nv, nu)")
      .def_property_readonly("dforces_dq", block_property(&IslandDerivatives::dforces_dq), "(nc, nv)")
      .def_property_readonly("dforces_dv", block_property(&IslandDerivatives::dforces_dv), "(nc, nv)")
      .def_property_readonly("dforces_du", block_property(&IslandDerivatives::dforces_du), "(nc, nu)")
      .def_property_readonly("nv", [](const IslandBlocks& b) { return b.get().nv; })
      .def_property_readonly("nc", [](const IslandBlocks& b) { return b.get().nc; })
      .def_property_readonly("nu", [](const IslandBlocks& b) { return b.get().nu; });

  struct Islands : Derivatives {};
  py::class_<Islands>(m, "IslandDerivativesList", "A sequence of IslandDerivatives.")
      .def("__len__", [](const Islands& x) { return x.get().islands.size(); })
      .def(
          "__getitem__",
          [](const Islands& x, py::ssize_t i) {
            const auto n = static_cast<py::ssize_t>(x.get().islands.size());
            if (i < -n || i >= n) throw py::index_error("there are " + std::to_string(n) + " islands");
            return IslandBlocks{x.data, static_cast<std::size_t>(i < 0 ? i + n : i)};
          },
          py::arg("island"));
  py::class_<Derivatives>(m, "DerivativeData", "Derivatives by differentiate: blocks per island.")
      .def_property_readonly(
          "islands", [](const Derivatives& x) { return Islands{{x.data}}; }, "One entry per island of the report.");

  py::class_<SceneDerivatives, std::shared_ptr<SceneDerivatives>> dense(
      m, "SceneDerivatives", "The scene's matrices, in the order of its v, u and of data.f.");
  member_view(dense, "da_dq", &SceneDerivatives::da_dq, "(nv, nv)");
  member_view(dense, "da_dv", &SceneDerivatives::da_dv, "(nv, nv)");
  member_view(dense, "da_du", &SceneDerivatives::da_du, "(nv, nu)");
  member_view(dense, "dforces_dq", &SceneDerivatives::dforces_dq, "(rows of f, nv)");
  member_view(dense, "dforces_dv", &SceneDerivatives::dforces_dv, "(rows of f, nv)");
  member_view(dense, "dforces_du", &SceneDerivatives::dforces_du, "(rows of f, nu)");

  py::class_<Island>(m, "Island", "Robots joined by active contacts between bodies that move.")
      .def_readonly("robots", &Island::robots, "Numbers in the scene, ascending.")
      .def_readonly("contacts", &Island::contacts, "Numbers of the active ones, ascending.")
      .def_readonly("dof_offset", &Island::dof_offset, "Per robot its first velocity coordinate in the island.")
      .def_readonly("row_offset", &Island::row_offset, "Per contact its first row in the island.")
      .def_readonly("nv", &Island::nv)
      .def_readonly("nc", &Island::nc);
}

void add_derivatives(py::module_& m) {
  m.def(
      "differentiate",
      [](const Scene& scene, const std::shared_ptr<Data>& data, const DerivativeRequest& request) {
        data->use([&](SceneData& d) { (void)differentiate(scene, d, request); });
        return Derivatives{data};
      },
      py::arg("scene"), py::arg("data").none(false), py::arg_v("request", DerivativeRequest(), "DerivativeRequest()"),
      "Derivatives of data.a and data.f at the last solve, with its factor, as blocks per island:\n\n"
      "    mc.differentiate(scene, data).islands[0].da_dq       # (nv, nv) of island 0\n\n"
      "f is held constant in each contact's own frame while the dynamics are differentiated; q is on the tangent "
      "space.\n"
      "Where contacts are redundant, dforces_* are those of the least-norm forces. Blocks of failed islands are NaN.\n"
      "Raises ValueError before the first solve, after contacts were switched, and for data of another scene.");
  m.def(
      "dense_derivatives",
      [](const Scene& scene, const Data& data) {
        return std::make_shared<SceneDerivatives>(data.use([&](SceneData& d) { return dense_derivatives(scene, d); }));
      },
      py::arg("scene"), py::arg("data"), "After differentiate: the derivatives as dense matrices of the whole scene.");
  m.def(
      "sparse_derivatives",
      [](const Scene& scene, const Data& data) {
        return scipy_csc(data.use([&](SceneData& d) { return sparse_derivatives(scene, d); }));
      },
      py::arg("scene"), py::arg("data"),
      "After differentiate: one scipy.sparse.csc_matrix of the whole scene, rows [a; f], columns [q | v | u] (those\n"
      "asked for).");
  m.def(
      "release_derivatives", [](const Data& data) { data.use([](SceneData& d) { release_derivatives(d); }); },
      py::arg("data"), "Gives back the memory of derivatives.");
  m.def(
      "matrix_of", &kkt_matrix, py::arg("scene"), py::arg("data"), py::arg("island") = -1,
      "After solve: K = [M J^T; J -delta I] as a scipy.sparse.csc_matrix, rows and columns [a; f] in the order of the\n"
      "scene; of one island in its own order.");
  m.def(
      "jvp",
      [](const Scene& scene, const Data& data, const Vector& dq, const Vector& dv, const Vector& du) {
        Vector da(scene.nv), df(data.at_rest().f.size());
        data.use([&](SceneData& d) { jvp(scene, d, dq, dv, du, da, df); });
        return std::make_pair(std::move(da), std::move(df));
      },
      py::arg("scene"), py::arg("data"), py::arg("dq"), py::arg("dv"), py::arg("du"),
      "(da, df) = the derivatives at the last solve times (dq, dv, du), of nv, nv and nu numbers; da: (nv), df: (rows\n"
      "of f). No matrix is formed.");
  m.def(
      "vjp",
      [](const Scene& scene, const Data& data, const Vector& wa, const Vector& wf) {
        Vector wq(scene.nv), wv(scene.nv), wu(scene.nu);
        data.use([&](SceneData& d) { vjp(scene, d, wa, wf, wq, wv, wu); });
        return std::make_tuple(std::move(wq), std::move(wv), std::move(wu));
      },
      py::arg("scene"), py::arg("data"), py::arg("wa"), py::arg("wf"),
      "(wq, wv, wu) = (wa, wf) times the derivatives at the last solve; wa: (nv), wf: (rows of f). No matrix is "
      "formed.");
}

// ---- views ---------------------------------------------------------------------------------------------------------

int robot_number(const Scene& scene, const std::string& name) {
  const auto found = scene.robot_index.find(name);
  if (found == scene.robot_index.end()) throw py::value_error(no_robot(scene, name));
  return found->second;
}

void add_views(py::module_& m) {
  m.def(
      "island_count", [](const Data& data) { return island_count(data.at_rest()); }, py::arg("data"));
  m.def(
      "island_of",
      [](const Data& data, std::size_t i) {
        if (i >= island_count(data.at_rest())) throw py::value_error("island_of: there is no such island");
        return island_of(data.at_rest(), i);
      },
      py::arg("data"), py::arg("island"), "Robots and contacts of an island; a copy.");
  m.def(
      "update_kinematics",
      [](const Scene& scene, const Vector& q, const Vector& v, const Data& data) {
        data.use([&](SceneData& d) { update_kinematics(scene, q, v, d); });
      },
      py::arg("scene"), py::arg("q"), py::arg("v"), py::arg("data"),
      "Places and velocities of all robots at q (nq), v (nv), for frame_placement; gives up the solution.");
  m.def(
      "frame_placement",
      [](const Scene& scene, const Data& data, const std::string& robot, const std::string& frame) {
        const int r = robot_number(scene, robot);
        const Robot& owner = scene.robots[r];
        const int number = owner.model->find_frame(frame);
        if (number < 0) throw py::value_error(no_frame(robot, *owner.model, frame));
        data.use([&](SceneData& d) { d.serial != 0 ? complete(scene, d) : prepare(scene, d); });  // or refuse the scene
        const Frame& f = owner.model->frames[number];
        return frame_placement<double>(kinematics_of(data.at_rest(), r), owner.base, f.joint, f.placement);
      },
      py::arg("scene"), py::arg("data"), py::arg("robot"), py::arg("frame"),
      "The placement oMf in the world of a robot's frame, at the q solved at or of update_kinematics.");
  m.def(
      "complete", [](const Scene& scene, const Data& data) { data.use([&](SceneData& d) { complete(scene, d); }); },
      py::arg("scene"), py::arg("data"), "After solve: what robots that stood in SIMD lanes would have left behind.");
}

// ---- batches -------------------------------------------------------------------------------------------------------

std::mutex one_batch;  // OpenBLAS' number of threads is the program's

// A matrix with a row per state; numbers that are not finite make that state fail.
struct Rows {
  Doubles array;
  ConstBatchRows ref() const {
    return Eigen::Map<const BatchMatrix, 0, Eigen::OuterStride<>>(array.data(), array.shape(0), array.shape(1),
                                                                  Eigen::OuterStride<>(array.shape(1)));
  }
};

Rows rows_of(const char* function, const char* name, py::handle source) {
  Rows rows{as_doubles(source, true)};
  if (!rows.array || rows.array.ndim() != 2)
    throw py::value_error(std::string(function) + ": " + name + " has to be a matrix, one state per row");
  return rows;
}

struct NewRows {
  NewRows(Eigen::Index rows, Eigen::Index cols) : array({rows, cols}) {}
  BatchRows ref() {
    return Eigen::Map<BatchMatrix, 0, Eigen::OuterStride<>>(array.mutable_data(), array.shape(0), array.shape(1),
                                                            Eigen::OuterStride<>(array.shape(1)));
  }
  py::array_t<double> array;
};

py::array status_array(const std::vector<Status>& status) {
  py::array_t<std::int8_t> out(static_cast<py::ssize_t>(status.size()));
  for (std::size_t i = 0; i < status.size(); ++i) out.mutable_data()[i] = static_cast<std::int8_t>(status[i]);
  return out;
}

template <class Work>
void run_batch(Work&& work) {
  const std::unique_lock turn(one_batch, std::try_to_lock);
  if (!turn) throw py::value_error("another thread works on a batch: one at a time");
  const py::gil_scoped_release unlocked;
  work();
}

py::tuple batch_of_solutions(const Scene& scene, py::handle q, py::handle v, py::handle u, BatchData& batch,
                             bool derivatives) {
  const char* name = derivatives ? "differentiate_batch" : "solve_batch";
  const Rows Q = rows_of(name, "Q", q), V = rows_of(name, "V", v), U = rows_of(name, "U", u);
  const Eigen::Index n = Q.array.shape(0), nf = force_rows(scene, batch);
  NewRows A(n, scene.nv), F(n, nf), D(n, derivatives ? (scene.nv + nf) * (2 * scene.nv + scene.nu) : 0);
  std::vector<Status> status(static_cast<std::size_t>(n));
  run_batch([&] {
    const BatchStates states{Q.ref(), V.ref(), U.ref()};
    if (derivatives)
      differentiate_batch(scene, states, batch, A.ref(), F.ref(), D.ref(), status);
    else
      solve_batch(scene, states, batch, A.ref(), F.ref(), status);
  });
  if (!derivatives) return py::make_tuple(A.array, F.array, status_array(status));
  const py::object blocks = D.array.attr("reshape")(n, scene.nv + nf, 2 * scene.nv + scene.nu);
  return py::make_tuple(A.array, F.array, blocks, status_array(status));
}

py::tuple batch_of_products(const Scene& scene, py::handle q, py::handle v, py::handle u, py::handle wa, py::handle wf,
                            BatchData& batch) {
  const char* name = "vjp_batch";
  const Rows Q = rows_of(name, "Q", q), V = rows_of(name, "V", v), U = rows_of(name, "U", u);
  const Rows WA = rows_of(name, "WA", wa), WF = rows_of(name, "WF", wf);
  const Eigen::Index n = Q.array.shape(0);
  NewRows WQ(n, scene.nv), WV(n, scene.nv), WU(n, scene.nu);
  std::vector<Status> status(static_cast<std::size_t>(n));
  run_batch([&] {
    vjp_batch(scene, {Q.ref(), V.ref(), U.ref()}, WA.ref(), WF.ref(), batch, WQ.ref(), WV.ref(), WU.ref(), status);
  });
  return py::make_tuple(WQ.array, WV.array, WU.array, status_array(status));
}

void add_batches(py::module_& m) {
  py::class_<BatchData>(m, "BatchData", "The memory of the threads that solve many states of one scene.")
      .def(py::init([](const Scene& scene, int threads, const Options& options) {
             return std::make_unique<BatchData>(scene, checked_threads(threads), options);
           }),
           py::arg("scene"), py::arg("threads") = 0, py::arg_v("options", Options(), "Options()"),
           "threads: 0, as many as OpenMP would take.")
      .def_readwrite("options", &BatchData::options)
      .def_property(
          "active", [](const BatchData& b) { return std::vector<bool>(b.active.begin(), b.active.end()); },
          [](BatchData& b, py::handle values) { set_flags("BatchData.active", values, b.active); },
          "A list of bools, one per contact; a copy: assign the whole list.");
  const char* const states =
      "\n\nQ: (n, nq), V: (n, nv), U: (n, nu), one state per row. status: int8 (n), int(Status). States that fail,\n"
      "those with numbers that are not finite too, are NaN; the others are solved all the same. Bit by bit the "
      "numbers\n"
      "of solve, for any number of threads.";
  m.def(
      "solve_batch",
      [](const Scene& scene, py::object Q, py::object V, py::object U, BatchData& batch) {
        return batch_of_solutions(scene, Q, V, U, batch, false);
      },
      py::arg("scene"), py::arg("Q"), py::arg("V"), py::arg("U"), py::arg("batch"),
      (std::string("(A, F, status): accelerations (n, nv) and forces (n, rows) of many states.") + states).c_str());
  m.def(
      "differentiate_batch",
      [](const Scene& scene, py::object Q, py::object V, py::object U, BatchData& batch) {
        return batch_of_solutions(scene, Q, V, U, batch, true);
      },
      py::arg("scene"), py::arg("Q"), py::arg("V"), py::arg("U"), py::arg("batch"),
      (std::string("(A, F, D, status): with derivatives D (n, nv + rows, 2 nv + nu) of [a; f] by [q v u].") + states)
          .c_str());
  m.def(
      "vjp_batch",
      [](const Scene& scene, py::object Q, py::object V, py::object U, py::object WA, py::object WF, BatchData& batch) {
        return batch_of_products(scene, Q, V, U, WA, WF, batch);
      },
      py::arg("scene"), py::arg("Q"), py::arg("V"), py::arg("U"), py::arg("WA"), py::arg("WF"), py::arg("batch"),
      (std::string("(WQ, WV, WU, status): rows of WA (n, nv), WF (n, rows) times the derivatives at each state.") +
       states)
          .c_str());
}

}  // namespace

py::object scipy_csc(Eigen::SparseMatrix<double>&& given) {
  auto* A = new Eigen::SparseMatrix<double>(std::move(given));
  const py::capsule owner(A, [](void* p) { delete static_cast<Eigen::SparseMatrix<double>*>(p); });
  const py::array values = view(A->valuePtr(), {A->nonZeros()}, {1}, owner, true);
  const py::array_t<int> rows(A->nonZeros(), A->innerIndexPtr(), owner);
  const py::array_t<int> columns(A->outerSize() + 1, A->outerIndexPtr(), owner);
  return py::module_::import("scipy.sparse")
      .attr("csc_matrix")(py::make_tuple(values, rows, columns),
                          py::arg("shape") = py::make_tuple(A->rows(), A->cols()), py::arg("copy") = false);
}

Options options_of(py::handle method, py::handle order, py::handle lanes) {
  Options options;
  options.method = value_or_name<Method>(method, method_from_string, "method");
  if (!order.is_none()) options.order = value_or_name<Order>(order, order_from_string, "order");
  options.lanes = value_or_name<Lanes>(lanes, lanes_from_string, "lanes");
  return options;
}

void add_dynamics(py::module_& m) {
  add_enumerations(m);
  add_reports(m);
  add_data(m);
  add_derivative_classes(m);
  add_derivatives(m);
  add_views(m);
  add_batches(m);
}

}  // namespace manycontact::python
