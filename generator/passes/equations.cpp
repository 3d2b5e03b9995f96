#include "passes/equations.hpp"

namespace dalembert::passes {

namespace {

Vec3 placed_origin(const BodyConstants& body, const JointPosition& q) {
  return body.translation + q.displacement * column(body.rotation, 2);
}

// (tr(S) 1 − S) v
Vec3 apply_rotational(const Sym6& s, const Vec3& v) {
  const Sym6 inertia{s[3] + s[5], -s[1], -s[2], s[0] + s[5], -s[4], s[0] + s[3]};
  return full(inertia) * v;
}

}  // namespace

Mat3 turned(const Mat3& m, const JointPosition& q) {
  const Vec3 x = column(m, 0), y = column(m, 1);
  const Vec3 back = q.sine * x, ahead = q.cosine * y, turned_y = ahead - back;
  const Vec3 over = q.sine * y, turned_x = q.cosine * x + over;
  return from_columns(turned_x, turned_y, column(m, 2));
}

Pose pose(const Pose& parent, const BodyConstants& body, const JointPosition& q) {
  const Mat3 placed = parent.rotation * body.rotation;
  const Mat3 rotation = turned(placed, q);
  const Vec3 slide = q.displacement * column(placed, 2);
  return {rotation, parent.position + parent.rotation * body.translation + slide};
}

Pose pose_of_parent(const Pose& pose, const BodyConstants& body, const JointPosition& q) {
  const Mat3 rotation = turned(pose.rotation, {-q.sine, q.cosine, q.displacement}) * transpose(body.rotation);
  const Vec3 moved = rotation * body.translation, slide = q.displacement * column(pose.rotation, 2);
  return {rotation, pose.position - moved - slide};
}

Twist joint_twist(const Pose& pose, const BodyConstants& body) {
  const Vec3 z = column(pose.rotation, 2);
  const Vec3 sliding = body.sliding * z;
  const Vec3 linear = body.turning * cross(pose.position, z) + sliding;
  return {linear, body.turning * z};
}

Twist body_twist(const Twist& parent, const Twist& joint, Sym rate) {
  return {parent.linear + rate * joint.linear, parent.angular + rate * joint.angular};
}

Twist joint_twist_rate(const Twist& body, const Twist& joint) {
  const Vec3 moved = cross(body.linear, joint.angular);
  const Vec3 linear = cross(body.angular, joint.linear) + moved;
  return {linear, cross(body.angular, joint.angular)};
}

Sums moments(const Pose& pose, const BodyConstants& body) {
  const Mat3& r = pose.rotation;
  const Vec3& p = pose.position;
  Sums sums;
  const Vec3 moved = body.mass * p;
  sums.first = r * body.first + moved;
  // S as a sum of a bᵀ + b aᵀ over the body's axes a: half the multiplications of R (S_k Rᵀ).
  const Vec3 x = column(r, 0), y = column(r, 1), z = column(r, 2);
  const Sym6& s = body.second;
  const Vec3 xz = s[2] * z, xy = s[1] * y, xx = body.half_second[0] * x, along_x = body.first[0] * p + xx + xy + xz;
  const Vec3 yz = s[4] * z, yy = body.half_second[1] * y, along_y = body.first[1] * p + yy + yz;
  const Vec3 zz = body.half_second[2] * z, along_z = body.first[2] * p + zz;
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = i; j < 3; ++j) {
      const auto half = [&](std::size_t a, std::size_t b) {
        const Sym third = z[a] * along_z[b];
        return sum_of_products(x[a], along_x[b], y[a], along_y[b]) + third;
      };
      const Sym shift = moved[i] * p[j], sum = half(i, j), other = i == j ? sum : half(j, i);
      sums.second[sym6_index[i][j]] = sum + other + shift;
    }
  return sums;
}

void add_velocity(Sums& sums, const Twist& twist, Sym mass, Sym half_trace) {
  const Vec3 &u = twist.linear, &w = twist.angular, &x = sums.first;
  const Vec3 turning = cross(w, x);
  sums.momentum = mass * u + turning;
  Sym6 s = sums.second;
  for (std::size_t i : {0u, 3u, 5u}) s[i] = s[i] + half_trace;
  const Mat3 m = full(s);
  const Sym xu = dot(x, u);
  const Vec3 wz = cross(w, column(m, 2)), wy = cross(w, column(m, 1)), wx = cross(w, column(m, 0));
  const Mat3 wm = from_columns(wx, wy, wz);
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j) {
      const Sym sum = wm[i][j] + u[i] * x[j];
      sums.bias[i][j] = i == j ? xu - sum : -sum;
    }
}

Sums operator+(const Sums& a, const Sums& b) {
  Sums sum;
  sum.first = a.first + b.first;
  for (std::size_t i = 0; i < 6; ++i) sum.second[i] = a.second[i] + b.second[i];
  sum.momentum = a.momentum + b.momentum;
  sum.bias = a.bias + b.bias;
  return sum;
}

