// Contacts and loops against MuJoCo's soft constraints: its rows, what it makes of them, and what is left where they are stiff.
//
// MuJoCo solves (J M⁻¹ Jᵀ + R) f = a_ref − J v̇_free, in which J̇ v is left out. Its rows are T times ours: T turns linear rows
// to the world's axes and halves angular ones. What our rows' accelerations are to be, then, is T⁻¹ a_ref + J̇ v, our R is
// T⁻¹ R T⁻ᵀ, and MuJoCo's forces are T⁻ᵀ times ours. Loops are closed in all states here: where they are not, MuJoCo pushes
// each body at its own point, and we both at that of the second.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <dalembert/generic/constraints.hpp>

#include "load_robot.hpp"
#include "mujoco_oracle.hpp"
#include "reference/generic_model.hpp"
#include "reference/instances.hpp"
#include "standing_biped/dynamics.hpp"
#include "standing_quadruped/dynamics.hpp"
#include "states.hpp"

namespace dalembert::oracle {
namespace {

using Eigen::Matrix3d;
using Eigen::MatrixXd;
using Eigen::Quaterniond;
using Eigen::Vector3d;
using Eigen::VectorXd;

constexpr double stiffness = 400, damping = 30, impedance = 0.9;
constexpr double near = 1e-10;  // of the largest element
constexpr int states = 4;

struct Scenario {
  const char* name;
  TestRobot robot;
  bool floating;
  std::vector<Held> held;
  std::vector<bool> along_link{};  // of contacts: whether our rows are along the link's axes
  bool planar = false;             // whose rows are redundant
  std::vector<Vector3d> at{};      // where on the links; else random
  Vector3d gravity = testing::test_gravity;
};
void PrintTo(const Scenario& s, std::ostream* out) { *out << s.name; }

std::vector<Scenario> scenarios() {
  const char* const robots = TESTS "/robots/";
  static const std::string four_bars = TESTS "/numeric/generated/mechanisms/four_bars.urdf",
                           quadruped = std::string(robots) + "quadruped_12.urdf", arm = std::string(robots) + "six_axis.urdf",
                           arms = std::string(robots) + "dual_arm.urdf",
                           mahru = std::string(TESTS) + "/../examples/mahru/mahru.urdf";
  const std::vector<Held> feet{{"left_ankle_roll", "", true}, {"right_ankle_roll", "", true}},
      points{
          {"front_left_3_knee_joint"}, {"front_right_3_knee_joint"}, {"hind_left_3_knee_joint"}, {"hind_right_3_knee_joint"}},
      hand{{"a_6_roll_joint", "", true}},
      hands{{"b_left_7_yaw_joint", "b_right_7_yaw_joint", true}, {"b_left_3_yaw_joint", "b_right_3_yaw_joint"}},
      bars{{"foot_1", "top_0"}, {"foot_2", "top_1"}};
  return {{"mahru_floating", {"mahru", mahru.c_str()}, true, feet, {false, true}},
          {"mahru_fixed", {"mahru", mahru.c_str()}, false, feet, {true, false}},
          {"quadruped_floating", {"quadruped_12", quadruped.c_str()}, true, points, {false, true, false, true}},
          {"quadruped_fixed", {"quadruped_12", quadruped.c_str()}, false, points, {false, false, true, true}},
          {"hand_floating", {"six_axis", arm.c_str()}, true, hand},
          {"hand_fixed", {"six_axis", arm.c_str()}, false, hand},
          {"hands_floating", {"dual_arm", arms.c_str()}, true, hands},
          {"hands_fixed", {"dual_arm", arms.c_str()}, false, hands},
          {"four_bars", {"four_bars", four_bars.c_str()}, false, bars, {}, true}};
}

double error(const MatrixXd& ours, const MatrixXd& theirs) {
  if (!ours.allFinite() || !theirs.allFinite()) return std::numeric_limits<double>::infinity();
  return (ours - theirs).cwiseAbs().maxCoeff() / theirs.cwiseAbs().maxCoeff();
}

Matrix3d skew(const Vector3d& a) { return cross_matrix<double>(a); }

// A robot that is held, in both worlds.
struct Both {
  const Scenario& scenario;
  ir::KinematicTree tree;
  MujocoOracle mujoco;
  generic::Model<double> model;
  // At a state.
  VectorXd q, v, tau;
  generic::Constraints<double> constraints;
  MatrixXd turn;  // T

