#include "dart_oracle.hpp"

#include <dart/dart.hpp>
#include <dart/utils/urdf/urdf.hpp>
#include <stdexcept>

#include "urdf_text.hpp"

namespace dalembert::oracle {

struct DartOracle::Impl {
  dart::dynamics::SkeletonPtr skeleton;
  bool floating = false;
  std::vector<int> dof;  // our coordinate of v → DART's
  dart::dynamics::Joint* last_joint = nullptr;

  dart::dynamics::FreeJoint& free_joint() { return dynamic_cast<dart::dynamics::FreeJoint&>(*skeleton->getJoint(0)); }

  Coordinates own_coordinates(const Eigen::VectorXd& q, const Eigen::VectorXd& v) const {
    const int nv = static_cast<int>(dof.size());
    const int base_dofs = floating ? 6 : 0;
    Coordinates own{Eigen::VectorXd(nv), Eigen::VectorXd(nv)};
    if (floating) {
      Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
      pose.translation() = q.head<3>();
      pose.linear() = Eigen::Quaterniond(q[6], q[3], q[4], q[5]).toRotationMatrix();
      own.positions.head<6>() = dart::dynamics::FreeJoint::convertToPositions(pose);
    }
    for (int i = 0; i < nv; ++i) {
      own.velocities[dof[static_cast<size_t>(i)]] = v[i];
      if (i >= base_dofs) own.positions[dof[static_cast<size_t>(i)]] = q[i + (floating ? 1 : 0)];
    }
    return own;
  }

