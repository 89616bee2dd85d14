#pragma once
// Newton and Euler's equations in the world's axes, link after link, in quadruple precision or with a derivative.

#include "case.hpp"
#include "quad.hpp"

namespace manycontact::attack {

template <class T>
struct Body {  // frame and motion of a link, in the world's axes
  Rot<T> R;
  Vec<T> p, v, w, acceleration, turning;  // of the link's origin
};

/// q, v, a are a tree's; nullptr means zero. Accelerations exclude gravity.
template <class T>
std::vector<Body<T>> move(const Tree& tree, const T* q, const T* v, const T* a);

template <class T>
struct Wrench {  // force, and moment about the link's origin, in the world's axes
  Vec<T> force, moment;
};

/// Returns a point of a link, which moves with it.
template <class T>
Body<T> point_of(const Body<T>& link, const Numbers& offset);

/// Returns the joint forces that cause the tree's motion, given `on`, other wrenches on its links, and gravity.
template <class T>
std::vector<T> joint_forces(const Tree& tree, const std::vector<Body<T>>& bodies, const Vec<T>& gravity,
                            const T* a, std::vector<Wrench<T>> on);

template <class T>
struct Touch {  // motion of A relative to B' of a hold, at A's origin, in A's axes
  Rot<T> R;     // rotation of A in the world
  Vec<T> p;
  Vec<T> v, w;              // relative velocity
  Vec<T> linear, angular;   // the rows' accelerations with all terms: J a + a0 is selected from these
  std::vector<std::array<Vec<T>, 2>> rows;  // selection of the rows, in A's axes
};
template <class T>
Touch<T> touch(const Case& c, const Hold& hold, const std::vector<std::vector<Body<T>>>& bodies);

}  // namespace manycontact::attack
