// SPDX-License-Identifier: MIT
#include "static_contact/interior_point.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/Dense>
#include <Eigen/Sparse>
#include <cstdio>
#include <cstdlib>

namespace flotilla {

double exp_smooth = 0; int exp_retry = 0; int exp_ls = 1, exp_sw = 100, exp_nn = 6, exp_rr = 20; int exp_stall = 8, exp_multi = 0;
int exp_start = 0, exp_gs = 0, exp_ipm = 100; double exp_weight = 0;
int exp_full_newton = 1, exp_newton_first = 6, exp_verbose = 0, exp_polish = 1;
double exp_eps = 1e-9;

namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kTinyFriction = 1e-6;
constexpr std::int32_t kLargestDense = 60;

std::size_t index(std::int32_t i) { return static_cast<std::size_t>(i); }

Mat3 outer(const Vec3& a, const Vec3& b) {
    return {{a.x * b.x, a.x * b.y, a.x * b.z, a.y * b.x, a.y * b.y, a.y * b.z, a.z * b.x, a.z * b.y, a.z * b.z}};
}

// The body-space matrix I + sum H_i^T B_i H_i.
class BodySystem {
  public:
    void analyse(const ConeProgram& p) {
        program_ = &p;
        n_ = p.num_columns;
        dense_ = n_ <= kLargestDense;
        if (!dense_) build_pattern();
    }
    bool factor(const std::vector<Mat3>& b, bool symmetric) {
        symmetric_ = symmetric;
        if (dense_) {
            full_.setIdentity(n_, n_);
            double* const values = full_.data();
            const ConeProgram& p = *program_;
            for (std::size_t i = 0; i < p.contacts.size(); ++i)
                for (auto k = index(p.first_entry[i]); k < index(p.first_entry[i + 1]); ++k) {
                    const Vec3 bh = b[i] * p.entries[k].h;
                    double* column = values + p.entries[k].column * n_;
                    for (auto l = index(p.first_entry[i]); l < index(p.first_entry[i + 1]); ++l)
                        column[p.entries[l].column] += dot(p.entries[l].h, bh);
                }
            if (symmetric) {
                llt_.compute(full_);
                return llt_.info() == Eigen::Success;
            }
            lu_.compute(full_);
            return true;
        }
        double* const values = sparse_.valuePtr();
        std::fill(values, values + sparse_.nonZeros(), 0.0);
        for (const std::int32_t d : diagonal_) values[d] = 1;
        const ConeProgram& p = *program_;
        const std::int32_t* at = positions_.data();
        for (std::size_t i = 0; i < p.contacts.size(); ++i)
            for (auto k = index(p.first_entry[i]); k < index(p.first_entry[i + 1]); ++k) {
                const Vec3 bh = b[i] * p.entries[k].h;
                for (auto l = index(p.first_entry[i]); l < index(p.first_entry[i + 1]); ++l)
                    values[*at++] += dot(p.entries[l].h, bh);
            }
        if (symmetric) {
            if (!ldlt_ready_) ldlt_.analyzePattern(sparse_);
            ldlt_ready_ = true;
            ldlt_.factorize(sparse_);
            return ldlt_.info() == Eigen::Success;
        }
        if (!lu_ready_) sparse_lu_.analyzePattern(sparse_);
        lu_ready_ = true;
        sparse_lu_.factorize(sparse_);
        return sparse_lu_.info() == Eigen::Success;
    }
    void solve(Eigen::VectorXd& x) {
        if (dense_) {
            if (symmetric_)
                llt_.solveInPlace(x);
            else
                x = lu_.solve(x).eval();
        } else if (symmetric_)
            x = ldlt_.solve(x).eval();
        else
            x = sparse_lu_.solve(x).eval();
    }
    std::int32_t size() const { return n_; }

