// The generated code of one robot as a GeneratedRobot: works with whatever outputs were asked for.
#pragma once

#include <Eigen/Core>
#include <cstring>

#include "generated_robot.hpp"

namespace dalembert::testing {

// What the generated namespace offers, gathered by adapter.cpp.in.
template <class Scalar>
struct Layout {
  int nq, nv;
  std::vector<std::string> joint_names, body_names;
  bool (*self_test)(SelfTestReport*) noexcept;
};

// Stands in where no task graph was generated.
struct NoTaskGraph {};

// Outside the class, whose own evaluate() would hide the generated one.
template <class Scalar, class Workspace>
void evaluate_serial(const Scalar* q, const Scalar* v, Workspace& workspace) {
  evaluate(q, v, workspace);
}

template <class Scalar, class Workspace, class TaskGraph>
class Adapter final : public GeneratedRobot {
 public:
  explicit Adapter(Layout<Scalar> layout) : layout_(std::move(layout)) { renew_workspaces(); }

  int nq() const override { return layout_.nq; }
  int nv() const override { return layout_.nv; }
  bool single_precision() const override { return std::is_same_v<Scalar, float>; }
  std::vector<std::string> joint_names() const override { return layout_.joint_names; }
  std::vector<std::string> body_names() const override { return layout_.body_names; }

  void set_state(const Eigen::VectorXd& q, const Eigen::VectorXd& v) override {
    q_ = q.cast<Scalar>();
    v_ = v.cast<Scalar>();
  }
  bool has_tasks() const override { return !std::is_same_v<TaskGraph, NoTaskGraph>; }
  void evaluate(Variant variant) override {
    if (variant == Variant::serial) {
      evaluate_serial(q_.data(), v_.data(), *serial_);
    } else if constexpr (!std::is_same_v<TaskGraph, NoTaskGraph>) {
      graph_->evaluate(q_.data(), v_.data());
    }
  }
  void renew_workspaces() override {
    graph_.reset();
    serial_ = std::make_unique<Workspace>();
    parallel_ = std::make_unique<Workspace>();
    if constexpr (!std::is_same_v<TaskGraph, NoTaskGraph>) graph_ = std::make_unique<TaskGraph>(*parallel_);
  }

  bool self_test(SelfTestReport& report) const override { return layout_.self_test(&report); }

  Results results(Variant variant) const override {
    Results all;
    visit(variant, [&](const char* name, const auto& view) { all[name] = view.template cast<double>(); });
    return all;
  }
  std::vector<std::byte> bits(Variant variant) const override {
    std::vector<std::byte> all;
    visit(variant, [&](const char*, const auto& view) {
      const size_t size = static_cast<size_t>(view.size()) * sizeof(Scalar), end = all.size();
      all.resize(end + size);
      if (size > 0) std::memcpy(all.data() + end, view.data(), size);
    });
    return all;
  }

 private:
  template <class Action>
  void visit(Variant variant, const Action& action) const {
    const auto each = [&](const auto& ws) {
#define DALEMBERT_QUANTITY(name, ...) \
  if constexpr (requires { name(ws); }) action(#name, name(ws));
#include "ir/quantities.def"
#undef DALEMBERT_QUANTITY
    };
    each(variant == Variant::serial ? *serial_ : *parallel_);
  }

  Layout<Scalar> layout_;
  Eigen::VectorX<Scalar> q_, v_;
  std::unique_ptr<Workspace> serial_, parallel_;
  std::unique_ptr<TaskGraph> graph_;
};

}  // namespace dalembert::testing
