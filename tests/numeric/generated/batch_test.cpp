// Generated batches: the results of single calls, for batches of any size, of arrays anywhere in memory, in every layout; the
// same bits wherever a state stands; nothing read or written beyond the last state.
#include <gtest/gtest.h>
#include <sys/mman.h>
#include <tbb/global_control.h>
#include <unistd.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstring>
#include <dalembert/integrators/linearly_implicit.hpp>
#include <dalembert/integrators/rk4.hpp>
#include <dalembert/integrators/semi_implicit_euler.hpp>
#include <limits>
#include <random>
#include <vector>

#include "batch_robots.hpp"  // written by CMake
#include "reference/eigenvalues.hpp"

namespace {

using dalembert::batch_index;
using dalembert::BatchError;
using dalembert::BatchLayout;
using dalembert::MatrixLayout;

// Numbers with a page behind the last one that may not be touched, and one before the first's page: they are where pages leave
// them, at a multiple of their own size and no more.
template <class T>
class Guarded {
 public:
  explicit Guarded(std::size_t count, T value = T(0)) : count_(count) {
    const auto page = static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
    bytes_ = (count * sizeof(T) + page - 1) / page * page + 2 * page;
    memory_ = static_cast<char*>(mmap(nullptr, bytes_, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0));
    if (memory_ == MAP_FAILED) throw std::bad_alloc();
    mprotect(memory_, page, PROT_NONE);
    mprotect(memory_ + bytes_ - page, page, PROT_NONE);
    data_ = reinterpret_cast<T*>(memory_ + bytes_ - page) - count;
    std::fill(data_, data_ + count, value);
  }
  ~Guarded() { munmap(memory_, bytes_); }
  Guarded(const Guarded&) = delete;
  Guarded& operator=(const Guarded&) = delete;

  T* data() { return data_; }
  std::size_t size() const { return count_; }
  T& operator[](std::size_t i) { return data_[i]; }

 private:
  std::size_t count_, bytes_ = 0;
  char* memory_ = nullptr;
  T* data_ = nullptr;
};

// Room for n states of k numbers.
template <class T>
std::size_t room(BatchLayout layout, std::size_t n, std::size_t k) {
  constexpr std::size_t lanes = dalembert::batch_lanes<T>;
  return layout == BatchLayout::rows ? n * k : (n + lanes - 1) / lanes * lanes * k;
}

// The numbers of n states, row by row, in a layout; places of states that are not there hold NaN.
template <class T>
void lay_out(const std::vector<T>& rows, std::size_t n, std::size_t k, BatchLayout layout, Guarded<T>& to) {
  std::fill(to.data(), to.data() + to.size(), std::numeric_limits<T>::quiet_NaN());
  for (std::size_t s = 0; s < n; ++s)
    for (std::size_t i = 0; i < k; ++i) to[batch_index<T>(layout, s, i, k)] = rows[s * k + i];
}

template <class Robot>
class Batches : public testing::Test {
 protected:
  using T = typename Robot::Scalar;
  using Results = std::vector<std::vector<T>>;  // of each output: all states, row by row, matrices by rows

  struct States {
    std::vector<T> q, v, input, given;
    std::size_t count = 0;
  };

  States some_states(std::size_t n) {
    std::mt19937 random(7);
    std::uniform_real_distribution<double> number(-3, 3);
    States states;
    states.count = n;
    const auto fill = [&](std::vector<T>& of, int k) {
      of.resize(n * static_cast<std::size_t>(k));
      for (T& x : of) x = static_cast<T>(number(random));
    };
    fill(states.q, Robot::nq), fill(states.v, Robot::nv), fill(states.input, Robot::nv);
    fill(states.given, Robot::given_numbers);
    for (std::size_t s = 0; Robot::nq > Robot::nv && s < n; ++s) {
      T* const quaternion = states.q.data() + s * Robot::nq + 3;
      const T norm = std::sqrt(quaternion[0] * quaternion[0] + quaternion[1] * quaternion[1] + quaternion[2] * quaternion[2] +
                               quaternion[3] * quaternion[3]);
      for (int i = 0; i < 4; ++i) quaternion[i] /= norm;
    }
    return states;
  }

  static States one(const States& all, std::size_t s) {
    const auto part = [s](const std::vector<T>& of, std::size_t k) {
      return std::vector<T>(of.begin() + static_cast<std::ptrdiff_t>(s * k),
                            of.begin() + static_cast<std::ptrdiff_t>((s + 1) * k));
    };
    States state;
    state.count = 1;
    state.q = part(all.q, Robot::nq), state.v = part(all.v, Robot::nv), state.input = part(all.input, Robot::nv);
    state.given = part(all.given, Robot::given_numbers);
    return state;
  }

