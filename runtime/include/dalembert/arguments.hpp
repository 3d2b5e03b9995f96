// Vectors given to generated code. What can be known of them at compile time is checked then: length, scalar and shape, and
// that velocities are not taken for positions. What is known at run time only, the length of an Eigen::VectorXd, of a map or of
// a segment of one, is checked then, in every build type: nothing is read beyond a vector's end.
//
//   mahru::VectorQ q;  mahru::VectorV v;           // or Eigen::Matrix, Map, Ref, segment<n>() and expressions of fixed size
//   mahru::evaluate(q, v, workspace);              // returns nothing: lengths are right
//   mahru::evaluate(v, q, workspace);              // does not compile, not on a fixed base either
//   Eigen::VectorXd x, y;                          // or maps, Refs, segment(i, n) and expressions of run-time size
//   if (!mahru::evaluate(x, y, workspace)) ...     // a length is wrong, and nothing was computed
//
// None of it allocates, locks or throws, but for what a caller's expression of run-time size does when it is evaluated.
#pragma once

#include <Eigen/Core>
#include <dalembert/version.hpp>  // before what an older language does not know: it says so
#include <limits>
#include <type_traits>

namespace dalembert {

// What a vector is of: positions; or what stands along v's coordinates, which are velocities, accelerations and forces.
struct Positions;
struct Velocities;

// `count` numbers of one kind: an Eigen::Matrix<Scalar, count, 1>, as large and as aligned, and used like it. Its arithmetic is
// Eigen's and forgets the kind: q + h * v is of neither. Nothing of the other kind converts to it. Of a vector whose length is
// known at run time only it takes the numbers if they are `count`, else it is NaN throughout.
template <class Scalar, int count, class Kind>
class Coordinates;

template <class Scalar, int nq>
using VectorQ = Coordinates<Scalar, nq, Positions>;
template <class Scalar, int nv>
using VectorV = Coordinates<Scalar, nv, Velocities>;

// Whether what was asked for was done: a bool that compilers want looked at.
struct [[nodiscard]] Success {
  bool value;
  constexpr operator bool() const noexcept { return value; }
};

namespace detail {

template <class T>
struct Is {
  using type = T;
};

// Eigen's class that an object is of, for Coordinates an Eigen::Matrix; void where it is none of Eigen's.
template <class X>
Is<X> eigen_class(const Eigen::EigenBase<X>*);
Is<void> eigen_class(...);
template <class X>
using EigenClass = typename decltype(eigen_class(static_cast<std::remove_reference_t<X>*>(nullptr)))::type;
template <class X>
inline constexpr bool is_eigen = !std::is_void_v<EigenClass<X>>;

// Positions, Velocities, or void: not known.
template <class X>
struct Kind : Is<void> {};
template <class Scalar, int count, class Of>
struct Kind<Coordinates<Scalar, count, Of>> : Is<Of> {};
template <class Vector, int options, class Stride>
struct Kind<Eigen::Map<Vector, options, Stride>> : Kind<std::remove_const_t<Vector>> {};
template <class Vector, int options, class Stride>
struct Kind<Eigen::Ref<Vector, options, Stride>> : Kind<std::remove_const_t<Vector>> {};

// What is known of X at compile time.
template <class X, bool = is_eigen<X>>
struct Shape {
  static constexpr bool has_known_rows = false;
};
template <class X>
struct Shape<X, true> {
  using Traits = Eigen::internal::traits<EigenClass<X>>;
  using Scalar = typename Traits::Scalar;
  using Of = typename Kind<std::remove_cv_t<std::remove_reference_t<X>>>::type;
  static constexpr int rows = Traits::RowsAtCompileTime, columns = Traits::ColsAtCompileTime;
  static constexpr bool has_known_rows = rows != Eigen::Dynamic;
};

// Whether X may stand where `Vector`, a Coordinates, is wanted; or, with any number of columns, columns of which each is one.
template <class Vector, class X, bool one_column = true>
struct Check;
template <class Scalar, int count, class Of, class X, bool one_column>
struct Check<Coordinates<Scalar, count, Of>, X, one_column> {
  using S = Shape<X>;
  static constexpr bool no_velocities = !std::is_same_v<Of, Positions> || !std::is_same_v<typename S::Of, Velocities>;
  static constexpr bool no_positions = !std::is_same_v<Of, Velocities> || !std::is_same_v<typename S::Of, Positions>;
  static constexpr bool same_scalar = std::is_same_v<typename S::Scalar, Scalar>;
  static constexpr bool is_column = !one_column || S::columns == 1;
  static constexpr bool others_passed = no_velocities && no_positions && same_scalar && is_column;
  static constexpr bool is_as_long = !others_passed || !S::has_known_rows || S::rows == count;
  static constexpr bool passed = others_passed && is_as_long;

