#pragma once
// Binds classes and functions. Their docstrings, and the names and default values of parameters, are in docs/*.txt.
//   shared<Joint>(m).read<&Joint::name, &Joint::type>().read("mass", &mass_of);
//   functions<&velocity_names>(m);
// Classes and members have their C++ names in Python, unless another name is given.

#include <functional>
#include <memory>
#include <tuple>
#include <type_traits>
#include <utility>

#include "texts.hpp"

namespace manycontact::python {

using Unlocked = py::call_guard<py::gil_scoped_release>;  // lets Python run in other threads during a call

/// Calls `each` for consecutive groups of N arguments. For N = 2 and a, b, c, d, these are each(a, b) and each(c, d).
template <std::size_t N, class Each, class... Given>
void in_groups(Each&& each, const Given&... given) {
  static_assert(sizeof...(Given) % N == 0);
  const auto all = std::tie(given...);
  const auto group = [&]<std::size_t First, std::size_t... K>(std::index_sequence<K...>) {
    each(std::get<First + K>(all)...);
  };
  [&]<std::size_t... Group>(std::index_sequence<Group...>) {
    (group.template operator()<N * Group>(std::make_index_sequence<N>()), ...);
  }
  (std::make_index_sequence<sizeof...(Given) / N>());
}

template <class T>
class Handle;  // defined in handle.hpp

/// Accesses the C++ value in an object of a Python class. For most classes the object itself is the value.
template <class Held>
struct ValueOf {
  using Type = Held;
  static const Held& get(const Held& x) { return x; }
  static Held make(Held x) { return x; }
};
template <class T>
struct ValueOf<Handle<T>> {
  using Type = T;
  static const T& get(const Handle<T>& x) { return x.get(); }
  static Handle<T> make(T x) { return Handle<T>(std::move(x)); }
};

/// Returns the Python name of a member, method or function, which is its C++ name without the prefix get_ of Crocoddyl.
template <auto member>
std::string python_name_of() {
  std::string name = name_of<member>();
  if (std::is_member_function_pointer_v<decltype(member)> && name.starts_with("get_")) name.erase(0, 4);
  return name;
}

/// Defines a Python class. Each of its members and methods has an entry in docs/*.txt.
template <class T, class... Options>
class Class {
 public:
  using type = T;

  template <class... Extra>
  Class(py::module_& m, const std::string& name, const Extra&... extra)
      : name_(name), class_(m, name.c_str(), text_of(name).doc, extra...) {}
  explicit Class(py::module_& m) : Class(m, type_name<T>()) {}

  template <class F, class... Extra>
  Class& def(const char* name, F&& f, const Extra&... extra) {
    class_.def(name, std::forward<F>(f), Described{text(name)}, extra...);
    return *this;
  }
  template <class F, class... Extra>
  Class& def_static(const char* name, F&& f, const Extra&... extra) {
    class_.def_static(name, std::forward<F>(f), Described{text(name)}, extra...);
    return *this;
  }
  /// Adds a constructor, given as py::init<...>() or py::init(function).
  template <class Init, class... Extra>
  requires(!std::is_convertible_v<Init, const char*>) Class& def(Init&& init, const Extra&... extra) {
    class_.def(std::forward<Init>(init), Described{text("__init__")}, extra...);
    return *this;
  }
  /// Adds constructors, given by the types of their arguments, such as void(int, double).
  template <class... Signatures, class... Extra>
  Class& constructors(const Extra&... extra) {
    const auto add = [&]<class... Arguments>(void (*)(Arguments...)) { def(py::init<Arguments...>(), extra...); };
    (add(static_cast<Signatures*>(nullptr)), ...);
    return *this;
  }
  /// Adds methods, given as pairs: "name", &T::method, ...
  template <class... Given>
  Class& methods(Given... given) {
    in_groups<2>([this](const char* name, auto method) { def(name, method); }, given...);
    return *this;
  }
  template <auto... member>
  Class& methods() {
    (..., def(python_name_of<member>().c_str(), member));
    return *this;
  }
  /// Adds methods, given as pairs like those of `methods`, that let Python run in other threads.
  template <class... Given>
  Class& unlocked(Given... given) {
    in_groups<2>([this](const char* name, auto method) { def(name, method, Unlocked()); }, given...);
    return *this;
  }
  template <auto... member>
  Class& unlocked() {
    (..., def(python_name_of<member>().c_str(), member, Unlocked()));
    return *this;
  }
  /// Adds a constructor from the first members of a structure, which have the types Members.
  template <class... Members>
  Class& from_members() {
    return def(py::init(
        [](Members... members) { return ValueOf<T>::make(typename ValueOf<T>::Type{std::move(members)...}); }));
  }
  template <class Get, class Set>
  Class& pickle(Get&& get, Set&& set) {
    class_.def(py::pickle(std::forward<Get>(get), std::forward<Set>(set)));
    return *this;
  }