  // Results of a batch, with the order of elements undone. `run` calls the batch.
  template <class Run>
  static Results results(const States& states, BatchLayout in, BatchLayout out, MatrixLayout matrices, const Run& run) {
    const std::size_t n = states.count;
    Guarded<T> q(room<T>(in, n, Robot::nq)), v(room<T>(in, n, Robot::nv)), input(room<T>(in, n, Robot::nv)),
        given(room<T>(in, n, Robot::given_numbers));
    lay_out(states.q, n, Robot::nq, in, q);
    lay_out(states.v, n, Robot::nv, in, v);
    lay_out(states.input, n, Robot::nv, in, input);
    lay_out(states.given, n, Robot::given_numbers, in, given);
    typename Robot::Batch batch;
    batch.count = n, batch.q = q.data(), batch.v = v.data(), batch.input = input.data();
    batch.states = in, batch.results = out, batch.matrices = matrices;
    Robot::set_given(batch, given.data());
    const auto outputs = Robot::outputs();
    std::vector<std::unique_ptr<Guarded<T>>> arrays;
    std::vector<T*> pointers;
    std::vector<std::size_t> sizes;
    const T untouched = T(-77);
    for (const auto& output : outputs) {
      const bool packed = matrices == MatrixLayout::packed && output.packed;
      sizes.push_back(static_cast<std::size_t>(packed ? output.packed_size : output.size));
      arrays.push_back(std::make_unique<Guarded<T>>(room<T>(out, n, sizes.back()), untouched));
      pointers.push_back(arrays.back()->data());
    }
    EXPECT_EQ(run(batch, Robot::results(pointers)), BatchError::none);
    Results results;
    for (std::size_t o = 0; o < outputs.size(); ++o) {
      const auto& output = outputs[o];
      const int rows = Robot::nv, columns = output.size / rows;
      results.emplace_back(n * static_cast<std::size_t>(output.size), T(0));
      for (std::size_t s = 0; s < n; ++s)
        for (std::size_t i = 0; i < sizes[o]; ++i) {
          const T x = (*arrays[o])[batch_index<T>(out, s, i, sizes[o])];
          T* const to = results.back().data() + s * static_cast<std::size_t>(output.size);
          const int at = static_cast<int>(i);
          if (columns == 1 || matrices == MatrixLayout::by_rows) to[i] = x;
          else if (matrices == MatrixLayout::by_columns) to[at % rows * columns + at / rows] = x;
          else {
            const dalembert::MatrixPlace place = output.packed[i];
            to[place.row * columns + place.column] = x;
            if (output.symmetric) to[place.column * columns + place.row] = x;
          }
        }
      std::size_t left = 0;
      for (std::size_t i = 0; i < arrays[o]->size(); ++i) left += (*arrays[o])[i] == untouched;
      EXPECT_EQ(left, arrays[o]->size() - n * sizes[o]) << output.name << ": places of states that are not there";
    }
    return results;
  }

  static Results results(const States& states, BatchLayout in = BatchLayout::rows, BatchLayout out = BatchLayout::rows,
                         MatrixLayout matrices = MatrixLayout::by_rows) {
    return results(states, in, out, matrices, [](const auto& batch, const auto& to) { return Robot::batch(batch, to); });
  }

  static T ulp(T x) { return std::nextafter(x, std::numeric_limits<T>::infinity()) - x; }

  // The largest eigenvalue of M over the least, rows and columns divided so that its diagonal is 1 and units do not count: by
  // how much rounding may be magnified in what is solved for with it.
  static double condition_of_mass(const typename Robot::Workspace& workspace) {
    using Matrix = Eigen::Matrix<T, Robot::nv, Robot::nv>;
    for (const auto& output : Robot::outputs())
      if (std::strcmp(output.name, "mass_matrix") == 0) {
        Eigen::MatrixXd M = Eigen::Map<const Matrix>(output.single(workspace)).template cast<double>();
        const Eigen::VectorXd scale = M.diagonal().cwiseSqrt().cwiseInverse();
        M = scale.asDiagonal() * M * scale.asDiagonal();
        const Eigen::VectorXd values = dalembert::reference::eigenvalues(M);
        return values.maxCoeff() / values.minCoeff();
      }
    return 1;
  }

  // Within a few ulp (Robot::ulps) of the largest element that single calls give at any of the states; and of the largest at
  // that state, where elements may be what is left of larger terms, within four times as many. What is solved for: within eight
  // times as many of the latter, times the condition of M; derivatives by q, which are taken at a dv/dt that is solved for
  // itself and may be by another frame of reference, twice that.
  static void expect_single_results(const States& states, const Results& results) {
    typename Robot::Workspace workspace;
    const auto outputs = Robot::outputs();
    struct Worst {
      T largest = T(0), error = T(0);
    };
    std::vector<Worst> of_all(outputs.size());
    for (std::size_t s = 0; s < states.count; ++s) {
      const States state = one(states, s);
      Robot::set_given(workspace, state.given.data());
      Robot::single(state.q.data(), state.v.data(), state.input.data(), workspace);
      const double condition = condition_of_mass(workspace);
      for (std::size_t o = 0; o < outputs.size(); ++o) {
        const int rows = Robot::nv, columns = outputs[o].size / rows;
        const T* const expected = outputs[o].single(workspace);
        T largest = T(0), error = T(0);
        for (int r = 0; r < rows; ++r)
          for (int c = 0; c < columns; ++c) {
            const T x = expected[r + rows * c];
            largest = std::max(largest, std::abs(x));
            const T difference = std::abs(
                results[o][s * static_cast<std::size_t>(outputs[o].size) + static_cast<std::size_t>(r * columns + c)] - x);
            error = difference <= error ? error : difference;
          }
        const bool twice = std::strcmp(outputs[o].name, "forward_dynamics_dq") == 0;
        const T ulps = T(Robot::ulps) * (outputs[o].solved ? static_cast<T>((twice ? 16 : 8) * condition) : T(4));
        EXPECT_LE(error, ulps * ulp(largest)) << outputs[o].name << " of state " << s;
        of_all[o] = {std::max(of_all[o].largest, largest), error <= of_all[o].error ? of_all[o].error : error};
      }
    }
    for (std::size_t o = 0; o < outputs.size(); ++o) {
      if (outputs[o].solved) continue;
      EXPECT_LE(of_all[o].error, T(Robot::ulps) * ulp(of_all[o].largest)) << outputs[o].name << " of all states";
    }
  }