  private:
    void build_pattern() {
        const ConeProgram& p = *program_;
        std::vector<Eigen::Triplet<double>> triplets;
        for (std::int32_t i = 0; i < n_; ++i) triplets.emplace_back(i, i, 1.0);
        for (std::size_t i = 0; i < p.contacts.size(); ++i)
            for (auto k = index(p.first_entry[i]); k < index(p.first_entry[i + 1]); ++k)
                for (auto l = index(p.first_entry[i]); l < index(p.first_entry[i + 1]); ++l)
                    triplets.emplace_back(p.entries[l].column, p.entries[k].column, 1.0);
        sparse_.resize(n_, n_);
        sparse_.setFromTriplets(triplets.begin(), triplets.end());
        sparse_.makeCompressed();
        const auto find = [&](std::int32_t row, std::int32_t column) {
            const std::int32_t* first = sparse_.innerIndexPtr() + sparse_.outerIndexPtr()[column];
            const std::int32_t* last = sparse_.innerIndexPtr() + sparse_.outerIndexPtr()[column + 1];
            return static_cast<std::int32_t>(std::lower_bound(first, last, row) - sparse_.innerIndexPtr());
        };
        diagonal_.clear();
        for (std::int32_t i = 0; i < n_; ++i) diagonal_.push_back(find(i, i));
        positions_.clear();
        for (std::size_t i = 0; i < p.contacts.size(); ++i)
            for (auto k = index(p.first_entry[i]); k < index(p.first_entry[i + 1]); ++k)
                for (auto l = index(p.first_entry[i]); l < index(p.first_entry[i + 1]); ++l)
                    positions_.push_back(find(p.entries[l].column, p.entries[k].column));
        lu_ready_ = ldlt_ready_ = false;
        if (exp_verbose) std::printf("n %d nnz %d\n", n_, (int)sparse_.nonZeros());
    }

    const ConeProgram* program_ = nullptr;
    std::int32_t n_ = 0;
    bool dense_ = true, symmetric_ = true, lu_ready_ = false, ldlt_ready_ = false;
    Eigen::MatrixXd full_;
    Eigen::LLT<Eigen::MatrixXd> llt_;
    Eigen::PartialPivLU<Eigen::MatrixXd> lu_;
    Eigen::SparseMatrix<double> sparse_;
    Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> ldlt_;
    Eigen::SparseLU<Eigen::SparseMatrix<double>> sparse_lu_;
    std::vector<std::int32_t> positions_, diagonal_;
};

// ---- the cone
double jdet(const Vec3& a) {
    const double t = std::sqrt(a.y * a.y + a.z * a.z);
    return (a.x - t) * (a.x + t);
}
Vec3 jmul(const Vec3& a, const Vec3& b) { return {dot(a, b), a.x * b.y + b.x * a.y, a.x * b.z + b.x * a.z}; }
Vec3 jdiv(const Vec3& l, const Vec3& r) {
    const double z = (l.x * r.x - (l.y * r.y + l.z * r.z)) / jdet(l);
    return {z, (r.y - z * l.y) / l.x, (r.z - z * l.z) / l.x};
}
// largest step to the boundary
double max_step(const Vec3& x, const Vec3& d) {
    const double root = std::sqrt(jdet(x));
    const Vec3 l = x / root;
    const double rho = (l.x * d.x - (l.y * d.y + l.z * d.z)) / root;
    const double f = (rho + d.x / root) / (l.x + 1);
    const double s1 = d.y / root - f * l.y, s2 = d.z / root - f * l.z;
    const double k = std::sqrt(s1 * s1 + s2 * s2) - rho;
    return k > 0 ? 1 / k : kInfinity;
}

struct Scaling {
    double eta = 1; // of W
    Vec3 w;         // unit hyperbolic
    Vec3 apply(const Vec3& v) const {
        const double wt = w.y * v.y + w.z * v.z;
        const double f = v.x + wt / (1 + w.x);
        return eta * Vec3{w.x * v.x + wt, v.y + f * w.y, v.z + f * w.z};
    }
    Vec3 apply_inverse(const Vec3& v) const {
        const double wt = w.y * v.y + w.z * v.z;
        const double f = -v.x + wt / (1 + w.x);
        return (1 / eta) * Vec3{w.x * v.x - wt, v.y + f * w.y, v.z + f * w.z};
    }
    Mat3 inverse_square() const {
        const Vec3 jw{w.x, -w.y, -w.z};
        return (1 / (eta * eta)) * (2 * outer(jw, jw) - diagonal({1, -1, -1}));
    }
};
Scaling make_scaling(const Vec3& x, const Vec3& y) {
    const double dx = std::sqrt(jdet(x)), dy = std::sqrt(jdet(y));
    const Vec3 xn = x / dx, yn = y / dy;
    const double g = std::sqrt((1 + dot(xn, yn)) / 2);
    Scaling s;
    s.w = (1 / (2 * g)) * Vec3{yn.x + xn.x, yn.y - xn.y, yn.z - xn.z};
    // w has unit determinant; recompute w.x from the tangential part to keep that exactly
    s.w.x = std::sqrt(1 + (s.w.y * s.w.y + s.w.z * s.w.z));
    s.eta = std::sqrt(dy / dx);
    return s;
}

} // namespace