  static_assert(no_velocities, "velocities (a VectorV) where positions (a VectorQ) are wanted: are q and v swapped?");
  static_assert(no_positions, "positions (a VectorQ) where a VectorV is wanted: are q and v swapped?");
  static_assert(same_scalar, "the vector's scalar is not the robot's: take cast<Scalar>() of it");
  static_assert(is_column, "a row or a matrix where a column is wanted: take transpose() or col(0) of it");
  static_assert(is_as_long, "the vector's length is not the one wanted: nq of positions, nv of everything else");
};

template <int count, class X>
bool has_rows(const X& x) noexcept {
  return Shape<X>::rows == count || x.rows() == count;
}

// A vector that owns its numbers is read where they stand. Everything else is copied first: a view of the workspace may be
// written over by the very function that it is given to.
template <class Vector, class X>
using Held =
    std::conditional_t<std::is_base_of_v<Eigen::PlainObjectBase<EigenClass<X>>, EigenClass<X>>, const X&, const Vector>;

}  // namespace detail

template <class Scalar_, int count, class Kind>
class Coordinates : public Eigen::Matrix<Scalar_, count, 1> {
  template <class X>
  static constexpr bool has_known_rows = detail::Shape<X>::has_known_rows;

 public:
  using Base = Eigen::Matrix<Scalar_, count, 1>;  // Eigen::Map looks for it
  Coordinates() = default;
  // From as many numbers as there are entries; or `count` of them from here on.
  template <
      class... Numbers,
      std::enable_if_t<(count > 1) && sizeof...(Numbers) == count && (std::is_convertible_v<Numbers, Scalar_> && ...), int> = 0>
  Coordinates(const Numbers&... numbers) {
    Eigen::Index i = 0;
    ((this->coeffRef(i++) = static_cast<Scalar_>(numbers)), ...);
  }
  explicit Coordinates(const Scalar_* numbers) : Base(numbers) {}
  // As of any Eigen::Matrix: the number of entries, or the only one.
  template <class Number, std::enable_if_t<std::is_arithmetic_v<Number>, int> = 0>
  explicit Coordinates(const Number& number) : Base(number) {}

  template <class X, std::enable_if_t<has_known_rows<X>, int> = 0>
  Coordinates(const X& x) : Base(as_eigen(x)) {}
  template <class X, std::enable_if_t<detail::is_eigen<X> && !has_known_rows<X>, int> = 0>
  Coordinates(const X& x) {
    *this = x;
  }
  template <class X, std::enable_if_t<detail::is_eigen<X>, int> = 0>
  Coordinates& operator=(const X& x) {
    if (detail::has_rows<count>(x)) Base::operator=(as_eigen(x));
    else this->setConstant(std::numeric_limits<Scalar_>::quiet_NaN());
    return *this;
  }

 private:
  template <class X>
  static decltype(auto) as_eigen(const X& x) noexcept {
    if constexpr (detail::Check<Coordinates, X>::passed) return static_cast<const detail::EigenClass<X>&>(x);
    else return Base::Zero();  // the check has told; no more errors of it
  }
};

// What a call with all of X returns: T where no length is left to be checked at run time, else whether all are right. No type
// at all where something else than Eigen's is among them, such as a pointer.
template <class T, class... X>
using Checked =
    std::enable_if_t<(detail::is_eigen<X> && ...), std::conditional_t<(detail::Shape<X>::has_known_rows && ...), T, Success>>;

// Calls function(numbers of x...), each x standing for the Vector of its place, unless a length is wrong.
template <class... Vectors, class Function, class... X>
Checked<void, X...> call(const Function& function, const X&... x) {
  if constexpr (!(detail::Check<Vectors, X>::passed & ...)) {
    return Checked<void, X...>();
  } else if constexpr ((detail::Shape<X>::has_known_rows && ...)) {
    function(detail::Held<Vectors, X>(x).data()...);
  } else {
    if (!(detail::has_rows<Vectors::RowsAtCompileTime>(x) && ...)) return {false};
    function(detail::Held<Vectors, X>(x).data()...);
    return {true};
  }
}

// Calls function(first number, columns, elements from one column to the next) of columns to be written over, each standing for
// a Vector, unless they have another number of rows. What it returns, or false.
template <class Vector, class Columns, class Function>
Checked<bool, Columns> call_on_columns(Columns&& columns, const Function& function) {
  if constexpr (detail::Check<Vector, Columns, false>::passed) {
    Eigen::Ref<Eigen::Matrix<typename Vector::Scalar, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor>> b(columns);
    if (b.rows() == Vector::RowsAtCompileTime)
      return {function(b.data(), static_cast<int>(b.cols()), static_cast<int>(b.outerStride()))};
  }
  return {false};
}

}  // namespace dalembert

// Eigen::Map and Eigen::Ref of Coordinates.
namespace Eigen::internal {
template <class Scalar, int count, class Of>
struct traits<dalembert::Coordinates<Scalar, count, Of>> : traits<Matrix<Scalar, count, 1>> {};
template <class Scalar, int count, class Of>
struct evaluator<dalembert::Coordinates<Scalar, count, Of>> : evaluator<Matrix<Scalar, count, 1>> {
  using evaluator<Matrix<Scalar, count, 1>>::evaluator;
};
}  // namespace Eigen::internal