  static void expect_same_bits(const Results& a, const Results& b, const char* what) {
    ASSERT_EQ(a.size(), b.size());
    for (std::size_t o = 0; o < a.size(); ++o) {
      ASSERT_EQ(a[o].size(), b[o].size());
      EXPECT_TRUE(a[o].empty() || std::memcmp(a[o].data(), b[o].data(), sizeof(T) * a[o].size()) == 0)
          << what << ": " << Robot::outputs()[o].name;
    }
  }
};

TYPED_TEST_SUITE(Batches, BatchRobots);

TYPED_TEST(Batches, GiveWhatSingleCallsGive) {
  const auto states = this->some_states(100);
  this->expect_single_results(states, this->results(states));
}

TYPED_TEST(Batches, OfAnySizeAndLayoutAreTheSameBits) {
  const auto all = this->some_states(1000);
  const auto expected = this->results(all);
  for (const std::size_t n : {0, 1, 3, 4, 5, 8, 9, 17, 33, 1000}) {
    auto states = all;
    states.count = n;
    auto first = expected;
    for (auto& of : first) of.resize(of.size() / 1000 * n);
    for (const BatchLayout in : {BatchLayout::rows, BatchLayout::lanes})
      for (const BatchLayout out : {BatchLayout::rows, BatchLayout::lanes})
        for (const MatrixLayout matrices : {MatrixLayout::by_rows, MatrixLayout::by_columns, MatrixLayout::packed}) {
          if (n == 1000 && in != out) continue;
          SCOPED_TRACE(n);
          this->expect_same_bits(this->results(states, in, out, matrices), first, "layout");
        }
  }
}

TYPED_TEST(Batches, WhereAStateStandsChangesNothing) {
  using T = typename TypeParam::Scalar;
  const auto all = this->some_states(37);
  const auto expected = this->results(all);
  for (std::size_t shift = 1; shift < 17; ++shift) {
    auto states = all;
    const auto rotate = [&](std::vector<T>& of) {
      std::rotate(of.begin(), of.begin() + static_cast<std::ptrdiff_t>(of.size() / 37 * shift), of.end());
    };
    rotate(states.q), rotate(states.v), rotate(states.input), rotate(states.given);
    auto rotated = expected;
    for (auto& of : rotated) rotate(of);
    this->expect_same_bits(this->results(states), rotated, "place");
  }
}

TYPED_TEST(Batches, OneLargeAngleChangesNoOtherState) {
  const auto all = this->some_states(21);
  auto changed = all;
  const std::size_t at = 6;
  changed.q[at * TypeParam::nq + TypeParam::nq - 1] = 4e6;
  const auto before = this->results(all);
  auto after = this->results(changed);
  this->expect_single_results(changed, after);
  for (std::size_t o = 0; o < after.size(); ++o) {
    const std::size_t size = after[o].size() / 21;
    std::copy_n(before[o].data() + at * size, size, after[o].data() + at * size);
  }
  this->expect_same_bits(after, before, "others");
}

TYPED_TEST(Batches, PartsAndThreadsGiveTheSameBits) {
  const auto states = this->some_states(1000);
  const auto expected = this->results(states);
  for (const BatchLayout layout : {BatchLayout::rows, BatchLayout::lanes}) {
    this->expect_same_bits(
        this->results(
            states, layout, layout, MatrixLayout::by_rows,
            [](const auto& batch, const auto& to) {
              for (const std::size_t first : {496, 0, 16})
                if (TypeParam::batch(batch, to, first, first == 496 ? 504 : first == 0 ? 16 : 480) != BatchError::none)
                  return BatchError::range;
              return BatchError::none;
            }),
        expected, "parts");
    for (const std::size_t threads : {1, 2, 4}) {
      const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
      this->expect_same_bits(this->results(states, layout, layout, MatrixLayout::by_rows,
                                           [](const auto& batch, const auto& to) { return TypeParam::tasks(batch, to); }),
                             expected, "threads");
    }
  }
}

TYPED_TEST(Batches, AreHandedOnBlockByBlock) {
  using T = typename TypeParam::Scalar;
  const auto states = this->some_states(29);
  const auto expected = this->results(states);
  struct Seen {
    std::vector<std::vector<T>> results;
    std::size_t next = 0;
  } seen;
  const auto outputs = TypeParam::outputs();
  for (const auto& of : expected) seen.results.emplace_back(of.size(), T(0));
  this->results(states, BatchLayout::rows, BatchLayout::rows, MatrixLayout::by_rows, [&](const auto& batch, const auto& to) {
    const BatchError error = TypeParam::blocks(
        batch,
        [](const typename TypeParam::Block& block, void* user) {
          Seen& into = *static_cast<Seen*>(user);
          EXPECT_EQ(block.first, into.next);
          into.next += static_cast<std::size_t>(block.count);
          const auto pointers = TypeParam::pointers(block);
          const auto outs = TypeParam::outputs();
          for (std::size_t o = 0; o < outs.size(); ++o) {
            const int rows = TypeParam::nv, columns = outs[o].size / rows,
                      size = outs[o].packed ? outs[o].packed_size : outs[o].size;
            for (int s = 0; s < block.count; ++s)
              for (int i = 0; i < size; ++i) {
                T* const of_state = into.results[o].data() +
                                    (block.first + static_cast<std::size_t>(s)) * static_cast<std::size_t>(outs[o].size);
                const T x = pointers[o][i * block.stride + s];
                const dalembert::MatrixPlace place = outs[o].packed ? outs[o].packed[i] : dalembert::MatrixPlace{i, 0};
                of_state[place.row * columns + place.column] = x;
                if (outs[o].symmetric) of_state[place.column * columns + place.row] = x;
              }
          }
        },
        &seen);
    EXPECT_EQ(error, BatchError::none);
    return TypeParam::batch(batch, to);
  });
  EXPECT_EQ(seen.next, 29u);
  this->expect_same_bits(seen.results, expected, "blocks");
}

TYPED_TEST(Batches, NamesWhatIsWrong) {
  using T = typename TypeParam::Scalar;
  typename TypeParam::Batch batch;
  const auto error = [&](std::size_t first = 0, std::size_t count = 0) {
    return TypeParam::batch(batch, TypeParam::results(std::vector<T*>(TypeParam::outputs().size(), nullptr)), first, count);
  };
  EXPECT_EQ(error(), BatchError::none) << "no states need no arrays";
  batch.count = 3;
  EXPECT_EQ(error(), BatchError::q);
  const auto states = this->some_states(3);
  batch.q = states.q.data();
  EXPECT_EQ(error(), BatchError::v);
  batch.v = states.v.data();
  if (TypeParam::takes_input) {
    EXPECT_EQ(error(), BatchError::input);
  }
  batch.input = states.input.data();
  EXPECT_EQ(error(0, 3), BatchError::none) << "no result is wanted";
  EXPECT_EQ(error(0, 4), BatchError::range);
  EXPECT_EQ(error(4, 0), BatchError::range);
  EXPECT_EQ(error(1, 2), BatchError::none);
  EXPECT_EQ(TypeParam::blocks(batch, nullptr, nullptr), BatchError::results);
  batch.results = BatchLayout::lanes;
  EXPECT_EQ(error(1, 2), BatchError::range) << "within a block";
  batch.results = static_cast<BatchLayout>(2);
  EXPECT_EQ(error(), BatchError::layout);
  batch.results = BatchLayout::rows;
  batch.matrices = static_cast<MatrixLayout>(-1);
  EXPECT_EQ(error(), BatchError::layout);
  batch.matrices = MatrixLayout::by_rows;
  batch.count = static_cast<std::size_t>(-1);
  EXPECT_EQ(error(), BatchError::count);
  EXPECT_NE(std::string(describe(BatchError::count)).find("negative"), std::string::npos);
}

// Motions, beside those of the integrators with single calls.
template <class Robot>
struct Rollouts : testing::Test {
  static constexpr std::size_t n = 19, steps = 12;
  static constexpr auto nq = static_cast<std::size_t>(Robot::nq), nv = static_cast<std::size_t>(Robot::nv);

