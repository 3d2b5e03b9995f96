// What generated functions take for q, v and the like: whatever Eigen has with as many numbers, with the same bits as from
// pointers; and where a length that is known at run time only is wrong, nothing. (What must not compile is seen by
// tests/packaging/wrong_uses.cpp.)
#include <gtest/gtest.h>

#include <Eigen/Core>
#include <cmath>
#include <cstring>
#include <memory>
#include <type_traits>
#include <utility>
#include <vector>

#include "chain_7_fixed/dynamics.hpp"
#include "chain_7_fixed/tasks.hpp"
#include "functions/dynamics.hpp"
#include "functions/tasks.hpp"
#include "heap_count.hpp"

namespace dalembert::testing {
namespace {

// The code of a namespace as a type.
#define DALEMBERT_CODE(Name, space)                                                                      \
  struct Name {                                                                                          \
    using VectorQ = space::VectorQ;                                                                      \
    using VectorV = space::VectorV;                                                                      \
    using Workspace = space::Workspace;                                                                  \
    using TaskGraph = space::TaskGraph;                                                                  \
    static constexpr int nq = space::nq, nv = space::nv;                                                 \
    template <class... X>                                                                                \
    static auto evaluate(const X&... x) -> decltype(space::evaluate(x..., std::declval<Workspace&>())) { \
      return space::evaluate(x..., *workspace);                                                          \
    }                                                                                                    \
    template <class W>                                                                                   \
    static auto result(W&& w) -> decltype(space::inverse_mass_matrix(std::forward<W>(w)));               \
    static inline const std::unique_ptr<Workspace> workspace = std::make_unique<Workspace>();            \
  };
DALEMBERT_CODE(Arm, chain_7_fixed)
DALEMBERT_CODE(Floating, functions)
#undef DALEMBERT_CODE

template <class Code>
class Arguments : public ::testing::Test {
 protected:
  using Workspace = typename Code::Workspace;
  using VectorQ = typename Code::VectorQ;
  using VectorV = typename Code::VectorV;
  static constexpr int nq = Code::nq, nv = Code::nv;

  Arguments() {
    for (int i = 0; i < nq; ++i) q[i] = std::sin(1 + i);
    for (int i = 0; i < nv; ++i) v[i] = std::cos(2 + i);
    Code::evaluate(q.data(), v.data());
    expected = copy();
  }

  // All bytes but those between members of the status, which nobody sets.
  static std::vector<std::byte> copy() {
    std::vector<std::byte> bytes(sizeof(Workspace));
    std::memcpy(bytes.data(), Code::workspace.get(), bytes.size());
    const auto& status = Code::workspace->status;
    const auto address = [](const auto& of) { return reinterpret_cast<const std::byte*>(&of); };
    const auto place = [&](const auto& of) { return bytes.data() + (address(of) - address(*Code::workspace)); };
    std::memset(place(status), 0, sizeof status);
    std::memcpy(place(status.coordinate), &status.coordinate, sizeof status.coordinate);
    std::memcpy(place(status.pivot), &status.pivot, sizeof status.pivot);
    return bytes;
  }
  // Whether the call left what the one with pointers leaves; before it the workspace has seen another state.
  template <class Call>
  bool gives_the_same(const Call& call) const {
    const VectorQ other_q = VectorQ::Constant(0.3);
    const VectorV other_v = VectorV::Constant(0.4);
    Code::evaluate(other_q, other_v);
    EXPECT_NE(copy(), expected);
    call();
    return copy() == expected;
  }

