// Derivatives and products with them.

#include "docs/derivatives.hpp"

#include <optional>

#include "data.hpp"
#include "docs/solve.hpp"
#include "manycontact/dynamics/differentiate.hpp"
#include "manycontact/dynamics/jvp.hpp"
#include "manycontact/dynamics/views.hpp"

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
    const Eigen::SparseMatrix<double> K = matrix_of(d, i);
    const Island& at = island_of(d, i);
    std::vector<int> place(at.size());  // positions of the island's [a; f] in the matrix
    for (int k = 0; k < at.size(); ++k) place[k] = k;
    if (island < 0) {
      each_velocity_block(scene, at, [&](int first, int local, int n) {
        for (int k = 0; k < n; ++k) place[local + k] = first + k;
      });
      each_force_block(scene, d.f_offset, at, [&](int first, int local, int n) {
        for (int k = 0; k < n; ++k) place[at.nv + local + k] = scene.nv + first + k;
      });
    }
    for (int j = 0; j < K.cols(); ++j)
      for (Eigen::SparseMatrix<double>::InnerIterator entry(K, j); entry; ++entry) {
        rows.push_back(place[entry.row()]);
        columns.push_back(place[j]);
        values.push_back(entry.value());
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
  py::class_<DerivativeRequest> request(
      m, "DerivativeRequest",
      "The variables to differentiate with respect to. Columns that are not requested cost nothing.");
  add_value(request)
      .def(py::init([](bool q, bool v, bool u, bool forces, bool tau, bool pushes) {
             return DerivativeRequest{q, v, u, forces, tau, pushes};
           }),
           py::kw_only(), py::arg("q") = true, py::arg("v") = true, py::arg("u") = true, py::arg("forces") = true,
           py::arg("tau") = false, py::arg("pushes") = false, "Make a request; see the attributes.")
      .def_readwrite("q", &DerivativeRequest::q, "Whether to differentiate with respect to q.")
      .def_readwrite("v", &DerivativeRequest::v, "Whether to differentiate with respect to v.")
      .def_readwrite("u", &DerivativeRequest::u, "Whether to differentiate with respect to u.")
      .def_readwrite("forces", &DerivativeRequest::forces, "Whether to compute dforces_*.")
      .def_readwrite("tau", &DerivativeRequest::tau,
                     "Whether u means the torques of all nv coordinates instead of the nu actuated ones.")
      .def_readwrite("pushes", &DerivativeRequest::pushes,
                     "Whether to differentiate with respect to the wrenches of pushes.");

  py::class_<IslandBlocks>(
      m, "IslandDerivatives",
      "Derivatives of one island, in its order: robots ascending, contacts ascending (see island_of).\n"
      "\n"
      "The arrays share the library's memory; they keep their numbers when the scene is solved and\n"
      "differentiated again.\n"
      "Reading an attribute raises ValueError if the scene was solved again but not differentiated.")
      .def_property_readonly("da_dq", block_property(&IslandDerivatives::da_dq),
                             "Derivative of the accelerations with respect to q (nv, nv), on the tangent space.")
      .def_property_readonly("da_dv", block_property(&IslandDerivatives::da_dv),
                             "Derivative of the accelerations with respect to v (nv, nv).")
      .def_property_readonly("da_du", block_property(&IslandDerivatives::da_du),
                             "Derivative of the accelerations with respect to u (nv, nu).")
      .def_property_readonly("dforces_dq", block_property(&IslandDerivatives::dforces_dq),
                             "Derivative of the contact forces with respect to q (nc, nv), on the tangent space.")
      .def_property_readonly("dforces_dv", block_property(&IslandDerivatives::dforces_dv),
                             "Derivative of the contact forces with respect to v (nc, nv).")
      .def_property_readonly("dforces_du", block_property(&IslandDerivatives::dforces_du),
                             "Derivative of the contact forces with respect to u (nc, nu).")
      .def_property_readonly(
          "da_dw", [](const IslandBlocks& b) { return read_only(copy(b.get().da_dw())); },
          "Derivative of the accelerations with respect to the wrenches of `pushes` (nv, 6 per push), if requested;\n"
          "a copy.")
      .def_property_readonly(
          "dforces_dw", [](const IslandBlocks& b) { return read_only(copy(b.get().dforces_dw())); },
          "Derivative of the contact forces with respect to the wrenches of `pushes` (nc, 6 per push), if requested;\n"
          "a copy.")
      .def_property_readonly(
          "pushes", [](const IslandBlocks& b) { return b.get().pushes; },
          "Numbers of the scene's pushes on the island's robots, if requested.")
      .def_property_readonly(
          "nv", [](const IslandBlocks& b) { return b.get().nv; }, "Number of velocity coordinates.")
      .def_property_readonly(
          "nc", [](const IslandBlocks& b) { return b.get().nc; }, "Number of constraint rows.")
      .def_property_readonly(
          "nu", [](const IslandBlocks& b) { return b.get().nu; }, "Number of actuated coordinates of the island.");

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
  py::class_<Derivatives>(m, "DerivativeData", "The result of differentiate: blocks per island.")
      .def_property_readonly(
          "islands", [](const Derivatives& x) { return Islands{{x.data}}; },
          "One IslandDerivatives per island of the report.");

  py::class_<DerivativeBounds> bounds(
      m, "DerivativeBounds",
      "Bounds of the largest errors of an island's derivatives, each relative to the largest entry of its\n"
      "matrix.\n"
      "\n"
      "A bound is above 1 if all entries may be rounding errors, and inf if no bound is known.");
  bounds.def_readonly("da_dq", &DerivativeBounds::da_dq, "Bound for da_dq.")
      .def_readonly("da_dv", &DerivativeBounds::da_dv, "Bound for da_dv.")
      .def_readonly("da_du", &DerivativeBounds::da_du, "Bound for da_du.")
      .def_readonly("dforces_dq", &DerivativeBounds::dforces_dq, "Bound for dforces_dq.")
      .def_readonly("dforces_dv", &DerivativeBounds::dforces_dv, "Bound for dforces_dv.")
      .def_readonly("dforces_du", &DerivativeBounds::dforces_du, "Bound for dforces_du.")
      .def_readonly("da_dw", &DerivativeBounds::da_dw, "Bound for da_dw.")
      .def_readonly("dforces_dw", &DerivativeBounds::dforces_dw, "Bound for dforces_dw.");

  py::class_<SceneDerivatives, std::shared_ptr<SceneDerivatives>> dense(
      m, "SceneDerivatives", "The derivatives of the whole scene, in the order of its v, u and of data.f.");
  member_view(dense, "da_dq", &SceneDerivatives::da_dq, "Derivative of the accelerations with respect to q (nv, nv).");
  member_view(dense, "da_dv", &SceneDerivatives::da_dv, "Derivative of the accelerations with respect to v (nv, nv).");
  member_view(dense, "da_du", &SceneDerivatives::da_du, "Derivative of the accelerations with respect to u (nv, nu).");
  member_view(dense, "dforces_dq", &SceneDerivatives::dforces_dq,
              "Derivative of the contact forces with respect to q (rows of f, nv).");
  member_view(dense, "dforces_dv", &SceneDerivatives::dforces_dv,
              "Derivative of the contact forces with respect to v (rows of f, nv).");
  member_view(dense, "dforces_du", &SceneDerivatives::dforces_du,
              "Derivative of the contact forces with respect to u (rows of f, nu).");
  member_view(dense, "da_dw", &SceneDerivatives::da_dw,
              "Derivative of the accelerations with respect to wrenches of pushes (nv, 6 per push), if requested.");
  member_view(dense, "dforces_dw", &SceneDerivatives::dforces_dw,
              "Derivative of the contact forces with respect to wrenches of pushes (rows of f, 6 per push), if\n"
              "requested.");
}

