#include "commands/input_setters.hpp"

#include <Eigen/Core>

#include "ir/identifier.hpp"

namespace dalembert {

InputSetters::InputSetters(const Model& model, const LoadedCode& code) {
  const auto function = [&](const std::string& name) { return reinterpret_cast<void*>(code.function<void()>(name)); };
  for (const ir::Constraint& c : model.scene.constraints())
    constraints_.push_back(
        {function(model.name + "_set_" + c.member), function(model.name + "_weigh_" + c.member), c.loop, c.rows});
  for (const std::string& link : model.scene.payloads)
    payloads_.push_back(function(model.name + "_set_payload_" + ir::identifier(link)));
  if (model.scene.gravity_kind == ir::GravityKind::run_time) gravity_ = function(model.name + "_set_gravity");
  own_gravity_ = model.scene.gravity;
}

template <class Scalar>
void InputSetters::set(const ir::Acting& acting, const ir::Loading& loading, void* workspace) const {
  set<Scalar>(acting, workspace);
  set<Scalar>(loading, workspace);
}

template <class Scalar>
void InputSetters::set(const ir::Loading& loading, void* workspace) const {
  using Vector = Eigen::Vector3<Scalar>;
  for (std::size_t i = 0; i < payloads_.size(); ++i) {
    const ir::Inertia payload =
        loading.payloads.empty() ? ir::Inertia{0, Eigen::Vector3d::Zero(), Eigen::Matrix3d::Zero()} : loading.payloads[i];
    const Vector com = payload.com.cast<Scalar>();
    const Eigen::Matrix3<Scalar> I = payload.inertia.cast<Scalar>();
    const Scalar inertia[] = {I(0, 0), I(0, 1), I(0, 2), I(1, 1), I(1, 2), I(2, 2)};
    reinterpret_cast<void (*)(Scalar, const Scalar*, const Scalar*, void*)>(payloads_[i])(static_cast<Scalar>(payload.mass),
                                                                                          com.data(), inertia, workspace);
  }
  if (!gravity_) return;
  const Vector gravity = loading.gravity.value_or(own_gravity_).cast<Scalar>();
  reinterpret_cast<void (*)(const Scalar*, void*)>(gravity_)(gravity.data(), workspace);
}

template <class Scalar>
void InputSetters::set(const ir::Acting& acting, void* workspace) const {
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

template void InputSetters::set<float>(const ir::Acting&, const ir::Loading&, void*) const;
template void InputSetters::set<double>(const ir::Acting&, const ir::Loading&, void*) const;

}  // namespace dalembert