  std::vector<double> q = std::vector<double>(n * nq), v = std::vector<double>(n * nv),
                      tau = std::vector<double>(n * steps * nv);

  Rollouts() {
    std::mt19937 random(5);
    std::uniform_real_distribution<double> number(-1, 1);
    for (std::vector<double>* of : {&q, &v, &tau})
      for (double& x : *of) x = number(random);
    for (std::size_t s = 0; nq > nv && s < n; ++s) {
      Eigen::Map<Eigen::Vector4d> quaternion(q.data() + s * nq + 3);
      quaternion.normalize();
    }
  }

  struct Motions {
    std::vector<double> last_q, last_v, path_q, path_v;
    std::vector<int> stopped;
    bool operator==(const Motions& other) const {
      return last_q == other.last_q && last_v == other.last_v && path_q == other.path_q && path_v == other.path_v &&
             stopped == other.stopped;
    }
  };

  // All motions, or `count` of them from `first` on, as an array of their own.
  template <class Run>
  Motions run(dalembert::RolloutMethod method, const Run& run, std::size_t first = 0, std::size_t count = n) {
    Motions m{std::vector<double>(count * nq), std::vector<double>(count * nv), std::vector<double>(count * steps * nq),
              std::vector<double>(count * steps * nv), std::vector<int>(count, 77)};
    typename Robot::Batch batch;
    batch.count = count, batch.q = q.data() + first * nq, batch.v = v.data() + first * nv,
    batch.input = tau.data() + first * steps * nv;
    dalembert::Rollout<double> rollout;
    rollout.steps = steps, rollout.time_step = 0.01, rollout.method = method;
    rollout.last_q = m.last_q.data(), rollout.last_v = m.last_v.data();
    rollout.path_q = m.path_q.data(), rollout.path_v = m.path_v.data(), rollout.stopped = m.stopped.data();
    EXPECT_EQ(run(batch, rollout), BatchError::none);
    return m;
  }
};

struct HeldForces {
  const double* tau;
};
template <class Robot>
struct SingleDynamics : HeldForces {
  typename Robot::Workspace workspace{};
  using V = Eigen::Matrix<double, Robot::nv, 1>;
  V acceleration(const Eigen::Matrix<double, Robot::nq, 1>& q, const V& v) {
    Robot::single(q.data(), v.data(), tau, workspace);
    return Eigen::Map<const V>(Robot::acceleration(workspace));
  }
};

using RolloutRobots = testing::Types<batch_arm_1_robot, batch_arm_4_robot, batch_biped_2_robot, batch_biped_8_robot>;
TYPED_TEST_SUITE(Rollouts, RolloutRobots);

TYPED_TEST(Rollouts, AreWhatIntegratorsMake) {
  using Q = Eigen::Matrix<double, TypeParam::nq, 1>;
  using V = Eigen::Matrix<double, TypeParam::nv, 1>;
  const std::size_t nq = this->nq, nv = this->nv;
  for (const auto method : {dalembert::RolloutMethod::semi_implicit_euler, dalembert::RolloutMethod::rk4}) {
    const auto motions = this->run(method, [](const auto& batch, const auto& to) { return TypeParam::rollout(batch, to); });
    for (std::size_t s = 0; s < this->n; ++s) {
      Q q = Eigen::Map<const Q>(this->q.data() + s * nq);
      V v = Eigen::Map<const V>(this->v.data() + s * nv);
      SingleDynamics<TypeParam> dynamics;
      for (std::size_t step = 0; step < this->steps; ++step) {
        const std::size_t at = s * this->steps + step;
        dynamics.tau = this->tau.data() + at * nv;
        if (method == dalembert::RolloutMethod::rk4) dalembert::integrators::rk4(dynamics, 0.01, q, v);
        else dalembert::integrators::semi_implicit_euler(dynamics, 0.01, q, v);
        const double scale = 1 + v.template lpNorm<Eigen::Infinity>();
        EXPECT_LT((Eigen::Map<const Q>(motions.path_q.data() + at * nq) - q).template lpNorm<Eigen::Infinity>(), 1e-10 * scale);
        EXPECT_LT((Eigen::Map<const V>(motions.path_v.data() + at * nv) - v).template lpNorm<Eigen::Infinity>(), 1e-10 * scale);
      }
      EXPECT_EQ(motions.stopped[s], -1);
      const std::size_t last = (s + 1) * this->steps - 1;
      EXPECT_EQ(std::memcmp(motions.last_q.data() + s * nq, motions.path_q.data() + last * nq, sizeof(double) * nq), 0);
      EXPECT_EQ(std::memcmp(motions.last_v.data() + s * nv, motions.path_v.data() + last * nv, sizeof(double) * nv), 0);
    }
  }
}

// A step that turns far is computed by other functions than those beside it.
TYPED_TEST(Rollouts, TurnFarBesideMotionsThatHardlyTurn) {
  using Q = Eigen::Matrix<double, TypeParam::nq, 1>;
  using V = Eigen::Matrix<double, TypeParam::nv, 1>;
  const std::size_t nq = this->nq, nv = this->nv;
  for (std::size_t s = 1; nq > nv && s < this->n; s += 4) this->v[s * nv + 3] = 60;
  const auto method = dalembert::RolloutMethod::semi_implicit_euler;
  const auto serial = [](const auto& batch, const auto& to) { return TypeParam::rollout(batch, to); };
  const auto all = this->run(method, serial);
  for (std::size_t s = 0; s < this->n; ++s) {
    Q q = Eigen::Map<const Q>(this->q.data() + s * nq);
    V v = Eigen::Map<const V>(this->v.data() + s * nv);
    SingleDynamics<TypeParam> dynamics;
    dynamics.tau = this->tau.data() + s * this->steps * nv;
    dalembert::integrators::semi_implicit_euler(dynamics, 0.01, q, v);
    const double* const first = all.path_q.data() + s * this->steps * nq;
    EXPECT_LT((Eigen::Map<const Q>(first) - q).template lpNorm<Eigen::Infinity>(),
              1e-12 * (1 + v.template lpNorm<Eigen::Infinity>()));
    const auto one = this->run(method, serial, s, 1);
    EXPECT_EQ(std::memcmp(one.path_q.data(), first, sizeof(double) * nq), 0);
  }
}

TYPED_TEST(Rollouts, AreTheSameBitsWhereverAMotionStands) {
  const auto method = dalembert::RolloutMethod::rk4;
  const auto serial = [](const auto& batch, const auto& to) { return TypeParam::rollout(batch, to); };
  const auto all = this->run(method, serial);
  EXPECT_TRUE(all == this->run(method, [](const auto& batch, const auto& to) { return TypeParam::rollout_tasks(batch, to); }));
  for (std::size_t s = 0; s < this->n; s += 5) {
    const auto one = this->run(method, serial, s, 1);
    EXPECT_EQ(
        std::memcmp(one.path_q.data(), all.path_q.data() + s * this->steps * this->nq, sizeof(double) * one.path_q.size()), 0);
    EXPECT_EQ(std::memcmp(one.last_v.data(), all.last_v.data() + s * this->nv, sizeof(double) * one.last_v.size()), 0);
  }
  // What acts as a function says it, before each step.
  struct Given {
    const double* tau;
    std::size_t steps;
  } given{this->tau.data(), this->steps};
  EXPECT_TRUE(all == this->run(method, [&](auto batch, auto to) {
    batch.input = nullptr;
    to.user = &given;
    to.control = [](const dalembert::RolloutStep<double>& at, void* user) {
      const Given& g = *static_cast<const Given*>(user);
      for (int k = 0; k < at.count; ++k)
        for (int i = 0; i < TypeParam::nv; ++i)
          at.input[i * at.stride + k] = g.tau[((at.first + static_cast<std::size_t>(k)) * g.steps + at.step) * TypeParam::nv +
                                              static_cast<std::size_t>(i)];
    };
    return TypeParam::rollout(batch, to);
  }));
  // Lanes, there and back.
  this->run(method, [&](auto batch, auto to) {
    const std::size_t n = this->n, nq = this->nq, nv = this->nv, steps = this->steps;
    Guarded<double> q(room<double>(BatchLayout::lanes, n, nq)), v(room<double>(BatchLayout::lanes, n, nv)),
        input(room<double>(BatchLayout::lanes, n, nv * steps)), path(room<double>(BatchLayout::lanes, n, nq * steps), -77.0);
    lay_out(this->q, n, nq, BatchLayout::lanes, q);
    lay_out(this->v, n, nv, BatchLayout::lanes, v);
    lay_out(this->tau, n, nv * steps, BatchLayout::lanes, input);
    batch.q = q.data(), batch.v = v.data(), batch.input = input.data();
    batch.states = batch.results = BatchLayout::lanes;
    to.path_q = path.data(), to.path_v = to.last_q = to.last_v = nullptr, to.stopped = nullptr;
    const BatchError error = TypeParam::rollout(batch, to);
    for (std::size_t s = 0; s < n; ++s)
      for (std::size_t i = 0; i < nq * steps; ++i)
        EXPECT_EQ(path[batch_index<double>(BatchLayout::lanes, s, i, nq * steps)], all.path_q[s * nq * steps + i]);
    return error;
  });
}

TYPED_TEST(Rollouts, StopWhereNumbersEnd) {
  const auto serial = [](const auto& batch, const auto& to) { return TypeParam::rollout(batch, to); };
  const auto method = dalembert::RolloutMethod::semi_implicit_euler;
  const auto all = this->run(method, serial);
  constexpr std::size_t bad = 6, at = 4;
  this->tau[(bad * this->steps + at) * this->nv + 2] = std::numeric_limits<double>::quiet_NaN();
  const auto some = this->run(method, serial);
  for (std::size_t s = 0; s < this->n; ++s) {
    SCOPED_TRACE(s);
    EXPECT_EQ(some.stopped[s], s == bad ? static_cast<int>(at) : -1);
    const double* const before = all.path_q.data() + (s * this->steps + (s == bad ? at - 1 : this->steps - 1)) * this->nq;
    EXPECT_EQ(std::memcmp(some.last_q.data() + s * this->nq, before, sizeof(double) * this->nq), 0);
  }
}

TYPED_TEST(Rollouts, NameWhatIsWrong) {
  typename TypeParam::Batch batch;
  dalembert::Rollout<double> rollout;
  EXPECT_EQ(TypeParam::rollout(batch, rollout), BatchError::none);
  batch.count = 1;
  EXPECT_EQ(TypeParam::rollout(batch, rollout), BatchError::q);
  batch.q = this->q.data();
  EXPECT_EQ(TypeParam::rollout(batch, rollout), BatchError::v);
  batch.v = this->v.data();
  rollout.steps = 2;
  EXPECT_EQ(TypeParam::rollout(batch, rollout), BatchError::none) << "nothing acts";
  rollout.steps = static_cast<std::size_t>(-3);
  EXPECT_EQ(TypeParam::rollout(batch, rollout), BatchError::steps);
  rollout.steps = 2;
  rollout.time_step = std::numeric_limits<double>::infinity();
  EXPECT_EQ(TypeParam::rollout(batch, rollout), BatchError::time_step);
  rollout.time_step = 1e-3;
  rollout.method = static_cast<dalembert::RolloutMethod>(3);
  EXPECT_EQ(TypeParam::rollout(batch, rollout), BatchError::method);
  rollout.method = dalembert::RolloutMethod::linearly_implicit;
  EXPECT_EQ(TypeParam::rollout(batch, rollout), BatchError::left_out) << "the scene does not ask for it";
  EXPECT_NE(std::string(describe(BatchError::left_out)).find("rollouts: [linearly_implicit]"), std::string::npos);
  rollout.method = dalembert::RolloutMethod::rk4;
  rollout.active = this->tau.data();
  EXPECT_EQ(TypeParam::rollout(batch, rollout), BatchError::active) << "the scene does not ask for it";
  rollout.active = nullptr;
  rollout.control = [](const dalembert::RolloutStep<double>&, void*) {};
  batch.input = this->tau.data();
  EXPECT_EQ(TypeParam::rollout(batch, rollout), BatchError::control);
}

// With dampers and springs that explicit steps cannot bear.
template <class Robot>
struct StiffRollouts : Rollouts<Robot> {
  using Q = Eigen::Matrix<double, Robot::nq, 1>;
  using V = Eigen::Matrix<double, Robot::nv, 1>;
  using Matrix = Eigen::Matrix<double, Robot::nv, Robot::nv>;
  static constexpr auto method = dalembert::RolloutMethod::linearly_implicit;