  explicit Both(const Scenario& s, double how_soft = impedance)
      : scenario(s),
        tree(testing::load_robot(s.robot, s.floating)),
        mujoco(request(s, tree), Inertias::overwritten),
        model(to_generic<double>(tree, s.gravity)) {
    mujoco.hold(s.held, stiffness, damping, how_soft);
    mujoco.overwrite_inertias(tree);
  }

  static Request request(const Scenario& s, const ir::KinematicTree& tree) {
    Request r{s.robot.urdf, s.floating ? Base::floating : Base::fixed, {}, s.gravity};
    for (const ir::Body& body : tree.bodies) r.joints.push_back(body.joint);
    return r;
  }
  int body_of(const std::string& joint) const {
    for (size_t k = 0; k < tree.bodies.size(); ++k)
      if (tree.bodies[k].joint == joint) return static_cast<int>(k);
    throw std::invalid_argument(joint);
  }

  // A random state. Loops are closed there, contacts off their anchors, and the angle of welds is an error in how they stand.
  void draw(std::uint64_t seed, double angle = 0) {
    testing::Random random(seed);
    const auto vector = [&](double size) {
      Vector3d a;
      for (double& x : a) x = random.uniform(-size, size);
      return a;
    };
    const testing::State state = testing::moderate_state(tree, seed);
    q = state.q, v = state.v, tau = VectorXd(v.size());
    for (double& x : tau) x = random.uniform(-20, 20);
    const generic::Kinematics<double> kinematics = generic::phase1<double>(model, q, v);
    constraints = {};
    turn = MatrixXd::Zero(rows(), rows());
    int row = 0;
    for (size_t i = 0; i < scenario.held.size(); ++i) {
      const Held& held = scenario.held[i];
      const int body = body_of(held.joint), own = held.weld ? 6 : 3;
      const auto pose_of = [&](int k) { return generic::frame_pose<double>(model, kinematics, q, k, {}); };
      const Transform<double> pose = pose_of(body),
                              at{Matrix3d::Identity(), i < scenario.at.size() ? scenario.at[i] : vector(0.2)},
                              whole = pose * at;
      const Matrix3d away = Eigen::AngleAxisd(angle, vector(1).normalized()).toRotationMatrix();  // in the other's axes
      Matrix3d axes;                                                                              // our rows', in the world
      Transform<double> other;
      if (held.other.empty()) {
        const bool along_link = i < scenario.along_link.size() && scenario.along_link[i];
        constraints.contacts.push_back({body, at, own, along_link ? generic::Axes::body : generic::Axes::mixed});
        axes = along_link ? pose.rotation : Matrix3d(Matrix3d::Identity());
        const Vector3d anchor = whole.translation - vector(0.05);
        mujoco.place(i, at.translation, anchor, Quaterniond(Matrix3d(away.transpose() * pose.rotation)));
      } else {
        const int second = body_of(held.other);
        other = pose_of(second);
        const Vector3d about = vector(1).normalized();
        const Vector3d closing = other.rotation.transpose() * (whole.translation - other.translation);
        const Transform<double> frame{Eigen::AngleAxisd(0.8, about).toRotationMatrix(), closing};
        constraints.loops.push_back(
            {{second, body}, {frame, at}, {0, 1, 2}, held.weld ? std::vector<int>{0, 1, 2} : std::vector<int>{}, 0.0});
        axes = other.rotation * frame.rotation;
        mujoco.place(i, at.translation, frame.translation,
                     Quaterniond(Matrix3d(away.transpose() * other.rotation.transpose() * pose.rotation)));
      }
      turn.block<3, 3>(row, row) = axes;
      if (held.weld) {
        const Quaterniond off(away);
        const Matrix3d half = 0.5 * (off.w() * Matrix3d::Identity() - skew(off.vec()));
        turn.block<3, 3>(row + 3, row + 3) = half * other.rotation.transpose() * axes;
      }
      row += own;
    }
  }
  int rows() const {
    int count = 0;
    for (const Held& held : scenario.held) count += held.weld ? 6 : 3;
    return count;
  }

