#include <optional>

#include "data.hpp"
#include "manycontact/dynamics/differentiate.hpp"
#include "manycontact/dynamics/jvp.hpp"
#include "manycontact/dynamics/views.hpp"

namespace manycontact::python {

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
    // The keeper then owns the memory that the arrays view.
    keeper->panel.swap(X);
    keeper->data.reset();
  }
  state_->exported.clear();
}

namespace {

// The results of the last differentiate, looked up in `data` at each access. IslandBlocks are those of one island.
struct Derivatives {
  std::shared_ptr<Data> data;
  const DerivativeData& get() const { return derivatives(data->at_rest()); }
};
struct IslandBlocks {
  std::shared_ptr<Data> data;
  std::size_t island;
  const IslandDerivatives& get() const {
    const DerivativeData& d = derivatives(data->at_rest());
    if (island >= d.islands.size())
      throw py::value_error("derivatives of an island: the island no longer exists, get the derivatives again");
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

// Returns the KKT matrix K of one island, or of the whole scene if island is -1.
Eigen::SparseMatrix<double> joined_kkt_matrix(const Scene& scene, const SceneData& d, int island) {
  const auto count = static_cast<int>(island_count(d));
  if (island < -1 || island >= count)
    throw py::value_error("kkt_matrix: there is no island " + std::to_string(island) + ", the scene has " +
                          std::to_string(count) + " islands");
  std::vector<Eigen::Triplet<double>> entries;
  int size = 0;
  for (int i = std::max(0, island); i < (island < 0 ? count : island + 1); ++i) {
    const Eigen::SparseMatrix<double> K = kkt_matrix(scene, d, i);
    const Island& at = solved_island(d, i);
    std::vector<int> place(at.size());  // rows of the entries of the island's [a; f] in the returned matrix
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
      for (Eigen::SparseMatrix<double>::InnerIterator entry(K, j); entry; ++entry)
        entries.emplace_back(place[entry.row()], place[j], entry.value());
    size += at.size();
  }
  Eigen::SparseMatrix<double> whole(size, size);
  whole.setFromTriplets(entries.begin(), entries.end());
  return whole;
}

void add_derivative_classes(py::module_& m) {
  value<DerivativeRequest>(m)
      .from_members<bool, bool, bool, bool, bool, bool>()
      .write<&DerivativeRequest::q, &DerivativeRequest::v, &DerivativeRequest::u, &DerivativeRequest::forces,
             &DerivativeRequest::tau, &DerivativeRequest::wrenches>();

  using D = IslandDerivatives;
  const auto get = [](const IslandBlocks& b) -> const D& { return b.get(); };
  Class<IslandBlocks>(m, "IslandDerivatives")
      .read(
          "da_dq", block_property(&D::da_dq), "da_dv", block_property(&D::da_dv), "da_du", block_property(&D::da_du),
          "dforces_dq", block_property(&D::dforces_dq), "dforces_dv", block_property(&D::dforces_dv), "dforces_du",
          block_property(&D::dforces_du), "da_dw",
          [](const IslandBlocks& b) { return read_only(copy(b.get().da_dw())); }, "dforces_dw",
          [](const IslandBlocks& b) { return read_only(copy(b.get().dforces_dw())); })
      .read_at<&D::wrenches, &D::nv, &D::nc, &D::nu>(get);

  struct Islands : Derivatives {};
  Class<Islands>(m, "IslandDerivativesList")
      .def("__len__", [](const Islands& x) { return x.get().islands.size(); })
      .def("__getitem__", [](const Islands& x, py::ssize_t i) {
        const auto n = static_cast<py::ssize_t>(x.get().islands.size());
        if (i < -n || i >= n) throw py::index_error("there are " + std::to_string(n) + " islands");
        return IslandBlocks{x.data, static_cast<std::size_t>(i < 0 ? i + n : i)};
      });
  Class<Derivatives>(m, "DerivativeData").read("islands", [](const Derivatives& x) { return Islands{{x.data}}; });

  using B = DerivativeBounds;
  Class<B>(m)
      .read<&B::da_dq, &B::da_dv, &B::da_du, &B::dforces_dq, &B::dforces_dv, &B::dforces_du, &B::da_dw,
            &B::dforces_dw>();
  using S = SceneDerivatives;
  shared<S>(m)
      .views<&S::da_dq, &S::da_dv, &S::da_du, &S::dforces_dq, &S::dforces_dv, &S::dforces_du, &S::da_dw,
             &S::dforces_dw>();
}

void add_differentiate(py::module_& m) {
  def(m, "estimate_derivative_errors", with_data(&estimate_derivative_errors));
  def(m, "differentiate", [](const Scene& scene, const std::shared_ptr<Data>& data, const DerivativeRequest& request) {
    data->use([&](SceneData& d) { (void)differentiate(scene, d, request); });
    return Derivatives{data};
  });
  def(m, "dense_derivatives", with_data(&dense_derivatives, [](SceneDerivatives d) {
        return std::make_shared<SceneDerivatives>(std::move(d));
      }));
  def(m, "sparse_derivatives", with_data(&sparse_derivatives, scipy_csc));
  def(m, "release_derivatives", [](const Data& data) { data.use([](SceneData& d) { release_derivatives(d); }); });
  def(m, "kkt_matrix", [](const Scene& scene, const Data& data, int island) {
    return scipy_csc(data.use([&](const SceneData& d) { return joined_kkt_matrix(scene, d, island); }));
  });
  def(m, "jvp",
      [](const Scene& scene, const Data& data, const Vector& dq, const Vector& dv, const Vector& du,
         const std::optional<Vector>& dw) {
        Vector da(scene.nv), df(data.at_rest().f.size());
        data.use(
            [&](SceneData& d) { dw ? jvp(scene, d, dq, dv, du, *dw, da, df) : jvp(scene, d, dq, dv, du, da, df); });
        return std::make_pair(std::move(da), std::move(df));
      });
  def(m, "vjp", [](const Scene& scene, const Data& data, const Vector& wa, const Vector& wf) {
    Vector wq(scene.nv), wv(scene.nv), wu(scene.nu);
    data.use([&](SceneData& d) { vjp(scene, d, wa, wf, wq, wv, wu); });
    return std::make_tuple(std::move(wq), std::move(wv), std::move(wu));
  });
  def(m, "vjp_with_wrenches", [](const Scene& scene, const Data& data, const Vector& wa, const Vector& wf) {
    Vector wq(scene.nv), wv(scene.nv), wu(scene.nu), ww(static_cast<Eigen::Index>(6 * scene.wrenches.size()));
    data.use([&](SceneData& d) { vjp(scene, d, wa, wf, wq, wv, wu, ww); });
    return std::make_tuple(std::move(wq), std::move(wv), std::move(wu), std::move(ww));
  });
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
