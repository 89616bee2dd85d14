#pragma once
// Motions and contact rows at the solution's accelerations. Derivatives, their products with vectors and quasi-static
// torques are computed from them.

#include "manycontact/contact/products.hpp"
#include "manycontact/detail/algorithm/rnea_derivatives.hpp"
#include "manycontact/detail/contact/derivatives.hpp"
#include "manycontact/detail/kkt/island.hpp"
#include "manycontact/dynamics/data.hpp"

namespace manycontact {

struct Workspace;

/// Memory of each of a scene's robots or contacts that an island needed; SIMD batches have their own.
template <class T>
class OnDemand {
 public:
  explicit OnDemand(std::size_t count) : made_(count) {}
  T& operator[](std::size_t k) { return *made_[k]; }
  const T& operator[](std::size_t k) const { return *made_[k]; }
  bool has(std::size_t k) const { return made_.at(k) != nullptr; }
  template <class... Args>
  void make(std::size_t k, Args&&... args) {
    made_[k] = std::make_unique<T>(std::forward<Args>(args)...);
  }

 private:
  std::vector<std::unique_ptr<T>> made_;
};

/// Robots of one model take turns in the places of a pool, the islands of a thread being linearised one after the
/// other, so that these stay in the cache.
struct Linearisation {
  explicit Linearisation(const Scene& scene);

  struct Slot {
    explicit Slot(const Model& model);
    std::vector<Vec6<double>> a;     // njoints: set by AtSolution, in exchange with kin.a
    RneaDerivatives rnea;            // set by right_hand_sides
    std::vector<Vec6<double>> fext;  // njoints: contact forces, tree frame; set by right_hand_sides
  };
  std::vector<Slot> pool;
  std::vector<int> place;  // one entry per robot
  Slot& of(int robot) { return pool[place[robot]]; }
  const Slot& of(int robot) const { return pool[place[robot]]; }

  OnDemand<ContactData<double>> contacts;    // contacts' terms at the solution; set by AtSolution
  OnDemand<ContactDerivatives> derivatives;  // set by right_hand_sides
  std::vector<std::uint64_t> state;          // one entry per contact: the Workspace::state that these terms belong to

  /// Gives the robots of an island places of their own, and its contacts memory, the first time since islands changed.
  /// By the thread that calls, before others come to these islands. Joint-space terms of the island must be there.
  void assign(const Scene& scene, const Workspace& work, const Island& island);
  /// Islands change.
  void forget_places() { std::fill(place.begin(), place.end(), -1); }

 private:
  std::vector<int> model;  // one entry per robot: number of its model
  std::size_t models = 0;
  std::vector<std::vector<int>> of_model;  // one list per thread and model: its places in the pool
  std::vector<int> used;                   // one entry per model: places taken by the current island
};

/// During its lifetime, kin.a of an island's robots are the accelerations of the solution, and the linearisation's
/// contacts are evaluated at them.
class AtSolution {
 public:
  AtSolution(const Scene& scene, SceneData& data, const Island& island);
  ~AtSolution();
  AtSolution(const AtSolution&) = delete;

 private:
  void exchange();
  Workspace& work_;
  const Island& island_;
};

namespace internal {

/// The linearisation, made when first needed and fit for the current islands.
Linearisation& linearisation_of(const Scene& scene, SceneData& data);

/// Forces of an island's contacts on its robots' bodies, in their tree frames, into fext(robot)[joint]. contacts: per
/// contact of the scene, evaluated. f: of the scene.
template <class Contacts, class Fext>
void contact_forces(const Scene& scene, const Island& island, const Contacts& contacts,
                    const std::vector<int>& f_offset, const Eigen::VectorXd& f, Fext&& fext) {
  for (int r : island.robots) std::fill(fext(r).begin(), fext(r).end(), Vec6<double>(Vec6<double>::Zero()));
  for (int c : island.contacts) {
    const Contact& contact = scene.contacts[c];
    const ContactData<double>& rows = contacts[c];
    const Vec6<double> F = rows.W.transpose() * f.segment(f_offset[c], contact.rows());
    each_body_force(contact, rows, F,
                    [&](const Attachment& at, const Vec6<double>& force) { fext(at.robot)[at.joint] += force; });
  }
}

}  // namespace internal

}  // namespace manycontact