  Soft soft() { return mujoco.soft(q, v, tau); }
  MatrixXd jacobian() const { return generic::constraint_jacobian<double>(model, constraints, q); }
  VectorXd bias() const { return generic::constraint_bias<double>(model, constraints, q, v); }
  // What MuJoCo leaves out: its J̇ v, which is ours but for what the base's velocity turns with, being along the base's axes
  // here and the world's there.
  VectorXd left_out() const {
    if (!scenario.floating) return bias();
    return bias() - jacobian().leftCols<3>() * v.segment<3>(3).cross(v.head<3>());
  }
  // b and R for which ours is MuJoCo's model; of R, that on the diagonal.
  generic::ConstraintOptions<double> as(const Soft& theirs) const {
    generic::ConstraintOptions<double> options;
    const MatrixXd back = turn.inverse();
    options.wanted = back * theirs.reference + left_out();
    options.regularization = (back * theirs.regularization.asDiagonal() * back.transpose()).diagonal();
    return options;
  }
  generic::Constrained<double> ours(const generic::ConstraintOptions<double>& options) const {
    return generic::constrained_forward_dynamics<double>(model, constraints, q, v, tau, VectorXd(), options);
  }
};

class MujocoScenarios : public ::testing::TestWithParam<Scenario> {};
class MujocoContacts : public MujocoScenarios {};
class MujocoWelds : public MujocoScenarios {};
class MujocoOfFullRank : public MujocoScenarios {};

TEST_P(MujocoScenarios, HaveOurRowsTurned) {
  Both both(GetParam());
  for (std::uint64_t seed = 1; seed <= states; ++seed) {
    for (const double angle : {0.0, 0.4}) {
      SCOPED_TRACE(std::to_string(seed) + ", off by " + std::to_string(angle));
      both.draw(seed, angle);
      const Soft theirs = both.soft();
      ASSERT_EQ(theirs.jacobian.rows(), both.rows());
      const MatrixXd J = both.turn * both.jacobian();
      EXPECT_LT(error(J, theirs.jacobian), 1e-12);
      EXPECT_LT(error(J * both.v, theirs.velocity), 1e-12);
      // a_ref is all of position and velocity: J̇ v is not in it.
      const VectorXd reference = -theirs.damping.cwiseProduct(theirs.velocity) - theirs.stiffness.cwiseProduct(theirs.position);
      EXPECT_LT(error(reference, theirs.reference), 1e-13);
    }
  }
}

// MuJoCo has no J̇ v: it is how its J v changes while our v does not. Loops are no part of this: our rows turn with the first
// link, MuJoCo's do not.
TEST_P(MujocoContacts, ChangeAsOurBiasSays) {
  Both both(GetParam());
  for (std::uint64_t seed = 1; seed <= states; ++seed) {
    both.draw(seed, 0.4);
    // Rows along the world's axes, so that T is the poses' own; J̇ v of those along the link's has ẋ × w besides.
    for (auto& contact : both.constraints.contacts) contact.axes = generic::Axes::mixed;
    const VectorXd q = both.q;
    const auto moved = [&](double time) {
      VectorXd to = q + VectorXd::Zero(q.size());
      if (GetParam().floating) {
        const Quaterniond before(q[6], q[3], q[4], q[5]);
        const Vector3d w = both.v.segment<3>(3);
        const Quaterniond after = before * Quaterniond(Eigen::AngleAxisd(time * w.norm(), w.normalized()));
        to.head<3>() += time * (before * both.v.head<3>());
        to.segment<4>(3) = after.coeffs();
      }
      const Eigen::Index joints = both.tree.joints();
      to.tail(joints) += time * both.v.tail(joints);
      return to;
    };
    const auto velocities = [&](double time) {
      both.q = moved(time);
      const Soft theirs = both.soft();
      // Of angular rows back to the angular velocity: v, the quaternion's vector part, is their position.
      VectorXd rows = theirs.velocity;
      int row = 0;
      for (const Held& held : GetParam().held) {
        if (held.weld) {
          const Vector3d off = theirs.position.segment<3>(row + 3);
          const Matrix3d half = 0.5 * (std::sqrt(1 - off.squaredNorm()) * Matrix3d::Identity() - skew(off));
          rows.segment<3>(row + 3) = half.inverse() * theirs.velocity.segment<3>(row + 3);
        }
        row += held.weld ? 6 : 3;
      }
      return rows;
    };
    const double h = 1e-5;
    const VectorXd rate = (velocities(h) - velocities(-h)) / (2 * h);
    both.q = q;
    EXPECT_LT(error(both.bias(), rate), 1e-7) << seed;
  }
}

TEST_P(MujocoScenarios, AreOursRegularized) {
  Both both(GetParam());
  for (std::uint64_t seed = 1; seed <= states; ++seed) {
    SCOPED_TRACE(seed);
    both.draw(seed);
    const Soft theirs = both.soft();
    generic::ConstraintOptions<double> options = both.as(theirs);
    const VectorXd forces = both.turn.transpose() * theirs.forces;
    const auto expect = [&](double limit) {
      const auto result = both.ours(options);
      EXPECT_LT(error(result.value, theirs.v_dot), limit);
      EXPECT_LT(error(result.forces, forces), limit);
    };
    expect(near);
    options.steps = 1, options.mu = 0;  // one step of nothing but R
    expect(near);
    options = both.as(theirs);
    options.steps = 1;  // R and mu N: as wrong as mu N is large against the least of J M⁻¹ Jᵀ + R
    expect(1e-4);
    EXPECT_GT(error(both.ours(options).forces, forces), 1e-11);
    // A slip is noticed.
    options = both.as(theirs);
    options.regularization *= 1 + 1e-6;
    EXPECT_GT(error(both.ours(options).forces, forces), 1e-9);
    options = both.as(theirs);
    options.wanted -= both.left_out();
    EXPECT_GT(error(both.ours(options).forces, forces), 1e-5) << "MuJoCo leaves J̇ v out";
    options = both.as(theirs);
    if (GetParam().held.front().weld) {
      options.regularization.segment<3>(3) /= 4;
      EXPECT_GT(error(both.ours(options).forces, forces), 1e-5) << "MuJoCo's angular rows are half of ours";
    }
  }
}

// A weld that stands askew by an angle: MuJoCo's R along its rows is no longer a diagonal along ours, by tan² of half of it.
TEST_P(MujocoWelds, ThatStandAskewHaveAnRThatOursHasNot) {
  Both both(GetParam());
  for (std::uint64_t seed = 1; seed <= states; ++seed) {
    SCOPED_TRACE(seed);
    for (const double angle : {0.2, 0.02, 0.002}) {
      both.draw(seed, angle);
      const Soft theirs = both.soft();
      const VectorXd forces = both.turn.transpose() * theirs.forces;
      const double off = error(both.ours(both.as(theirs)).forces, forces);
      EXPECT_LT(off, 2 * std::pow(std::tan(angle / 2), 2));
      if (angle == 0.2) {
        EXPECT_GT(off, 1e-6);
      }
      // With all of R there is nothing left.
      const MatrixXd J = both.jacobian(), back = both.turn.inverse(),
                     R = back * theirs.regularization.asDiagonal() * back.transpose();
      const MatrixXd inverse = generic::inverse_mass_matrix<double>(both.model, both.q).value;
      const VectorXd free = generic::forward_dynamics<double>(both.model, both.q, both.v, both.tau).value;
      const VectorXd solved =
          (J * inverse * J.transpose() + R).ldlt().solve(back * theirs.reference + both.left_out() - both.bias() - J * free);
      EXPECT_LT(error(solved, forces), near);
    }
  }
}

// MuJoCo is never rigid: its tightest impedance leaves R at 1e-4 of what its diagonal is where all joints are at zero. By
// scaling that R is taken on towards none; what MuJoCo then gives goes to ours without regularization, in proportion to R.
TEST_P(MujocoOfFullRank, GoToOursAsTheyStiffen) {
  Both both(GetParam(), 0.9999);
  const auto scale = [&](double by) {
    mjModel& m = *both.mujoco.model();
    Eigen::Map<VectorXd>(m.body_invweight0, 2 * m.nbody) *= by;
  };
  for (std::uint64_t seed = 1; seed <= states; ++seed) {
    SCOPED_TRACE(seed);
    both.draw(seed);
    const Soft tightest = both.soft();
    generic::ConstraintOptions<double> rigid = both.as(tightest);
    rigid.regularization.resize(0);
    const auto ours = both.ours(rigid);
    scale(0.5);
    const Soft half = both.soft();
    scale(2e-4);
    const Soft least = both.soft();
    scale(1e4);
    const double off = error(ours.value, tightest.v_dot), off_half = error(ours.value, half.v_dot),
                 extrapolated = error(ours.value, 2 * half.v_dot - tightest.v_dot), off_least = error(ours.value, least.v_dot);
    EXPECT_LT(off_least, std::min(2e-4 * off, 1e-3));
    EXPECT_GT(off, 1e-6) << "MuJoCo is not as stiff";
    if (off > 0.2) continue;  // a leg all but straight, where R is no small matter
    EXPECT_NEAR(off_half / off, 0.5, 0.02);
    EXPECT_LT(extrapolated, off / 30);
  }
}

const auto named = [](const auto& info) { return std::string(info.param.name); };
std::vector<Scenario> scenarios(bool (*wanted)(const Scenario&)) {
  std::vector<Scenario> all = scenarios();
  std::erase_if(all, [&](const Scenario& s) { return !wanted(s); });
  return all;
}
INSTANTIATE_TEST_SUITE_P(Robots, MujocoScenarios, ::testing::ValuesIn(scenarios()), named);
INSTANTIATE_TEST_SUITE_P(Robots, MujocoContacts,
                         ::testing::ValuesIn(scenarios([](const Scenario& s) { return s.held.front().other.empty(); })), named);
INSTANTIATE_TEST_SUITE_P(Robots, MujocoWelds,
                         ::testing::ValuesIn(scenarios([](const Scenario& s) { return s.held.front().weld; })), named);
// Rows that say the same have forces that depend on R, however small.
INSTANTIATE_TEST_SUITE_P(Robots, MujocoOfFullRank, ::testing::ValuesIn(scenarios([](const Scenario& s) { return !s.planar; })),
                         named);

// What a user does with the members of a contact so that generated code gives MuJoCo's model.
template <class Contact>
void set_as_mujoco(const Both& both, const Soft& theirs, const std::vector<Contact*>& contacts) {
  const generic::Kinematics<double> kinematics = generic::phase1<double>(both.model, both.q, both.v);
  const VectorXd left_out = both.left_out();
  int row = 0;
  for (size_t i = 0; i < contacts.size(); ++i) {
    const generic::Contact<double>& own = both.constraints.contacts[i];
    Contact& contact = *contacts[i];
    const Transform<double> pose = generic::frame_pose<double>(both.model, kinematics, both.q, own.body, own.frame);
    const Matrix3d axes = own.axes == generic::Axes::body ? pose.rotation : Matrix3d(Matrix3d::Identity());
    contact.kp = theirs.stiffness[row];
    contact.kd = theirs.damping[row];
    // MuJoCo's anchor, moved so that what it leaves out is left out: e is less by that / kp.
    const Vector3d e = theirs.position.segment<3>(row) - axes * left_out.segment<3>(row) / contact.kp;
    Eigen::Map<Vector3d>(contact.anchor) = pose.translation - e;
    for (int r = 0; r < 3; ++r) contact.regularization[r] = theirs.regularization[row + r];
    if (own.rows == 6) {
      // The sine of the angle, about the axis; MuJoCo has that of half of it, and half of the rows.
      const Vector3d turned = 2 * theirs.position.segment<3>(row + 3) - axes * left_out.segment<3>(row + 3) / contact.kp;
      const Quaterniond anchor(Eigen::AngleAxisd(-std::asin(turned.norm()), turned.normalized()) * pose.rotation);
      Eigen::Map<Eigen::Vector4d>(contact.anchor + 3) = anchor.coeffs();
      for (int r = 3; r < 6; ++r) contact.regularization[r] = 4 * theirs.regularization[row + r];
    }
    row += own.rows;
  }
}

template <class Contact, class Solve>
void expect_mujoco(const Scenario& scenario, const std::vector<Contact*>& contacts, const Solve& solve) {
  Both both(scenario);
  for (std::uint64_t seed = 1; seed <= states; ++seed)
    for (const double angle : {0.0, 0.02}) {
      SCOPED_TRACE(std::to_string(seed) + ", off by " + std::to_string(angle));
      both.draw(seed, angle);
      const Soft theirs = both.soft();
      set_as_mujoco(both, theirs, contacts);
      const auto [acceleration, forces] = solve(both);
      const double limit = near + 2 * std::pow(std::tan(angle / 2), 2);
      EXPECT_LT(error(acceleration, theirs.v_dot), limit);
      EXPECT_LT(error(forces, both.turn.transpose() * theirs.forces), limit);
    }
}

const Vector3d down(0, 0, -9.81);

TEST(MujocoConstraints, OfABipedAreGeneratedCodes) {
  using namespace standing_biped;
  const Scenario scenario{"",
                          {"biped_10", TESTS "/robots/biped_10.urdf"},
                          true,
                          {{"left_5_toe_joint", "", true}, {"right_5_toe_joint", "", true}},
                          {false, true},
                          false,
                          {Vector3d::Zero(), Vector3d(-0.1, 0.02, 0.05)},
                          down};
  Workspace w;
  expect_mujoco<Contact>(scenario, {&w.contact_left_5_toe, &w.contact_heel}, [&](const Both& at) {
    forward_dynamics(at.q.data(), at.v.data(), at.tau.data(), w);
    return std::pair<VectorXd, VectorXd>(constrained_forward_dynamics(w), constraint_forces(w));
  });
}

TEST(MujocoConstraints, OfAQuadrupedAreGeneratedCodes) {
  using namespace standing_quadruped;
  const Scenario scenario{
      "",
      {"quadruped_12", TESTS "/robots/quadruped_12.urdf"},
      true,
      {{"front_left_3_knee_joint"}, {"front_right_3_knee_joint"}, {"hind_left_3_knee_joint"}, {"hind_right_3_knee_joint"}},
      {false, false, true, false},
      false,
      {Vector3d::Zero(), Vector3d(0.1, 0, -0.2), Vector3d(0, 0.1, -0.2), Vector3d::Zero()},
      down};
  Workspace w;
  const auto solve = [&](const Both& at) {
    forward_dynamics(at.q.data(), at.v.data(), at.tau.data(), w);
    return std::pair<VectorXd, VectorXd>(constrained_forward_dynamics(w), constraint_forces(w));
  };
  expect_mujoco<Contact>(
      scenario, {&w.contact_front_left_3_knee, &w.contact_front_right, &w.contact_hind_left, &w.contact_hind_right_3_knee},
      solve);
}

}  // namespace
}  // namespace dalembert::oracle
