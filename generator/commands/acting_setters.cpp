#include "commands/acting_setters.hpp"

#include <Eigen/Core>

namespace dalembert {

ActingSetters::ActingSetters(const Model& model, const LoadedCode& code) {
  const auto function = [&](const std::string& name) { return reinterpret_cast<void*>(code.function<void()>(name)); };
  for (const ir::Constraint& c : model.scene.constraints())
    constraints_.push_back(
        {function(model.name + "_set_" + c.member), function(model.name + "_weigh_" + c.member), c.loop, c.rows});
}

template <class Scalar>
void ActingSetters::set(const ir::Acting& acting, void* workspace) const {
  Eigen::Index row = 0;
  for (std::size_t c = 0; c < constraints_.size(); row += constraints_[c++].rows) {
    const Constraint& constraint = constraints_[c];
    const int active = acting.active.empty() || acting.active[c] ? 1 : 0;
    const Scalar restitution = acting.restitution.empty() ? Scalar(0) : static_cast<Scalar>(acting.restitution[c]);
    using Numbers = Eigen::VectorX<Scalar>;
    const auto own = [&](const Eigen::VectorXd& all, Scalar otherwise) {
      return all.size() == 0 ? Numbers(Numbers::Constant(constraint.rows, otherwise))
                             : Numbers(all.segment(row, constraint.rows).template cast<Scalar>());
    };
    const Numbers regularization = own(acting.regularization, 0), weights = own(acting.weights, 1);
    using S = Scalar;
    if (constraint.loop)
      reinterpret_cast<void (*)(int, S, S, S, const S*, void*)>(constraint.set)(active, 0, 0, restitution,
                                                                                regularization.data(), workspace);
    else
      reinterpret_cast<void (*)(int, S, S, S, const S*, const S*, void*)>(constraint.set)(active, 0, 0, restitution, nullptr,
                                                                                          regularization.data(), workspace);
    reinterpret_cast<void (*)(const S*, void*)>(constraint.weigh)(weights.data(), workspace);
  }
}

template void ActingSetters::set<float>(const ir::Acting&, void*) const;
template void ActingSetters::set<double>(const ir::Acting&, void*) const;

}  // namespace dalembert