  // Stiff springs begin near their rest: from 1 rad, one of 1e6 N m/rad has 500 kJ to spend.
  StiffRollouts() {
    for (const auto& joint : Robot::joint_constants())
      for (std::size_t s = 0; joint.stiffness >= 1e5 && s < this->n; ++s)
        this->q[s * this->nq + this->nq - this->nv + static_cast<std::size_t>(Robot::coordinate(joint.joint))] *= 1e-2;
  }

  // By single calls, the constants of the joints as the scene says them.
  struct Dynamics {
    const double* tau = nullptr;
    double step = 0.01;
    double least = 0, largest = 0;  // eigenvalues of what the step solves with
    typename Robot::Workspace workspace{};

    dalembert::integrators::Linearised<double, Robot::nv> linearised(const Q& q, const V& v) {
      Robot::single(q.data(), v.data(), tau, workspace);
      const auto outputs = Robot::outputs();  // mass_matrix, bias, forward_dynamics
      dalembert::integrators::Linearised<double, Robot::nv> near;
      near.mass = Eigen::Map<const Matrix>(outputs[0].single(workspace));
      near.damping = near.stiffness = Matrix::Zero();
      for (const auto& joint : Robot::joint_constants()) {
        const int k = Robot::coordinate(joint.joint);
        near.damping(k, k) = joint.damping, near.stiffness(k, k) = joint.stiffness;
      }
      near.force = Eigen::Map<const V>(tau) - Eigen::Map<const V>(outputs[1].single(workspace));
      const Matrix system = near.mass + step * near.damping + (step * step) * near.stiffness;
      const V values = dalembert::reference::eigenvalues(system);
      least = values.minCoeff(), largest = values.maxCoeff();
      return near;
    }
  };
};
using StiffRobots = testing::Types<batch_stiff_arm_robot, batch_stiff_biped_robot, batch_stiff_fingers_robot>;
TYPED_TEST_SUITE(StiffRollouts, StiffRobots);

// Step by step, from where the motion was: so that no step's rounding grows in those behind it. A step is as wrong as what it
// solves with magnifies the rounding of v and of its change.
TYPED_TEST(StiffRollouts, AreWhatTheIntegratorMakes) {
  using Q = typename TestFixture::Q;
  using V = typename TestFixture::V;
  constexpr double epsilon = std::numeric_limits<double>::epsilon();
  const std::size_t nq = this->nq, nv = this->nv;
  const auto motions = this->run(this->method, [](const auto& batch, const auto& to) { return TypeParam::rollout(batch, to); });
  double worst = 0;
  for (std::size_t s = 0; s < this->n; ++s) {
    EXPECT_EQ(motions.stopped[s], -1);
    Q from_q = Eigen::Map<const Q>(this->q.data() + s * nq);
    V from_v = Eigen::Map<const V>(this->v.data() + s * nv);
    typename TestFixture::Dynamics dynamics;
    for (std::size_t step = 0; step < this->steps; ++step) {
      const std::size_t at = s * this->steps + step;
      dynamics.tau = this->tau.data() + at * nv;
      Q q = from_q;
      V v = from_v;
      dalembert::integrators::linearly_implicit(dynamics, 0.01, q, v);
      const double scale = from_v.template lpNorm<Eigen::Infinity>() + v.template lpNorm<Eigen::Infinity>();
      const double tolerance = 10 * dynamics.largest / dynamics.least * epsilon * scale;
      from_q = Eigen::Map<const Q>(motions.path_q.data() + at * nq);
      from_v = Eigen::Map<const V>(motions.path_v.data() + at * nv);
      const double of_v = (from_v - v).template lpNorm<Eigen::Infinity>(),
                   of_q = (from_q - q).template lpNorm<Eigen::Infinity>();
      EXPECT_LE(of_v, tolerance);
      EXPECT_LE(of_q, 0.01 * tolerance + 8 * epsilon * (1 + q.template lpNorm<Eigen::Infinity>()));
      worst = std::max(worst, of_v / tolerance);
    }
  }
  this->RecordProperty("worst", std::to_string(worst));  // of the tolerance
}

// Five seconds without forces: what is stiff comes to rest, where semi-implicit Euler soon has no finite numbers.
TYPED_TEST(StiffRollouts, ComeToRestWhereExplicitStepsBlowUp) {
  const auto end = [&](dalembert::RolloutMethod method, std::vector<double>& v, std::vector<int>& stopped) {
    v.assign(this->n * this->nv, 0), stopped.assign(this->n, 77);
    typename TypeParam::Batch batch;
    batch.count = this->n, batch.q = this->q.data(), batch.v = this->v.data();
    dalembert::Rollout<double> rollout;
    rollout.steps = 500, rollout.time_step = 0.01, rollout.method = method;
    rollout.last_v = v.data(), rollout.stopped = stopped.data();
    EXPECT_EQ(TypeParam::rollout(batch, rollout), BatchError::none);
  };
  std::vector<double> v;
  std::vector<int> stopped;
  end(dalembert::RolloutMethod::linearly_implicit, v, stopped);
  for (std::size_t s = 0; s < this->n; ++s) {
    EXPECT_EQ(stopped[s], -1) << s;
    for (const auto& joint : TypeParam::joint_constants()) {
      const double speed = std::abs(v[s * this->nv + static_cast<std::size_t>(TypeParam::coordinate(joint.joint))]);
      EXPECT_TRUE(speed < 1 || (joint.damping < 1e3 && joint.stiffness < 1e5)) << joint.joint << ": " << speed;
    }
  }
  end(dalembert::RolloutMethod::semi_implicit_euler, v, stopped);
  for (std::size_t s = 0; s < this->n; ++s) EXPECT_TRUE(stopped[s] >= 0 && stopped[s] < 400) << s << ": " << stopped[s];
}

TYPED_TEST(StiffRollouts, AreTheSameBitsWhereverAMotionStands) {
  const auto serial = [](const auto& batch, const auto& to) { return TypeParam::rollout(batch, to); };
  const auto all = this->run(this->method, serial);
  EXPECT_TRUE(all ==
              this->run(this->method, [](const auto& batch, const auto& to) { return TypeParam::rollout_tasks(batch, to); }));
  for (std::size_t s = 0; s < this->n; s += 5) {
    const auto one = this->run(this->method, serial, s, 1);
    EXPECT_EQ(
        std::memcmp(one.path_q.data(), all.path_q.data() + s * this->steps * this->nq, sizeof(double) * one.path_q.size()), 0);
    EXPECT_EQ(std::memcmp(one.last_v.data(), all.last_v.data() + s * this->nv, sizeof(double) * one.last_v.size()), 0);
  }
}

// Backwards in time a damper takes from the diagonal: what is left need not be positive definite, and no such step is made.
TYPED_TEST(StiffRollouts, StopWhereTheStepHasNoPositiveDefiniteMatrix) {
  using Q = typename TestFixture::Q;
  using V = typename TestFixture::V;
  std::size_t refused = 0;
  for (const double time_step : {-0.05, -0.01, -1e-3, -1e-5}) {
    typename TypeParam::Batch batch;
    batch.count = this->n, batch.q = this->q.data(), batch.v = this->v.data();
    dalembert::Rollout<double> rollout;
    std::vector<int> stopped(this->n, 77);
    rollout.steps = 1, rollout.time_step = time_step, rollout.method = this->method, rollout.stopped = stopped.data();
    EXPECT_EQ(TypeParam::rollout(batch, rollout), BatchError::none);
    for (std::size_t s = 0; s < this->n; ++s) {
      typename TestFixture::Dynamics dynamics;
      dynamics.tau = this->tau.data(), dynamics.step = time_step;
      dynamics.linearised(Eigen::Map<const Q>(this->q.data() + s * this->nq),
                          Eigen::Map<const V>(this->v.data() + s * this->nv));
      EXPECT_EQ(stopped[s], dynamics.least > 0 ? -1 : 0) << time_step << ": " << dynamics.least;
      refused += dynamics.least > 0 ? 0 : 1;
    }
  }
  EXPECT_GT(refused, 0u);
}

// A leaf without mass, but for a payload given at run time: where there is none, M is singular.
TEST(SingularStates, ChangeNoOther) {
  using Robot = batch_singular_robot;
  constexpr std::size_t n = 23;
  std::mt19937 random(3);
  std::uniform_real_distribution<double> number(-1, 1);
  std::vector<double> q(n * Robot::nq), v(n * Robot::nv), tau(n * Robot::nv), payloads(n * 10, 0.0);
  for (std::vector<double>* of : {&q, &v, &tau})
    for (double& x : *of) x = number(random);
  for (std::size_t s = 0; s < n; ++s) {
    double* const quaternion = q.data() + s * Robot::nq + 3;
    for (int i = 0; i < 4; ++i) quaternion[i] = i == 3 ? 1 : 0;
    double* const payload = payloads.data() + 10 * s;
    payload[0] = 1 + 0.1 * static_cast<double>(s), payload[1] = 0.1, payload[4] = payload[7] = payload[9] = 0.02;
  }
  Robot::Batch batch;
  batch.count = n, batch.q = q.data(), batch.v = v.data(), batch.input = tau.data(), batch.payloads_c = payloads.data();
  const auto run = [&](std::vector<std::vector<double>>& results, std::vector<int>& status) {
    std::vector<double*> pointers;
    results.clear();
    for (const auto& output : Robot::outputs()) results.emplace_back(n * static_cast<std::size_t>(output.size), 5.0);
    for (auto& of : results) pointers.push_back(of.data());
    auto to = Robot::results(pointers);
    status.assign(n, 99);
    to.status = status.data();
    ASSERT_EQ(Robot::batch(batch, to), BatchError::none);
  };
  std::vector<std::vector<double>> regular, results;
  std::vector<int> status;
  run(regular, status);
  EXPECT_EQ(std::count(status.begin(), status.end(), -1), static_cast<std::ptrdiff_t>(n));
  const std::vector<std::size_t> singular{0, 5, 6, 14, 22};
  for (const std::size_t s : singular) std::fill_n(payloads.begin() + static_cast<std::ptrdiff_t>(10 * s), 10, 0.0);
  run(results, status);
  Robot::Workspace workspace;
  for (std::size_t s = 0; s < n; ++s) {
    SCOPED_TRACE(s);
    Robot::set_given(workspace, payloads.data() + 10 * s);
    Robot::single(q.data() + s * Robot::nq, v.data() + s * Robot::nv, tau.data() + s * Robot::nv, workspace);
    EXPECT_EQ(status[s], Robot::status(workspace));
    const bool is_singular = std::count(singular.begin(), singular.end(), s) == 1;
    EXPECT_EQ(status[s] >= 0, is_singular);
    for (std::size_t o = 0; o < results.size(); ++o) {
      const auto size = static_cast<std::size_t>(Robot::outputs()[o].size);
      const double* const of_state = results[o].data() + s * size;
      if (is_singular) EXPECT_EQ(std::count(of_state, of_state + size, 0.0), static_cast<std::ptrdiff_t>(size));
      else EXPECT_EQ(std::memcmp(of_state, regular[o].data() + s * size, sizeof(double) * size), 0);
    }
  }
}

// C's functions, with what they take as numpy has it.
TEST(BatchesInC, AreThoseOfCpp) {
  using Robot = batch_singular_robot;
  EXPECT_EQ(std::string(batch_singular_batch_error(3)), describe(static_cast<BatchError>(3)));
  const double q[2 * Robot::nq] = {0, 0, 0, 0, 0, 0, 1, 0.3}, zeros[2 * Robot::nv] = {};
  double dv[2 * Robot::nv];
  int status[2] = {7, 7};
  batch_singular_together_batch_results results = {};
  results.together_forward_dynamics = dv;
  EXPECT_EQ(batch_singular_batch_together(q, zeros, nullptr, 2, &results, status, nullptr),
            static_cast<int>(BatchError::input));
  EXPECT_EQ(status[0], 7);
  double q_twice[2 * Robot::nq];
  for (int i = 0; i < 2 * Robot::nq; ++i) q_twice[i] = q[i % Robot::nq];
  batch_singular_workspace* workspace = batch_singular_create();
  const double com[3] = {0.1, 0, 0}, inertia[6] = {0.02, 0, 0, 0.02, 0, 0.02};
  batch_singular_set_payload_c(1.5, com, inertia, workspace);
  batch_singular_batch_options options = {};
  options.workspace = workspace;
  ASSERT_EQ(batch_singular_batch_together(q_twice, zeros, zeros, 2, &results, status, &options), 0);
  EXPECT_EQ(status[0], -1);
  EXPECT_EQ(status[1], -1);
  batch_singular_together(q_twice, zeros, zeros, workspace);
  for (int i = 0; i < 2 * Robot::nv; ++i)
    EXPECT_NEAR(dv[i], batch_singular_together_forward_dynamics(workspace)[i % Robot::nv], 1e-9);
  ASSERT_EQ(batch_singular_batch_together(q_twice, zeros, zeros, 2, &results, status, nullptr), 0);
  EXPECT_GE(status[0], 0) << "a new workspace carries nothing";
  batch_singular_destroy(workspace);
}

}  // namespace
