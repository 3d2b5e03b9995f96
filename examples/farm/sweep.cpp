// A sweep: forward dynamics at states all over the arm's workspace, as learning wants them.
#include <algorithm>
#include <string>

#include "draw.hpp"
#include "farm_arm/batch.hpp"
#include "job.hpp"

namespace farm {

namespace {

constexpr double q_range = 1.5, v_range = 3.0, tau_range = 10.0;  // ± rad, rad/s, N m

class Sweep : public Job {
 public:
  Sweep(std::uint64_t states, std::uint64_t seed, bool results_only)
      : states_(states), seed_(seed), results_only_(results_only), drawn_(results_only ? piece() * 3 * farm_arm::nq : 0) {}

  std::uint64_t items() const override { return states_; }
  std::size_t piece() const override { return 1024; }

  std::string settings() const override {
    return "job sweep\nrobot farm_arm\nstates " + std::to_string(states_) + "\nseed " + std::to_string(seed_) + "\nkept " +
           (results_only_ ? "results" : "states and results") + "\n";
  }

  std::vector<Column> columns() const override {
    std::vector<Column> all;
    if (!results_only_)
      all = {{"q", "rad", "joint positions", farm_arm::nq},
             {"v", "rad/s", "joint rates", farm_arm::nv},
             {"tau", "N m", "joint torques", farm_arm::nv}};
    all.push_back({"forward_dynamics", "rad/s^2", "joint accelerations", farm_arm::nv});
    all.push_back({"status", "", "-1, or the coordinate at which M is not positive definite", 1, true});
    return all;
  }

  void compute(std::uint64_t first, std::size_t count, const std::vector<void*>& into) override {
    const std::size_t begin = results_only_ ? 0 : 3;
    double* const own = drawn_.data();
    double* const q = results_only_ ? own : static_cast<double*>(into[0]);
    double* const v = results_only_ ? own + piece() * farm_arm::nq : static_cast<double*>(into[1]);
    double* const tau = results_only_ ? own + 2 * piece() * farm_arm::nq : static_cast<double*>(into[2]);
    for (std::size_t i = 0; i < count; ++i) {
      Draw draw(seed_, first + i);
      for (int k = 0; k < farm_arm::nq; ++k) q[i * farm_arm::nq + static_cast<std::size_t>(k)] = draw(-q_range, q_range);
      for (int k = 0; k < farm_arm::nv; ++k) v[i * farm_arm::nv + static_cast<std::size_t>(k)] = draw(-v_range, v_range);
      for (int k = 0; k < farm_arm::nv; ++k) tau[i * farm_arm::nv + static_cast<std::size_t>(k)] = draw(-tau_range, tau_range);
    }
    farm_arm::Batch batch;
    batch.count = count, batch.q = q, batch.v = v, batch.input = tau;
    farm_arm::ForwardDynamicsBatchResults results;
    results.forward_dynamics = static_cast<double*>(into[begin]);
    results.status = static_cast<std::int32_t*>(into[begin + 1]);
    (void)farm_arm::forward_dynamics_batch(batch, results);  // nothing can be wrong with these
  }

 private:
  std::uint64_t states_, seed_;
  bool results_only_;
  std::vector<double> drawn_;  // where it is not kept
};

}  // namespace

std::unique_ptr<Job> make_sweep(std::uint64_t states, std::uint64_t seed, bool results_only) {
  return std::make_unique<Sweep>(states, seed, results_only);
}

}  // namespace farm
