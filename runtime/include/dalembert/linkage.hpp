// Local linkages whose loops are embedded: some of their joints, the dependent ones, follow others, the independent ones, and
// dynamics are those of the independent coordinates y (Jain 2012; Chignoli et al. 2023).
//
// Rows J of loops are those of the scene's loops as rows (docs/scene.md): of the second link against the first, along the axes
// of the frame on the first, at the point of the second. They read the joints between the two links alone. Where J v = 0,
//   v_d = G y', G = -J_d^-1 J_y,    v_d' = G y'' + G' y', G' = -J_d^-1 (J_y' + J_d' G),
// and T = [1; G], G' of all linkages make M, C, forces and Jacobians of the tree those of y: T'M T, T'(C T + M T'), T'f, J T.
//
// At a toggle point J_d has no inverse: the status says so, G and G' are zero, and nothing is divided by.
#pragma once

#include <cmath>

namespace dalembert {

// What following came to, or closing.
template <class T>
struct LinkageStatus {
  T error = T(0);        // the largest that loops are from closed, m or rad
  T least_pivot = T(1);  // of J_d, in terms of the largest element of its row of J: near zero where there is a toggle point
  int linkage = -1;      // the first at a toggle point, counted from 0; -1: none is
  constexpr bool ok() const noexcept { return linkage < 0; }
};

// Pivots below this count as zero: half of the digits would be lost.
template <class T>
inline constexpr T least_linkage_pivot = T(sizeof(T) > 4 ? 1e-8 : 2e-4);

// One joint on the way from where the two links of a loop hang to one of them.
template <class T>
struct LinkedJoint {
  int position;     // in q
  int column;       // in the linkage: dependent joints first, independent ones behind them
  T turns, slides;  // per unit of its coordinate, about the axis and along it
  T rotation[9];    // of the body's frame in the one before it, at zero, row by row
  T translation[3];
  T axis[3];  // unit, in the body's frame
};

// What a loop holds: bits of axes of the frame on its first link, or a distance.
template <class T>
struct LinkedLoop {
  int begin[3];      // joints towards the first link, those towards the second, and where these end
  T rotation[2][9];  // frames, on the last body each, or on what both hang on
  T translation[2][3];
  int linear, angular;  // bits of x y z
  T length;             // of a distance, else zero
};

// Loops that share dependent joints. Joints that move it are columns.
template <class T>
struct Linkage {
  const LinkedLoop<T>* loops;
  int loop_count;
  const LinkedJoint<T>* joints;
  int dependent, independent;          // how many; rows are as many as dependent joints
  const int* dependent_positions;      // in q
  const int* dependent_coordinates;    // among those of all joints
  const int* independent_coordinates;  // in v
};

// One element of T that is not of the unit matrix: the coordinate among all that follows, and the one in v that it follows.
struct Follower {
  int coordinate, follows;
};

namespace linkage_detail {

template <class T>
struct Three {
  T x[3];
  constexpr T& operator[](int i) { return x[i]; }
  constexpr const T& operator[](int i) const { return x[i]; }
};
template <class T>
Three<T> crossed(const Three<T>& a, const Three<T>& b) {
  return {{a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]}};
}
template <class T>
Three<T> plus(const Three<T>& a, const Three<T>& b) {
  return {{a[0] + b[0], a[1] + b[1], a[2] + b[2]}};
}
template <class T>
Three<T> minus(const Three<T>& a, const Three<T>& b) {
  return {{a[0] - b[0], a[1] - b[1], a[2] - b[2]}};
}
template <class T>
Three<T> times(const T& s, const Three<T>& a) {
  return {{s * a[0], s * a[1], s * a[2]}};
}
template <class T>
T dotted(const Three<T>& a, const Three<T>& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
template <class T>
T size_of(const T& x) {
  return x < T(0) ? T(-x) : x;
}

// Rows: a frame's axes as columns.
template <class T>
struct Place {
  T R[9];
  Three<T> x, velocity, spin;  // origin, and how it and the axes move

  Three<T> column(int i) const { return {{R[i], R[3 + i], R[6 + i]}}; }
  Three<T> along(const T* a) const {
    return {{R[0] * a[0] + R[1] * a[1] + R[2] * a[2], R[3] * a[0] + R[4] * a[1] + R[5] * a[2],
             R[6] * a[0] + R[7] * a[1] + R[8] * a[2]}};
  }
  void turn(const T* by) {
    T turned[9];
    for (int i = 0; i < 3; ++i)
      for (int k = 0; k < 3; ++k) turned[3 * i + k] = R[3 * i] * by[k] + R[3 * i + 1] * by[3 + k] + R[3 * i + 2] * by[6 + k];
    for (int i = 0; i < 9; ++i) R[i] = turned[i];
  }
  // To a frame that is fixed in this one.
  void shift(const T* rotation, const T* translation) {
    const Three<T> arm = along(translation);
    x = plus(x, arm);
    velocity = plus(velocity, crossed(spin, arm));
    turn(rotation);
  }
};

// A joint on its way: what it does per unit of its coordinate, the point it turns about, and how they move.
template <class T>
struct MovingAxis {
  Three<T> turning, sliding, origin, velocity, turning_rate, sliding_rate;
};

// Of each column of a linkage: where the joint is.
template <int most_dependent, int most_independent, class T>
struct LinkagePositions {
  T value[most_dependent + most_independent], sine[most_dependent + most_independent],
      cosine[most_dependent + most_independent];

  LinkagePositions(const Linkage<T>& linkage, const T* q) {
    using std::cos;
    using std::sin;
    bool found[most_dependent + most_independent] = {};
    const int end = linkage.loops[linkage.loop_count - 1].begin[2];
    for (int k = 0; k < end; ++k) {
      const LinkedJoint<T>& joint = linkage.joints[k];
      if (found[joint.column]) continue;  // by another loop
      found[joint.column] = true;
      const T angle = value[joint.column] = q[joint.position];
      if (joint.turns == T(0)) continue;
      sine[joint.column] = sin(angle);
      cosine[joint.column] = cos(angle);
    }
  }
};

// Rows of one linkage: how far each is from closed, J and J', dependent columns first; as many rows as dependent joints.
// rates: by column; null: J' is not wanted.
template <int most_dependent, int most_independent, class T>
struct LinkageRows {
  static constexpr int columns = most_dependent + most_independent;
  using Positions = LinkagePositions<most_dependent, most_independent, T>;
  T error[most_dependent], jacobian[most_dependent][columns], rate[most_dependent][columns];

  LinkageRows(const Linkage<T>& linkage, const Positions& positions, const T* rates) {
    int row = 0;
    for (int l = 0; l < linkage.loop_count; ++l) {
      const LinkedLoop<T>& loop = linkage.loops[l];
      const int end = row + rows_of(loop), first = loop.begin[0];
      for (int r = row; r < end; ++r)
        for (int c = 0; c < linkage.dependent + linkage.independent; ++c) jacobian[r][c] = rate[r][c] = T(0);
      MovingAxis<T> axes[columns];  // a loop has no joint twice
      const Place<T> ends[2] = {walk(linkage, loop, 0, positions, rates, axes), walk(linkage, loop, 1, positions, rates, axes)};
      fill_errors(loop, ends, row);
      for (int side = 0; side < 2; ++side)
        for (int k = loop.begin[side]; k < loop.begin[side + 1]; ++k)
          add(loop, ends, side, linkage.joints[k].column, axes[k - first], rates != nullptr, row);
      row = end;
    }
  }

  // Of each row the largest element, those of independent joints too: dependent ones may not move it at all. Where no joint
  // moves it its elements are rounding, and it counts as a thousandth of the largest.
  void size_rows(const Linkage<T>& linkage, T (&scale)[most_dependent]) const {
    constexpr T least = T(1e-3);
    T largest = T(0);
    for (int r = 0; r < linkage.dependent; ++r) {
      scale[r] = T(0);
      for (int c = 0; c < linkage.dependent + linkage.independent; ++c)
        scale[r] = scale[r] < size_of(jacobian[r][c]) ? size_of(jacobian[r][c]) : scale[r];
      largest = largest < scale[r] ? scale[r] : largest;
    }
    for (int r = 0; r < linkage.dependent; ++r) scale[r] = scale[r] < least * largest ? T(least * largest) : scale[r];
  }

  static int rows_of(const LinkedLoop<T>& loop) {
    if (loop.length > T(0)) return 1;
    int count = 0;
    for (int i = 0; i < 3; ++i) count += ((loop.linear >> i) & 1) + ((loop.angular >> i) & 1);
    return count;
  }

 private:
  static Place<T> walk(const Linkage<T>& linkage, const LinkedLoop<T>& loop, int side, const Positions& positions,
                       const T* rates, MovingAxis<T>* axes) {
    Place<T> at{{T(1), T(0), T(0), T(0), T(1), T(0), T(0), T(0), T(1)}, {}, {}, {}};
    for (int i = 0; i < 3; ++i) at.x[i] = at.velocity[i] = at.spin[i] = T(0);
    for (int k = loop.begin[side]; k < loop.begin[side + 1]; ++k) {
      const LinkedJoint<T>& joint = linkage.joints[k];
      at.shift(joint.rotation, joint.translation);
      MovingAxis<T>& moving = axes[k - loop.begin[0]];
      const Three<T> axis = at.along(joint.axis);
      moving.turning = times(joint.turns, axis);
      moving.sliding = times(joint.slides, axis);
      moving.turning_rate = crossed(at.spin, moving.turning);
      moving.sliding_rate = crossed(at.spin, moving.sliding);
      moving.origin = at.x;
      moving.velocity = at.velocity;
      const Three<T> arm = times(positions.value[joint.column], moving.sliding);
      at.x = plus(at.x, arm);
      at.velocity = plus(at.velocity, crossed(at.spin, arm));
      if (rates) {
        const T speed = rates[joint.column];
        at.velocity = plus(at.velocity, times(speed, moving.sliding));
        at.spin = plus(at.spin, times(speed, moving.turning));
      }
      if (joint.turns != T(0)) {
        const T s = positions.sine[joint.column], c = positions.cosine[joint.column], v = T(1) - c;
        const T *a = joint.axis,
                turned[9] = {c + v * a[0] * a[0],        v * a[0] * a[1] - s * a[2], v * a[0] * a[2] + s * a[1],
                             v * a[0] * a[1] + s * a[2], c + v * a[1] * a[1],        v * a[1] * a[2] - s * a[0],
                             v * a[0] * a[2] - s * a[1], v * a[1] * a[2] + s * a[0], c + v * a[2] * a[2]};
        at.turn(turned);
      }
    }
    at.shift(loop.rotation[side], loop.translation[side]);
    return at;
  }

  // As constraints' rows have them: xb - xa; (|xb - xa|^2 - l^2) / 2 l; za x zb, or half the sum of a_i x b_i.
  void fill_errors(const LinkedLoop<T>& loop, const Place<T>* ends, int row) {
    const Three<T> between = minus(ends[1].x, ends[0].x);
    if (loop.length > T(0)) {
      error[row] = (dotted(between, between) - loop.length * loop.length) / (T(2) * loop.length);
      return;
    }
    for (int i = 0; i < 3; ++i)
      if ((loop.linear >> i) & 1) error[row++] = dotted(ends[0].column(i), between);
    Three<T> turned = crossed(ends[0].column(2), ends[1].column(2));
    if (loop.angular == 7) {
      for (int i = 0; i < 2; ++i) turned = plus(turned, crossed(ends[0].column(i), ends[1].column(i)));
      turned = times(T(0.5), turned);
    }
    for (int i = 0; i < 3; ++i)
      if ((loop.angular >> i) & 1) error[row++] = dotted(ends[0].column(i), turned);
  }

  void add(const LinkedLoop<T>& loop, const Place<T>* ends, int side, int column, const MovingAxis<T>& joint, bool moves,
           int row) {
    const T sign = side == 1 ? T(1) : T(-1);
    // Of the rows' point, moved with this joint: the second link's, and of a distance each link's own.
    const bool distance = loop.length > T(0);
    const Place<T>& point = ends[distance ? side : 1];
    const Three<T> arm = minus(point.x, joint.origin);
    const Three<T> moved = times(sign, plus(crossed(joint.turning, arm), joint.sliding));
    Three<T> moved_rate{};
    if (moves)
      moved_rate = times(
          sign, plus(plus(crossed(joint.turning_rate, arm), crossed(joint.turning, minus(point.velocity, joint.velocity))),
                     joint.sliding_rate));
    if (distance) {
      const Three<T> between = minus(ends[1].x, ends[0].x), opening = minus(ends[1].velocity, ends[0].velocity);
      jacobian[row][column] += dotted(between, moved) / loop.length;
      if (moves) rate[row][column] += (dotted(opening, moved) + dotted(between, moved_rate)) / loop.length;
      return;
    }
    const Three<T> turned = times(sign, joint.turning), turned_rate = times(sign, joint.turning_rate);
    for (int kind = 0; kind < 2; ++kind)
      for (int i = 0; i < 3; ++i) {
        if (!(((kind == 0 ? loop.linear : loop.angular) >> i) & 1)) continue;
        const Three<T> axis = ends[0].column(i);
        jacobian[row][column] += dotted(axis, kind == 0 ? moved : turned);
        if (moves)
          rate[row][column] += dotted(crossed(ends[0].spin, axis), kind == 0 ? moved : turned) +
                               dotted(axis, kind == 0 ? moved_rate : turned_rate);
        ++row;
      }
  }
};

// B becomes A^-1 B: n rows, `columns` of B. scale: how large rows are, which is spoiled. Returns the least pivot in terms of
// it. Below the least that is allowed B is zero.
template <int most, int most_columns, class T>
T eliminate(int n, int columns, T (&A)[most][most], T (&B)[most][most_columns], T (&scale)[most]) {
  T least = T(1);
  for (int k = 0; k < n; ++k) {
    int best = k;
    T most_of_row = T(-1);
    for (int r = k; r < n; ++r) {
      const T ratio = scale[r] > T(0) ? T(size_of(A[r][k]) / scale[r]) : T(0);
      if (ratio > most_of_row) best = r, most_of_row = ratio;
    }
    if (!(most_of_row >= least)) least = most_of_row;
    if (!(least > least_linkage_pivot<T>)) {
      for (int r = 0; r < n; ++r)
        for (int c = 0; c < columns; ++c) B[r][c] = T(0);
      return least > T(0) ? least : T(0);
    }
    for (int c = k; c < n; ++c) {
      const T held = A[k][c];
      A[k][c] = A[best][c], A[best][c] = held;
    }
    for (int c = 0; c < columns; ++c) {
      const T held = B[k][c];
      B[k][c] = B[best][c], B[best][c] = held;
    }
    scale[best] = scale[k];
    for (int r = k + 1; r < n; ++r) {
      const T factor = A[r][k] / A[k][k];
      for (int c = k + 1; c < n; ++c) A[r][c] -= factor * A[k][c];
      for (int c = 0; c < columns; ++c) B[r][c] -= factor * B[k][c];
    }
  }
  for (int k = n; k-- > 0;)
    for (int c = 0; c < columns; ++c) {
      T sum = B[k][c];
      for (int i = k + 1; i < n; ++i) sum -= A[k][i] * B[i][c];
      B[k][c] = sum / A[k][k];
    }
  return least;
}

template <class T>
void take(LinkageStatus<T>& status, int number, const T& error, const T& pivot) {
  if (!(error <= status.error)) status.error = error;
  if (!(pivot >= status.least_pivot)) status.least_pivot = pivot;
  if (!(pivot > least_linkage_pivot<T>)&&status.linkage < 0) status.linkage = number;
}

template <int most_dependent, int most_independent, class T>
T largest_error(const Linkage<T>& linkage, const LinkageRows<most_dependent, most_independent, T>& rows) {
  T most = T(0);
  for (int r = 0; r < linkage.dependent; ++r)
    if (!(size_of(rows.error[r]) <= most)) most = size_of(rows.error[r]);
  return most;
}

}  // namespace linkage_detail

// G and G' of the linkage of this number, row by row; y: rates of the independent coordinates, as v has them; null: at rest,
// and G' is not filled. most_dependent, most_independent: at least as many as the linkage has.
template <int most_dependent, int most_independent, class T>
void follow(const Linkage<T>& linkage, int number, const T* q, const T* v, T* G, T* G_rate, LinkageStatus<T>& status) noexcept {
  using Rows = linkage_detail::LinkageRows<most_dependent, most_independent, T>;
  const int d = linkage.dependent, y = linkage.independent;
  T A[most_dependent][most_dependent], B[most_dependent][most_independent], scale[most_dependent];
  const auto solve = [&](const Rows& rows) {
    for (int r = 0; r < d; ++r)
      for (int c = 0; c < d; ++c) A[r][c] = rows.jacobian[r][c];
    rows.size_rows(linkage, scale);
    return linkage_detail::eliminate<most_dependent, most_independent, T>(d, y, A, B, scale);
  };
  const typename Rows::Positions positions(linkage, q);
  const Rows still(linkage, positions, nullptr);
  for (int r = 0; r < d; ++r)
    for (int c = 0; c < y; ++c) B[r][c] = -still.jacobian[r][d + c];
  linkage_detail::take(status, number, linkage_detail::largest_error(linkage, still), solve(still));
  T rates[most_dependent + most_independent];
  for (int r = 0; r < d; ++r) {
    rates[r] = T(0);
    for (int c = 0; c < y; ++c) {
      G[r * y + c] = B[r][c];
      if (v) rates[r] += B[r][c] * v[linkage.independent_coordinates[c]];
    }
  }
  if (!v) return;
  for (int c = 0; c < y; ++c) rates[d + c] = v[linkage.independent_coordinates[c]];
  const Rows moving(linkage, positions, rates);
  for (int r = 0; r < d; ++r)
    for (int c = 0; c < y; ++c) {
      B[r][c] = -moving.rate[r][d + c];
      for (int i = 0; i < d; ++i) B[r][c] -= moving.rate[r][i] * G[i * y + c];
    }
  solve(still);
  for (int r = 0; r < d; ++r)
    for (int c = 0; c < y; ++c) G_rate[r * y + c] = B[r][c];
}

// Positions of dependent joints, so that loops are closed: `steps` of Newton's from where they are in q, none larger than half
// a radian or metre. At a toggle point they stay where they are.
template <int most_dependent, int most_independent, class T>
void close_linkage(const Linkage<T>& linkage, int number, int steps, T* q, LinkageStatus<T>& status) noexcept {
  using Rows = linkage_detail::LinkageRows<most_dependent, most_independent, T>;
  T pivot = T(1);
  for (int step = 0; step < steps; ++step) {
    const Rows rows(linkage, typename Rows::Positions(linkage, q), nullptr);
    T A[most_dependent][most_dependent], move[most_dependent][1], scale[most_dependent];
    rows.size_rows(linkage, scale);
    for (int r = 0; r < linkage.dependent; ++r) {
      for (int c = 0; c < linkage.dependent; ++c) A[r][c] = rows.jacobian[r][c];
      move[r][0] = -rows.error[r];
    }
    pivot = linkage_detail::eliminate<most_dependent, 1, T>(linkage.dependent, 1, A, move, scale);
    T largest = T(0);
    for (int r = 0; r < linkage.dependent; ++r)
      largest = largest < linkage_detail::size_of(move[r][0]) ? linkage_detail::size_of(move[r][0]) : largest;
    const T part = largest > T(0.5) ? T(T(0.5) / largest) : T(1);
    for (int r = 0; r < linkage.dependent; ++r) q[linkage.dependent_positions[r]] += part * move[r][0];
  }
  const Rows rows(linkage, typename Rows::Positions(linkage, q), nullptr);
  linkage_detail::take(status, number, linkage_detail::largest_error(linkage, rows), pivot);
}

// What follows is with T as a list of its elements: `at`, per coordinate of v which it is among all of the tree; `followers`,
// with a number each. Matrices stand column by column.

// of all = T of v.
template <int nv, int all, int count, class T>
void spread(const int* at, const Follower* followers, const T* G, const T* of_v, T* of_all) noexcept {
  for (int i = 0; i < all; ++i) of_all[i] = T(0);
  for (int i = 0; i < nv; ++i) of_all[at[i]] = of_v[i];
  for (int i = 0; i < count; ++i) of_all[followers[i].coordinate] += G[i] * of_v[followers[i].follows];
}

// of all += T' v: accelerations that dependent joints have at y'' = 0.
template <int count, class T>
void add_turning(const Follower* followers, const T* G_rate, const T* v, T* of_all) noexcept {
  for (int i = 0; i < count; ++i) of_all[followers[i].coordinate] += G_rate[i] * v[followers[i].follows];
}

// to = from T, of `rows` rows.
template <int rows, int nv, int count, class T>
void project_columns(const int* at, const Follower* followers, const T* G, const T* from, T* to) noexcept {
  for (int c = 0; c < nv; ++c)
    for (int r = 0; r < rows; ++r) to[c * rows + r] = from[at[c] * rows + r];
  for (int i = 0; i < count; ++i) {
    const T* const column = from + followers[i].coordinate * rows;
    T* const sum = to + followers[i].follows * rows;
    for (int r = 0; r < rows; ++r) sum[r] += column[r] * G[i];
  }
}

// to += from T', of `rows` rows: only dependent joints' columns are read.
template <int rows, int count, class T>
void add_turning_columns(const Follower* followers, const T* G_rate, const T* from, T* to) noexcept {
  for (int i = 0; i < count; ++i) {
    const T* const column = from + followers[i].coordinate * rows;
    T* const sum = to + followers[i].follows * rows;
    for (int r = 0; r < rows; ++r) sum[r] += column[r] * G_rate[i];
  }
}

// to = T' from, of `columns` columns.
template <int columns, int nv, int all, int count, class T>
void project_rows(const int* at, const Follower* followers, const T* G, const T* from, T* to) noexcept {
  for (int c = 0; c < columns; ++c) {
    const T* const column = from + c * all;
    T* const own = to + c * nv;
    for (int r = 0; r < nv; ++r) own[r] = column[at[r]];
    for (int i = 0; i < count; ++i) own[followers[i].follows] += G[i] * column[followers[i].coordinate];
  }
}

// to = from + J a, of `rows` rows, a being what dependent joints are accelerated by at y'' = 0: nothing else's columns are
// read.
template <int rows, int count, class T>
void add_bias(const Follower* followers, const T* G_rate, const T* v, const T* J, const T* from, T* to) noexcept {
  for (int r = 0; r < rows; ++r) to[r] = from[r];
  for (int i = 0; i < count; ++i) {
    const T acceleration = G_rate[i] * v[followers[i].follows];
    const T* const column = J + followers[i].coordinate * rows;
    for (int r = 0; r < rows; ++r) to[r] += column[r] * acceleration;
  }
}

template <int size, class T>
void copy_numbers(const T* from, T* to) noexcept {
  for (int i = 0; i < size; ++i) to[i] = from[i];
}
// to = from - to.
template <int size, class T>
void subtract_from(const T* from, T* to) noexcept {
  for (int i = 0; i < size; ++i) to[i] = from[i] - to[i];
}
template <int size, class T>
void clear_at_toggle_point(const LinkageStatus<T>& status, T* numbers) noexcept {
  if (status.ok()) return;
  for (int i = 0; i < size; ++i) numbers[i] = T(0);
}

}  // namespace dalembert
