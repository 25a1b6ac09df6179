// SPDX-License-Identifier: MIT
// The exact solve of a problem given by its matrix (friction_problem.hpp), by a factor H of W.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/Dense>

#include "static_contact/friction_problem.hpp"
#include "static_contact/interior_point.hpp"

namespace flotilla {

/// H of the symmetric part of W, by Cholesky with the largest pivot first.
inline ConeProgram factor_matrix(const FrictionProblem& f) {
    const auto n = static_cast<Eigen::Index>(3 * f.contacts.size());
    Eigen::MatrixXd w = Eigen::MatrixXd::Zero(n, n), h = Eigen::MatrixXd::Zero(n, n);
    for (std::size_t i = 0; i < f.contacts.size(); ++i)
        for (const FrictionProblem::Block& b : f.row[i])
            for (int k = 0; k < 9; ++k) {
                const auto at = static_cast<Eigen::Index>(3 * i) + k / 3;
                const auto to = static_cast<Eigen::Index>(3 * b.column) + k % 3;
                w(at, to) += b.w.m[static_cast<std::size_t>(k)] / 2;
                w(to, at) += b.w.m[static_cast<std::size_t>(k)] / 2;
            }
    Eigen::VectorXd rest = w.diagonal();
    const double rounding = 1e-14 * rest.maxCoeff();
    Eigen::Index rank = 0;
    for (Eigen::Index pivot = 0; rank < n && rest.maxCoeff(&pivot) > rounding; ++rank) {
        h.col(rank) = (w.col(pivot) - h.leftCols(rank) * h.row(pivot).head(rank).transpose()) / std::sqrt(rest(pivot));
        for (Eigen::Index i = 0; i < n; ++i) {
            if (std::isinf(rest(i))) h(i, rank) = 0; // was a pivot
            rest(i) -= h(i, rank) * h(i, rank);
        }
        rest(pivot) = -std::numeric_limits<double>::infinity();
    }
    ConeProgram p;
    p.num_columns = static_cast<std::int32_t>(rank);
    for (std::size_t i = 0; i < f.contacts.size(); ++i) {
        const auto at = static_cast<Eigen::Index>(3 * i);
        p.contacts.push_back({f.q[i], f.contacts[i].friction});
        for (Eigen::Index k = 0; k < rank; ++k)
            if (!h.col(k).segment(at, 3).isZero(0))
                p.entries.push_back({static_cast<std::int32_t>(k), {h(at, k), h(at + 1, k), h(at + 2, k)}});
        p.first_entry.push_back(static_cast<std::int32_t>(p.entries.size()));
    }
    return p;
}

/// What W r has beyond H H^T r goes into q.
inline void move_rest_to_q(const FrictionProblem& f, ConeProgram& p) {
    std::vector<double> v(static_cast<std::size_t>(p.num_columns));
    const auto for_entries = [&](std::size_t i, const auto& body) {
        for (auto k = p.first_entry[i]; k < p.first_entry[i + 1]; ++k) {
            const ConeProgram::Entry& e = p.entries[static_cast<std::size_t>(k)];
            body(v[static_cast<std::size_t>(e.column)], e.h);
        }
    };
    for (std::size_t i = 0; i < f.contacts.size(); ++i)
        for_entries(i, [&](double& x, const Vec3& h) { x += dot(h, f.contacts[i].impulse); });
    for (std::size_t i = 0; i < f.contacts.size(); ++i) {
        p.contacts[i].q = f.velocity(i);
        for_entries(i, [&](double& x, const Vec3& h) { p.contacts[i].q -= x * h; });
    }
}

struct MatrixSolve {
    int factorisations = 0;
    bool solved = true; ///< every pass, to its tolerance
};

/// Solves until the natural map is at most `goal`, from the problem's impulses on; `p` is its factor. Some of the
/// matrices are not quite symmetric: a pass takes what H H^T leaves of W r as part of q, which converges as the share
/// is small. A pass is solved to a tenth of the goal, relative to the largest |q|.
inline MatrixSolve solve_by_factor(FrictionProblem& f, ConeProgram p, double goal, ConeScratch& scratch) {
    double speed = 0;
    for (const Vec3& q : f.q) speed = std::max(speed, length(q));
    MatrixSolve solve;
    std::vector<Vec3> r;
    for (const LocalContact& c : f.contacts) r.push_back(c.impulse);
    for (int pass = 0; pass < 8 && f.natural_map() > goal; ++pass) {
        move_rest_to_q(f, p);
        const ConeSolveStats stats = solve_cone_program(p, {0.1 * goal * speed, 100}, r, scratch);
        solve.factorisations += stats.iterations;
        solve.solved = solve.solved && stats.solved;
        for (std::size_t i = 0; i < r.size(); ++i) f.contacts[i].impulse = r[i];
    }
    return solve;
}

} // namespace flotilla