  Eigen::VectorXd ours(const Eigen::VectorXd& theirs) const {
    Eigen::VectorXd result(theirs.size());
    for (int i = 0; i < result.size(); ++i) result[i] = theirs[dof[static_cast<size_t>(i)]];
    return result;
  }
  Eigen::VectorXd theirs(const Eigen::VectorXd& ours) const {
    Eigen::VectorXd result(ours.size());
    for (int i = 0; i < result.size(); ++i) result[dof[static_cast<size_t>(i)]] = ours[i];
    return result;
  }
  Eigen::MatrixXd ours(const Eigen::MatrixXd& theirs) const {
    Eigen::MatrixXd result(theirs.rows(), theirs.cols());
    for (int i = 0; i < result.cols(); ++i) result.col(i) = ours(Eigen::VectorXd(theirs.col(dof[static_cast<size_t>(i)])));
    return result;
  }
};

namespace {

dart::dynamics::SkeletonPtr load(const Request& request) {
  // A link without <inertial> would silently weigh 1 kg. DART refuses a mass of zero only in asserts that its release build
  // does not have; a mass of 1e-300 adds nothing to any sum and passes them all.
  const dart::dynamics::Inertia nothing(1e-300, Eigen::Vector3d::Zero(), 1e-300 * Eigen::Matrix3d::Identity());
  using Root = dart::utils::DartLoader::RootJointType;
  dart::utils::DartLoader::Options options(nullptr, request.base == Base::floating ? Root::FLOATING : Root::FIXED, nothing);
  auto skeleton = dart::utils::DartLoader(options).parseSkeletonString(edited_urdf(request.urdf, {}), "");
  if (!skeleton) throw std::runtime_error(request.urdf + ": DART cannot read it");
  skeleton->setGravity(request.gravity);
  for (auto* dof : skeleton->getDofs()) {
    dof->setDampingCoefficient(0);
    dof->setCoulombFriction(0);
    dof->setSpringStiffness(0);
  }
  return skeleton;
}

}  // namespace

DartOracle::DartOracle(const Request& request) : impl_(std::make_unique<Impl>()) {
  impl_->skeleton = load(request);
  impl_->floating = request.base == Base::floating;
  if (impl_->floating) {
    // DART: [angular; linear], both in base axes; ours: [linear; angular]. A permutation, so nothing else changes.
    for (const int i : {3, 4, 5, 0, 1, 2})
      impl_->dof.push_back(static_cast<int>(impl_->free_joint().getIndexInSkeleton(static_cast<size_t>(i))));
  }
  for (const std::string& name : request.joints) {
    auto* joint = impl_->skeleton->getJoint(name);
    if (!joint || joint->getNumDofs() != 1)
      throw std::runtime_error(request.urdf + ": DART has no moving joint '" + name + "'");
    impl_->dof.push_back(static_cast<int>(joint->getIndexInSkeleton(0)));
    impl_->last_joint = joint;
  }
  if (impl_->dof.size() != impl_->skeleton->getNumDofs()) {
    throw std::runtime_error(request.urdf + ": DART reads " + std::to_string(impl_->skeleton->getNumDofs()) +
                             " coordinates, not " + std::to_string(impl_->dof.size()));
  }
}

DartOracle::~DartOracle() = default;
DartOracle::DartOracle(DartOracle&&) noexcept = default;

DartOracle::Coordinates DartOracle::own_coordinates(const Eigen::VectorXd& q, const Eigen::VectorXd& v) {
  return impl_->own_coordinates(q, v);
}
void DartOracle::set_state(const Coordinates& coordinates) {
  impl_->skeleton->setPositions(coordinates.positions);
  impl_->skeleton->setVelocities(coordinates.velocities);
}
const Eigen::MatrixXd& DartOracle::own_mass_matrix() { return impl_->skeleton->getMassMatrix(); }
const Eigen::VectorXd& DartOracle::own_gravity() { return impl_->skeleton->getGravityForces(); }
const Eigen::VectorXd& DartOracle::own_bias() { return impl_->skeleton->getCoriolisAndGravityForces(); }
Eigen::VectorXd DartOracle::own_inverse_dynamics(const Eigen::VectorXd& own_accelerations) {
  impl_->skeleton->setAccelerations(own_accelerations);
  impl_->skeleton->computeInverseDynamics();
  return impl_->skeleton->getForces();
}
Eigen::VectorXd DartOracle::own_forward_dynamics(const Eigen::VectorXd& own_forces) {
  impl_->skeleton->setForces(own_forces);
  impl_->skeleton->computeForwardDynamics();
  return impl_->skeleton->getAccelerations();
}
Eigen::VectorXd DartOracle::own_vector(const Eigen::VectorXd& ours) const { return impl_->theirs(ours); }
Eigen::VectorXd DartOracle::our_vector(const Eigen::VectorXd& own) const { return impl_->ours(own); }

Dynamics DartOracle::evaluate(const Eigen::VectorXd& q, const Eigen::VectorXd& v) {
  set_state(own_coordinates(q, v));
  Dynamics result;
  result.mass_matrix = impl_->ours(impl_->skeleton->getMassMatrix());
  result.coriolis = impl_->ours(impl_->skeleton->getCoriolisForces());
  result.gravity = impl_->ours(impl_->skeleton->getGravityForces());
  result.bias = impl_->ours(impl_->skeleton->getCoriolisAndGravityForces());
  result.momentum.setZero();
  if (impl_->floating) {
    // Body by body, from DART's spatial velocities and inertias rather than from the mass matrix: another road to M's rows.
    const auto* base = impl_->skeleton->getBodyNode(0);
    for (const auto* body : impl_->skeleton->getBodyNodes()) {
      const Eigen::Isometry3d pose = body->getTransform(base);
      const Eigen::Matrix<double, 6, 1> own =
          body->getInertia().getSpatialTensor() * body->getSpatialVelocity();  // [angular; linear]
      const Eigen::Vector3d linear = pose.linear() * own.tail<3>();
      result.momentum.head<3>() += linear;
      result.momentum.tail<3>() += pose.linear() * own.head<3>() + pose.translation().cross(linear);
    }
  }
  return result;
}

Response DartOracle::respond(const Question& question) {
  dart::dynamics::Skeleton& skeleton = *impl_->skeleton;
  set_state(own_coordinates(question.q, question.v));
  Response result;
  dart::dynamics::BodyNode* last = impl_->last_joint->getChildBodyNode();
  last->addExtForce(question.wrench.head<3>(), Eigen::Vector3d::Zero(), false, true);
  last->addExtTorque(question.wrench.tail<3>(), false);
  skeleton.setAccelerations(own_vector(question.v_dot));
  skeleton.computeInverseDynamics(true);
  result.inverse_dynamics = our_vector(skeleton.getForces());
  result.forward_dynamics = our_vector(own_forward_dynamics(own_vector(question.tau)));
  skeleton.clearExternalForces();

  // Column by column, by articulated bodies at rest without gravity: getInvMassMatrix() of DART 6.12 forgets what hangs on a
  // welded link.
  const Eigen::Index nv = question.v.size();
  const Eigen::Vector3d gravity = skeleton.getGravity();
  skeleton.setGravity(Eigen::Vector3d::Zero());
  skeleton.setVelocities(Eigen::VectorXd::Zero(nv));
  result.inverse_mass_matrix.resize(nv, nv);
  for (Eigen::Index i = 0; i < nv; ++i) {
    skeleton.setForces(impl_->theirs(Eigen::VectorXd::Unit(nv, i)));
    skeleton.computeForwardDynamics();
    result.inverse_mass_matrix.col(i) = impl_->ours(skeleton.getAccelerations());
  }
  skeleton.setGravity(gravity);
  return result;
}

namespace {

using namespace dart::dynamics;

// The joint of the given kind between two bodies.
template <class Kind>
BodyNode* add(Skeleton& skeleton, BodyNode* parent, typename Kind::Properties properties, const ir::Joint& joint,
              const BodyNode::AspectProperties& body) {
  properties.mName = joint.name;
  properties.mT_ParentBodyToJoint = joint.origin;
  return skeleton.createJointAndBodyNodePair<Kind>(parent, properties, BodyNode::Properties(body)).second;
}

BodyNode* add_joint(Skeleton& skeleton, BodyNode* parent, const ir::Joint& joint, const ir::JointKind* kind,
                    const BodyNode::AspectProperties& body) {
  switch (kind ? kind->type : joint.type) {
    case ir::JointType::prismatic: {
      PrismaticJoint::Properties p;
      p.mAxis = joint.axis;
      return add<PrismaticJoint>(skeleton, parent, p, joint, body);
    }
    case ir::JointType::helical: {
      ScrewJoint::Properties p;
      p.mAxis = joint.axis;
      p.mPitch = kind->pitch;
      return add<ScrewJoint>(skeleton, parent, p, joint, body);
    }
    case ir::JointType::universal: {
      UniversalJoint::Properties p;
      p.mAxis = {joint.axis, kind->second};
      return add<UniversalJoint>(skeleton, parent, p, joint, body);
    }
    case ir::JointType::planar: {
      PlanarJoint::Properties p;
      const Eigen::Quaterniond turn = Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitZ(), joint.axis);
      p.setArbitraryPlane(turn * Eigen::Vector3d::UnitX(), turn * Eigen::Vector3d::UnitY());
      return add<PlanarJoint>(skeleton, parent, p, joint, body);
    }
    case ir::JointType::spherical: return add<BallJoint>(skeleton, parent, {}, joint, body);
    case ir::JointType::floating: return add<FreeJoint>(skeleton, parent, {}, joint, body);
    default: {
      RevoluteJoint::Properties p;
      p.mAxis = joint.axis;
      return add<RevoluteJoint>(skeleton, parent, p, joint, body);
    }
  }
}

}  // namespace

