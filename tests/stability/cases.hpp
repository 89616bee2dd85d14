#pragma once
// The cases of the table: each has a cause (the difficulty of its scene), a robot and contacts.

#include <functional>
#include <string>
#include <vector>

#include "stability/problem.hpp"

namespace manycontact::test {

struct Case {
  std::string cause, name;
  std::function<Problem()> make;  // may throw the library's exceptions for bad input
  bool small = true;              // every method in every order; large cases: default orders, no dense reference
  bool bad_input = false;         // an exception when the scene is built counts as refused; otherwise it ends the test
  bool demanded = false;          // all methods but dense-schur must solve it, accelerations to 1e-9
};

struct Cases {
  std::string cause;
  std::vector<Case> list;

  Case& add(std::string name, std::function<Problem()> make) {
    return list.emplace_back(Case{cause, std::move(name), std::move(make)});
  }
};

void add_held_twice(Cases& cases);
void add_corners(Cases& cases);
void add_loops(Cases& cases);
void add_conflicts(Cases& cases);
void add_near(Cases& cases);
void add_straight_legs(Cases& cases);
void add_mass_ratios(Cases& cases);
void add_singular_inertias(Cases& cases);
void add_chains(Cases& cases);
void add_units(Cases& cases);
void add_velocities(Cases& cases);
void add_half_turns(Cases& cases);
void add_denormals(Cases& cases);
void add_not_finite(Cases& cases);
void add_damping(Cases& cases);
void add_quaternions(Cases& cases);

/// All causes, in the order of the page.
const std::vector<Cases>& all_causes();

/// Returns text such as "1e-04".
std::string power(double x);

}  // namespace manycontact::test
