// Driven joints (URDF <mimic>): several joints share one independent coordinate.
//
// The full model has a coordinate per joint; q_full = G_q q + offset and v_full = G v with G constant, so
// M_r = Gᵀ M G, C_r = Gᵀ C G, g_r = Gᵀ g, W_r = Gᵀ W. The base's coordinates pass unchanged.
#pragma once

#include <dalembert/generic/model.hpp>

namespace dalembert::generic {

template <class S>
class Reduction {
 public:
  // Refuses a malformed model (check_model). Keeps a reference to it.
  explicit Reduction(const Model<S>& model)
      : model_(model), driven_(!model.coordinates.empty()), base_rows_(model.base_rows()) {
    check_model(model);
    if (!driven_) return;
    G_ = MatrixX<S>::Zero(base_rows_ + model.joints(), model.nv());
    G_.topLeftCorner(base_rows_, base_rows_).setIdentity();
    for (int k = 0; k < model.joints(); ++k) {
      const Coordinate<S>& coordinate = model.coordinates[static_cast<size_t>(k)];
      G_(base_rows_ + k, base_rows_ + coordinate.index) = coordinate.multiplier;
    }
  }

  // Position of every joint, behind the base's pose; then the w of every quaternion.
  VectorX<S> expand_position(const VectorX<S>& q) const {
    const int quaternions = model_.quaternions();
    if (!driven_ && quaternions == 0) return q;
    const Eigen::Index base = model_.floating_base ? 7 : 0;
    const auto coordinate = [&](int k) {
      return driven_ ? model_.coordinates[static_cast<size_t>(k)] : Coordinate<S>{k, S(1), S(0)};
    };
    VectorX<S> full(base + model_.joints() + quaternions);
    full.head(base) = q.head(base);
    int found = 0;
    for (int k = 0; k < model_.joints(); ++k) {
      const Coordinate<S> of = coordinate(k);
      Eigen::Index at = base + of.index;  // q has a number more for each quaternion before
      for (int i = 0; i < model_.joints(); ++i) {
        const Body<S>& body = model_.bodies[static_cast<size_t>(i)];
        if (body.part == 0 && coordinate(i).index + body.parts <= of.index) ++at;
      }
      full[base + k] = of.multiplier * q[at] + of.offset;
      const Body<S>& body = model_.bodies[static_cast<size_t>(k)];
      if (body.part == 0) full[base + model_.joints() + found++] = q[at + body.parts];
    }
    return full;
  }
  // Velocity or acceleration of every joint, behind the base's.
  VectorX<S> expand_velocity(const VectorX<S>& v) const { return driven_ ? VectorX<S>(G_ * v) : v; }

  // M or C: Gᵀ X G.
  MatrixX<S> reduce_matrix(MatrixX<S> full) const { return driven_ ? MatrixX<S>(G_.transpose() * full * G_) : full; }
  // g, bias or W: Gᵀ X.
  template <class X>
  X reduce_rows(X full) const {
    return driven_ ? X(G_.transpose() * full) : full;
  }
  // A Jacobian: J G.
  MatrixX<S> reduce_columns(MatrixX<S> full) const { return driven_ ? MatrixX<S>(full * G_) : full; }

 private:
  const Model<S>& model_;
  bool driven_;
  int base_rows_;
  MatrixX<S> G_;
};

}  // namespace dalembert::generic
