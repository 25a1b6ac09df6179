// SPDX-License-Identifier: MIT
// The linear system of a Newton step on a contact problem, in the space of the bodies. A step changes the impulses by
// dr_i = c_i - B_i du_i with a 3x3 matrix B_i per contact, and the velocities by du = H dv, dv = H^T dr, so that
//     (I + H^T B H) dv = H^T c.
// It is as large as the bodies have degrees of freedom, however many contacts hold them, and regular for redundant
// contacts. B is not symmetric where contacts slide, hence LU.
#pragma once

#include <span>
#include <vector>

#include <Eigen/Dense>
#include <Eigen/Sparse>

#include "static_contact/cone_program.hpp"

namespace flotilla {

class BodySystem {
  public:
    /// Sets the pattern. The program must outlive the calls below.
    void analyse(const ConeProgram& program);

    /// Factorises I + H^T B H; false where that broke down.
    [[nodiscard]] bool factorise(std::span<const Mat3> b);

    /// du of the step with the given c; false where it is not finite.
    [[nodiscard]] bool solve(std::span<const Vec3> c, std::span<Vec3> du);

    /// Of the matrix factorised last, 1 or -1.
    [[nodiscard]] int determinant_sign();

    /// v = H^T r.
    void gather(std::span<const Vec3> r);
    /// v += H_i^T r.
    void add(std::size_t contact, const Vec3& r);
    /// H_i H_i^T: the contact's own block of W.
    Mat3 own_block(std::size_t contact) const;
    /// H_i v.
    Vec3 spread(std::size_t contact) const;

  private:
    std::span<const ConeProgram::Entry> entries(std::size_t contact) const;
    void build_pattern();
    std::int32_t find(std::int32_t row, std::int32_t column) const;
    void fill_dense(std::span<const Mat3> b);
    void fill_sparse(std::span<const Mat3> b);

    const ConeProgram* program_ = nullptr;
    bool dense_ = true;
    Eigen::VectorXd v_, solution_;
    Eigen::MatrixXd full_;
    Eigen::PartialPivLU<Eigen::MatrixXd> full_lu_;
    Eigen::SparseMatrix<double> sparse_;
    Eigen::SparseLU<Eigen::SparseMatrix<double>> sparse_lu_;
    std::vector<Eigen::Triplet<double>> pattern_;
    std::vector<std::int32_t> diagonal_;  ///< where the values of the diagonal are
    std::vector<std::int32_t> positions_; ///< where each contact's products go, column by column
};

} // namespace flotilla
