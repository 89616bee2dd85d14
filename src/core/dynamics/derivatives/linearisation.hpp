#pragma once
// Motions of bodies and contact rows at the solution's accelerations, for derivatives, products and static torques.

#include "manycontact/contact/products.hpp"
#include "manycontact/detail/algorithm/rnea_derivatives.hpp"
#include "manycontact/detail/contact/derivatives.hpp"
#include "manycontact/detail/kkt/island.hpp"
#include "manycontact/dynamics/data.hpp"

namespace manycontact {

struct Workspace;

template <class T>
class OnDemand {  // one object per robot or contact, allocated when an island outside SIMD batches needs it
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

/// Terms for derivatives at the solution. Robots of one model share pool slots: a thread processes an island at a time.
struct Linearisation {
  explicit Linearisation(const Scene& scene);

  struct Slot {
    explicit Slot(const Model& model);
    std::vector<Vec6<double>> a;     // njoints: kin.a's bias accelerations while an AtSolution exists
    RneaDerivatives rnea;            // set by right_hand_sides
    std::vector<Vec6<double>> fext;  // njoints: contact forces, tree frame; set by right_hand_sides
  };
  std::vector<Slot> pool;
  std::vector<int> place;  // slot of each robot in the pool; -1: none
  Slot& of(int robot) { return pool[place[robot]]; }
  const Slot& of(int robot) const { return pool[place[robot]]; }

  OnDemand<ContactData<double>> contacts;    // constraint rows at the solution; set by AtSolution
  OnDemand<ContactDerivatives> derivatives;  // set by right_hand_sides
  std::vector<std::uint64_t> state;          // one entry per contact: Workspace::state at which `contacts` was set

  /// Assigns slots to robots and allocates contacts. Call it after make_joint_space, before threads start.
  void assign(const Scene& scene, const Workspace& work, const Island& island);
  void forget_places() { std::fill(place.begin(), place.end(), -1); }  // call it when islands change

 private:
  std::vector<int> model;  // the number of each robot's model
  std::size_t models = 0;
  std::vector<std::vector<int>> of_model;  // slots in the pool, one list per thread and model
  std::vector<int> used;                   // number of slots that the current island uses, one entry per model
};

/// While this object exists, kin.a of an island's robots and Linearisation::contacts have the solution's accelerations.
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

Linearisation& linearisation_of(const Scene& scene, SceneData& data);  // constructed at the first call

/// Writes contact forces on an island's bodies, in tree frames, into fext(robot)[joint]. contacts: evaluated rows.
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
