#pragma once
// Newton and Euler in the world's axes, one link after the other, in quadruple precision or with a derivative.

#include "case.hpp"
#include "quad.hpp"

namespace manycontact::attack {

template <class T>
struct Body {  // of a link: its frame, and how it moves, in the world's axes
  Rot<T> R;
  Vec<T> p, v, w, acceleration, turning;  // of its origin; the acceleration is the point's
};

/// q, v, a: a tree's; a nullptr: zero. acceleration is without gravity's.
template <class T>
std::vector<Body<T>> move(const Tree& tree, const T* q, const T* v, const T* a);

template <class T>
struct Wrench {  // force, and moment about the link's origin, in the world's axes
  Vec<T> force, moment;
};

/// A point of a link, which moves with it.
template <class T>
Body<T> point_of(const Body<T>& link, const Numbers& offset);

/// The force on each joint's coordinates that makes the tree move as it does against `on`, other wrenches on its links,
/// and gravity.
template <class T>
std::vector<T> joint_forces(const Tree& tree, const std::vector<Body<T>>& bodies, const Vec<T>& gravity,
                            const T* a, std::vector<Wrench<T>> on);

template <class T>
struct Touch {  // of a hold: how A moves as seen from B', at A's origin, in A's axes
  Rot<T> R;     // of A in the world
  Vec<T> p;
  Vec<T> v, w;              // nu
  Vec<T> linear, angular;   // the rows' accelerations with all their terms: J a + a0 is picked from these
  std::vector<std::array<Vec<T>, 2>> rows;  // what picks them, in A's axes
};
template <class T>
Touch<T> touch(const Case& c, const Hold& hold, const std::vector<std::vector<Body<T>>>& bodies);

}  // namespace manycontact::attack