struct ConeScratch::Storage {
    ConeProgram program;
    BodySystem system;
    std::vector<double> w_n, w_t, weight;
    std::vector<Vec3> linear, angular, r, u, best, x, y, dx, dy, dxa, dya, rhs, lambda;
    std::vector<Scaling> scaling;
    std::vector<Mat3> b, w;
    Eigen::VectorXd v;
};

ConeScratch::ConeScratch() : storage_(std::make_unique<Storage>()) {}
ConeScratch::~ConeScratch() = default;
ConeScratch::ConeScratch(ConeScratch&&) noexcept = default;
ConeScratch& ConeScratch::operator=(ConeScratch&&) noexcept = default;

void ConeProgram::clear() {
    num_columns = 0;
    contacts.clear();
    first_entry.assign(1, 0);
    entries.clear();
}

namespace {

Vec3 to_contact(const ConeContact& c, const Vec3& v) {
    return {dot(c.normal, v), dot(c.tangent_1, v), dot(c.tangent_2, v)};
}
Vec3 to_world(const ConeContact& c, const Vec3& v) {
    return (v.x * c.normal + v.y * c.tangent_1) + v.z * c.tangent_2;
}

struct Solver {
    std::span<const ConeBody> bodies;
    std::span<const ConeContact> cone_contacts;
    const ConeProgram& p;
    ConeSolveOptions options;
    ConeScratch::Storage& s;
    ConeSolveStats stats;

    std::size_t size() const { return p.contacts.size(); }
    bool has_cone(std::size_t i) const { return p.contacts[i].friction > kTinyFriction && s.w_t[i] > 0; }
    bool live(std::size_t i) const { return s.w_n[i] > 0; }

    void velocities(const std::vector<Vec3>& r, std::vector<Vec3>& u) {
        u.resize(size());
        if (!bodies.empty()) {
            s.linear.assign(bodies.size(), {});
            s.angular.assign(bodies.size(), {});
            for (std::size_t i = 0; i < size(); ++i) {
                const ConeContact& c = cone_contacts[i];
                const Vec3 w = to_world(c, r[i]);
                if (c.a >= 0) s.linear[index(c.a)] -= w, s.angular[index(c.a)] -= cross(c.arm_a, w);
                if (c.b >= 0) s.linear[index(c.b)] += w, s.angular[index(c.b)] += cross(c.arm_b, w);
            }
            for (std::size_t k = 0; k < bodies.size(); ++k) {
                s.linear[k] *= bodies[k].inv_mass;
                s.angular[k] = bodies[k].inv_inertia * s.angular[k];
            }
            for (std::size_t i = 0; i < size(); ++i) {
                const ConeContact& c = cone_contacts[i];
                Vec3 v;
                if (c.b >= 0) v += s.linear[index(c.b)] + cross(s.angular[index(c.b)], c.arm_b);
                if (c.a >= 0) v -= s.linear[index(c.a)] + cross(s.angular[index(c.a)], c.arm_a);
                u[i] = c.free_velocity + to_contact(c, v);
            }
            return;
        }
        gather(r);
        for (std::size_t i = 0; i < size(); ++i) u[i] = p.contacts[i].q + spread(i);
    }
    // v = H^T r
    void gather(const std::vector<Vec3>& r) {
        s.v.setZero(p.num_columns);
        for (std::size_t i = 0; i < size(); ++i)
            for (auto k = index(p.first_entry[i]); k < index(p.first_entry[i + 1]); ++k)
                s.v[p.entries[k].column] += dot(p.entries[k].h, r[i]);
    }
    // H_i v
    Vec3 spread(std::size_t i) const {
        Vec3 sum;
        for (auto k = index(p.first_entry[i]); k < index(p.first_entry[i + 1]); ++k)
            sum += s.v[p.entries[k].column] * p.entries[k].h;
        return sum;
    }
    double violation(std::size_t i, const Vec3& r, const Vec3& u) const {
        if (!live(i)) return 0;
        const double n = std::abs(std::max(r.x - u.x / s.w_n[i], 0.0) - r.x) * s.w_n[i];
        if (!(s.w_t[i] > 0)) return n;
        const double bound = p.contacts[i].friction * r.x;
        const double z1 = r.y - u.y / s.w_t[i], z2 = r.z - u.z / s.w_t[i];
        const double l = std::sqrt(z1 * z1 + z2 * z2), f = l > bound ? bound / l : 1;
        const double d1 = f * z1 - r.y, d2 = f * z2 - r.z;
        return std::max(n, std::sqrt(d1 * d1 + d2 * d2) * s.w_t[i]);
    }
    double residual(const std::vector<Vec3>& r, const std::vector<Vec3>& u) const {
        double worst = 0;
        for (std::size_t i = 0; i < size(); ++i) {
            const double v = violation(i, r[i], u[i]);
            if (!(v <= worst)) worst = v;
            if (std::isnan(worst)) return kInfinity;
        }
        return worst;
    }
    void project(std::vector<Vec3>& r) const {
        for (std::size_t i = 0; i < size(); ++i) {
            Vec3& a = r[i];
            if (!live(i) || !(a.x > 0)) {
                a = {};
                continue;
            }
            const double bound = s.w_t[i] > 0 ? p.contacts[i].friction * a.x : 0;
            const double t = std::sqrt(a.y * a.y + a.z * a.z);
            if (t > bound) {
                double f = bound / t;
                a.y *= f, a.z *= f;
            }
        }
    }
    // projects r, evaluates u, keeps the best
    double consider(std::vector<Vec3>& r, std::vector<Vec3>& u) {
        project(r);
        velocities(r, u);
        const double f = residual(r, u);
        if (f < stats.residual) {
            stats.residual = f;
            s.best = r;
        }
        return f;
    }
    double floor() const { double w = 0; for (std::size_t i = 0; i < size(); ++i) w = std::max(w, std::max(s.w_n[i], s.w_t[i]) * length(s.best[i])); return 16 * 2.2e-16 * w; }
    bool done() const { return stats.residual <= std::max(options.tolerance, floor()) || stats.iterations >= options.max_iterations; }

