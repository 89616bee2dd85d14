#pragma once
// SceneData in Python, for one thread at a time. Arrays of derivatives keep their numbers if SceneData changes.

#include <unordered_map>

#include "manycontact/dynamics/data.hpp"
#include "manycontact/dynamics/derivatives.hpp"
#include "objects.hpp"

namespace manycontact::python {

/// Keeps the memory alive that numpy arrays of an island's panel view: the SceneData, or, if these change, the panel.
struct PanelKeeper {
  std::shared_ptr<SceneData> data;
  AlignedPanel panel;
};

class Data {
 public:
  explicit Data(std::shared_ptr<SceneData> data) : data_(std::move(data)), state_(std::make_shared<State>()) {}

  /// Returns the data for reading, while the GIL is held. Throws ValueError if another thread works on them.
  SceneData& at_rest() const {
    if (state_->busy) throw_busy();
    return *data_;
  }

  /// Calls work(SceneData&) without the GIL. Before, numpy arrays of derivatives take over the memory that they view,
  /// and SceneData gets a copy.
  template <class Work>
  auto use(Work&& work) const {
    const Turn turn(*state_);
    if (!state_->exported.empty()) let_go_of_panels();
    const py::gil_scoped_release unlocked;
    return work(*data_);
  }

  /// Returns the result of contact_force. The scene is checked only in the first call after a solve.
  Eigen::VectorXd force_of(const Scene& scene, int contact) const;

  /// Returns an array that views a block of an island's panel.
  py::array export_block(const IslandDerivatives& island, const double* x, Eigen::Index rows, Eigen::Index cols) const;

 private:
  struct State {
    std::atomic<bool> busy = false;
    std::unordered_map<const IslandDerivatives*, std::weak_ptr<PanelKeeper>> exported;
    const Scene* checked_scene = nullptr;  // scene that force_of checked last
    std::uint64_t checked_serial = 0;      // serial number of the solve at this check
    std::vector<char> checked_active;      // flags of the contacts that were active at this check
  };
  struct Turn {
    explicit Turn(State& s) : state(s) {
      if (state.busy.exchange(true)) throw_busy();
    }
    ~Turn() { state.busy = false; }
    State& state;
  };
  [[noreturn]] static void throw_busy() {
    throw py::value_error("the data are in use by another thread: use separate SceneData in each thread");
  }
  void let_go_of_panels() const;

  std::shared_ptr<SceneData> data_;
  std::shared_ptr<State> state_;
};

/// Returns a function for Python that returns convert(f(scene, data)).
template <class F, class Convert = std::identity>
auto with_data(F f, Convert convert = {}) {
  return [=](const Scene& scene, const Data& data) {
    const auto work = [&](SceneData& d) { return f(scene, d); };
    if constexpr (std::is_void_v<decltype(data.use(work))>)
      data.use(work);
    else
      return convert(data.use(work));
  };
}
/// Returns a function for Python that returns convert(f(scene, q, data)).
template <class F, class Convert = std::identity>
auto at_solution(F f, Convert convert = {}) {
  return [=](const Scene& scene, const Raw& q, const Data& data) {
    const auto Q = checked("q", q, scene.nq);
    return convert(data.use([&](SceneData& d) { return f(scene, Q, d); }));
  };
}

}  // namespace manycontact::python
