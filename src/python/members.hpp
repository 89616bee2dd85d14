#pragma once
// The members of a plain structure as a tuple of references, found by the compiler: none can be forgotten.

#include <tuple>
#include <type_traits>

namespace manycontact::python {

// clang-format off
// B3: {}, {}, {}    N3: m1, m2, m3
#define B1 {}
#define B2 B1, {}
#define B3 B2, {}
#define B4 B3, {}
#define B5 B4, {}
#define B6 B5, {}
#define B7 B6, {}
#define B8 B7, {}
#define B9 B8, {}
#define B10 B9, {}
#define B11 B10, {}
#define B12 B11, {}
#define B13 B12, {}
#define B14 B13, {}
#define B15 B14, {}
#define B16 B15, {}
#define B17 B16, {}
#define B18 B17, {}
#define B19 B18, {}
#define B20 B19, {}
#define B21 B20, {}
#define B22 B21, {}
#define B23 B22, {}
#define B24 B23, {}
#define B25 B24, {}
#define B26 B25, {}
#define B27 B26, {}
#define B28 B27, {}
#define N1 m1
#define N2 N1, m2
#define N3 N2, m3
#define N4 N3, m4
#define N5 N4, m5
#define N6 N5, m6
#define N7 N6, m7
#define N8 N7, m8
#define N9 N8, m9
#define N10 N9, m10
#define N11 N10, m11
#define N12 N11, m12
#define N13 N12, m13
#define N14 N13, m14
#define N15 N14, m15
#define N16 N15, m16
#define N17 N16, m17
#define N18 N17, m18
#define N19 N18, m19
#define N20 N19, m20
#define N21 N20, m21
#define N22 N21, m22
#define N23 N22, m23
#define N24 N23, m24
#define N25 N24, m25
#define N26 N25, m26
#define N27 N26, m27
// clang-format on

/// Empty braces count the members: an aggregate takes as many of them as it has members, and no more.
template <class T>
auto members(T& x) {
  using A = std::remove_const_t<T>;
  static_assert(
      !requires { A{B28}; }, "it has more members than members.hpp knows");
#define TAKE(n)                          \
  if constexpr (requires { A{B##n}; }) { \
    auto& [N##n] = x;                    \
    return std::tie(N##n);               \
  } else
  // clang-format off
  TAKE(27) TAKE(26) TAKE(25) TAKE(24) TAKE(23) TAKE(22) TAKE(21) TAKE(20) TAKE(19) TAKE(18) TAKE(17) TAKE(16) TAKE(15)
  TAKE(14) TAKE(13) TAKE(12) TAKE(11) TAKE(10) TAKE(9) TAKE(8) TAKE(7) TAKE(6) TAKE(5) TAKE(4) TAKE(3) TAKE(2) TAKE(1)
    return std::tie();
  // clang-format on
#undef TAKE
}

#undef B1
#undef B2
#undef B3
#undef B4
#undef B5
#undef B6
#undef B7
#undef B8
#undef B9
#undef B10
#undef B11
#undef B12
#undef B13
#undef B14
#undef B15
#undef B16
#undef B17
#undef B18
#undef B19
#undef B20
#undef B21
#undef B22
#undef B23
#undef B24
#undef B25
#undef B26
#undef B27
#undef B28
#undef N1
#undef N2
#undef N3
#undef N4
#undef N5
#undef N6
#undef N7
#undef N8
#undef N9
#undef N10
#undef N11
#undef N12
#undef N13
#undef N14
#undef N15
#undef N16
#undef N17
#undef N18
#undef N19
#undef N20
#undef N21
#undef N22
#undef N23
#undef N24
#undef N25
#undef N26
#undef N27

}  // namespace manycontact::python