  /// Adds read-only attributes as pairs: "name", getter, ... A getter is a member, method or function of the object.
  template <class... Given>
  Class& read(Given... given) {
    in_groups<2>([this](const char* name, auto member) { read_one(name, member); }, given...);
    return *this;
  }
  template <auto... member>
  Class& read() {
    (..., read_one(python_name_of<member>(), member));
    return *this;
  }
  /// Adds members of the structure at(object) as read-only attributes. Python gets copies of them.
  template <auto... member, class At>
  Class& read_at(At at) {
    const auto add = [&](const std::string& name, auto m) {
      read_one(name, [at, m](const T& object) { return std::invoke(m, std::invoke(at, object)); });
    };
    (..., add(python_name_of<member>(), member));
    return *this;
  }
  /// Adds members that can be assigned in Python.
  template <auto... member>
  Class& write() {
    (..., class_.def_readwrite(name_of<member>().c_str(), member, text(name_of<member>()).doc));
    return *this;
  }
  /// Adds properties, given as triples: "name", get, set, ...
  template <class... Given>
  Class& property(Given... given) {
    in_groups<3>([this](const char* name, auto get, auto set) { property_one(name, get, set); }, given...);
    return *this;
  }
  template <auto get, auto set, auto... more>
  Class& property() {
    property_one(python_name_of<get>(), get, set);
    if constexpr (sizeof...(more) > 0) property<more...>();
    return *this;
  }
  /// Adds a property that is a Handle (an object with attributes). get(owner) reads it; set(owner, object) assigns it.
  template <class Owner, class Get, class Set>
  Class& handle(const char* name, Get get, Set set) {
    using Held = std::decay_t<decltype(get(std::declval<const Owner&>()))>;
    const auto found = [=](const Owner& owner) {
      return Handle<Held>([=]() -> const Held& { return get(owner); }, [=](Held x) { set(owner, std::move(x)); });
    };
    return property(name, found, [=](const Owner& owner, const Held& x) { set(owner, x); });
  }
  /// Adds matrices as numpy arrays that view their memory (view_property in objects.hpp).
  template <auto... member>
  Class& views() {
    (..., view_property(*this, name_of<member>().c_str(), member));
    return *this;
  }
  /// Adds members of an object that belongs to another object (handle_field in handle.hpp).
  template <auto... member>
  Class& fields() {
    (..., handle_field(*this, name_of<member>().c_str(), member));
    return *this;
  }

 private:
  // This is not inlined, so that all members of one type share one compiled function.
  template <class M>
  [[gnu::noinline]] void read_one(const std::string& name, M member) {
    if constexpr (std::is_member_object_pointer_v<M>)
      class_.def_readonly(name.c_str(), member, text(name).doc);
    else
      class_.def_property_readonly(name.c_str(), member, text(name).doc);
  }
  template <class Get, class Set>
  [[gnu::noinline]] void property_one(const std::string& name, Get get, Set set) {
    class_.def_property(name.c_str(), get, set, text(name).doc);
  }
  const Text& text(const std::string& member) const { return text_of(name_ + "." + member); }

  std::string name_;
  py::class_<T, Options...> class_;
};

/// Defines a class whose objects are shared by C++ and Python.
template <class T, class... Bases, class... Extra>
Class<T, Bases..., std::shared_ptr<T>> shared(py::module_& m, const std::string& name = type_name<T>(),
                                              const Extra&... extra) {
  return {m, name, extra...};
}

/// Adds a function of the module. `entry` is the key of its entry in docs/*.txt; `def` uses the function's name.
template <class F, class... Extra>
void def_as(py::module_& m, const char* name, const char* entry, F&& f, const Extra&... extra) {
  m.def(name, std::forward<F>(f), Described{text_of(entry)}, extra...);
}
template <class F, class... Extra>
void def(py::module_& m, const char* name, F&& f, const Extra&... extra) {
  def_as(m, name, name, std::forward<F>(f), extra...);
}
template <auto... function>
void functions(py::module_& m) {
  (..., def(m, name_of<function>().c_str(), function));
}

}  // namespace manycontact::python
