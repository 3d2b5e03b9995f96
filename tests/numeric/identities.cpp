#include "identities.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>

#include "scale.hpp"

namespace dalembert::testing {

namespace {

const Multi step("1e-30");

// |a − b| against the largest element of either.
double relative(const Matrix& a, const Matrix& b) { return relative_error(a, b, std::max<Multi>(largest(a), largest(b))); }

Matrix transposed(const Matrix& m) { return m.transpose(); }

const Inertia<Multi>& inertia_of(const Model& model, size_t pose) {
  return pose == 0 ? model.base : model.bodies[pose - 1].inertia;
}

// Bodies that can move; poses[0] is the base.
size_t first_moving(const Model& model) { return model.floating_base ? 0 : 1; }

Vector3<Multi> unskew(const Matrix3<Multi>& m) { return {m(2, 1), m(0, 2), m(1, 0)}; }

// Body twists in body axes, from differences of world poses along v.
std::vector<Vector6<Multi>> twists(const Model& model, const Vector& q, const Vector& v) {
  const auto before = world_poses(model, integrate(model, q, v, -step)),
             after = world_poses(model, integrate(model, q, v, step));
  const auto now = world_poses(model, q);
  std::vector<Vector6<Multi>> result;
  for (size_t b = first_moving(model); b < now.size(); ++b) {
    const Matrix3<Multi> back = now[b].rotation.transpose();
    Vector6<Multi> twist;
    twist << back * (after[b].translation - before[b].translation), unskew(back * (after[b].rotation - before[b].rotation));
    result.push_back(twist / (2 * step));
  }
  return result;
}

Multi potential_energy(const Model& model, const Vector& q) {
  Multi energy = 0;
  const auto poses = world_poses(model, q);
  for (size_t b = first_moving(model); b < poses.size(); ++b) {
    const Inertia<Multi>& body = inertia_of(model, b);
    energy -= body.mass * model.gravity.dot(poses[b].rotation * body.com + poses[b].translation);
  }
  return energy;
}

// Momentum of the whole robot in the world: linear, and angular about the point `about`.
Vector6<Multi> momentum(const Case& robot, const Vector& q, const Vector3<Multi>& about) {
  const Model& model = robot.model;
  const auto poses = world_poses(model, q);
  const auto motion = twists(model, q, robot.v);
  Vector3<Multi> linear = Vector3<Multi>::Zero(), angular = Vector3<Multi>::Zero();
  for (size_t b = first_moving(model); b < poses.size(); ++b) {
    const Inertia<Multi>& body = inertia_of(model, b);
    const Matrix3<Multi>& R = poses[b].rotation;
    const Vector6<Multi>& twist = motion[b - first_moving(model)];
    const Vector3<Multi> v = twist.head<3>(), w = twist.tail<3>();
    const Vector3<Multi> p = R * (body.mass * (v + w.cross(body.com)));
    linear += p;
    angular += (R * body.com + poses[b].translation - about).cross(p) + R * (body.inertia * w);
  }
  Vector6<Multi> result;
  result << linear, angular;
  return result;
}

// A 6-vector of the world's axes in the base's.
Vector6<Multi> in_base_axes(const Case& robot, const Vector6<Multi>& vector) {
  const Matrix3<Multi> back = world_poses(robot.model, robot.q)[0].rotation.transpose();
  Vector6<Multi> result;
  result << back * vector.head<3>(), back * vector.tail<3>();
  return result;
}

}  // namespace

Vector integrate(const Model& model, const Vector& q, const Vector& v, const Multi& h) {
  Vector result = q;
  Eigen::Index at = 0, i = 0;  // in q and v
  // A pose moves by the twist that begins at i, along its own axes. It turns half-way while it slides; what is left out is of
  // order h³.
  const auto move_pose = [&](bool slides) {
    const Eigen::Index turn = slides ? at + 3 : at;
    const Eigen::Quaternion<Multi> now(q[turn + 3], q[turn], q[turn + 1], q[turn + 2]);
    const Vector3<Multi> angular = h * v.segment<3>(slides ? i + 3 : i);
    if (slides) {
      const Vector3<Multi> linear = v.segment<3>(i);
      result.segment<3>(at) += now.toRotationMatrix() * (h * linear + h * angular.cross(linear) / 2);
    }
    if (const Multi angle = angular.norm(); angle > 0) {
      const Eigen::Quaternion<Multi> next = now * Eigen::Quaternion<Multi>(Eigen::AngleAxis<Multi>(angle, angular / angle));
      result.segment<4>(turn) = next.coeffs();
    }
    at = turn + 4, i += slides ? 6 : 3;
  };
  if (model.floating_base) move_pose(true);
  if (model.quaternions() == 0) {  // driven joints have no number of their own
    result.tail(q.size() - at) += h * v.tail(v.size() - i);
    return result;
  }
  for (const generic::Body<Multi>& body : model.bodies) {
    if (body.part == 0) move_pose(body.parts == 6);
    else if (body.part < 0) result[at++] += h * v[i++];
  }
  return result;
}

std::vector<Transform<Multi>> world_poses(const Model& model, const Vector& q) {
  std::vector<Transform<Multi>> poses(1);
  Eigen::Index next = 0;
  if (model.floating_base) {
    poses[0] = {Eigen::Quaternion<Multi>(q[6], q[3], q[4], q[5]).toRotationMatrix(), q.head<3>()};
    next = 7;
  }
  for (const generic::Body<Multi>& body : model.bodies) {
    const Transform<Multi>& parent = poses[static_cast<size_t>(body.parent + 1)];
    Transform<Multi> pose{parent.rotation * body.rotation, parent.rotation * body.translation + parent.translation};
    if (body.part == 0) {
      if (body.parts == 6) pose.translation += pose.rotation * q.segment<3>(next), next += 3;
      pose.rotation =
          pose.rotation * Eigen::Quaternion<Multi>(q[next + 3], q[next], q[next + 1], q[next + 2]).toRotationMatrix();
      next += 4;
    }
    if (body.part >= 0) {
      poses.push_back(pose);
      continue;
    }
    const Multi position = q[next++];
    if (!body.prismatic) pose.translation += pose.rotation * body.axis * (body.pitch * position);
    if (body.prismatic) {
      pose.translation += pose.rotation * body.axis * position;
    } else {
      pose.rotation = pose.rotation * Eigen::AngleAxis<Multi>(position, body.axis).toRotationMatrix();
    }
    poses.push_back(pose);
  }
  return poses;
}

double mass_rate_error(const Case& c, const Dynamics& result) {
  const Matrix after = generic::mass_matrix<Multi>(c.model, integrate(c.model, c.q, c.v, step));
  const Matrix before = generic::mass_matrix<Multi>(c.model, integrate(c.model, c.q, c.v, -step));
  const Matrix rate = (after - before) / (2 * step);
  return relative_error(rate, Matrix(result.coriolis_matrix + transposed(result.coriolis_matrix)),
                        Scale<Multi>(result, c.v).coriolis_matrix);
}

double bias_error(const Case& c, const Dynamics& result) {
  const Vector zero = Vector::Zero(c.v.size());
  return relative(result.coriolis_matrix * c.v + result.gravity, generic::inverse_dynamics<Multi>(c.model, c.q, c.v, zero)) +
         relative(result.coriolis_matrix * c.v + result.gravity, result.bias);
}

double mass_column_error(const Case& c, const Dynamics& result) {
  Model weightless = c.model;
  weightless.gravity.setZero();
  const Vector zero = Vector::Zero(c.v.size());
  Matrix columns(c.v.size(), c.v.size());
  for (Eigen::Index i = 0; i < columns.cols(); ++i)
    columns.col(i) = generic::inverse_dynamics<Multi>(weightless, c.q, zero, Vector::Unit(columns.rows(), i));
  return relative(columns, result.mass_matrix);
}

double symmetry_error(const Case&, const Dynamics& result) {
  return relative(result.mass_matrix, transposed(result.mass_matrix));
}

double definiteness_error(const Case&, const Dynamics& result) {
  return Eigen::LLT<Matrix>(result.mass_matrix).info() == Eigen::Success ? 0 : 1;
}

double gravity_error(const Case& c, const Dynamics& result) {
  Vector gradient(c.v.size());
  for (Eigen::Index i = 0; i < gradient.size(); ++i) {
    const Vector direction = Vector::Unit(gradient.size(), i);
    gradient[i] = (potential_energy(c.model, integrate(c.model, c.q, direction, step)) -
                   potential_energy(c.model, integrate(c.model, c.q, direction, -step))) /
                  (2 * step);
  }
  return relative(gradient, result.gravity);
}

double momentum_error(const Case& c, const Dynamics& result) {
  if (!c.model.floating_base) return 0;
  const Vector6<Multi> expected = in_base_axes(c, momentum(c, c.q, c.q.head<3>()));
  return relative(expected, result.mass_matrix.topRows<6>() * c.v);
}

double momentum_rate_error(const Case& c, const Dynamics& result) {
  if (!c.model.floating_base) return 0;
  // With constant v (rates in moving axes) the momentum about the point where the base is now changes by the base's rows of C
  // v.
  const Vector3<Multi> about = c.q.head<3>();
  const Vector6<Multi> change =
      (momentum(c, integrate(c.model, c.q, c.v, step), about) - momentum(c, integrate(c.model, c.q, c.v, -step), about)) /
      (2 * step);
  return relative(in_base_axes(c, change), result.coriolis_matrix.topRows<6>() * c.v);
}

double energy_error(const Case& c, const Dynamics& result) {
  Multi energy = 0;
  const auto motion = twists(c.model, c.q, c.v);
  for (size_t b = 0; b < motion.size(); ++b) {
    const Inertia<Multi>& body = inertia_of(c.model, b + first_moving(c.model));
    const Vector3<Multi> w = motion[b].tail<3>(), v = motion[b].head<3>() + w.cross(body.com);
    energy += (body.mass * v.squaredNorm() + w.dot(body.inertia * w)) / 2;
  }
  return relative(Matrix::Constant(1, 1, energy), Matrix::Constant(1, 1, c.v.dot(result.mass_matrix * c.v) / 2));
}

double influence_error(const Case& c, const Dynamics& result) {
  Matrix expected(result.wrench_influence.rows(), result.wrench_influence.cols());
  for (Eigen::Index i = 0; i < expected.rows(); ++i) {
    const auto motion = twists(c.model, c.q, Vector::Unit(expected.rows(), i));
    if (expected.cols() != static_cast<Eigen::Index>(6 * motion.size())) return 1;
    for (size_t b = 0; b < motion.size(); ++b) {
      const auto column = static_cast<Eigen::Index>(6 * b);
      // Of a joint with a quaternion the last body alone is one.
      const size_t body = b + first_moving(c.model);
      const bool is_part =
          body > 0 && c.model.bodies[body - 1].part >= 0 && c.model.bodies[body - 1].part + 1 < c.model.bodies[body - 1].parts;
      if (is_part) expected.row(i).segment<6>(column) = result.wrench_influence.row(i).segment<6>(column);
      else expected.row(i).segment<6>(column) = motion[b].transpose();
    }
  }
  return relative(expected, result.wrench_influence);
}

double sparsity_error(const Case& c, const Dynamics& result) {
  const int base = c.model.base_rows();
  const auto is_ancestor = [&](int i, int k) {
    while (k > i) k = c.model.bodies[static_cast<size_t>(k)].parent;
    return k == i;
  };
  Multi largest = 0;
  for (int i = 0; i < c.model.joints(); ++i)
    for (int k = i + 1; k < c.model.joints(); ++k)
      if (!is_ancestor(i, k))
        for (const Matrix* m : {&result.mass_matrix, &result.coriolis_matrix})
          largest = std::max<Multi>({largest, abs((*m)(base + i, base + k)), abs((*m)(base + k, base + i))});
  return static_cast<double>(largest);
}

}  // namespace dalembert::testing