KindsAnswer dart_answer(const KindsRobot& robot, const std::vector<KindsCoordinate>& coordinates,
                        const std::vector<int>& positions, bool floating, const Eigen::Vector3d& gravity,
                        const Eigen::VectorXd& q, const Eigen::VectorXd& v, const Eigen::VectorXd& tau) {
  const auto skeleton = Skeleton::create("kinds");
  skeleton->setGravity(gravity);
  std::vector<BodyNode*> bodies;
  const auto properties = [&](size_t link) {
    BodyNode::AspectProperties body(robot.robot.links[link].name);
    const ir::Inertia& inertia = *robot.robot.links[link].inertia;
    body.mInertia = Inertia(inertia.mass, inertia.com, inertia.inertia);
    return body;
  };
  const BodyNode::Properties base(properties(0));
  bodies.push_back(floating ? skeleton->createJointAndBodyNodePair<FreeJoint>(nullptr, FreeJoint::Properties(), base).second
                            : skeleton->createJointAndBodyNodePair<WeldJoint>(nullptr, WeldJoint::Properties(), base).second);
  for (const ir::Joint& joint : robot.robot.joints) {  // parents stand before their children
    const auto kind = robot.joints.find(joint.name);
    bodies.push_back(add_joint(*skeleton, bodies[static_cast<size_t>(joint.parent)], joint,
                               kind == robot.joints.end() ? nullptr : &kind->second,
                               properties(static_cast<size_t>(joint.child))));
  }
  std::vector<Eigen::Index> dof;
  Eigen::VectorXd own_q = Eigen::VectorXd::Zero(v.size()), own_v(v.size()), own_tau(v.size());
  const auto pose = [&](Eigen::Index at, bool flies) {
    Eigen::Isometry3d moved = Eigen::Isometry3d::Identity();
    if (flies) moved.translation() = q.segment<3>(at);
    if (flies) at += 3;
    moved.linear() = Eigen::Quaterniond(q[at + 3], q[at], q[at + 1], q[at + 2]).toRotationMatrix();
    return moved;
  };
  if (floating) {
    const auto& joint = *skeleton->getJoint(0);
    for (const size_t i : {3u, 4u, 5u, 0u, 1u, 2u}) dof.push_back(static_cast<Eigen::Index>(joint.getIndexInSkeleton(i)));
    own_q.segment<6>(static_cast<Eigen::Index>(joint.getIndexInSkeleton(0))) = FreeJoint::convertToPositions(pose(0, true));
  }
  for (size_t i = 0; i < coordinates.size(); ++i) {
    const auto* joint = skeleton->getJoint(coordinates[i].joint);
    const bool flies = joint->getType() == FreeJoint::getStaticType(), turns = joint->getType() == BallJoint::getStaticType();
    const int part = coordinates[i].part;  // DART has the angular velocity first
    dof.push_back(static_cast<Eigen::Index>(joint->getIndexInSkeleton(static_cast<size_t>(flies ? (part + 3) % 6 : part))));
    const auto first = static_cast<Eigen::Index>(joint->getIndexInSkeleton(0));
    if (flies) own_q.segment<6>(first) = FreeJoint::convertToPositions(pose(positions[i], true));
    else if (turns)
      own_q.segment<3>(first) = BallJoint::convertToPositions(Eigen::Matrix3d(pose(positions[i], false).linear()));
    else own_q[dof.back()] = q[positions[i]];
  }
  for (size_t i = 0; i < dof.size(); ++i) {
    own_v[dof[i]] = v[static_cast<Eigen::Index>(i)];
    own_tau[dof[i]] = tau[static_cast<Eigen::Index>(i)];
  }
  skeleton->setPositions(own_q);
  skeleton->setVelocities(own_v);
  const auto ours = [&](const Eigen::VectorXd& theirs) {
    Eigen::VectorXd result(theirs.size());
    for (size_t i = 0; i < dof.size(); ++i) result[static_cast<Eigen::Index>(i)] = theirs[dof[i]];
    return result;
  };
  KindsAnswer answer{Eigen::MatrixXd(v.size(), v.size()), ours(skeleton->getCoriolisAndGravityForces()), {}};
  const Eigen::MatrixXd M = skeleton->getMassMatrix();
  for (size_t i = 0; i < dof.size(); ++i) answer.mass_matrix.col(static_cast<Eigen::Index>(i)) = ours(M.col(dof[i]));
  skeleton->setForces(own_tau);
  skeleton->computeForwardDynamics();
  answer.forward_dynamics = ours(skeleton->getAccelerations());
  return answer;
}

}  // namespace dalembert::oracle
