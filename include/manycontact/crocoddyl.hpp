#pragma once
// This header is for programs written for Crocoddyl. It defines all names in a namespace `crocoddyl`, which programs
// may reopen or use. No header of this library includes this one.
//
// throw_pretty and its exception, stacks, and pseudoInverse behave as in Crocoddyl, not as in namespace manycontact.
// Stacks warn on std::cerr and continue if a name is added twice, or does not exist. Getters of action models return
// the stacks of namespace manycontact, which throw: declare variables for them with auto.

#include <Eigen/QR>
#include <exception>
#include <iostream>
#include <memory>
#include <sstream>
#include <string>

#include "manycontact/action.hpp"
#include "manycontact/crocoddyl/names.hpp"

#ifndef throw_pretty
#define throw_pretty(m)                                                                        \
  {                                                                                            \
    std::stringstream pretty_message;                                                          \
    pretty_message << m;                                                                       \
    throw crocoddyl::Exception(pretty_message.str(), __FILE__, __PRETTY_FUNCTION__, __LINE__); \
  }
#endif
#ifndef assert_pretty
#ifndef NDEBUG
#define assert_pretty(condition, m) \
  if (!(condition)) throw_pretty(m)
#else
#define assert_pretty(condition, m) ((void)0)
#endif
#endif

namespace crocoddyl {

using namespace names;  // not namespace manycontact, which has stacks of the same names

class Exception : public std::exception {  // thrown by throw_pretty
 public:
  Exception(const std::string& message, const char* file, const char* function, int line)
      : message_(message),
        place_(std::string("In ") + file + "\n" + function + " " + std::to_string(line)),
        what_(place_ + "\n" + message_) {}
  const char* what() const noexcept override { return what_.c_str(); }
  std::string getMessage() const { return message_; }
  std::string getExtraData() const { return place_; }

 private:
  std::string message_, place_, what_;
};

/// Returns the pseudoinverse of a matrix of any rank. Singular values below epsilon times the largest count as zero.
inline Eigen::MatrixXd pseudoInverse(const Eigen::MatrixXd& a) {
  return a.completeOrthogonalDecomposition().pseudoInverse();
}

namespace internal {

/// Returns whether a part of this name exists as `expected`; otherwise prints a warning.
template <class Parts>
bool expect_named(const Parts& parts, const std::string& name, bool expected, const char* act, const char* what) {
  if (parts.contains(name) == expected) return true;
  std::cerr << "Warning: we couldn't " << act << " the " << name << " " << what << " item, it "
            << (expected ? "doesn't exist." : "already existed.") << std::endl;
  return false;
}

}  // namespace internal

class CostModelSum : public manycontact::CostModelSum {
 public:
  using Base = manycontact::CostModelSum;
  using Base::Base;
  void addCost(const std::string& name, std::shared_ptr<CostModelAbstract> cost, double weight, bool active = true) {
    if (internal::expect_named(get_costs(), name, false, "add", "cost"))
      Base::addCost(name, std::move(cost), weight, active);
  }
  void removeCost(const std::string& name) {
    if (internal::expect_named(get_costs(), name, true, "remove", "cost")) Base::removeCost(name);
  }
  void changeCostStatus(const std::string& name, bool active) {
    if (internal::expect_named(get_costs(), name, true, "change the status of", "cost"))
      Base::changeCostStatus(name, active);
  }
  bool getCostStatus(const std::string& name) const {
    return internal::expect_named(get_costs(), name, true, "get the status of", "cost") && Base::getCostStatus(name);
  }
};

class ConstraintModelManager : public manycontact::ConstraintModelManager {
 public:
  using Base = manycontact::ConstraintModelManager;
  using Base::Base;
  void addConstraint(const std::string& name, std::shared_ptr<ConstraintModelAbstract> constraint, bool active = true) {
    if (internal::expect_named(get_constraints(), name, false, "add", "constraint"))
      Base::addConstraint(name, std::move(constraint), active);
  }
  void removeConstraint(const std::string& name) {
    if (internal::expect_named(get_constraints(), name, true, "remove", "constraint")) Base::removeConstraint(name);
  }
  void changeConstraintStatus(const std::string& name, bool active) {
    if (internal::expect_named(get_constraints(), name, true, "change the status of", "constraint"))
      Base::changeConstraintStatus(name, active);
  }
  bool getConstraintStatus(const std::string& name) const {
    return internal::expect_named(get_constraints(), name, true, "get the status of", "constraint") &&
           Base::getConstraintStatus(name);
  }
};

class ContactModelMultiple : public manycontact::ContactModelMultiple {
 public:
  using Base = manycontact::ContactModelMultiple;
  using Base::Base;
  void addContact(const std::string& name, std::shared_ptr<ContactModelAbstract> contact, bool active = true) {
    if (internal::expect_named(get_contacts(), name, false, "add", "contact"))
      Base::addContact(name, std::move(contact), active);
  }
  void removeContact(const std::string& name) {
    if (internal::expect_named(get_contacts(), name, true, "remove", "contact")) Base::removeContact(name);
  }
  void changeContactStatus(const std::string& name, bool active) {
    if (internal::expect_named(get_contacts(), name, true, "change the status of", "contact"))
      Base::changeContactStatus(name, active);
  }
  bool getContactStatus(const std::string& name) const {
    return internal::expect_named(get_contacts(), name, true, "get the status of", "contact") &&
           Base::getContactStatus(name);
  }
};

class ImpulseModelMultiple : public manycontact::ImpulseModelMultiple {
 public:
  using Base = manycontact::ImpulseModelMultiple;
  using Base::Base;
  void addImpulse(const std::string& name, std::shared_ptr<ImpulseModelAbstract> impulse, bool active = true) {
    if (internal::expect_named(get_impulses(), name, false, "add", "impulse"))
      Base::addImpulse(name, std::move(impulse), active);
  }
  void removeImpulse(const std::string& name) {
    if (internal::expect_named(get_impulses(), name, true, "remove", "impulse")) Base::removeImpulse(name);
  }
  void changeImpulseStatus(const std::string& name, bool active) {
    if (internal::expect_named(get_impulses(), name, true, "change the status of", "impulse"))
      Base::changeImpulseStatus(name, active);
  }
  bool getImpulseStatus(const std::string& name) const {
    return internal::expect_named(get_impulses(), name, true, "get the status of", "impulse") &&
           Base::getImpulseStatus(name);
  }
};

template <std::same_as<double> Scalar>
using CostModelSumTpl = CostModelSum;
template <std::same_as<double> Scalar>
using ConstraintModelManagerTpl = ConstraintModelManager;
template <std::same_as<double> Scalar>
using ContactModelMultipleTpl = ContactModelMultiple;
template <std::same_as<double> Scalar>
using ImpulseModelMultipleTpl = ImpulseModelMultiple;

}  // namespace crocoddyl

using crocoddyl::pseudoInverse;  // global, as in Crocoddyl
