#include "paper_parallel.hpp"

#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/task_group.h>

namespace dalembert::benchmarks {

using generic::Composite;
using generic::Composites;
using generic::Kinematics;
using generic::Model;

// One evaluation: what the phases share, and what each does to one body.
struct PaperParallel::Evaluation {
  const PaperParallel& paper;
  const Model<double>& model;
  const Eigen::VectorXd &q, &v;
  Kinematics<double> kinematics;
  Composites<double> composites;
  Matrices result;

  Evaluation(const PaperParallel& from, const Eigen::VectorXd& at_q, const Eigen::VectorXd& at_v)
      : paper(from), model(from.model_), q(at_q), v(at_v), kinematics(generic::kinematics_of_base<double>(model, v)) {
    composites.base = generic::base_composite(model, kinematics);
    composites.bodies.resize(model.bodies.size());
    const int nv = model.nv();
    if (paper.with_M_) result.M = Eigen::MatrixXd::Zero(nv, nv);
    if (paper.with_C_) result.C = Eigen::MatrixXd::Zero(nv, nv);
  }

  void move(int k) {
    const auto at = static_cast<size_t>(k);
    generic::update_kinematics<double>(model, q, v, k, kinematics);
    composites.bodies[at] = generic::own_composite<double>(model, model.bodies[at].inertia, kinematics.bodies[at].V);
  }

  void accumulate_children(int k) {
    Composite<double>& own = k < 0 ? composites.base : composites.bodies[static_cast<size_t>(k)];
    for (const int j : paper.children_[static_cast<size_t>(k + 1)])
      generic::accumulate(kinematics.bodies[static_cast<size_t>(j)], composites.bodies[static_cast<size_t>(j)], own);
  }

  void elements(int k) {
    if (paper.with_M_) generic::mass_elements<double>(model, kinematics, composites, k, result.M);
    if (paper.with_C_) generic::coriolis_elements<double>(model, kinematics, composites, k, result.C);
  }

  void base_elements() {
    if (!model.floating_base) return;
    if (paper.with_M_) result.M.topLeftCorner<6, 6>() = composites.base.A;
    if (paper.with_C_) result.C.topLeftCorner<6, 6>() = composites.base.B;
  }

  // Algorithm 2's Task 1; `others` runs Task 2.
  void task(int k, tbb::task_group& others) {
    if (k >= 0) move(k);
    const std::vector<int>& children = paper.children_[static_cast<size_t>(k + 1)];
    tbb::task_group below;
    for (size_t i = 1; i < children.size(); ++i) below.run([this, j = children[i], &others] { task(j, others); });
    if (!children.empty()) task(children.front(), others);  // itself, rather than to wait
    below.wait();
    accumulate_children(k);
    if (k >= 0) others.run([this, k] { elements(k); });
    else base_elements();
  }
};

PaperParallel::PaperParallel(const Model<double>& model, bool with_M, bool with_C)
    : model_(model), with_M_(with_M), with_C_(with_C), children_(model.bodies.size() + 1) {
  std::vector<size_t> level(model.bodies.size());
  for (int k = 0; k < model.joints(); ++k) {
    const int parent = model.bodies[static_cast<size_t>(k)].parent;
    level[static_cast<size_t>(k)] = parent < 0 ? 0 : level[static_cast<size_t>(parent)] + 1;
    levels_.resize(std::max(levels_.size(), level[static_cast<size_t>(k)] + 1));
    levels_[level[static_cast<size_t>(k)]].push_back(k);
  }
  for (int k = model.joints(); k-- > 0;)
    children_[static_cast<size_t>(model.bodies[static_cast<size_t>(k)].parent + 1)].push_back(k);
}

Matrices PaperParallel::loops(const Eigen::VectorXd& q, const Eigen::VectorXd& v) const {
  Evaluation at(*this, q, v);
  const auto each = [](const std::vector<int>& bodies, const auto& work) {
    tbb::parallel_for(size_t{0}, bodies.size(), [&](size_t i) { work(bodies[i]); });
  };
  for (const std::vector<int>& bodies : levels_) each(bodies, [&](int k) { at.move(k); });
  for (size_t level = levels_.size(); level-- > 0;) each(levels_[level], [&](int k) { at.accumulate_children(k); });
  at.accumulate_children(-1);
  tbb::parallel_for(0, model_.joints(), [&](int k) { at.elements(k); });
  at.base_elements();
  return std::move(at.result);
}

Matrices PaperParallel::tasks(const Eigen::VectorXd& q, const Eigen::VectorXd& v) const {
  Evaluation at(*this, q, v);
  tbb::task_group others;
  at.task(-1, others);
  others.wait();
  return std::move(at.result);
}

Matrices PaperParallel::serial(const Eigen::VectorXd& q, const Eigen::VectorXd& v) const {
  Evaluation at(*this, q, v);
  for (int k = 0; k < model_.joints(); ++k) at.move(k);
  for (int k = model_.joints(); k-- > -1;) at.accumulate_children(k);
  for (int k = 0; k < model_.joints(); ++k) at.elements(k);
  at.base_elements();
  return std::move(at.result);
}

}  // namespace dalembert::benchmarks