    // Semismooth Newton from s.best
    void newton(int max_steps) {
        s.r = s.best;
        double current = consider(s.r, s.u);
        double before = current;
        int no_gain = 0;
        for (int step = 0; step < max_steps && !done(); ++step) {
            newton_blocks();
            gather(s.rhs);
            ++stats.iterations;
            if (!s.system.factor(s.b, false)) return;
            s.system.solve(s.v);
            bool finite = s.v.allFinite();
            if (!finite) return;
            for (std::size_t i = 0; i < size(); ++i) s.dx[i] = s.rhs[i] - s.b[i] * spread(i);
            double alpha = 1, f = 0;
            for (int k = 0; k < exp_ls; ++k) {
                for (std::size_t i = 0; i < size(); ++i) s.x[i] = s.r[i] + alpha * s.dx[i];
                f = consider(s.x, s.y);
                if (f < current) break;
                alpha /= 4;
            }
            if (exp_verbose) std::printf("   newton %d: %.3e -> %.3e\n", step, current, f);
            s.r.swap(s.x);
            s.u.swap(s.y);
            current = f;
            if (!(f < 0.9 * before) && ++no_gain > 3) return;
            before = std::min(before, f);
        }
    }
    // dr = rhs - B H dv of the law linearised at (r, u), Alart and Curnier
    void newton_blocks() {
        s.b.resize(size());
        s.rhs.resize(size());
        s.dx.resize(size());
        for (std::size_t i = 0; i < size(); ++i) {
            const Vec3 &r = s.r[i], &u = s.u[i];
            Mat3& b = s.b[i];
            Vec3& c = s.rhs[i];
            b = {};
            const double mu = p.contacts[i].friction;
            if (!live(i) || !(r.x - u.x / s.w_n[i] > 0)) {
                c = -r;
                continue;
            }
            const double stiff_n = 1 / (exp_eps * s.w_n[i]);
            b.m[0] = stiff_n;
            c.x = -stiff_n * u.x;
            const bool friction = s.w_t[i] > 0 && mu > 0;
            const double stiff_t = friction ? 1 / (exp_eps * s.w_t[i]) : 0;
            const double z1 = r.y - u.y / s.w_t[i], z2 = r.z - u.z / s.w_t[i];
            const double z = std::sqrt(z1 * z1 + z2 * z2);
            const double bound = mu * r.x;
            if (!friction) {
                c.y = -r.y;
                c.z = -r.z;
            } else if (z <= bound) {
                b.m[4] = b.m[8] = stiff_t;
                c.y = -stiff_t * u.y;
                c.z = -stiff_t * u.z;
            } else {
                const double d1 = z1 / z, d2 = z2 / z;
                const double kappa = bound / z;
                // (I - kappa P) dr = bound d - r + mu d dr_n - kappa rho P u'
                const double open = std::max(1 - kappa, exp_eps);
                const auto solve = [&](double a1, double a2, double f) { // (dd + P/open) a
                    const double ad = a1 * d1 + a2 * d2;
                    return std::pair{ad * d1 + (a1 - ad * d1) * f, ad * d2 + (a2 - ad * d2) * f};
                };
                const auto [g1, g2] = solve(bound * d1 - r.y, bound * d2 - r.z, 1 / open);
                const double k = kappa / (open * s.w_t[i]);
                c.y = g1 + mu * d1 * c.x;
                c.z = g2 + mu * d2 * c.x;
                b.m[3] = mu * d1 * stiff_n;
                b.m[6] = mu * d2 * stiff_n;
                b.m[4] = k * (1 - d1 * d1);
                b.m[5] = b.m[7] = -k * d1 * d2;
                b.m[8] = k * (1 - d2 * d2);
            }
        }
    }

