#pragma once
// `data.shared`: part of an action model that residuals and costs in Python can read in calc, calcDiff, createData.

#include "action.hpp"
#include "manycontact/action/state.hpp"
#include "manycontact/detail/action/collector.hpp"

namespace manycontact::python {

class Shared {
 public:
  Shared(DataCollector* collector, const StateMultibody& state) : collector_(collector), state_(state) {}
  void end() { collector_ = nullptr; }
  const DataCollector& get() const {
    if (!collector_) throw py::value_error("data.shared is available only while calc, calcDiff and createData run");
    return *collector_;
  }
  /// Returns the DataCollector, which createData of C++ classes takes as argument.
  DataCollector* collector() const {
    (void)get();
    return collector_;
  }
  const Multibody::BodyFrame& frame(std::size_t id) const {
    (void)get();
    if (id >= state_.get_model()->frames.size()) throw py::value_error("the state has no frame " + std::to_string(id));
    return state_.get_model()->frames[id];
  }

 private:
  DataCollector* collector_;
  const StateMultibody& state_;
};

class Scope {  // registers a call to Python in this thread during its lifetime, so that `data` can read their `shared`
 public:
  template <class Model, class Data>
  Scope(const Model& model, const Data& data) {
    begin(&data, std::make_shared<Shared>(data.shared, dynamic_cast<const StateMultibody&>(*model.get_state())));
  }
  ~Scope();
  Scope(const Scope&) = delete;
  /// Returns the Shared of the innermost running call that has these data. Raises ValueError if there is none.
  static std::shared_ptr<Shared> shared_of(const void* data);

 private:
  void begin(const void* data, std::shared_ptr<Shared> shared);
};

/// Returns the result of createData(self, shared) in Python, or null if the class has none. T is the registered class.
template <class T, class Data>
std::shared_ptr<Data> created_in_python(const T* model, DataCollector* collector) {
  const py::gil_scoped_acquire gil;
  const py::function own = py::get_override(model, "createData");
  if (!own) return nullptr;
  const auto shared = std::make_shared<Shared>(collector, dynamic_cast<const StateMultibody&>(*model->get_state()));
  struct End {
    Shared& shared;
    ~End() { shared.end(); }
  } const end{*shared};
  return made(own(shared).template cast<std::shared_ptr<Data>>());
}

}  // namespace manycontact::python