  VectorQ q;
  VectorV v;
  std::vector<std::byte> expected;
};
using Codes = ::testing::Types<Arm, Floating>;
TYPED_TEST_SUITE(Arguments, Codes);

TYPED_TEST(Arguments, OfFixedSizeGiveNothingToLookAt) {
  using Q = typename TestFixture::VectorQ;
  using V = typename TestFixture::VectorV;
  static_assert(std::is_void_v<decltype(TypeParam::evaluate(Q(), V()))>);
  static_assert(std::is_same_v<decltype(TypeParam::evaluate(Q(), Eigen::VectorXd())), Success>);
  static_assert(
      std::is_same_v<decltype(TypeParam::evaluate(Eigen::Ref<Eigen::VectorXd>(std::declval<Eigen::VectorXd&>()), V())),
                     Success>);
  const double *const q = this->q.data(), *const v = this->v.data();
  const Q& positions = this->q;
  const V& rates = this->v;
  const Eigen::Matrix<double, Q::RowsAtCompileTime, 1> plain_q = positions;
  const Eigen::Matrix<double, V::RowsAtCompileTime, 1> plain_v = rates;
  EXPECT_TRUE(this->gives_the_same([&] { TypeParam::evaluate(positions, rates); }));
  EXPECT_TRUE(this->gives_the_same([&] { TypeParam::evaluate(plain_q, plain_v); }));
  EXPECT_TRUE(this->gives_the_same([&] { TypeParam::evaluate(Eigen::Map<const Q>(q), Eigen::Map<const V>(v)); }));
  EXPECT_TRUE(this->gives_the_same([&] { TypeParam::evaluate(Eigen::Ref<const Q>(plain_q), Eigen::Ref<const V>(rates)); }));
  EXPECT_TRUE(this->gives_the_same([&] { TypeParam::evaluate((positions + positions) / 2, plain_v.array() * 1); }));
  EXPECT_TRUE(this->gives_the_same([&] { TypeParam::evaluate(plain_q.transpose().transpose(), -(-rates)); }));
  Eigen::Matrix<double, Q::RowsAtCompileTime + 2, 2, Eigen::RowMajor> wider;  // its columns' numbers stand apart
  wider.template block<Q::RowsAtCompileTime, 1>(1, 1) = positions;
  EXPECT_TRUE(
      this->gives_the_same([&] { TypeParam::evaluate(wider.col(1).template segment<Q::RowsAtCompileTime>(1), rates); }));
}

TYPED_TEST(Arguments, OfRunTimeSizeSayWhetherTheyFit) {
  const Eigen::VectorXd q = this->q, v = this->v;
  EXPECT_TRUE(this->gives_the_same([&] { EXPECT_TRUE(TypeParam::evaluate(q, v)); }));
  EXPECT_TRUE(this->gives_the_same([&] { EXPECT_TRUE(TypeParam::evaluate(this->q, v)); }));
  EXPECT_TRUE(this->gives_the_same([&] { EXPECT_TRUE(TypeParam::evaluate(q + 0 * q, Eigen::Ref<const Eigen::VectorXd>(v))); }));
  Eigen::MatrixXd log = Eigen::MatrixXd::Zero(q.size(), 3);
  log.col(2) = q;
  EXPECT_TRUE(this->gives_the_same([&] { EXPECT_TRUE(TypeParam::evaluate(log.col(2), v)); }));
  const Eigen::MatrixXd rows = log.transpose();
  EXPECT_TRUE(this->gives_the_same([&] { EXPECT_TRUE(TypeParam::evaluate(rows.row(2).transpose(), v)); }));
}

TYPED_TEST(Arguments, OfTheWrongLengthAreNotRead) {
  const Eigen::VectorXd q = this->q, v = this->v;
  typename TypeParam::TaskGraph graph(*TypeParam::workspace);
  const auto refused = [&](const auto& positions, const auto& rates) {
    const std::vector<std::byte> before = this->copy();
    const bool is_refused = !TypeParam::evaluate(positions, rates) && !graph.evaluate(positions, rates);
    return is_refused && this->copy() == before;
  };
  for (const int length : {0, 1, TestFixture::nq - 1, TestFixture::nq + 1}) {
    const Eigen::VectorXd wrong = Eigen::VectorXd::Ones(length);  // on the heap, where sanitizers see its end
    EXPECT_TRUE(refused(wrong, v)) << length;
    EXPECT_TRUE(refused(wrong, this->v)) << length;
    EXPECT_TRUE(refused(Eigen::Map<const Eigen::VectorXd>(wrong.data(), length), v)) << length;
    EXPECT_TRUE(refused(wrong + wrong, v)) << length;
  }
  EXPECT_TRUE(refused(q, Eigen::VectorXd::Ones(TestFixture::nv - 1)));
  EXPECT_TRUE(refused(this->q, v.head(TestFixture::nv - 2)));
  EXPECT_TRUE(TypeParam::evaluate(q, v));
}

TYPED_TEST(Arguments, OfATaskGraphAreAsOfTheFunction) {
  typename TypeParam::TaskGraph graph(*TypeParam::workspace);
  const Eigen::VectorXd q = this->q, v = this->v;
  EXPECT_TRUE(this->gives_the_same([&] { graph.evaluate(this->q, this->v); }));
  EXPECT_TRUE(this->gives_the_same([&] { graph.evaluate(this->q + 0 * this->q, this->v); }));
  EXPECT_TRUE(this->gives_the_same([&] { EXPECT_TRUE(graph.evaluate(q, v)); }));
}

TYPED_TEST(Arguments, DoNotAllocate) {
  const Eigen::VectorXd q = this->q, v = this->v;
  const std::uint64_t before = heap_allocations();
  TypeParam::evaluate(this->q, this->v);
  TypeParam::evaluate(this->q + 0.1 * this->q, -this->v);
  bool fits = TypeParam::evaluate(q, v);
  fits &= TypeParam::evaluate(q + 0.1 * q, Eigen::Map<const Eigen::VectorXd>(v.data(), v.size()));
  fits &= !TypeParam::evaluate(q.head(2), v);
  EXPECT_EQ(heap_allocations() - before, 0u);
  EXPECT_TRUE(fits);
}

TYPED_TEST(Arguments, AreVectorsOfEigen) {
  using Q = typename TestFixture::VectorQ;
  using V = typename TestFixture::VectorV;
  using Plain = Eigen::Matrix<double, Q::RowsAtCompileTime, 1>;
  static_assert(sizeof(Q) == sizeof(Plain) && alignof(Q) == alignof(Plain) && std::is_base_of_v<Plain, Q>);
  static_assert(!std::is_same_v<Q, V> &&
                std::is_nothrow_move_constructible_v<Q> == std::is_nothrow_move_constructible_v<Plain>);
  std::vector<Q> list(3, this->q);
  list.push_back(2 * list.front() - Q::Ones());
  std::swap(list.front(), list.back());
  list.back() += Eigen::VectorXd::Ones(Q::RowsAtCompileTime);
  EXPECT_EQ(list.front(), Plain(2 * this->q - Q::Ones()));
  EXPECT_EQ(list.back(), Plain(this->q + Q::Ones()));
  const Q some = (Q() << Eigen::Vector3d(1, 2, 3), Q::Zero().template tail<Q::RowsAtCompileTime - 3>()).finished();
  EXPECT_EQ(some.sum(), 6);
  Q numbers;
  numbers.setLinSpaced(1, Q::RowsAtCompileTime);
  EXPECT_EQ(numbers[2], 3);
  EXPECT_EQ(V(this->v.data()), this->v);
}

// Where a vector takes over one of run-time size, no status can be given: what does not fit shows.
TYPED_TEST(Arguments, ThatDoNotFitShowInAVector) {
  using Q = typename TestFixture::VectorQ;
  const Eigen::VectorXd right = this->q, wrong = Eigen::VectorXd::Ones(TestFixture::nq - 1);
  Q taken = right;
  EXPECT_EQ(taken, this->q);
  const Q made = wrong;
  EXPECT_TRUE(made.array().isNaN().all());
  taken = Eigen::VectorXd::Ones(TestFixture::nq + 1);
  EXPECT_TRUE(taken.array().isNaN().all());
  taken = right.array() + 0;
  EXPECT_EQ(taken, this->q);
}

template <class Code, class Workspace, class = void>
struct HasResult : std::false_type {};
template <class Code, class Workspace>
struct HasResult<Code, Workspace, std::void_t<decltype(Code::result(std::declval<Workspace>()))>> : std::true_type {};

TYPED_TEST(Arguments, OfResultsMustOutliveThem) {
  using Workspace = typename TypeParam::Workspace;
  static_assert(HasResult<TypeParam, Workspace&>() && HasResult<TypeParam, const Workspace&>());
  static_assert(!HasResult<TypeParam, Workspace>() && !HasResult<TypeParam, const Workspace>());
}

TEST(ArgumentsOfMore, AreCheckedToo) {
  const auto workspace = std::make_unique<functions::Workspace>();
  functions::InverseDynamicsTaskGraph graph(*workspace);
  const functions::VectorQ q = functions::VectorQ::Constant(0.1);
  const functions::VectorV v = functions::VectorV::Constant(0.2), a = functions::VectorV::Constant(0.3);
  functions::inverse_dynamics(q, v, a, *workspace);
  const functions::VectorV tau = functions::inverse_dynamics(*workspace);
  const Eigen::VectorXd shorter = a.head(3), right = a;
  workspace->inverse_dynamics[0] = 7;
  EXPECT_FALSE(functions::inverse_dynamics(q, v, shorter, *workspace) || graph.inverse_dynamics(q, v, shorter) ||
               functions::plan(q, v, shorter, *workspace) || functions::track(shorter, v, a, *workspace));
  EXPECT_EQ(workspace->inverse_dynamics[0], 7);
  EXPECT_TRUE(functions::inverse_dynamics(q, v, right, *workspace));
  EXPECT_EQ(functions::inverse_dynamics(*workspace), tau);
}

// A result, which the function that it is given to writes over.
TEST(ArgumentsOfMore, MayBeViewsOfTheWorkspace) {
  const auto workspace = std::make_unique<functions::Workspace>(), other = std::make_unique<functions::Workspace>();
  const functions::VectorQ q = functions::VectorQ::Constant(0.1);
  const functions::VectorV v = functions::VectorV::Constant(0.2);
  functions::inverse_dynamics(q, v, functions::VectorV::Ones(), *workspace);
  const functions::VectorV first = functions::inverse_dynamics(*workspace);
  functions::inverse_dynamics(q, v, functions::inverse_dynamics(*workspace), *workspace);
  functions::inverse_dynamics(q, v, first, *other);
  EXPECT_EQ(functions::inverse_dynamics(*workspace), functions::inverse_dynamics(*other));
}

TEST(IndicesOfJoints, StandBehindTheBase) {
  using functions::Joint, functions::q_index, functions::v_index;
  static_assert(q_index(Joint{0}) == 7 && v_index(Joint{0}) == 6 && noexcept(q_index(Joint{0})));
  static_assert(q_index(Joint::c_01_joint) == 7 + static_cast<int>(Joint::c_01_joint));
  static_assert(v_index(Joint::c_01_joint) == 6 + static_cast<int>(Joint::c_01_joint));
  EXPECT_STREQ(functions::joint_names[v_index(Joint::c_01_joint) - 6], "c_01_joint");
}

TEST(IndicesOfJoints, AreTheirNumbersOnAFixedBase) {
  using chain_7_fixed::Joint, chain_7_fixed::q_index, chain_7_fixed::v_index;
  static_assert(q_index(Joint::link_03_joint) == 2 && v_index(Joint::link_03_joint) == 2);
  const chain_7_fixed::VectorQ q(0, 0, 0.7, 0, 0, 0, 0);
  EXPECT_EQ(q[q_index(Joint::link_03_joint)], 0.7);
}

}  // namespace
}  // namespace dalembert::testing