    // Projected block Gauss-Seidel from s.best
    void sweep(int count) {
        s.r = s.best;
        gather(s.r);
        for (int k = 0; k < count; ++k)
            for (std::size_t i = 0; i < size(); ++i) {
                if (!live(i)) continue;
                const Vec3 old = s.r[i];
                Vec3 r = old;
                const Vec3 u0 = p.contacts[i].q + spread(i);
                Vec3 u = u0;
                const Mat3& w = s.w[i];
                for (int l = 0; l < 3; ++l) {
                    r.x = std::max(r.x - u.x / s.w_n[i], 0.0);
                    u = u0 + w * (r - old);
                    if (!(s.w_t[i] > 0)) break;
                    const double bound = p.contacts[i].friction * r.x;
                    const double z1 = r.y - u.y / s.w_t[i], z2 = r.z - u.z / s.w_t[i];
                    const double z = std::sqrt(z1 * z1 + z2 * z2), f = z > bound ? bound / z : 1;
                    r.y = f * z1, r.z = f * z2;
                    u = u0 + w * (r - old);
                }
                s.r[i] = r;
                const Vec3 d = r - old;
                for (auto e = index(p.first_entry[i]); e < index(p.first_entry[i + 1]); ++e)
                    s.v[p.entries[e].column] += dot(p.entries[e].h, d);
            }
        const double had = stats.residual;
        const double f = consider(s.r, s.u);
        if (exp_verbose) std::printf("  sweeps: %.3e -> %.3e\n", had, f);
    }

