#pragma once
// Python objects for C++ objects that are members of other objects, such as scene.contacts[0], scene.contacts[0].B and
// data.options. Each is a Handle, which looks the object up in its owner and assigns it there, so that assigning to
// `scene.contacts[0].alpha` changes the scene. Invalid assignments raise. A Handle without an owner, as Contact() of
// Python, contains its object.

#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <functional>
#include <memory>
#include <string>
#include <type_traits>

#include "arrays.hpp"
#include "bind.hpp"
#include "manycontact/action/thrusters.hpp"
#include "manycontact/kkt/options.hpp"
#include "manycontact/model/scene.hpp"
#include "manycontact/simulation/step.hpp"

namespace manycontact::python {

template <class T>
class Handle {
 public:
  using Find = std::function<const T&()>;
  using Set = std::function<void(T)>;

  explicit Handle(T own) {
    const auto held = std::make_shared<T>(std::move(own));
    find_ = [held]() -> const T& { return *held; };
    set_ = [held](T x) { *held = std::move(x); };
  }
  /// find() looks the object up. set(value) checks and assigns a new value, and throws if it is invalid.
  Handle(Find find, Set set) : find_(std::move(find)), set_(std::move(set)) {}

  const T& get() const { return find_(); }
  /// Calls change(T&) on a copy of the object, and assigns the copy.
  template <class Change>
  void change(Change&& change) const {
    T changed = get();
    change(changed);
    set_(std::move(changed));
  }

 private:
  Find find_;
  Set set_;
};

/// Converts between a T in C++ and a Handle in Python.
template <class T>
struct HandleCaster {
  PYBIND11_TYPE_CASTER(T, py::detail::const_name<Handle<T>>());
  bool load(py::handle source, bool convert) {
    py::detail::make_caster<Handle<T>> handle;
    if (!source || source.is_none() || !handle.load(source, convert)) return false;
    value = py::detail::cast_op<Handle<T>&>(handle).get();
    return true;
  }
  static py::handle cast(const T& x, py::return_value_policy, py::handle parent) {
    return py::detail::make_caster<Handle<T>>::cast(Handle<T>(x), py::return_value_policy::move, parent);
  }
};

template <class M>
inline constexpr bool is_handled = std::is_base_of_v<HandleCaster<M>, py::detail::type_caster<M>>;

/// Adds a member as a property. If the member has attributes itself, the property is a Handle.
template <class T, class M>
void handle_field(Class<Handle<T>>& c, const char* name, M T::*member) {
  const auto set = [member](const Handle<T>& h, M x) { h.change([&](T& object) { object.*member = std::move(x); }); };
  if constexpr (is_handled<M>)
    c.template handle<Handle<T>>(
        name, [member](const Handle<T>& h) -> const M& { return h.get().*member; }, set);
  else
    c.property(
        name, [member](const Handle<T>& h) { return M(h.get().*member); }, set);
}

/// A list of an object's items that is not a copy, because each item is looked up when it is requested.
template <class Item>
struct Items {
  std::function<std::size_t()> size;
  std::function<Item(std::size_t)> at;
  std::function<int(const std::string&)> number = {};        // index of the item with this name, or -1
  std::function<std::string(const std::string&)> none = {};  // message for an unknown name
};

template <class Item>
void add_items(py::module_& m, const char* name, bool named = true) {
  using List = Items<Item>;
  Class<List> c(m, name);
  const auto at = [](const List& x, py::ssize_t i) {
    const auto n = static_cast<py::ssize_t>(x.size());
    if (i < -n || i >= n) throw py::index_error("there are " + std::to_string(n) + " items");
    return x.at(static_cast<std::size_t>(i < 0 ? i + n : i));
  };
  const auto part = [](const List& x, const py::slice& slice) {
    std::size_t start = 0, stop = 0, step = 0, count = 0;
    if (!slice.compute(x.size(), &start, &stop, &step, &count)) throw py::error_already_set();
    std::vector<Item> items;
    for (std::size_t k = 0; k < count; ++k, start += step) items.push_back(x.at(start));
    return items;
  };
  c.def("__len__", [](const List& x) { return x.size(); })
      .def("__getitem__", at, py::arg("number"))
      .def("__getitem__", part, py::arg("numbers"))
      .def("__iter__", [](const List& x) {
        py::list items;
        for (std::size_t k = 0; k < x.size(); ++k) items.append(py::cast(x.at(k)));
        return py::iter(items);
      });
  if (!named) return;
  const auto called = [](const List& x, const std::string& item) {
    const int k = x.number(item);
    if (k < 0) throw py::value_error(x.none(item));
    return x.at(static_cast<std::size_t>(k));
  };
  const auto contains = [](const List& x, const std::string& item) { return x.number(item) >= 0; };
  c.def("__getitem__", called, py::arg("name")).def("__contains__", contains, py::arg("name"));
}

}  // namespace manycontact::python

#define MANYCONTACT_HANDLE(T)                                      \
  namespace pybind11::detail {                                     \
  template <>                                                      \
  struct type_caster<T> : manycontact::python::HandleCaster<T> {}; \
  }
MANYCONTACT_HANDLE(manycontact::Contact)
MANYCONTACT_HANDLE(manycontact::Attachment)
MANYCONTACT_HANDLE(manycontact::ExternalWrench)
MANYCONTACT_HANDLE(manycontact::Robot)
MANYCONTACT_HANDLE(manycontact::Spring)
MANYCONTACT_HANDLE(manycontact::Options)
MANYCONTACT_HANDLE(manycontact::PdLaws)
MANYCONTACT_HANDLE(manycontact::Thruster)
#undef MANYCONTACT_HANDLE
