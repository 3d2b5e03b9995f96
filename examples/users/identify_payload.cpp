// An identification: what MAHRU's right hand holds, from the joints' torques along a motion.
//
// Inverse dynamics is linear in the inertial parameters φ = (m, m c, I about the link's origin; ten per body), τ = Y φ. What
// the hand holds is part of the hand, so that the torques measured, less those of the empty arm, are the hand's ten columns of
// Y times the payload's φ: least squares over a motion. Here torques are simulated, exactly and then with noise.
//
// Of the whole arm's parameters, by contrast, only combinations show in the torques (of the first link, which turns about an
// upright axis, nothing but the inertia about that axis): the rank of Y over the motion says how many.
#include <Eigen/Cholesky>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <iterator>
#include <random>

#include "figures.hpp"
#include "identified_arm/dynamics.hpp"

namespace {

using identified_arm::nv;
using identified_arm::VectorQ;
using identified_arm::VectorV;
using Parameters = Eigen::Matrix<double, 10, 1>;
constexpr const char* names[] = {"m", "m cx", "m cy", "m cz", "Ixx", "Ixy", "Ixz", "Iyy", "Iyz", "Izz"};
constexpr const char* units[] = {"kg", "kg m", "kg m", "kg m", "kg m^2", "kg m^2", "kg m^2", "kg m^2", "kg m^2", "kg m^2"};

constexpr int samples = 2000;
constexpr double sampling = 5e-3;  // s
constexpr double noise = 0.05;     // of a torque, N m

struct Motion {
  VectorQ q;
  VectorV v, v_dot;
};
// Harmonics of the ten seconds, other ones in each joint.
Motion motion(double time) {
  Motion at{VectorQ::Zero(), VectorV::Zero(), VectorV::Zero()};
  for (int joint = 0; joint < nv; ++joint) {
    for (int k = 1; k <= 5; ++k) {
      const double w = 2 * 3.14159265358979 / 10 * (k + joint % 3), size = 0.35 * std::sin(1.7 * joint + 2.3 * k) / k;
      at.q[joint] += size * std::sin(w * time + k);
      at.v[joint] += size * w * std::cos(w * time + k);
      at.v_dot[joint] -= size * w * w * std::sin(w * time + k);
    }
  }
  at.q[q_index(identified_arm::Joint::right_elbow)] -= 1.2;
  return at;
}

// A bottle that leans, in the hand's axes.
identified_arm::Payload bottle() {
  identified_arm::Payload payload;
  payload.mass = 1.2;
  payload.com[0] = 0.02, payload.com[1] = -0.03, payload.com[2] = -0.12;
  const double inertia[] = {6e-3, 2e-4, -3e-4, 7e-3, 1e-4, 2e-3};
  std::copy(std::begin(inertia), std::end(inertia), payload.inertia);
  return payload;
}

// Its φ: the inertia is moved from the centre of mass to the link's origin.
Parameters parameters_of(const identified_arm::Payload& payload) {
  const double m = payload.mass, x = payload.com[0], y = payload.com[1], z = payload.com[2];
  const double* I = payload.inertia;
  return (Parameters() << m, m * x, m * y, m * z, I[0] + m * (y * y + z * z), I[1] - m * x * y, I[2] - m * x * z,
          I[3] + m * (x * x + z * z), I[4] - m * y * z, I[5] + m * (x * x + y * y))
      .finished();
}

// Torques of the empty arm and of the loaded one, and Y, along the motion.
struct Measurement {
  Eigen::MatrixXd regressor = Eigen::MatrixXd(nv * samples, 10 * nv);
  Eigen::VectorXd difference = Eigen::VectorXd(nv * samples);
};
Measurement measure() {
  identified_arm::Workspace empty, loaded;
  loaded.payload_right_hand = bottle();
  Measurement measured;
  for (int i = 0; i < samples; ++i) {
    const Motion at = motion(i * sampling);
    identified_arm::inverse_dynamics(at.q, at.v, at.v_dot, empty);
    identified_arm::inverse_dynamics(at.q, at.v, at.v_dot, loaded);
    measured.regressor.middleRows<nv>(nv * i) = identified_arm::regressor(empty);
    measured.difference.segment<nv>(nv * i) =
        identified_arm::inverse_dynamics(loaded) - identified_arm::inverse_dynamics(empty);
  }
  return measured;
}

// How many combinations of parameters show in the torques: the rank of the regressor, its columns brought to one length.
int identifiable(const Eigen::MatrixXd& regressor) {
  const Eigen::VectorXd lengths = regressor.colwise().norm().cwiseMax(1e-300);
  Eigen::ColPivHouseholderQR<Eigen::MatrixXd> factors(regressor * lengths.cwiseInverse().asDiagonal());
  factors.setThreshold(1e-9);
  return static_cast<int>(factors.rank());
}

}  // namespace

int main() {
  Figures figures;
  Measurement measured = measure();
  constexpr int hand = 10 * static_cast<int>(identified_arm::Joint::right_wrist_pitch);
  const Eigen::MatrixXd Y = measured.regressor.middleCols<10>(hand);
  const Eigen::LDLT<Eigen::MatrixXd> normal(Y.transpose() * Y);
  const Parameters exact = parameters_of(bottle());

  const int of_payload = identifiable(Y);
  std::printf("identifiable: %d of the payload's 10 parameters; of the arm's %d, %d combinations\n", of_payload, 10 * nv,
              identifiable(measured.regressor));
  const Parameters found = normal.solve(Y.transpose() * measured.difference);
  figures.bounded("parameters that do not show in the torques", 10 - of_payload, 0.5, "");
  figures.bounded("from exact torques: off by, of the largest parameter", (found - exact).norm() / exact.norm(), 1e-10, "");

  std::mt19937_64 random(1);
  std::normal_distribution<double> error(0, noise);
  for (double& torque : measured.difference) torque += error(random);
  const Parameters noisy = normal.solve(Y.transpose() * measured.difference);
  const Eigen::MatrixXd variance = noise * noise * normal.solve(Eigen::MatrixXd::Identity(10, 10));
  std::printf("with noise of %.2f N m:\n", noise);
  double worst = 0;
  for (int i = 0; i < 10; ++i) {
    const double deviation = std::sqrt(variance(i, i));
    std::printf("    %-5s %9.5f, found %9.5f +- %.5f %s\n", names[i], exact[i], noisy[i], deviation, units[i]);
    worst = std::max(worst, std::abs(noisy[i] - exact[i]) / deviation);
  }
  figures.bounded("off by at most", worst, 4, "standard deviations");

  identified_arm::Workspace workspace;
  const Motion at = motion(1);
  figures.timed("inverse dynamics and the regressor",
                [&] { identified_arm::inverse_dynamics(at.q, at.v, at.v_dot, workspace); });
  return figures.exit_status();
}
