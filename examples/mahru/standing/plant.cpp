#include "plant.hpp"

#include <cmath>
#include <fstream>
#include <iterator>
#include <stdexcept>

namespace standing {
namespace {

using Rotation = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;  // as MuJoCo has it

constexpr double timestep = 0.5e-3;     // s
constexpr double contact_time = 10e-3;  // s, in which a sole that has sunk in comes up again

// The floor: a box that ends at z = 0.
constexpr const char* floor_link =
    "<link name=\"world\"><collision><origin xyz=\"0 0 -0.5\"/><geometry><box size=\"40 40 1\"/></geometry></collision></link>";

// MuJoCo leaves out what a URDF says of torques.
double effort_of(const std::string& urdf, const std::string& joint) {
  const std::size_t begin = urdf.find("<joint name=\"" + joint + "\""), end = urdf.find("</joint>", begin);
  const std::size_t effort = begin == std::string::npos ? begin : urdf.find("effort=\"", begin);
  if (effort >= end) throw std::runtime_error("the plant's URDF gives no effort of the joint " + joint);
  return std::stod(urdf.substr(effort + 8));
}

}  // namespace

Plant::Plant(const std::string& urdf_file, const char* const* joint_names, double friction)
    : controller::Plant(urdf_file, controller::Base::floating, joint_names, floor_link) {
  mjModel& m = *model_;
  m.opt.integrator = mjINT_EULER;  // with velocities first: the rule that MuJoCo's contacts are made for
  m.opt.timestep = timestep;
  m.opt.disableflags = mjDSBL_PASSIVE | mjDSBL_SENSOR;
  m.opt.gravity[2] = -9.81;
  m.opt.cone = mjCONE_ELLIPTIC;
  m.opt.solver = mjSOL_NEWTON;
  m.opt.tolerance = 1e-10;
  m.opt.impratio = 10;  // MuJoCo's friction creeps: this much less than it gives way under the weight

  std::ifstream in(urdf_file);
  const std::string urdf{std::istreambuf_iterator<char>(in), {}};
  for (int i = 0; i < joints; ++i) limits_[i] = effort_of(urdf, joint_names[i]);

  torso_ = mj_name2id(&m, mjOBJ_BODY, "torso");
  const int feet[] = {mj_name2id(&m, mjOBJ_BODY, "left_foot"), mj_name2id(&m, mjOBJ_BODY, "right_foot")};
  if (torso_ < 0 || feet[left] < 0 || feet[right] < 0)
    throw std::runtime_error("the plant's URDF lacks torso, left_foot or right_foot");
  for (int geom = 0; geom < m.ngeom; ++geom) {
    const int body = m.geom_bodyid[geom];
    const bool foot = body == feet[left] || body == feet[right], acts = foot || body == 0;
    if (foot) foot_geom_[body == feet[right]] = geom;
    m.geom_contype[geom] = m.geom_conaffinity[geom] = acts;
    m.geom_friction[3 * geom] = friction;
    m.geom_solref[mjNREF * geom] = contact_time;
    m.geom_solimp[mjNIMP * geom] = m.geom_solimp[mjNIMP * geom + 1] = 0.95;
  }
}

void Plant::push(const Vector3d& force) noexcept { mju_copy3(data_->xfrc_applied + 6 * torso_, force.data()); }

void Plant::ground(Vector12& forces) const noexcept {
  forces.setZero();
  for (int i = 0; i < data_->ncon; ++i) {
    const mjContact& contact = data_->contact[i];
    for (const Side side : sides) {
      const int geom = foot_geom_[side];
      if (contact.geom1 != geom && contact.geom2 != geom) continue;
      mjtNum local[6];
      mj_contactForce(model_.get(), data_.get(), i, local);
      // The normal, the first axis, points from the first geometry to the second, on which the force is.
      Vector3d force = Eigen::Map<const Rotation>(contact.frame).transpose() * Eigen::Map<const Vector3d>(local);
      if (contact.geom1 == geom) force = -force;
      const int body = model_->geom_bodyid[geom];
      const Eigen::Map<const Rotation> foot(data_->xmat + 9 * body);
      const Vector3d sole = Eigen::Map<const Vector3d>(data_->xpos + 3 * body) + foot * sole_in_foot(side);
      Vector3d lever = Eigen::Map<const Vector3d>(contact.pos) - sole;
      lever.z() = 0;  // MuJoCo's contacts are half as deep in the floor as the sole
      const Eigen::AngleAxisd heading(std::atan2(foot(1, 0), foot(0, 0)), Vector3d::UnitZ());
      forces.segment<3>(6 * side) += heading.inverse() * force;
      forces.segment<3>(6 * side + 3) += heading.inverse() * lever.cross(force);
    }
  }
}

}  // namespace standing