    double smooth = 0;
    double slip(const Vec3& u) const { return std::sqrt((u.y * u.y + u.z * u.z) + smooth * smooth); }
    // ---- interior point
    Vec3 to_r(std::size_t i, const Vec3& x) const {
        return has_cone(i) ? Vec3{x.x / p.contacts[i].friction, x.y, x.z} : Vec3{x.x, 0, 0};
    }
    void interior() {
        const std::size_t m = size();
        double speed = 0;
        for (std::size_t i = 0; i < m; ++i)
            if (live(i)) speed = std::max(speed, length(p.contacts[i].q));
        s.x.resize(m), s.y.resize(m), s.dx.resize(m), s.dy.resize(m), s.dxa.resize(m), s.dya.resize(m);
        s.b.resize(m), s.rhs.resize(m), s.lambda.resize(m), s.scaling.resize(m), s.r.resize(m);
        double count = 0;
        if (exp_start) {
            for (std::size_t i = 0; i < m; ++i) {
                s.b[i] = {};
                s.rhs[i] = {};
                if (!live(i)) continue;
                const double k = 1 / (exp_eps * s.w_n[i]), kt = has_cone(i) ? 1 / (exp_eps * s.w_t[i]) : 0;
                s.b[i] = diagonal({k, kt, kt});
                s.rhs[i] = -(s.b[i] * p.contacts[i].q);
            }
            gather(s.rhs);
            ++stats.iterations;
            if (!s.system.factor(s.b, true)) return;
            s.system.solve(s.v);
            for (std::size_t i = 0; i < m; ++i) s.r[i] = s.rhs[i] - s.b[i] * spread(i);
        }
        s.weight.resize(m);
        for (std::size_t i = 0; i < m; ++i) {
            s.weight[i] = 0;
            if (!live(i)) continue;
            const double mu = has_cone(i) ? p.contacts[i].friction : 1;
            double size = speed / std::max(s.w_n[i], s.w_t[i]);
            if (exp_start) size = std::max(size, length(s.r[i]));
            s.x[i] = {mu * size, 0, 0};
            s.y[i] = {speed * std::max(1., 1 / mu), 0, 0};
            s.weight[i] = exp_weight ? std::pow(s.x[i].x * s.y[i].x, exp_weight) : 1;
            count += s.weight[i];
        }
        double mean0 = 0, best_merit = kInfinity; int since = 0;
        int exp_left = exp_ipm;
        double next_polish = 1e-2 * speed;
        std::vector<Vec3> px, py, pr, pu; // polish saves
        while (!done()) {
            for (std::size_t i = 0; i < m; ++i) s.r[i] = to_r(i, s.x[i]);
            velocities(s.r, s.u);
            const double f = residual(s.r, s.u);
            if (f < stats.residual) stats.residual = f, s.best = s.r;
            if (done()) return;
            double gap = 0, infeasible = 0;
            for (std::size_t i = 0; i < m; ++i)
                if (live(i)) gap += dot(s.x[i], s.y[i]);
            if (mean0 == 0) mean0 = gap;
            smooth = exp_smooth * speed * std::min(1.0, gap / mean0);
            // rd stored in dy
            for (std::size_t i = 0; i < m; ++i) {
                if (!live(i)) continue;
                const double mu = p.contacts[i].friction;
                const Vec3 u = s.u[i];
                Vec3 want = has_cone(i) ? Vec3{u.x / mu + slip(u), u.y, u.z} : Vec3{u.x, 0, 0};
                s.lambda[i] = want - s.y[i]; // rd
                infeasible = std::max(infeasible, length(s.lambda[i]));
            }
            const double mean = gap / count;
            if (exp_verbose)
                std::printf("%3d residual %.3e infeasible %.3e mean %.3e\n", stats.iterations, f, infeasible, mean);
            if (exp_polish && f < next_polish) {
                px = s.x, py = s.y, pr = s.r, pu = s.u;
                auto rd = s.lambda;
                const double had = stats.residual;
                std::vector<Vec3> keep = s.best;
                s.best = s.r;
                stats.residual = f;
                newton(6);
                if (stats.residual > had) s.best = keep, stats.residual = had;
                if (done()) return;
                s.x = px, s.y = py, s.r = pr, s.u = pu, s.lambda = rd;
                next_polish = f * 0.03;
            }
            if (--exp_left < 0) return;
            const double merit = infeasible / speed + gap / mean0;
            if (exp_stall && merit < 0.7 * best_merit) best_merit = merit, since = 0; else if (exp_stall && ++since > exp_stall) return;
            // scaling and matrix
            for (std::size_t i = 0; i < m; ++i) {
                s.b[i] = {};
                if (!live(i)) continue;
                s.scaling[i] = make_scaling(s.x[i], s.y[i]);
                s.b[i] = matrix(i, s.scaling[i].inverse_square());
            }
            ++stats.iterations;
            if (!s.system.factor(s.b, !exp_full_newton)) return;
            direction(0, 1, false, s.dxa, s.dya);
            double alpha = std::min(1.0, step_length(s.dxa, s.dya));
            double after = 0;
            for (std::size_t i = 0; i < m; ++i)
                if (live(i)) after += dot(s.x[i] + alpha * s.dxa[i], s.y[i] + alpha * s.dya[i]);
            const double ratio = std::max(after / gap, 0.0);
            const double sigma = std::min(1.0, std::max(ratio * ratio * ratio, 1e-6));
            direction(sigma * mean, 1 - sigma, true, s.dx, s.dy);
            alpha = std::min(1.0, 0.99 * step_length(s.dx, s.dy));
            if (exp_verbose) std::printf("    sigma %.2e alpha %.3e\n", sigma, alpha);
            if (exp_retry && alpha < 0.3) {
                s.dxa.swap(s.dx), s.dya.swap(s.dy);
                const double si = std::max(sigma, 0.5);
                direction(si * mean, 1 - si, false, s.dx, s.dy);
                const double plain = std::min(1.0, 0.99 * step_length(s.dx, s.dy));
                if (exp_verbose) std::printf("    plain %.3e\n", plain);
                if (plain > alpha)
                    alpha = plain;
                else
                    s.dxa.swap(s.dx), s.dya.swap(s.dy);
            }
            if (!(alpha > 0)) return;
            for (std::size_t i = 0; i < m; ++i)
                if (live(i)) s.x[i] += alpha * s.dx[i], s.y[i] += alpha * s.dy[i];
        }
    }
    // B in the frame of r for the block G^-1 in that of x, with the derivative of the De Saxce term
    Mat3 matrix(std::size_t i, const Mat3& g) const {
        Mat3 b;
        if (!has_cone(i)) {
            b.m[0] = g.m[0];
            return b;
        }
        const double im = 1 / p.contacts[i].friction;
        Mat3 t = diagonal({im, 1, 1});
        if (exp_full_newton) {
            const Vec3& u = s.u[i];
            const double l = slip(u);
            if (l > 0) t.m[1] = u.y / l, t.m[2] = u.z / l;
        }
        return diagonal({im, 1, 1}) * (g * t);
    }
    // lambda holds rd
    void direction(double target, double share, bool corrector, std::vector<Vec3>& dx, std::vector<Vec3>& dy) {
        const std::size_t m = size();
        for (std::size_t i = 0; i < m; ++i) {
            s.rhs[i] = {};
            if (!live(i)) continue;
            const Scaling& w = s.scaling[i];
            const Vec3 l = w.apply(s.x[i]);
            Vec3 c = Vec3{target * s.weight[i], 0, 0} - jmul(l, l);
            if (corrector) c = c - jmul(w.apply_inverse(s.dya[i]), w.apply(s.dxa[i]));
            const Vec3 d = jdiv(l, c); // W dx + W^-1 dy
            const Vec3 scaled = w.apply_inverse(d) - w.inverse_square() * (share * s.lambda[i]);
            dx[i] = scaled; // x part without dv
            s.rhs[i] = to_r(i, scaled);
        }
        gather(s.rhs);
        s.system.solve(s.v);
        for (std::size_t i = 0; i < m; ++i) {
            if (!live(i)) continue;
            const Vec3 du = spread(i);
            const Scaling& w = s.scaling[i];
            Vec3 dyi = has_cone(i) ? Vec3{du.x / p.contacts[i].friction, du.y, du.z} : Vec3{du.x, 0, 0};
            if (exp_full_newton && has_cone(i)) {
                const Vec3& u = s.u[i];
                const double l = slip(u);
                if (l > 0) dyi.x += (u.y * du.y + u.z * du.z) / l;
            }
            dx[i] = dx[i] - w.inverse_square() * dyi;
            if (!has_cone(i)) dx[i].y = dx[i].z = 0;
            dy[i] = dyi + share * s.lambda[i];
        }
    }
    double step_length(const std::vector<Vec3>& dx, const std::vector<Vec3>& dy) const {
        double alpha = kInfinity;
        for (std::size_t i = 0; i < size(); ++i)
            if (live(i)) {
                alpha = std::min(alpha, max_step(s.x[i], dx[i]));
                alpha = std::min(alpha, max_step(s.y[i], dy[i]));
                if (std::isnan(alpha)) return 0;
            }
        return alpha;
    }

