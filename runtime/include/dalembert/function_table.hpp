// What a shared object tells of the functions in it, for programs that load it at run time: each is called for one state or for
// many, on plain rows of numbers. An entry computes one state after another, or, of batches, states in the lanes of registers.
//
// The object exports `extern "C" const dalembert::FunctionTable* dalembert_function_table()`. Numbers are the table's scalar,
// so that pointers to them are untyped here. A state is a row: q, v and what the function takes besides. Results are written
// row by row, states one after another, which is what arrays of most languages are; the workspace holds matrices column by
// column.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <dalembert/linkage.hpp>
#include <dalembert/rollout_layout.hpp>
#include <dalembert/self_test.hpp>
#include <new>
#include <type_traits>
#include <utility>

namespace dalembert {

inline constexpr std::int32_t function_table_version = 4;

// The rows of one argument: that of state s begins s · step numbers behind the first; with a step of 0 all states share one.
struct StateRows {
  const void* first = nullptr;
  std::ptrdiff_t step = 0;
};

struct FunctionCall {
  StateRows q, v, more;       // nq, nv and nv numbers; `more` is not read by functions of q and v alone
  StateRows run_time;         // the run-time inputs one after another: gravity_vector, payloads, wrenches
  void* const* results;       // per result: room for the states' matrices
  std::int32_t* status;       // per state: the coordinate at which M is not positive definite; nv + n where embedded loops'
                              // linkage n is at a toggle point; -1: neither. May be null.
  double* constraints;        // per state: residual, least pivot, rank as in ConstraintStatus. May be null.
  std::ptrdiff_t begin, end;  // which states
};

// Motions that a function makes from many states on (dalembert/rollout_layout.hpp): results are nullable, nq or nv numbers of
// each motion, or of each of its steps.
struct RolloutCall {
  StateRows q, v;                                      // where motions begin
  const void* more;                                    // what acts, or null: nothing. Number i in step t of motion m stands
  std::ptrdiff_t more_motion, more_step, more_number;  // m · more_motion + t · more_step + i · more_number behind it
  StateRows run_time;                                  // the same in all steps
  std::size_t steps;
  double time_step;
  RolloutMethod method;
  void *last_q, *last_v, *path_q, *path_v;
  std::int32_t* stopped;
  std::ptrdiff_t begin, end;  // which motions
};

struct FunctionEntry {
  const char* name;
  std::int32_t results;
  bool has_status, has_constraints;
  void* (*create)() noexcept;  // a workspace; null where there is no memory. Threads do not share one.
  void (*destroy)(void* workspace) noexcept;
  void (*run)(const FunctionCall& call, void* workspace) noexcept;
  bool (*self_test)(SelfTestReport* report) noexcept;
  void (*roll_out)(const RolloutCall& call, void* workspace) noexcept;  // null: no batch, or one that does not tell v̇
};

struct FunctionTable {
  std::int32_t version;
  std::int32_t scalar_bytes;  // 4: float, 8: double
  std::int32_t functions;
  const FunctionEntry* entries;
  // Closes embedded loops of so many rows of q, one after another; status: of each row error, least pivot, linkage as in
  // LinkageStatus. Null: none are embedded.
  void (*close_loops)(void* q, std::ptrdiff_t count, double* status) noexcept;
};

namespace table {

// A result of one state: `from`, column by column, to its place among the states' results, row by row.
template <int rows, int columns, class Scalar>
inline void copy_result(const Scalar* from, void* to, std::ptrdiff_t state) noexcept {
  Scalar* const into = static_cast<Scalar*>(to) + state * (rows * columns);
  if constexpr (rows == 1 || columns == 1) {
    std::memcpy(into, from, sizeof(Scalar) * rows * columns);
  } else {
    using Packet = typename Eigen::internal::packet_traits<Scalar>::type;
    constexpr int width = Eigen::internal::unpacket_traits<Packet>::size;
    constexpr int whole_rows = width > 1 ? rows / width * width : 0, whole_columns = width > 1 ? columns / width * width : 0;
    if constexpr (width > 1) {
      for (int c = 0; c < whole_columns; c += width)
        for (int r = 0; r < whole_rows; r += width) {
          Eigen::internal::PacketBlock<Packet, width> block;
          for (int i = 0; i < width; ++i) block.packet[i] = Eigen::internal::ploadu<Packet>(from + (c + i) * rows + r);
          Eigen::internal::ptranspose(block);
          for (int i = 0; i < width; ++i) Eigen::internal::pstoreu(into + (r + i) * columns + c, block.packet[i]);
        }
    }
    for (int c = 0; c < whole_columns; ++c)
      for (int r = whole_rows; r < rows; ++r) into[r * columns + c] = from[c * rows + r];
    for (int c = whole_columns; c < columns; ++c)
      for (int r = 0; r < rows; ++r) into[r * columns + c] = from[c * rows + r];
  }
}

// What a glue class Function says of one generated function: Scalar, Workspace, nv, call(q, v, more, workspace), set(values,
// workspace) for the run-time inputs, copy(workspace, results, state), and of_mass_matrix(workspace, 0), of_linkages(workspace,
// 0), of_constraints(workspace, 0), of_impact(workspace, 0) and of_support(workspace, 0): the status of each, or NoStatus.
struct NoStatus {};
template <class Function>
using OfMassMatrix = std::decay_t<decltype(Function::of_mass_matrix(std::declval<const typename Function::Workspace&>(), 0))>;
template <class Function>
using OfLinkages = std::decay_t<decltype(Function::of_linkages(std::declval<const typename Function::Workspace&>(), 0))>;

template <class Function>
using OfConstraints = std::decay_t<decltype(Function::of_constraints(std::declval<const typename Function::Workspace&>(), 0))>;
template <class Function>
using OfImpact = std::decay_t<decltype(Function::of_impact(std::declval<const typename Function::Workspace&>(), 0))>;
template <class Function>
using OfSupport = std::decay_t<decltype(Function::of_support(std::declval<const typename Function::Workspace&>(), 0))>;

template <class Function>
constexpr bool keeps_to_constraints() noexcept {
  return !std::is_same_v<OfConstraints<Function>, NoStatus> || !std::is_same_v<OfImpact<Function>, NoStatus> ||
         !std::is_same_v<OfSupport<Function>, NoStatus>;
}

// Residual, least pivot and rank; where a function solves for several things, the worst.
template <class Function>
void put_constraints(const typename Function::Workspace& workspace, double* to) noexcept {
  bool first = true;
  const auto put = [&](const auto& status) noexcept {
    if constexpr (!std::is_same_v<std::decay_t<decltype(status)>, NoStatus>) {
      const double numbers[] = {static_cast<double>(status.residual), static_cast<double>(status.least_pivot),
                                static_cast<double>(status.rank)};
      for (int i = 0; i < 3; ++i)
        if (first || !(i == 0 ? numbers[i] <= to[i] : numbers[i] >= to[i])) to[i] = numbers[i];
      first = false;
    }
  };
  put(Function::of_constraints(workspace, 0));
  put(Function::of_impact(workspace, 0));
  put(Function::of_support(workspace, 0));
}

template <class Function>
std::int32_t status_in(const typename Function::Workspace& workspace) noexcept {
  if constexpr (!std::is_same_v<OfMassMatrix<Function>, NoStatus>) {
    const auto& status = Function::of_mass_matrix(workspace, 0);
    if (!status.ok()) return static_cast<std::int32_t>(status.coordinate);
  }
  if constexpr (!std::is_same_v<OfLinkages<Function>, NoStatus>) {
    const auto& status = Function::of_linkages(workspace, 0);
    if (!status.ok()) return Function::nv + static_cast<std::int32_t>(status.linkage);
  }
  (void)workspace;
  return -1;
}

// Each row by `close`, which takes its nq numbers and tells a LinkageStatus.
template <int nq, class Scalar, class Status>
void close_rows(Status (*close)(Scalar*) noexcept, void* q, std::ptrdiff_t count, double* status) noexcept {
  for (std::ptrdiff_t i = 0; i < count; ++i) {
    const Status told = close(static_cast<Scalar*>(q) + i * nq);
    status[3 * i] = static_cast<double>(told.error);
    status[3 * i + 1] = static_cast<double>(told.least_pivot);
    status[3 * i + 2] = static_cast<double>(told.linkage);
  }
}

// One state after another.
template <class Function>
void run(const FunctionCall& call, void* untyped) noexcept {
  using Scalar = typename Function::Scalar;
  auto& workspace = *static_cast<typename Function::Workspace*>(untyped);
  const auto row = [](const StateRows& rows, std::ptrdiff_t state) {
    return static_cast<const Scalar*>(rows.first) + state * rows.step;
  };
  for (std::ptrdiff_t s = call.begin; s < call.end; ++s) {
    if (Function::run_time_inputs > 0) Function::set(row(call.run_time, s), workspace);
    Function::call(row(call.q, s), row(call.v, s), row(call.more, s), workspace);
    Function::copy(workspace, call.results, s);
    if (call.status) call.status[s] = status_in<Function>(workspace);
    if (call.constraints) put_constraints<Function>(workspace, call.constraints + 3 * s);
  }
}

// Of states in lanes, a glue class says: Scalar, Workspace, nq, nv, more (0 where it takes q and v alone), run_time_inputs;
// set() as above; set_each(from, step, n, room, batch) for run-time inputs of n states; call(batch, results, state, status) for
// the states of a batch whose results begin at those of `state`.

// States whose arguments are copied together, where they do not stand one after another.
constexpr int states_together = 64;

template <class Function>
struct BatchWorkspace {
  typename Function::Workspace workspace{};
  typename Function::Scalar q[states_together * (Function::nq + 1)], v[states_together * (Function::nv + 1)],
      more[states_together * (Function::more + 1)], given[states_together * (Function::run_time_inputs + 1)];
};

// n rows of `width` numbers, one after another in `room`.
template <class Scalar>
inline const Scalar* gathered(const Scalar* from, std::ptrdiff_t step, int width, std::ptrdiff_t n, Scalar* room) noexcept {
  for (std::ptrdiff_t s = 0; s < n; ++s)
    std::memcpy(room + s * width, from + s * step, sizeof(Scalar) * static_cast<std::size_t>(width));
  return room;
}

// Of batches that tell v̇ the class has roll_out(batch, rollout), too.
template <class Function>
void roll_out_batch(const RolloutCall& call, void* untyped) noexcept {
  using Scalar = typename Function::Scalar;
  auto& own = *static_cast<BatchWorkspace<Function>*>(untyped);
  constexpr std::ptrdiff_t nq = Function::nq, nv = Function::nv;
  const bool given_each = Function::run_time_inputs > 0 && call.run_time.step != 0;
  if (Function::run_time_inputs > 0 && !given_each)
    Function::set(static_cast<const Scalar*>(call.run_time.first), own.workspace);
  const auto steps = static_cast<std::ptrdiff_t>(call.steps);
  const bool acts_in_a_row =
      call.more_number == 1 && call.more_step == nv && (call.more_motion == steps * nv || call.end - call.begin == 1);
  const bool in_a_row = call.q.step == nq && call.v.step == nv && !given_each;
  const auto at = [](void* results, std::ptrdiff_t numbers) {
    return results ? static_cast<Scalar*>(results) + numbers : nullptr;
  };
  struct Acts {
    const RolloutCall& call;
    std::ptrdiff_t first;
  };
  for (std::ptrdiff_t m = call.begin, n; m < call.end; m += n) {
    n = call.end - m;
    if (!in_a_row && n > states_together) n = states_together;
    typename Function::Batch batch;
    batch.count = static_cast<std::size_t>(n);
    const Scalar *const q = static_cast<const Scalar*>(call.q.first) + m * call.q.step, *const v = static_cast<const Scalar*>(
                                                                                                       call.v.first) +
                                                                                                   m * call.v.step;
    batch.q = call.q.step == nq ? q : gathered(q, call.q.step, Function::nq, n, own.q);
    batch.v = call.v.step == nv ? v : gathered(v, call.v.step, Function::nv, n, own.v);
    if (given_each)
      Function::set_each(static_cast<const Scalar*>(call.run_time.first) + m * call.run_time.step, call.run_time.step, n,
                         own.given, batch);
    else if (Function::run_time_inputs > 0) Function::set_all(own.workspace, batch);
    Rollout<Scalar> rollout;
    rollout.steps = call.steps, rollout.time_step = static_cast<Scalar>(call.time_step), rollout.method = call.method;
    Acts acts{call, m};
    if (call.more && acts_in_a_row) batch.input = static_cast<const Scalar*>(call.more) + m * call.more_motion;
    else if (call.more)
      rollout.user = &acts, rollout.control = [](const RolloutStep<Scalar>& step, void* user) {
        const Acts& of = *static_cast<const Acts*>(user);
        const Scalar* const from = static_cast<const Scalar*>(of.call.more) +
                                   (of.first + static_cast<std::ptrdiff_t>(step.first)) * of.call.more_motion +
                                   static_cast<std::ptrdiff_t>(step.step) * of.call.more_step;
        for (std::ptrdiff_t i = 0; i < Function::nv; ++i)
          for (std::ptrdiff_t k = 0; k < step.count; ++k)
            step.input[i * step.stride + k] = from[k * of.call.more_motion + i * of.call.more_number];
      };
    rollout.last_q = at(call.last_q, m * nq), rollout.last_v = at(call.last_v, m * nv);
    rollout.path_q = at(call.path_q, m * steps * nq), rollout.path_v = at(call.path_v, m * steps * nv);
    rollout.stopped = call.stopped ? call.stopped + m : nullptr;
    Function::roll_out(batch, rollout);
  }
}

using RollOut = void (*)(const RolloutCall& call, void* workspace) noexcept;
template <class Function>
auto roll_out_of(int) noexcept
    -> std::enable_if_t<sizeof(decltype(Function::roll_out(std::declval<typename Function::Batch&>(),
                                                           std::declval<Rollout<typename Function::Scalar>&>()))) != 0,
                        RollOut> {
  return roll_out_batch<Function>;
}
template <class Function>
RollOut roll_out_of(long) noexcept {
  return nullptr;
}

template <class Function>
void run_batch(const FunctionCall& call, void* untyped) noexcept {
  using Scalar = typename Function::Scalar;
  auto& own = *static_cast<BatchWorkspace<Function>*>(untyped);
  const bool given_each = Function::run_time_inputs > 0 && call.run_time.step != 0;
  const bool in_a_row = call.q.step == Function::nq && (!Function::reads_v || call.v.step == Function::nv) &&
                        (Function::more == 0 || call.more.step == Function::more) && !given_each;
  const auto rows = [&](const StateRows& of, int width, std::ptrdiff_t state, std::ptrdiff_t n, Scalar* room) -> const Scalar* {
    const Scalar* const from = static_cast<const Scalar*>(of.first) + state * of.step;
    return of.step == width ? from : gathered(from, of.step, width, n, room);
  };
  if (Function::run_time_inputs > 0 && !given_each)
    Function::set(static_cast<const Scalar*>(call.run_time.first), own.workspace);
  for (std::ptrdiff_t s = call.begin, n; s < call.end; s += n) {
    n = call.end - s;
    if (!in_a_row && n > states_together) n = states_together;
    typename Function::Batch batch;
    batch.count = static_cast<std::size_t>(n);
    batch.q = rows(call.q, Function::nq, s, n, own.q);
    if (Function::reads_v) batch.v = rows(call.v, Function::nv, s, n, own.v);
    if (Function::more > 0) batch.input = rows(call.more, Function::more, s, n, own.more);
    if (given_each)
      Function::set_each(static_cast<const Scalar*>(call.run_time.first) + s * call.run_time.step, call.run_time.step, n,
                         own.given, batch);
    else if (Function::run_time_inputs > 0) Function::set_all(own.workspace, batch);
    Function::call(batch, call.results, s, call.status ? call.status + s : nullptr);
  }
}

template <class Function>
FunctionEntry batch_entry(const char* name, int results, bool (*self_test)(SelfTestReport*) noexcept) noexcept {
  using Own = BatchWorkspace<Function>;
  FunctionEntry entry{};
  entry.name = name;
  entry.results = results;
  entry.has_status = Function::has_status();
  entry.create = []() noexcept -> void* { return new (std::nothrow) Own(); };
  entry.destroy = [](void* workspace) noexcept { delete static_cast<Own*>(workspace); };
  entry.run = run_batch<Function>;
  entry.self_test = self_test;
  entry.roll_out = roll_out_of<Function>(0);
  return entry;
}

template <class Function>
FunctionEntry entry(const char* name, int results, bool (*self_test)(SelfTestReport*) noexcept) noexcept {
  using Workspace = typename Function::Workspace;
  FunctionEntry entry{};
  entry.name = name;
  entry.results = results;
  entry.has_constraints = keeps_to_constraints<Function>();
  entry.has_status = !std::is_same_v<OfMassMatrix<Function>, NoStatus> || !std::is_same_v<OfLinkages<Function>, NoStatus>;
  entry.create = []() noexcept -> void* { return new (std::nothrow) Workspace(); };
  entry.destroy = [](void* workspace) noexcept { delete static_cast<Workspace*>(workspace); };
  entry.run = run<Function>;
  entry.self_test = self_test;
  return entry;
}

}  // namespace table
}  // namespace dalembert
