// An identification by simulation: which load in the hand makes the arm move as it was recorded?
#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <string>
#include <utility>

#include "draw.hpp"
#include "farm_arm/batch.hpp"
#include "job.hpp"

namespace farm {

namespace {

constexpr std::size_t nq = farm_arm::nq, nv = farm_arm::nv;
constexpr std::size_t of_payload = 10;  // mass, com, inertia

std::uint64_t digest(const std::vector<double>& numbers, std::uint64_t of) {
  for (const double x : numbers) {
    std::uint64_t bits;
    std::memcpy(&bits, &x, sizeof bits);
    of = mixed(of ^ bits) + 1;
  }
  return of;
}

class Identification : public Job {
 public:
  Identification(std::uint64_t candidates, std::uint64_t seed, Recording recording)
      : candidates_(candidates),
        seed_(seed),
        recording_(std::move(recording)),
        q_(piece() * nq),
        v_(piece() * nv),
        end_(piece() * nq),
        payloads_(piece() * of_payload) {}

  std::uint64_t items() const override { return candidates_; }
  std::size_t piece() const override { return 64; }

  std::string settings() const override {
    const std::uint64_t motion = digest(recording_.tau, digest(recording_.v, digest(recording_.q, mixed(recording_.steps))));
    return "job identification\nrobot farm_arm\ncandidates " + std::to_string(candidates_) + "\nseed " + std::to_string(seed_) +
           "\nsteps " + std::to_string(recording_.steps) + "\ntime_step " + std::to_string(recording_.time_step) +
           "\nrecording " + std::to_string(motion) + "\n";
  }

  std::vector<Column> columns() const override {
    return {{"payload", "kg, m", "mass, and where it is in the hand's axes", 4},
            {"cost", "rad^2",
             "squared distance of the joints from the recording, mean over its steps; infinite where the "
             "motion stopped"},
            {"stopped", "", "-1, or the step that could not be made", 1, true}};
  }

  void compute(std::uint64_t first, std::size_t count, const std::vector<void*>& into) override {
    auto* const payload = static_cast<double*>(into[0]);
    cost_ = static_cast<double*>(into[1]);
    auto* const stopped = static_cast<std::int32_t*>(into[2]);
    std::fill(payloads_.begin(), payloads_.end(), 0.0);
    for (std::size_t i = 0; i < count; ++i) {
      Draw draw(seed_, first + i);
      double* const p = payload + 4 * i;
      p[0] = draw(0.0, 2.5);
      for (int k = 1; k < 4; ++k) p[k] = draw(-0.15, 0.15);
      std::copy_n(p, 4, payloads_.data() + of_payload * i);
      std::copy_n(recording_.q.data(), nq, q_.data() + nq * i);
      std::copy_n(recording_.v.data(), nv, v_.data() + nv * i);
      cost_[i] = 0;
    }
    farm_arm::Batch batch;
    batch.count = count, batch.q = q_.data(), batch.v = v_.data(), batch.payloads_right_hand = payloads_.data();
    dalembert::Rollout<double> rollout;
    rollout.steps = recording_.steps, rollout.time_step = recording_.time_step;
    rollout.control = [](const dalembert::RolloutStep<double>& step, void* self) {
      static_cast<Identification*>(self)->before(step);
    };
    rollout.user = this;
    rollout.last_q = end_.data(), rollout.stopped = stopped;
    (void)farm_arm::forward_dynamics_rollout(batch, rollout);  // nothing can be wrong with these
    const double* const last = recording_.q.data() + nq * recording_.steps;
    for (std::size_t i = 0; i < count; ++i) {
      for (std::size_t k = 0; k < nq; ++k) cost_[i] += square(end_[nq * i + k] - last[k]);
      cost_[i] = stopped[i] < 0 ? cost_[i] / static_cast<double>(recording_.steps) : std::numeric_limits<double>::infinity();
    }
  }

 private:
  static double square(double x) { return x * x; }

  // The torques of this step, and how far the motions are from the recording where it begins.
  void before(const dalembert::RolloutStep<double>& step) {
    const auto stride = static_cast<std::size_t>(step.stride);
    const double *const tau = recording_.tau.data() + nv * step.step, *const q = recording_.q.data() + nq * step.step;
    for (std::size_t i = 0; i < nv; ++i) std::fill_n(step.input + i * stride, stride, tau[i]);
    for (std::size_t i = 0; step.step > 0 && i < nq; ++i)
      for (int k = 0; k < step.count; ++k)
        cost_[step.first + static_cast<std::size_t>(k)] += square(step.q[i * stride + static_cast<std::size_t>(k)] - q[i]);
  }

  std::uint64_t candidates_, seed_;
  Recording recording_;
  std::vector<double> q_, v_, end_, payloads_;
  double* cost_ = nullptr;
};

}  // namespace

std::unique_ptr<Job> make_identification(std::uint64_t candidates, std::uint64_t seed, Recording recording) {
  return std::make_unique<Identification>(candidates, seed, std::move(recording));
}

Recording simulate_recording(std::size_t steps, double time_step) {
  Recording r;
  r.time_step = time_step, r.steps = steps;
  r.q.assign((steps + 1) * nq, 0.0), r.v.assign((steps + 1) * nv, 0.0), r.tau.resize(steps * nv);
  // Holds up some of the weight, and swings.
  const double holds[] = {0, 4, -2, 0.5, -2, 0, -0.3}, swings[] = {8, 6, 5, 2, 4, 0.5, 0.5};  // N m
  for (std::size_t step = 0; step < steps; ++step)
    for (std::size_t i = 0; i < nv; ++i) {
      const auto joint = static_cast<double>(i);
      r.tau[step * nv + i] = holds[i] + swings[i] * std::sin((4 + joint) * time_step * static_cast<double>(step) + 1.3 * joint);
    }
  farm_arm::Workspace workspace;
  workspace.payload_right_hand.mass = 1.2;
  workspace.payload_right_hand.com[0] = 0.02;
  workspace.payload_right_hand.com[1] = -0.03;
  workspace.payload_right_hand.com[2] = -0.12;
  farm_arm::Batch batch;
  batch.count = 1, batch.q = r.q.data(), batch.v = r.v.data(), batch.input = r.tau.data(), batch.workspace = &workspace;
  dalembert::Rollout<double> rollout;
  rollout.steps = steps, rollout.time_step = time_step;
  rollout.path_q = r.q.data() + nq, rollout.path_v = r.v.data() + nv;
  (void)farm_arm::forward_dynamics_rollout(batch, rollout);
  return r;
}

}  // namespace farm