    int rounds = 0;
    ConeSolveStats run(std::span<Vec3> impulses) {
        stats.residual = kInfinity;
        s.r.assign(size(), {});
        s.best = s.r;
        s.x.resize(size()), s.y.resize(size()), s.dx.resize(size());
        consider(s.r, s.u);
        s.r.assign(impulses.begin(), impulses.end());
        consider(s.r, s.u);
        s.system.analyse(p);
        if (!done() && exp_newton_first) newton(exp_newton_first);
        s.w.resize(size());
        for (std::size_t i = 0; i < size(); ++i) {
            s.w[i] = {};
            for (auto e = index(p.first_entry[i]); e < index(p.first_entry[i + 1]); ++e)
                s.w[i] = s.w[i] + outer(p.entries[e].h, p.entries[e].h);
        }
        if (exp_gs == 2) while (!done() && rounds++ < 20) { sweep(50); newton(6); }
        if (!done()) interior();
        if (exp_multi >= 1 && !done()) { exp_start = 1, exp_weight = 0.5, exp_smooth = 1, exp_retry = 1; interior(); }
        if (exp_multi >= 2 && !done()) { exp_start = 0, exp_weight = 0, exp_smooth = 0.1, exp_retry = 1; interior(); }
        if (exp_multi >= 3 && !done()) { exp_start = 0, exp_weight = 0, exp_smooth = 0, exp_retry = 0; exp_full_newton = 0; interior(); exp_full_newton = 1; }
        if (exp_multi >= 1) exp_start = 0, exp_weight = 0, exp_smooth = 0, exp_retry = 0;
        rounds = 0;
        if (exp_gs == 1) while (!done() && rounds++ < exp_rr) { sweep(exp_sw); newton(exp_nn); }
        if (exp_verbose) std::printf("rounds %d\n", rounds);
        stats.solved = stats.residual <= std::max(options.tolerance, floor());
        std::copy(s.best.begin(), s.best.end(), impulses.begin());
        return stats;
    }
};

// lower-triangular L with A = L L^T after pivoting
struct Factor3 {
    Vec3 column[3];
    int rank = 0;
};
Factor3 factor_inertia(Mat3 a) {
    Factor3 f;
    bool used[3] = {false, false, false};
    const double largest = std::max(a.m[0], std::max(a.m[4], a.m[8]));
    for (int k = 0; k < 3; ++k) {
        std::size_t pivot = 3;
        for (std::size_t i = 0; i < 3; ++i)
            if (!used[i] && (pivot == 3 || a.m[4 * i] > a.m[4 * pivot])) pivot = i;
        const double d = a.m[4 * pivot];
        if (!(d > 1e-16 * largest)) break;
        const double root = std::sqrt(d);
        used[pivot] = true;
        const Vec3 c = row(a, static_cast<int>(pivot)) / root;
        f.column[f.rank++] = c;
        a = a - outer(c, c);
        for (std::size_t i = 0; i < 3; ++i) a.m[3 * pivot + i] = a.m[3 * i + pivot] = 0;
    }
    return f;
}

void build_program(std::span<const ConeBody> bodies, std::span<const ConeContact> contacts, ConeScratch::Storage& s) {
    ConeProgram& p = s.program;
    p.clear();
    std::vector<Factor3> factors;
    std::vector<std::int32_t> first;
    for (const ConeBody& b : bodies) {
        first.push_back(p.num_columns);
        factors.push_back(factor_inertia(b.inv_inertia));
        p.num_columns += (b.inv_mass > 0 ? 3 : 0) + factors.back().rank;
    }
    s.w_n.clear();
    s.w_t.clear();
    for (const ConeContact& c : contacts) {
        p.contacts.push_back({c.free_velocity, c.friction});
        Vec3 w;
        const auto add = [&](std::int32_t body, const Vec3& arm, double sign) {
            if (body < 0) return;
            const ConeBody& b = bodies[index(body)];
            std::int32_t column = first[index(body)];
            if (b.inv_mass > 0) {
                const double root = sign * std::sqrt(b.inv_mass);
                for (int axis = 0; axis < 3; ++axis)
                    p.entries.push_back({column++, root * Vec3{component(c.normal, axis), component(c.tangent_1, axis),
                                                               component(c.tangent_2, axis)}});
            }
            const Factor3& f = factors[index(body)];
            for (int k = 0; k < f.rank; ++k)
                p.entries.push_back({column++, sign * to_contact(c, cross(f.column[k], arm))});
            const auto diag = [&](const Vec3& d) {
                const Vec3 t = cross(arm, d);
                return b.inv_mass + dot(t, b.inv_inertia * t);
            };
            w += {diag(c.normal), diag(c.tangent_1), diag(c.tangent_2)};
        };
        if (c.a < c.b) {
            add(c.a, c.arm_a, -1);
            add(c.b, c.arm_b, 1);
        } else {
            add(c.b, c.arm_b, 1);
            add(c.a, c.arm_a, -1);
        }
        p.first_entry.push_back(static_cast<std::int32_t>(p.entries.size()));
        s.w_n.push_back(w.x);
        s.w_t.push_back(std::max(w.y, w.z));
    }
}

} // namespace

ConeSolveStats solve_cone_program(std::span<const ConeBody> bodies, std::span<const ConeContact> contacts,
                                  const ConeSolveOptions& options, std::span<Vec3> impulses, ConeScratch& scratch) {
    ConeScratch::Storage& s = scratch.storage();
    build_program(bodies, contacts, s);
    return Solver{bodies, contacts, s.program, options, s, {}}.run(impulses);
}

ConeSolveStats solve_cone_program(const ConeProgram& program, const ConeSolveOptions& options,
                                  std::span<Vec3> impulses, ConeScratch& scratch) {
    ConeScratch::Storage& s = scratch.storage();
    s.w_n.clear();
    s.w_t.clear();
    for (std::size_t i = 0; i < program.contacts.size(); ++i) {
        Vec3 w;
        for (auto k = index(program.first_entry[i]); k < index(program.first_entry[i + 1]); ++k) {
            const Vec3& h = program.entries[k].h;
            w += {h.x * h.x, h.y * h.y, h.z * h.z};
        }
        s.w_n.push_back(w.x);
        s.w_t.push_back(std::max(w.y, w.z));
    }
    return Solver{{}, {}, program, options, s, {}}.run(impulses);
}

} // namespace flotilla