Twist apply_inertia(Sym mass, const Sums& sums, const Twist& twist) {
  const Vec3 turning = cross(twist.angular, sums.first), force = mass * twist.linear + turning;
  const Vec3 rotational = apply_rotational(sums.second, twist.angular);
  return {force, cross(sums.first, twist.linear) + rotational};
}

Twist apply_bias(const Sums& sums, const Twist& twist) {
  return {cross(twist.angular, sums.momentum), sums.bias * twist.angular};
}

Vec3 apply_bias_transposed(const Sums& sums, const Twist& joint) {
  const Vec3 turning = transpose(sums.bias) * joint.angular;
  return cross(sums.momentum, joint.linear) + turning;
}

Sym element(const Twist& wrench, const Twist& twist) {
  const Sym angular = dot(wrench.angular, twist.angular);
  return dot(wrench.linear, twist.linear) + angular;
}

Vec3 to_child(const BodyConstants& body, const JointPosition& q, const Vec3& v) {
  const Vec3 x = transpose(body.rotation) * v;
  return {sum_of_products(q.cosine, x[0], q.sine, x[1]), difference_of_products(q.cosine, x[1], q.sine, x[0]), x[2]};
}

Vec3 to_parent(const BodyConstants& body, const JointPosition& q, const Vec3& f) {
  const Vec3 x{difference_of_products(q.cosine, f[0], q.sine, f[1]), sum_of_products(q.sine, f[0], q.cosine, f[1]), f[2]};
  return body.rotation * x;
}

Twist body_velocity(const Twist& parent, const BodyConstants& body, const JointPosition& q, Sym rate) {
  const Vec3 moved = cross(parent.angular, placed_origin(body, q)), origin = parent.linear + moved;
  const Sym turning = body.turning * rate, sliding = body.sliding * rate;
  Twist velocity{to_child(body, q, origin), to_child(body, q, parent.angular)};
  velocity.linear[2] = velocity.linear[2] + sliding;
  velocity.angular[2] = velocity.angular[2] + turning;
  return velocity;
}

Twist joint_motion(const BodyConstants& body, Sym rate) {
  const Sym zero{rate.graph, rate.graph->constant(0)};
  return {Vec3{zero, zero, body.sliding * rate}, Vec3{zero, zero, body.turning * rate}};
}

Motion propagate(const Motion& parent, const BodyConstants& body, const JointPosition& q, const Twist& joint) {
  const Vec3 &w = parent.angular, &a = parent.angular_acceleration;
  const Vec3 p = placed_origin(body, q);
  const Vec3 centripetal = cross(w, cross(w, p)), origin = parent.acceleration + cross(a, p) + centripetal;
  const Vec3 carried = to_child(body, q, w), gyroscopic = cross(carried, joint.angular);
  const Vec3 coriolis = cross(carried, joint.linear), turned = cross(joint.angular, joint.linear);
  return {carried + joint.angular, to_child(body, q, a) + gyroscopic, to_child(body, q, origin) + coriolis + coriolis + turned};
}

Motion propagate(const Motion& parent, const BodyConstants& body, const JointPosition& q, Sym rate) {
  const Vec3 &w = parent.angular, &a = parent.angular_acceleration;
  const Vec3 p = placed_origin(body, q);
  const Sym zero{rate.graph, rate.graph->constant(0)};
  const Vec3 z{zero, zero, body.turning * rate};      // the joint's angular rate, in the body's axes
  const Vec3 slide{zero, zero, body.sliding * rate};  // its linear rate

  // The origin's acceleration: a_p + α × p + w × (w × p), and twice w × ḋ where the joint slides.
  const Vec3 centripetal = cross(w, cross(w, p));
  const Vec3 origin = parent.acceleration + cross(a, p) + centripetal;
  Motion motion;
  const Vec3 carried = to_child(body, q, w);
  motion.angular = carried + z;
  const Vec3 gyroscopic = cross(carried, z);
  motion.angular_acceleration = to_child(body, q, a) + gyroscopic;
  const Vec3 coriolis = cross(carried, slide);
  motion.acceleration = to_child(body, q, origin) + coriolis + coriolis;
  return motion;
}

void accelerate(Motion& motion, const BodyConstants& body, Sym acceleration) {
  motion.angular_acceleration[2] = motion.angular_acceleration[2] + body.turning * acceleration;
  motion.acceleration[2] = motion.acceleration[2] + body.sliding * acceleration;
}

Force body_force(const Motion& motion, const BodyConstants& body) {
  const Vec3 &w = motion.angular, &a = motion.angular_acceleration, &h = body.first;
  Force f;
  const Vec3 centripetal = cross(w, cross(w, h)), tangential = cross(a, h);
  f.force = body.mass * motion.acceleration + tangential + centripetal;
  const Vec3 gyroscopic = cross(w, apply_rotational(body.second, w)), angular = apply_rotational(body.second, a);
  f.torque = cross(h, motion.acceleration) + angular + gyroscopic;
  return f;
}

}  // namespace dalembert::passes
