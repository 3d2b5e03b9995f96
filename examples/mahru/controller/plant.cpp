#include "plant.hpp"

#include <cstring>
#include <fstream>
#include <iterator>
#include <stdexcept>

namespace controller {
namespace {

constexpr int substeps = 2;

// MuJoCo welds the root of a URDF to the world. A link named "world" and a floating joint release it. Fixed joints stay bodies
// of their own ("fusestatic"): fusing would diagonalise the sum of their inertias, which MuJoCo does to few digits only.
std::string prepare(const std::string& file, Base base, const std::string& world) {
  std::ifstream in(file);
  if (!in) throw std::runtime_error(file + ": cannot be read");
  std::string text{std::istreambuf_iterator<char>(in), {}};
  const std::size_t robot = text.find('>', text.find("<robot name="));
  if (robot == std::string::npos) throw std::runtime_error(file + ": no element <robot>");
  std::string insert = "\n<mujoco><compiler fusestatic=\"false\"/></mujoco>";
  if (base == Base::floating)
    insert +=
        "\n" + world + "<joint name=\"release\" type=\"floating\"><parent link=\"world\"/><child link=\"pelvis\"/></joint>";
  return text.insert(robot + 1, insert);
}

mjModel* load(const std::string& text) {
  const auto files = std::make_unique<mjVFS>();  // too large for the stack
  mj_defaultVFS(files.get());
  mj_makeEmptyFileVFS(files.get(), "plant.urdf", static_cast<int>(text.size()));
  std::memcpy(files->filedata[0], text.data(), text.size());
  char error[1000] = "";
  mjModel* model = mj_loadXML("plant.urdf", files.get(), error, sizeof error);
  mj_deleteVFS(files.get());
  if (!model) throw std::runtime_error(std::string("MuJoCo refuses the robot: ") + error);
  return model;
}

Eigen::Matrix3d rotation_of(const mjData& data) {
  return Eigen::Quaterniond(data.qpos[3], data.qpos[4], data.qpos[5], data.qpos[6]).toRotationMatrix();
}

}  // namespace

Plant::Plant(const std::string& urdf_file, Base base, const char* const* joint_names, const std::string& world)
    : model_(load(prepare(urdf_file, base, world))), data_(mj_makeData(model_.get())), base_(base), nv_(model_->nv) {
  model_->opt.integrator = mjINT_RK4;
  model_->opt.timestep = period / substeps;
  model_->opt.disableflags = mjDSBL_CONSTRAINT | mjDSBL_CONTACT | mjDSBL_LIMIT | mjDSBL_PASSIVE | mjDSBL_SENSOR;
  if (base == Base::floating) mju_zero3(model_->opt.gravity);

  if (nv_ != joints + (base == Base::floating ? 6 : 0)) throw std::runtime_error("MuJoCo counts other degrees of freedom");
  for (int i = 0; i < nv_ - joints; ++i) order_.push_back(i);
  for (int i = 0; i < joints; ++i) {
    const int id = mj_name2id(model_.get(), mjOBJ_JOINT, joint_names[i]);
    if (id < 0) throw std::runtime_error(std::string("MuJoCo does not know the joint ") + joint_names[i]);
    position_index_.push_back(model_->jnt_qposadr[id]);
    velocity_index_.push_back(model_->jnt_dofadr[id]);
    lower_[i] = model_->jnt_range[2 * id];
    upper_[i] = model_->jnt_range[2 * id + 1];
  }
  order_.insert(order_.end(), velocity_index_.begin(), velocity_index_.end());
  full_mass_matrix_.resize(static_cast<std::size_t>(nv_) * nv_);
}

void Plant::write(const State& state) noexcept {
  for (int i = 0; i < joints; ++i) {
    data_->qpos[position_index_[i]] = state.q[i];
    data_->qvel[velocity_index_[i]] = state.v[i];
  }
  if (base_ == Base::fixed) return;
  const Eigen::Vector3d linear = state.base_rotation * state.base_linear;  // MuJoCo: linear in the world, angular in the base
  const Eigen::Quaterniond& r = state.base_rotation;
  const double quaternion[4] = {r.w(), r.x(), r.y(), r.z()};
  mju_copy3(data_->qpos, state.base_position.data());
  mju_copy4(data_->qpos + 3, quaternion);
  mju_copy3(data_->qvel, linear.data());
  mju_copy3(data_->qvel + 3, state.base_angular.data());
}

void Plant::read(State& state) const noexcept {
  for (int i = 0; i < joints; ++i) {
    state.q[i] = data_->qpos[position_index_[i]];
    state.v[i] = data_->qvel[velocity_index_[i]];
  }
  if (base_ == Base::fixed) return;
  const mjtNum *p = data_->qpos, *v = data_->qvel;
  state.base_position = {p[0], p[1], p[2]};
  state.base_rotation = Eigen::Quaterniond(p[3], p[4], p[5], p[6]);
  state.base_linear = rotation_of(*data_).transpose() * Eigen::Vector3d(v[0], v[1], v[2]);
  state.base_angular = {v[3], v[4], v[5]};
}

void Plant::step(const VectorJ& torque) noexcept {
  for (int i = 0; i < joints; ++i) data_->qfrc_applied[velocity_index_[i]] = torque[i];
  for (int i = 0; i < substeps; ++i) mj_step(model_.get(), data_.get());
}

void Plant::account(Account& account) noexcept {
  const mjModel* m = model_.get();
  mjData* d = data_.get();
  mj_kinematics(m, d);
  mj_comPos(m, d);
  mj_crb(m, d);
  mj_fullM(m, full_mass_matrix_.data(), d->qM);
  for (int i = 0; i < nv_; ++i)
    for (int j = 0; j < nv_; ++j)
      account.mass_matrix(i, j) = full_mass_matrix_[static_cast<std::size_t>(order_[i]) * nv_ + order_[j]];
  if (base_ == Base::fixed) return;

  // From linear velocities in the world to linear velocities in base axes: Tᵀ M T with T = diag(R, 1).
  const Eigen::Matrix3d r = rotation_of(*d);
  for (int i = 0; i < nv_; ++i)
    account.mass_matrix.block<3, 1>(0, i) = r.transpose() * account.mass_matrix.block<3, 1>(0, i).eval();
  for (int i = 0; i < nv_; ++i) account.mass_matrix.block<1, 3>(i, 0) = account.mass_matrix.block<1, 3>(i, 0).eval() * r;

  mj_comVel(m, d);
  mj_subtreeVel(m, d);  // of the world's subtree, body 0: everything
  const Eigen::Map<const Eigen::Vector3d> velocity(d->subtree_linvel), about_centre(d->subtree_angmom), centre(d->subtree_com);
  account.linear_momentum = m->body_subtreemass[0] * velocity;
  account.angular_momentum = about_centre + centre.cross(account.linear_momentum);
}

}  // namespace controller
