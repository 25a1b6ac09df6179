// SPDX-License-Identifier: MIT
// Frictional contact problems with a general matrix, u = W r + q (data/friction), solved by the projection code of the
// solver itself: only the relative velocity comes from W instead of bodies.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include <flotilla/error.hpp>

#include "geometry/pack_scalar.hpp"

#include "static_contact/local_contact.hpp"

namespace flotilla {

inline PackVec<ScalarPack> to_pack(const Vec3& v) { return {{v.x}, {v.y}, {v.z}}; }
inline LocalPack<ScalarPack> to_pack(const LocalContact& c) {
    return {to_pack(c.mass_diagonal), to_pack(c.inv_mass_diagonal),
            to_pack(c.coupling),      to_pack(c.impulse),
            to_pack(c.target),        {c.friction}};
}

struct FrictionProblem {
    struct Block {
        std::size_t column = 0;
        Mat3 w;
    };
    std::vector<LocalContact> contacts;
    std::vector<Vec3> q;
    std::vector<std::vector<Block>> row; ///< all blocks of a contact's row, its own among them

    void set_diagonal(std::size_t i, const Mat3& w) {
        const auto mean = [&](std::size_t k, std::size_t l) { return (w.m[k] + w.m[l]) / 2; };
        LocalContact& c = contacts[i];
        c.mass_diagonal = {w.m[0], w.m[4], w.m[8]};
        c.inv_mass_diagonal = {1 / w.m[0], 1 / w.m[4], 1 / w.m[8]};
        c.coupling = {mean(1, 3), mean(2, 6), mean(5, 7)};
    }

    /// Turns the tangents of all contacts to where Cone::disc needs them.
    void turn_tangents() {
        std::vector<Mat3> turn;
        for (std::size_t i = 0; i < contacts.size(); ++i) {
            const TangentTurn t = principal_turn(contacts[i]);
            turn.push_back({{1, 0, 0, 0, t.cosine, t.sine, 0, -t.sine, t.cosine}});
            contacts[i].impulse = turn[i] * contacts[i].impulse;
            q[i] = turn[i] * q[i];
        }
        for (std::size_t i = 0; i < contacts.size(); ++i)
            for (Block& b : row[i]) {
                b.w = turn[i] * b.w * transpose(turn[b.column]);
                if (b.column == i) set_diagonal(i, b.w);
            }
    }

    Vec3 velocity(std::size_t i) const {
        Vec3 u = q[i];
        for (const Block& b : row[i]) u += b.w * contacts[b.column].impulse;
        return u;
    }

    /// One sweep in index order; the largest violation met.
    template <Cone kCone>
    double sweep() {
        double worst = 0;
        for (std::size_t i = 0; i < contacts.size(); ++i) {
            const auto update = visit<kCone>(to_pack(contacts[i]), to_pack(velocity(i)));
            contacts[i].impulse += Vec3{update.change.x.v, update.change.y.v, update.change.z.v};
            worst = std::max(worst, update.violation.v);
        }
        return worst;
    }

    template <Cone kCone>
    double residual() const {
        double worst = 0;
        for (std::size_t i = 0; i < contacts.size(); ++i)
            worst = std::max(worst, violation<kCone>(to_pack(contacts[i]), to_pack(velocity(i))).v);
        return worst;
    }

    /// Sweeps until the violation is at most `tolerance`; their number, at most `limit`.
    template <Cone kCone>
    int solve(double tolerance, int limit) {
        int sweeps = 0;
        while (sweeps < limit) {
            ++sweeps;
            if (sweep<kCone>() <= tolerance && residual<kCone>() <= tolerance) break;
        }
        return sweeps;
    }

    /// |r - P_K(r - u - mu |u_T| e_N)| / max(|q|, |r|, |u|): the law itself, apart from how it was solved.
    double natural_map() const {
        double map_sq = 0, q_sq = 0, r_sq = 0, u_sq = 0;
        for (std::size_t i = 0; i < contacts.size(); ++i) {
            const Vec3 r = contacts[i].impulse, u = velocity(i);
            const double mu = contacts[i].friction;
            const double slip = std::sqrt(u.y * u.y + u.z * u.z);
            map_sq += length_sq(r - project_on_cone({r.x - u.x - mu * slip, r.y - u.y, r.z - u.z}, mu));
            q_sq += length_sq(q[i]);
            r_sq += length_sq(r);
            u_sq += length_sq(u);
        }
        return std::sqrt(map_sq / std::max(q_sq, std::max(r_sq, u_sq)));
    }

    static Vec3 project_on_cone(const Vec3& a, double mu) {
        const double t = std::sqrt(a.y * a.y + a.z * a.z);
        if (t <= mu * a.x) return a;
        if (mu * t <= -a.x) return {};
        const double n = (a.x + mu * t) / (1 + mu * mu);
        return {n, mu * n * a.y / t, mu * n * a.z / t};
    }
};

/// Numbers as they lie in a file.
class BinaryReader {
  public:
    explicit BinaryReader(const std::filesystem::path& path) : path_(path), file_(path, std::ios::binary) {}

    template <class T>
    T read() {
        T value{};
        if (!file_.read(reinterpret_cast<char*>(&value), sizeof value))
            throw InputError(path_.string() + " is missing or too short");
        return value;
    }
    std::size_t read_index() { return static_cast<std::size_t>(read<std::int32_t>()); }
    Vec3 read_vec() {
        const double x = read<double>(), y = read<double>();
        return {x, y, read<double>()};
    }

  private:
    std::filesystem::path path_;
    std::ifstream file_;
};

/// Reads the format of data/README: int32 nc, nblocks, mu[nc], q[3 nc], nblocks x {int32 row, col, double B[9]}.
inline FrictionProblem read_friction_problem(const std::filesystem::path& path) {
    BinaryReader file(path);
    FrictionProblem p;
    const std::size_t n = file.read_index(), num_blocks = file.read_index();
    p.contacts.resize(n);
    p.row.resize(n);
    for (LocalContact& c : p.contacts) c.friction = file.read<double>();
    for (std::size_t i = 0; i < n; ++i) p.q.push_back(file.read_vec());
    for (std::size_t k = 0; k < num_blocks; ++k) {
        const std::size_t i = file.read_index(), j = file.read_index();
        const Mat3 w = file.read<Mat3>();
        p.row.at(i).push_back({j, w});
        if (i == j) p.set_diagonal(i, w);
    }
    return p;
}

/// Puts the reference's impulses into the problem: r[3 nc] of the .fcref beside it.
inline void read_reference_impulses(const std::filesystem::path& path, FrictionProblem& p) {
    BinaryReader file(path);
    for (LocalContact& c : p.contacts) c.impulse = file.read_vec();
}

} // namespace flotilla
