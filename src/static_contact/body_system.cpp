// SPDX-License-Identifier: MIT
#include "static_contact/body_system.hpp"

#include <algorithm>

#include "base/index.hpp"
#include "static_contact/lorentz_cone.hpp"

namespace flotilla {
namespace {

// Up to ten free bodies the dense factorisation is the faster one (a chain of bodies, measured).
constexpr std::int32_t kLargestDense = 60;

// A contact that touches more than half of the columns makes the matrix full, and its positions as many as the matrix
// has elements.
bool is_dense(const ConeProgram& p) {
    std::int32_t most = 0;
    for (std::size_t i = 0; i < p.contacts.size(); ++i) most = std::max(most, p.first_entry[i + 1] - p.first_entry[i]);
    return p.num_columns <= kLargestDense || 2 * most > p.num_columns;
}

} // namespace

std::span<const ConeProgram::Entry> BodySystem::entries(std::size_t contact) const {
    const std::size_t first = at(program_->first_entry[contact]);
    return {program_->entries.data() + first, at(program_->first_entry[contact + 1]) - first};
}

void BodySystem::analyse(const ConeProgram& program) {
    program_ = &program;
    dense_ = is_dense(program);
    if (!dense_) build_pattern();
}

void BodySystem::build_pattern() {
    const std::int32_t n = program_->num_columns;
    const std::size_t num_contacts = program_->contacts.size();
    pattern_.clear();
    for (std::int32_t k = 0; k < n; ++k) pattern_.emplace_back(k, k, 1.0);
    for (std::size_t i = 0; i < num_contacts; ++i)
        for (const ConeProgram::Entry& column : entries(i))
            for (const ConeProgram::Entry& row : entries(i)) pattern_.emplace_back(row.column, column.column, 1.0);
    sparse_.resize(n, n);
    sparse_.setFromTriplets(pattern_.begin(), pattern_.end());
    sparse_.makeCompressed();
    diagonal_.clear();
    positions_.clear();
    for (std::int32_t k = 0; k < n; ++k) diagonal_.push_back(find(k, k));
    for (std::size_t i = 0; i < num_contacts; ++i)
        for (const ConeProgram::Entry& column : entries(i))
            for (const ConeProgram::Entry& row : entries(i)) positions_.push_back(find(row.column, column.column));
    sparse_lu_.analyzePattern(sparse_);
}

std::int32_t BodySystem::find(std::int32_t row, std::int32_t column) const {
    const std::int32_t* const rows = sparse_.innerIndexPtr();
    const std::int32_t* const first = rows + sparse_.outerIndexPtr()[column];
    const std::int32_t* const last = rows + sparse_.outerIndexPtr()[column + 1];
    return static_cast<std::int32_t>(std::lower_bound(first, last, row) - rows);
}

void BodySystem::fill_dense(std::span<const Mat3> b) {
    const Eigen::Index n = program_->num_columns;
    full_.setIdentity(n, n);
    for (std::size_t i = 0; i < b.size(); ++i)
        for (const ConeProgram::Entry& column : entries(i)) {
            const Vec3 bh = b[i] * column.h;
            double* const values = full_.data() + column.column * n;
            for (const ConeProgram::Entry& row : entries(i)) values[row.column] += dot(row.h, bh);
        }
}

void BodySystem::fill_sparse(std::span<const Mat3> b) {
    double* const values = sparse_.valuePtr();
    std::fill(values, values + sparse_.nonZeros(), 0.0);
    for (const std::int32_t k : diagonal_) values[k] = 1;
    auto position = positions_.begin();
    for (std::size_t i = 0; i < b.size(); ++i)
        for (const ConeProgram::Entry& column : entries(i)) {
            const Vec3 bh = b[i] * column.h;
            for (const ConeProgram::Entry& row : entries(i)) values[*position++] += dot(row.h, bh);
        }
}

bool BodySystem::factorise(std::span<const Mat3> b) {
    if (dense_) {
        fill_dense(b);
        full_lu_.compute(full_);
        return true; // a singular matrix shows in solve()
    }
    fill_sparse(b);
    sparse_lu_.factorize(sparse_);
    return sparse_lu_.info() == Eigen::Success;
}

bool BodySystem::solve(std::span<const Vec3> c, std::span<Vec3> du) {
    gather(c);
    if (dense_)
        solution_ = full_lu_.solve(v_);
    else
        solution_ = sparse_lu_.solve(v_);
    v_.swap(solution_);
    for (std::size_t i = 0; i < du.size(); ++i) du[i] = spread(i);
    return v_.allFinite();
}

int BodySystem::determinant_sign() {
    if (!dense_) return sparse_lu_.signDeterminant() < 0 ? -1 : 1;
    const auto diagonal = full_lu_.matrixLU().diagonal();
    const auto negative = (diagonal.array() < 0).count() + (full_lu_.permutationP().determinant() < 0 ? 1 : 0);
    return negative % 2 == 0 ? 1 : -1;
}

void BodySystem::gather(std::span<const Vec3> r) {
    v_.setZero(program_->num_columns);
    for (std::size_t i = 0; i < r.size(); ++i) add(i, r[i]);
}

void BodySystem::add(std::size_t contact, const Vec3& r) {
    for (const ConeProgram::Entry& e : entries(contact)) v_[e.column] += dot(e.h, r);
}

Mat3 BodySystem::own_block(std::size_t contact) const {
    Mat3 w;
    for (const ConeProgram::Entry& e : entries(contact)) w = w + outer(e.h, e.h);
    return w;
}

Vec3 BodySystem::spread(std::size_t contact) const {
    Vec3 sum;
    for (const ConeProgram::Entry& e : entries(contact)) sum += v_[e.column] * e.h;
    return sum;
}

} // namespace flotilla
