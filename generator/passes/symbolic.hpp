// Three-dimensional algebra on symbolic scalars: what the lowering passes write the equations in.
//
// An operation makes its node when it is evaluated, and the order of nodes is the order of the code. C++ leaves open which
// operand of a + b, or which argument of a call, is evaluated first: where two of them make nodes, one is named beforehand, so
// that generated code does not depend on the compiler that built the generator.
#pragma once

#include <array>

#include "ir/graph.hpp"

namespace dalembert::passes {

// A node of a graph with arithmetic. Both operands of an operation belong to the same graph.
struct Sym {
  ir::Graph* graph = nullptr;
  ir::NodeId id = ir::no_node;
};

inline Sym operator+(Sym a, Sym b) { return {a.graph, a.graph->add(a.id, b.id)}; }
inline Sym operator-(Sym a, Sym b) { return {a.graph, a.graph->subtract(a.id, b.id)}; }
inline Sym operator*(Sym a, Sym b) { return {a.graph, a.graph->multiply(a.id, b.id)}; }
inline Sym operator-(Sym a) { return {a.graph, a.graph->negate(a.id)}; }

using Vec3 = std::array<Sym, 3>;
using Mat3 = std::array<Vec3, 3>;  // rows

inline Vec3 operator+(const Vec3& a, const Vec3& b) { return {a[0] + b[0], a[1] + b[1], a[2] + b[2]}; }
inline Vec3 operator-(const Vec3& a, const Vec3& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
inline Vec3 operator-(const Vec3& a) { return {-a[0], -a[1], -a[2]}; }
inline Vec3 operator*(Sym s, const Vec3& a) { return {s * a[0], s * a[1], s * a[2]}; }
// a b ± c d
inline Sym sum_of_products(Sym a, Sym b, Sym c, Sym d) {
  const Sym cd = c * d;
  return a * b + cd;
}
inline Sym difference_of_products(Sym a, Sym b, Sym c, Sym d) {
  const Sym cd = c * d;
  return a * b - cd;
}
inline Sym dot(const Vec3& a, const Vec3& b) {
  const Sym z = a[2] * b[2];
  return sum_of_products(a[0], b[0], a[1], b[1]) + z;
}
inline Vec3 cross(const Vec3& a, const Vec3& b) {
  return {difference_of_products(a[1], b[2], a[2], b[1]), difference_of_products(a[2], b[0], a[0], b[2]),
          difference_of_products(a[0], b[1], a[1], b[0])};
}
inline Vec3 operator*(const Mat3& m, const Vec3& a) { return {dot(m[0], a), dot(m[1], a), dot(m[2], a)}; }
inline Vec3 column(const Mat3& m, std::size_t j) { return {m[0][j], m[1][j], m[2][j]}; }
inline Mat3 from_columns(const Vec3& x, const Vec3& y, const Vec3& z) {
  return {Vec3{x[0], y[0], z[0]}, Vec3{x[1], y[1], z[1]}, Vec3{x[2], y[2], z[2]}};
}
inline Mat3 transpose(const Mat3& m) { return {column(m, 0), column(m, 1), column(m, 2)}; }
inline Mat3 operator*(const Mat3& a, const Mat3& b) {
  const Vec3 z = a * column(b, 2), y = a * column(b, 1), x = a * column(b, 0);
  return from_columns(x, y, z);
}

inline Mat3 operator+(const Mat3& a, const Mat3& b) { return {a[0] + b[0], a[1] + b[1], a[2] + b[2]}; }

// Symmetric: xx xy xz yy yz zz.
using Sym6 = std::array<Sym, 6>;
inline constexpr std::size_t sym6_index[3][3] = {{0, 1, 2}, {1, 3, 4}, {2, 4, 5}};
inline Mat3 full(const Sym6& s) { return {Vec3{s[0], s[1], s[2]}, Vec3{s[1], s[3], s[4]}, Vec3{s[2], s[4], s[5]}}; }

}  // namespace dalembert::passes