void add_differentiate(py::module_& m) {
  m.def(
      "estimate_derivative_errors",
      [](const Scene& scene, const Data& data) {
        return data.use([&](SceneData& d) { return estimate_derivative_errors(scene, d); });
      },
      py::arg("scene"), py::arg("data"), doc::estimate_derivative_errors);
  m.def(
      "differentiate",
      [](const Scene& scene, const std::shared_ptr<Data>& data, const DerivativeRequest& request) {
        data->use([&](SceneData& d) { (void)differentiate(scene, d, request); });
        return Derivatives{data};
      },
      py::arg("scene"), py::arg("data").none(false), py::arg_v("request", DerivativeRequest(), "DerivativeRequest()"),
      doc::differentiate);
  m.def(
      "dense_derivatives",
      [](const Scene& scene, const Data& data) {
        return std::make_shared<SceneDerivatives>(data.use([&](SceneData& d) { return dense_derivatives(scene, d); }));
      },
      py::arg("scene"), py::arg("data"), doc::dense_derivatives);
  m.def(
      "sparse_derivatives",
      [](const Scene& scene, const Data& data) {
        return scipy_csc(data.use([&](SceneData& d) { return sparse_derivatives(scene, d); }));
      },
      py::arg("scene"), py::arg("data"), doc::sparse_derivatives);
  m.def(
      "release_derivatives", [](const Data& data) { data.use([](SceneData& d) { release_derivatives(d); }); },
      py::arg("data"), doc::release_derivatives);
  m.def("matrix_of", &kkt_matrix, py::arg("scene"), py::arg("data"), py::arg("island") = -1, doc::matrix_of);
  m.def(
      "jvp",
      [](const Scene& scene, const Data& data, const Vector& dq, const Vector& dv, const Vector& du,
         const std::optional<Vector>& dw) {
        Vector da(scene.nv), df(data.at_rest().f.size());
        data.use([&](SceneData& d) {
          if (dw)
            jvp(scene, d, dq, dv, du, *dw, da, df);
          else
            jvp(scene, d, dq, dv, du, da, df);
        });
        return std::make_pair(std::move(da), std::move(df));
      },
      py::arg("scene"), py::arg("data"), py::arg("dq"), py::arg("dv"), py::arg("du"), py::arg("dw") = py::none(),
      doc::jvp);
  m.def(
      "vjp",
      [](const Scene& scene, const Data& data, const Vector& wa, const Vector& wf) {
        Vector wq(scene.nv), wv(scene.nv), wu(scene.nu);
        data.use([&](SceneData& d) { vjp(scene, d, wa, wf, wq, wv, wu); });
        return std::make_tuple(std::move(wq), std::move(wv), std::move(wu));
      },
      py::arg("scene"), py::arg("data"), py::arg("wa"), py::arg("wf"), doc::vjp);
  m.def(
      "vjp_with_pushes",
      [](const Scene& scene, const Data& data, const Vector& wa, const Vector& wf) {
        Vector wq(scene.nv), wv(scene.nv), wu(scene.nu), ww(static_cast<Eigen::Index>(6 * scene.pushes.size()));
        data.use([&](SceneData& d) { vjp(scene, d, wa, wf, wq, wv, wu, ww); });
        return std::make_tuple(std::move(wq), std::move(wv), std::move(wu), std::move(ww));
      },
      py::arg("scene"), py::arg("data"), py::arg("wa"), py::arg("wf"), doc::vjp_with_pushes);
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

void add_derivatives(py::module_& m) {
  add_derivative_classes(m);
  add_differentiate(m);
}

}  // namespace manycontact::python
