// Derivatives and products: floor dynamics.

#include <optional>

#include "data.hpp"
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
  py::class_<DerivativeRequest> request(m, "DerivativeRequest",
                                        "What to compute; what is not asked for costs nothing.");
  add_value(request)
      .def(py::init([](bool q, bool v, bool u, bool forces, bool tau, bool pushes) {
             return DerivativeRequest{q, v, u, forces, tau, pushes};
           }),
           py::kw_only(), py::arg("q") = true, py::arg("v") = true, py::arg("u") = true, py::arg("forces") = true,
           py::arg("tau") = false, py::arg("pushes") = false,
           "forces: dforces_*. tau: da_du and dforces_du by the torques on all nv coordinates, not the nu actuated.\n"
           "pushes: da_dw and dforces_dw.")
      .def_readwrite("q", &DerivativeRequest::q)
      .def_readwrite("v", &DerivativeRequest::v)
      .def_readwrite("u", &DerivativeRequest::u)
      .def_readwrite("forces", &DerivativeRequest::forces)
      .def_readwrite("tau", &DerivativeRequest::tau)
      .def_readwrite("pushes", &DerivativeRequest::pushes);

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
      .def_property_readonly(
          "da_dw", [](const IslandBlocks& b) { return copy(b.get().da_dw()); },
          "(nv, 6 pushes) by the wrenches of `pushes`, where they were asked for; a copy.")
      .def_property_readonly(
          "dforces_dw", [](const IslandBlocks& b) { return copy(b.get().dforces_dw()); }, "(nc, 6 pushes); a copy.")
      .def_property_readonly(
          "pushes", [](const IslandBlocks& b) { return b.get().pushes; },
          "Numbers of the scene's pushes on the island's robots, where they were asked for.")
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

  py::class_<DerivativeBounds> bounds(m, "DerivativeBounds",
                                      "Bounds of the largest errors of an island's derivatives, each relative to the "
                                      "largest entry of its matrix: above\n"
                                      "1 where all of it is rounding, inf where there is no bound.");
  bounds.def_readonly("da_dq", &DerivativeBounds::da_dq)
      .def_readonly("da_dv", &DerivativeBounds::da_dv)
      .def_readonly("da_du", &DerivativeBounds::da_du)
      .def_readonly("dforces_dq", &DerivativeBounds::dforces_dq)
      .def_readonly("dforces_dv", &DerivativeBounds::dforces_dv)
      .def_readonly("dforces_du", &DerivativeBounds::dforces_du)
      .def_readonly("da_dw", &DerivativeBounds::da_dw)
      .def_readonly("dforces_dw", &DerivativeBounds::dforces_dw);

  py::class_<SceneDerivatives, std::shared_ptr<SceneDerivatives>> dense(
      m, "SceneDerivatives", "The scene's matrices, in the order of its v, u and of data.f.");
  member_view(dense, "da_dq", &SceneDerivatives::da_dq, "(nv, nv)");
  member_view(dense, "da_dv", &SceneDerivatives::da_dv, "(nv, nv)");
  member_view(dense, "da_du", &SceneDerivatives::da_du, "(nv, nu)");
  member_view(dense, "dforces_dq", &SceneDerivatives::dforces_dq, "(rows of f, nv)");
  member_view(dense, "dforces_dv", &SceneDerivatives::dforces_dv, "(rows of f, nv)");
  member_view(dense, "dforces_du", &SceneDerivatives::dforces_du, "(rows of f, nu)");
  member_view(dense, "da_dw", &SceneDerivatives::da_dw, "(nv, 6 pushes), where they were asked for");
  member_view(dense, "dforces_dw", &SceneDerivatives::dforces_dw, "(rows of f, 6 pushes)");
}

void add_differentiate(py::module_& m) {
  m.def(
      "estimate_derivative_errors",
      [](const Scene& scene, const Data& data) {
        return data.use([&](SceneData& d) { return estimate_derivative_errors(scene, d); });
      },
      py::arg("scene"), py::arg("data"),
      "After differentiate: bounds of the relative errors of each island's derivatives, by a few solves.");
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
      "After differentiate: one scipy.sparse.csc_matrix of the whole scene, rows [a; f], columns [q | v | u | w] "
      "(those\n"
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
      "(da, df) = the derivatives at the last solve times (dq, dv, du, dw), of nv, nv, nu and 6 numbers per push; da:\n"
      "(nv), df: (rows of f). No matrix is formed.");
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
  m.def(
      "vjp_with_pushes",
      [](const Scene& scene, const Data& data, const Vector& wa, const Vector& wf) {
        Vector wq(scene.nv), wv(scene.nv), wu(scene.nu), ww(static_cast<Eigen::Index>(6 * scene.pushes.size()));
        data.use([&](SceneData& d) { vjp(scene, d, wa, wf, wq, wv, wu, ww); });
        return std::make_tuple(std::move(wq), std::move(wv), std::move(wu), std::move(ww));
      },
      py::arg("scene"), py::arg("data"), py::arg("wa"), py::arg("wf"),
      "(wq, wv, wu, ww): vjp, and by the wrenches of the scene's pushes, 6 numbers each.");
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
