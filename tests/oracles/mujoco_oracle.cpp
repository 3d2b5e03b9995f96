#include "mujoco_oracle.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <cstring>
#include <iomanip>
#include <sstream>
#include <stdexcept>

#include "urdf_text.hpp"

namespace dalembert::oracle {
namespace {

mjModel* loaded(const std::string& text, const char* name, const std::string& urdf) {
  const auto files = std::make_unique<mjVFS>();  // 2 MB: too large for the stack
  mj_defaultVFS(files.get());
  mj_makeEmptyFileVFS(files.get(), name, static_cast<int>(text.size()));
  std::memcpy(files->filedata[mj_findFileVFS(files.get(), name)], text.data(), text.size());
  char message[1000] = "";
  mjModel* model = mj_loadXML(name, files.get(), message, sizeof message);
  mj_deleteVFS(files.get());
  if (!model) throw std::runtime_error(urdf + ": MuJoCo: " + message);
  return model;
}

mjModel* load(const Request& request, Inertias inertias) {
  UrdfEdit edit;
  edit.floating_joint = request.base == Base::floating;
  edit.placeholder_inertia = inertias == Inertias::overwritten;
  return loaded(edited_urdf(request.urdf, edit), "robot.urdf", request.urdf);
}

std::ostream& write(std::ostream& out, const char* name, const double* numbers, int count) {
  out << ' ' << name << "='";
  for (int i = 0; i < count; ++i) out << (i ? " " : "") << numbers[i];
  return out << '\'';
}

// The bodies that hang on one, in MJCF, with placeholders for inertias: of a URDF, MuJoCo takes no constraints.
void write_bodies_on(const mjModel& m, int parent, std::ostream& out) {
  for (int body = 1; body < m.nbody; ++body) {
    if (m.body_parentid[body] != parent) continue;
    out << "<body name='" << mj_id2name(&m, mjOBJ_BODY, body) << '\'';
    write(out, "pos", m.body_pos + 3 * body, 3);
    write(out, "quat", m.body_quat + 4 * body, 4) << "><inertial pos='0 0 0' mass='1' diaginertia='1 1 1'/>";
    for (int i = 0; i < m.body_jntnum[body]; ++i) {
      const int joint = m.body_jntadr[body] + i;
      const char* const type = m.jnt_type[joint] == mjJNT_FREE ? "free" : m.jnt_type[joint] == mjJNT_SLIDE ? "slide" : "hinge";
      out << "<joint name='" << mj_id2name(&m, mjOBJ_JOINT, joint) << "' type='" << type << '\'';
      if (m.jnt_type[joint] != mjJNT_FREE) {
        write(out, "pos", m.jnt_pos + 3 * joint, 3);
        write(out, "axis", m.jnt_axis + 3 * joint, 3);
      }
      out << "/>";
    }
    write_bodies_on(m, body, out);
    out << "</body>";
  }
}

Eigen::Matrix3d base_rotation(const Eigen::VectorXd& q) {
  return Eigen::Quaterniond(q[6], q[3], q[4], q[5]).toRotationMatrix();  // w x y z
}

}  // namespace

MujocoOracle::MujocoOracle(const Request& request, Inertias inertias)
    : model_(load(request, inertias)),
      data_(mj_makeData(model_.get())),
      urdf_(request.urdf),
      floating_(request.base == Base::floating),
      joints_(request.joints) {
  if (const int moving = model_->nv - (floating_ ? 6 : 0); moving != static_cast<int>(joints_.size()))
    throw std::runtime_error(request.urdf + ": MuJoCo reads " + std::to_string(moving) + " moving joints, not " +
                             std::to_string(joints_.size()));
  find_joints();
  set_gravity(request.gravity);
}

void MujocoOracle::find_joints() {
  const mjModel& m = *model_;
  const auto joint_named = [&](const std::string& name) {
    const int joint = mj_name2id(&m, mjOBJ_JOINT, name.c_str());
    if (joint < 0) throw std::runtime_error(urdf_ + ": MuJoCo has no joint '" + name + "'");
    return joint;
  };
  qpos_.clear(), dof_.clear();
  for (const std::string& name : joints_) {
    const int joint = joint_named(name);
    qpos_.push_back(m.jnt_qposadr[joint]);
    dof_.push_back(m.jnt_dofadr[joint]);
  }
  if (floating_) {
    const int joint = joint_named(floating_joint_name);
    base_qpos_ = m.jnt_qposadr[joint];
    base_dof_ = m.jnt_dofadr[joint];
    base_body_ = m.jnt_bodyid[joint];
  }
}

void MujocoOracle::hold(const std::vector<Held>& held, double stiffness, double damping, double impedance) {
  const mjModel& m = *model_;
  std::ostringstream out;
  out << std::setprecision(17) << "<mujoco><compiler angle='radian'/><option gravity='" << m.opt.gravity[0] << ' '
      << m.opt.gravity[1] << ' ' << m.opt.gravity[2]
      << "' solver='Newton' jacobian='dense' tolerance='0' iterations='100'/><worldbody>";
  write_bodies_on(m, 0, out);
  out << "</worldbody><equality>";
  const auto body = [&](const std::string& joint) {
    const int id = mj_name2id(&m, mjOBJ_JOINT, joint.c_str());
    if (id < 0) throw std::runtime_error(urdf_ + ": MuJoCo has no joint '" + joint + "'");
    return mj_id2name(&m, mjOBJ_BODY, m.jnt_bodyid[id]);
  };
  for (const Held& one : held) {
    out << (one.weld ? "<weld" : "<connect anchor='0 0 0'") << " body1='" << body(one.joint) << '\'';
    if (!one.other.empty()) out << " body2='" << body(one.other) << '\'';
    out << " solref='" << -stiffness << ' ' << -damping << "' solimp='" << impedance << ' ' << impedance << " 1'/>";
  }
  out << "</equality></mujoco>";
  model_.reset(loaded(out.str(), "held.xml", urdf_));
  data_.reset(mj_makeData(model_.get()));
  model_->opt.disableflags |=
      mjDSBL_CONTACT | mjDSBL_LIMIT | mjDSBL_FRICTIONLOSS | mjDSBL_PASSIVE | mjDSBL_ACTUATION | mjDSBL_WARMSTART;
  find_joints();
}

void MujocoOracle::place(size_t i, const Eigen::Vector3d& at, const Eigen::Vector3d& at_other,
                         const Eigen::Quaterniond& turned) {
  double* const data = model_->eq_data + mjNEQDATA * i;
  const bool weld = model_->eq_type[i] == mjEQ_WELD;  // whose points stand the other way round
  Eigen::Map<Eigen::Vector3d>(data + (weld ? 3 : 0)) = at;
  Eigen::Map<Eigen::Vector3d>(data + (weld ? 0 : 3)) = at_other;
  if (!weld) return;
  const Eigen::Quaterniond back = turned.conjugate();  // of the other in the body
  Eigen::Map<Eigen::Vector4d>(data + 6) << back.w(), back.vec();
  data[10] = 1;  // "torquescale"
}

Soft MujocoOracle::soft(const Eigen::VectorXd& q, const Eigen::VectorXd& v, const Eigen::VectorXd& tau) {
  using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  const int nv = model_->nv;
  set_state(q, v);
  const auto [transform, drift] = change_of_coordinates(q, v);  // T is orthogonal
  Eigen::Map<Eigen::VectorXd>(data_->qfrc_applied, nv) = transform * tau;
  // Of a quaternion between two bodies and its negative, which are the same turn, the one near 1: else all its rows change
  // sign.
  mj_kinematics(model_.get(), data_.get());
  for (int i = 0; i < model_->neq; ++i) {
    if (model_->eq_type[i] != mjEQ_WELD) continue;
    const auto turn = [](const double* x) { return Eigen::Quaterniond(x[0], x[1], x[2], x[3]); };
    Eigen::Map<Eigen::Vector4d> back(model_->eq_data + mjNEQDATA * i + 6);
    const Eigen::Quaterniond body = turn(data_->xquat + 4 * model_->eq_obj1id[i]),
                             other = turn(data_->xquat + 4 * model_->eq_obj2id[i]);
    if ((other.conjugate() * body * turn(back.data())).w() < 0) back = -back.eval();
  }
  mj_forward(model_.get(), data_.get());
  const int rows = data_->nefc;
  const auto of_rows = [&](const double* array) { return Eigen::Map<const Eigen::VectorXd>(array, rows); };
  const Eigen::Map<const Eigen::Matrix<double, 4, Eigen::Dynamic>> gains(data_->efc_KBIP, 4, rows);  // K, B, I, I'
  return {Eigen::Map<const RowMajor>(data_->efc_J, rows, nv) * transform,
          of_rows(data_->efc_vel),
          of_rows(data_->efc_pos),
          of_rows(data_->efc_aref),
          of_rows(data_->efc_R),
          gains.row(0).cwiseProduct(gains.row(2)).transpose(),
          gains.row(1).transpose(),
          of_rows(data_->efc_force),
          transform.transpose() * (Eigen::Map<const Eigen::VectorXd>(data_->qacc, nv) - drift)};
}

void MujocoOracle::set_gravity(const Eigen::Vector3d& gravity) { Eigen::Map<Eigen::Vector3d>(model_->opt.gravity) = gravity; }

void MujocoOracle::set_springs(const ir::KinematicTree& tree) {
  for (size_t k = 0; k < tree.bodies.size(); ++k) {
    model_->jnt_stiffness[mj_name2id(model_.get(), mjOBJ_JOINT, joints_[k].c_str())] = tree.bodies[k].spring.k;
    model_->qpos_spring[qpos_[k]] = tree.bodies[k].spring.rest;
  }
}

Eigen::VectorXd MujocoOracle::spring_forces(const Eigen::VectorXd& q) {
  const int base = floating_ ? 6 : 0;
  set_state(q, Eigen::VectorXd::Zero(model_->nv));
  mj_fwdPosition(model_.get(), data_.get());
  mj_fwdVelocity(model_.get(), data_.get());
  Eigen::VectorXd result = Eigen::VectorXd::Zero(model_->nv);
  for (size_t k = 0; k < dof_.size(); ++k) result[base + static_cast<Eigen::Index>(k)] = data_->qfrc_passive[dof_[k]];
  return result;
}

void MujocoOracle::set_inertia(int body, const ir::Inertia& inertia) {
  // long double, so that the principal axes cost no digits.
  using Matrix3l = Eigen::Matrix<long double, 3, 3>;
  const Eigen::SelfAdjointEigenSolver<Matrix3l> solver(inertia.inertia.cast<long double>());
  Matrix3l axes = solver.eigenvectors();
  if (axes.determinant() < 0) axes.col(2) = -axes.col(2);
  const Eigen::Quaterniond orientation = Eigen::Quaternion<long double>(axes).normalized().cast<double>();

  mjModel& m = *model_;
  m.body_mass[body] = inertia.mass;
  Eigen::Map<Eigen::Vector3d>(m.body_ipos + 3 * body) = inertia.com;
  Eigen::Map<Eigen::Vector3d>(m.body_inertia + 3 * body) = solver.eigenvalues().cast<double>();
  Eigen::Map<Eigen::Vector4d>(m.body_iquat + 4 * body) << orientation.w(), orientation.vec();
  m.body_sameframe[body] = 0;
  m.body_simple[body] = 0;
}

void MujocoOracle::overwrite_inertias(const ir::KinematicTree& tree) {
  for (const ir::Body& body : tree.bodies) {
    const int joint = mj_name2id(model_.get(), mjOBJ_JOINT, body.joint.c_str());
    if (joint < 0) throw std::runtime_error("MuJoCo has no joint '" + body.joint + "'");
    set_inertia(model_->jnt_bodyid[joint], body.inertia);
  }
  if (floating_) set_inertia(base_body_, tree.base);
  std::fill_n(model_->dof_simplenum, model_->nv, 0);  // "simple" was decided on the old inertias
  mj_setConst(model_.get(), data_.get());             // what MuJoCo derives from inertias
}

void MujocoOracle::set_state(const Eigen::VectorXd& q, const Eigen::VectorXd& v) {
  int first = 0, first_v = 0;
  if (floating_) {
    const Eigen::Quaterniond rotation(q[6], q[3], q[4], q[5]);  // w x y z
    Eigen::Map<Eigen::Matrix<double, 7, 1>> qpos(data_->qpos + base_qpos_);
    Eigen::Map<Eigen::Matrix<double, 6, 1>> qvel(data_->qvel + base_dof_);
    qpos << q.head<3>(), rotation.w(), rotation.vec();
    qvel << rotation * v.head<3>(), v.segment<3>(3);
    first = 7, first_v = 6;
  }
  for (size_t i = 0; i < joints_.size(); ++i) {
    data_->qpos[qpos_[i]] = q[first + static_cast<int>(i)];
    data_->qvel[dof_[i]] = v[first_v + static_cast<int>(i)];
  }
}

Eigen::VectorXd MujocoOracle::own_bias(const Eigen::Vector3d& gravity) {
  const Eigen::Vector3d kept = Eigen::Map<Eigen::Vector3d>(model_->opt.gravity);
  set_gravity(gravity);
  Eigen::VectorXd result(model_->nv);
  mj_comVel(model_.get(), data_.get());
  mj_rne(model_.get(), data_.get(), 0, result.data());
  set_gravity(kept);
  return result;
}

Eigen::Matrix<double, 6, 1> MujocoOracle::own_momentum(const Eigen::Matrix3d& base_rotation) {
  mj_subtreeVel(model_.get(), data_.get());
  const auto of_base = [&](const double* array) { return Eigen::Map<const Eigen::Vector3d>(array + 3 * base_body_); };
  const Eigen::Vector3d linear = model_->body_subtreemass[base_body_] * of_base(data_->subtree_linvel);
  const Eigen::Vector3d arm = of_base(data_->subtree_com) - of_base(data_->xpos);
  const Eigen::Vector3d angular = of_base(data_->subtree_angmom) + arm.cross(linear);  // MuJoCo's is about the centre of mass
  Eigen::Matrix<double, 6, 1> result;
  result << base_rotation.transpose() * linear, base_rotation.transpose() * angular;
  return result;
}

MujocoOracle::Change MujocoOracle::change_of_coordinates(const Eigen::VectorXd& q, const Eigen::VectorXd& v) const {
  const int nv = model_->nv, base_dofs = floating_ ? 6 : 0;
  Change result{Eigen::MatrixXd::Zero(nv, nv), Eigen::VectorXd::Zero(nv)};
  for (size_t i = 0; i < dof_.size(); ++i) result.transform(dof_[i], base_dofs + static_cast<int>(i)) = 1;
  if (floating_) {
    const Eigen::Matrix3d rotation = base_rotation(q);
    result.transform.block<3, 3>(base_dof_, 0) = rotation;
    result.transform.block<3, 3>(base_dof_ + 3, 3).setIdentity();
    result.drift.segment<3>(base_dof_) = rotation * v.segment<3>(3).cross(v.head<3>());
  }
  return result;
}

void MujocoOracle::compute_mass_matrix() {
  mj_kinematics(model_.get(), data_.get());
  mj_comPos(model_.get(), data_.get());
  mj_crb(model_.get(), data_.get());
}

Dynamics MujocoOracle::evaluate(const Eigen::VectorXd& q, const Eigen::VectorXd& v) {
  const int nv = model_->nv;
  set_state(q, v);
  compute_mass_matrix();
  Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> own_mass(nv, nv);
  mj_fullM(model_.get(), own_mass.data(), data_->qM);

  Dynamics result;
  result.momentum.setZero();
  // M = Tᵀ M' T and C v = Tᵀ (c' + M' Ṫ v).
  const auto [transform, drift] = change_of_coordinates(q, v);
  const Eigen::VectorXd velocity_terms = own_bias(Eigen::Vector3d::Zero());
  if (floating_) result.momentum = own_momentum(base_rotation(q));
  result.mass_matrix = transform.transpose() * own_mass * transform;
  result.coriolis = transform.transpose() * (velocity_terms + own_mass * drift);
  result.bias = transform.transpose() * (own_bias(Eigen::Map<Eigen::Vector3d>(model_->opt.gravity)) + own_mass * drift);
  set_state(q, Eigen::VectorXd::Zero(nv));
  result.gravity = transform.transpose() * own_bias(Eigen::Map<Eigen::Vector3d>(model_->opt.gravity));
  return result;
}

int MujocoOracle::last_body() const {
  return model_->jnt_bodyid[mj_name2id(model_.get(), mjOBJ_JOINT, joints_.back().c_str())];
}

WholeRobot MujocoOracle::whole_robot(const Eigen::VectorXd& q, const Eigen::VectorXd& v) {
  using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  const int nv = model_->nv;
  set_state(q, v);
  compute_mass_matrix();
  mj_comVel(model_.get(), data_.get());
  model_->opt.enableflags |= mjENBL_ENERGY;  // else both energies are zero
  mj_energyPos(model_.get(), data_.get());
  mj_energyVel(model_.get(), data_.get());
  mj_subtreeVel(model_.get(), data_.get());
  const auto vector = [](const double* array) { return Eigen::Map<const Eigen::Vector3d>(array); };
  RowMajor center(3, nv), link(6, nv);
  mj_jacSubtreeCom(model_.get(), data_.get(), center.data(), 0);  // 0: the world's subtree
  const int body = last_body();
  mj_jacBody(model_.get(), data_.get(), link.data(), link.data() + 3 * nv, body);
  const Eigen::MatrixXd transform = change_of_coordinates(q, v).transform;

  WholeRobot result{data_->energy[1], data_->energy[0], vector(data_->subtree_com), center * transform, {}, {},
                    link * transform};
  result.momentum << model_->body_subtreemass[0] * vector(data_->subtree_linvel), vector(data_->subtree_angmom);
  result.link_pose << Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(data_->xmat + 9 * body),
      vector(data_->xpos + 3 * body);
  return result;
}

Response MujocoOracle::respond(const Question& question) {
  const int nv = model_->nv;
  set_state(question.q, question.v);
  compute_mass_matrix();
  mj_factorM(model_.get(), data_.get());
  mj_comVel(model_.get(), data_.get());
  const auto [transform, drift] = change_of_coordinates(question.q, question.v);  // T is orthogonal
  const auto rne = [&](const Eigen::VectorXd& qacc) {
    Eigen::Map<Eigen::VectorXd>(data_->qacc, nv) = qacc;
    Eigen::VectorXd result(nv);
    mj_rne(model_.get(), data_.get(), 1, result.data());
    return result;
  };
  const auto solve = [&](const Eigen::VectorXd& right) {
    Eigen::VectorXd result(nv);
    mj_solveM(model_.get(), data_.get(), result.data(), right.data(), 1);
    return result;
  };
  const int body = last_body();
  const Eigen::Vector3d force = question.wrench.head<3>(), torque = question.wrench.tail<3>();
  Eigen::VectorXd pushed = Eigen::VectorXd::Zero(nv);
  mj_applyFT(model_.get(), data_.get(), force.data(), torque.data(), data_->xpos + 3 * body, body, pushed.data());
  Response result;
  result.inverse_dynamics = transform.transpose() * (rne(transform * question.v_dot + drift) - pushed);
  const Eigen::VectorXd moving = transform * question.tau + pushed - rne(Eigen::VectorXd::Zero(nv));
  result.forward_dynamics = transform.transpose() * (solve(moving) - drift);
  result.inverse_mass_matrix.resize(nv, nv);
  for (int i = 0; i < nv; ++i) result.inverse_mass_matrix.col(i) = transform.transpose() * solve(transform.col(i));
  return result;
}

}  // namespace dalembert::oracle
