// SPDX-License-Identifier: MIT
#include "static_contact/rolling.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

#include <Eigen/Dense>

#include "base/index.hpp"
#include "state/loads.hpp"

namespace flotilla {
namespace {

/// A body that rolls over another one, as the lowest of their contacts sees it.
struct RollingMotion {
    Vec3 turn;  ///< rad/s, of b relative to a
    Vec3 along; ///< unit, tangential: where the contacts move, seen from the centre of mass of the body that rolls
    double speed = 0;     ///< m/s, of that
    double slip = 0;      ///< m/s, of the lowest contact along the surfaces
    double arm = 0;       ///< m, from the centre of mass
    double gravity = 0;   ///< m/s^2
    double time_step = 0; ///< s
    double fastest = 0;   ///< m/s, more than points of the bodies move against each other
    RollingBands bands{};
};

/// Contacts by height above the lowest one and by place along the way that they move.
class RollingPair {
  public:
    RollingPair(std::span<const Contact> pair, std::size_t lowest, const RollingMotion& motion)
        : pair_(pair),
          lowest_(pair[lowest]),
          motion_(motion),
          tilt_(std::abs(dot(lowest_.normal, cross(motion.turn, motion.along)))) {}

    [[nodiscard]] double tilt() const { return tilt_; }
    [[nodiscard]] double height(std::size_t i) const { return pair_[i].distance - lowest_.distance; }
    [[nodiscard]] double place(std::size_t i) const { return dot(pair_[i].point - lowest_.point, motion_.along); }
    [[nodiscard]] bool carries(std::size_t i) const { return !(height(i) > motion_.bands.carries); }
    [[nodiscard]] bool alike(std::size_t i) const {
        return dot(pair_[i].normal, lowest_.normal) >= motion_.bands.angle_cos;
    }

    /// On the way down, in the direction in which the body rolls.
    [[nodiscard]] bool ahead(std::size_t i, std::size_t carrier) const {
        return !carries(i) && alike(i) && place(i) < place(carrier);
    }

    /// Whether a contact is at the same corner as another one, nearer along the way than `near`. How high it is does
    /// not count: an edge that is tilted by a micron is one all the same.
    [[nodiscard]] bool same_corner(std::size_t i, std::size_t k, double near) const {
        return i == k || (alike(i) && std::abs(place(i) - place(k)) < near);
    }

    /// Of the contacts that carry the one on which the body rolls.
    [[nodiscard]] std::size_t carrier(std::size_t lowest) const {
        for (std::size_t i = 0; i < pair_.size(); ++i)
            if (carries(i) && alike(i) && place(i) < place(lowest)) lowest = i;
        return lowest;
    }

    struct Landing {
        std::size_t contact; ///< none if that is the carrier
        double time;         ///< s, from now
    };
    /// Where the body rolls on to from `carrier`; of all points of a side the one at its end.
    [[nodiscard]] Landing next(std::size_t carrier) const {
        constexpr double kSameAngle = 1 + 0x1p-10; // more than the rounding of heights
        double least = std::numeric_limits<double>::infinity();
        const auto angle = [&](std::size_t i) { return (height(i) - height(carrier)) / (place(carrier) - place(i)); };
        for (std::size_t i = 0; i < pair_.size(); ++i)
            if (ahead(i, carrier)) least = std::min(least, angle(i));
        std::size_t end = carrier;
        for (std::size_t i = 0; i < pair_.size(); ++i)
            if (ahead(i, carrier) && angle(i) <= kSameAngle * least && place(i) < place(end)) end = i;
        return {end, least / tilt_};
    }

  private:
    std::span<const Contact> pair_;
    const Contact& lowest_;
    const RollingMotion& motion_;
    double tilt_; ///< rad/s
};

/// Of a contact that carries for so many seconds of the step: equation 16 has its arc, on which the body comes down
/// when it has passed the axle. Without that it is a step late there, and passes the next corner before.
void stand_on(ArcContact& arc, double seconds, double time_step) {
    if (!(arc.apart > 0) || arc.rate + arc.apart * seconds <= 0) return; // ahead of the axle
    const double rises = arc.rate + 0.5 * arc.apart * seconds;           // m/s, in the mean
    arc.closer = (arc.rate > 0 ? arc.rate - rises : -rises) * time_step;
}

/// Of a contact's speed as its body turns, how fast it slips where no other one follows and it stays: between none, on
/// the corner of a coarse polygon that rolls, and all or more, at the end of a stick that swings across a trough.
constexpr double kSlides = 0.5;

/// Of contacts that slide on and no other ones follow in the step: what carries now does so to its end, and its load is
/// where it is at either end of the step, not where its arc leads it from there.
void stay(std::span<ArcContact> arcs, double time_step) {
    for (ArcContact& arc : arcs) {
        if (!arc.ahead) continue;
        arc.closer = -0.5 * arc.apart * time_step * time_step;
        arc.approach = 0;
        arc.shift = {};
    }
}

/// m/s, an approach along the normal that no contact of the pair has: one that may have it is not asked for anything.
double left_to_the_next_step(const RollingMotion& motion) { return -2 * motion.fastest; }

/// m, along the way that the contacts move: where a surface through the contacts of a pair is lowest, whose heights are
/// c + a x + k x^2 / 2 + b y + l y^2 / 2 along the way and across, by least squares. Nothing where it is not hollow,
/// the contacts do not tell a and k, as the two or three of a coarse polygon, or are not on it, as those of a cone.
std::optional<double> lowest_place(std::span<const Contact> contacts, const RollingPair& pair, std::size_t carrier,
                                   const Vec3& along) {
    constexpr double kLeast = 0x1p-40;     // of the scale: what two rims do not tell, l and b, is shared
    constexpr double kLoose = 0x1p20;      // variances beyond this are of what is not told
    constexpr double kOffSurface = 0x1p-8; // of the greatest height: what a circle is off its parabola at 7 degrees
    using Row = Eigen::Matrix<double, 5, 1>;
    const Contact& c = contacts[carrier];
    double size = 0, highest = 0;
    for (std::size_t i = 0; i < contacts.size(); ++i) {
        if (!pair.alike(i)) continue;
        size = std::max(size, length(contacts[i].point - c.point));
        highest = std::max(highest, std::abs(pair.height(i)));
    }
    if (!(size > 0 && highest > 0)) return std::nullopt;
    const auto row_of = [&](std::size_t i) {
        const Vec3 way = (1 / size) * (contacts[i].point - c.point);
        const double x = dot(way, along), y = dot(way, cross(c.normal, along));
        return Row{1, x, 0.5 * x * x, y, 0.5 * y * y};
    };
    Eigen::Matrix<double, 5, 5> squares = Eigen::Matrix<double, 5, 5>::Zero();
    Row heights = Row::Zero();
    for (std::size_t i = 0; i < contacts.size(); ++i) {
        if (!pair.alike(i)) continue;
        const Row row = row_of(i);
        squares += row * row.transpose();
        heights += (pair.height(i) / size) * row;
    }
    squares.diagonal().array() += kLeast * squares(0, 0);
    const Eigen::LDLT<Eigen::Matrix<double, 5, 5>> solver(squares);
    const Row surface = solver.solve(heights);
    const auto told = [&](int k) { return solver.solve(Row::Unit(k))[k] < kLoose; };
    if (!(surface[2] > 0) || !told(1) || !told(2)) return std::nullopt;
    for (std::size_t i = 0; i < contacts.size(); ++i)
        if (pair.alike(i) && !(std::abs(size * row_of(i).dot(surface) - pair.height(i)) <= kOffSurface * highest))
            return std::nullopt;
    return pair.place(carrier) - size * surface[1] / surface[2];
}

/// Steps of a side up to which a body rolls as if it were round. One that swings on a side of 512 corners (rolling.hpp)
/// came back to 0.349, 0.389, 0.404 and 0.405 of 0.4 rad in the third half swing at 1/120 s with one, two, four and
/// eight, due 0.400.
constexpr double kRoundSteps = 4;
/// Corners that the contacts of such a body span, one behind the other. With fewer another set of them each step makes
/// it hop: cylinders of 0.1 m at 1 m/s, of 64 sides at 1/24 s and of 96 at 1/60 s, by 1.66 and 0.72 mm in the mean with
/// three, 0.60 and 0.50 with five, 0.06 and 0.21 with seven or none that roll so.
constexpr int kLeastCorners = 7;

/// The contacts of a pair from the first to the last along the way.
struct Span {
    double from, to; ///< m
    int corners = 0; ///< sixteenths of it that have any

    [[nodiscard]] double side() const { return (to - from) / (corners - 1); } ///< m, or more
};
Span span_of(std::span<const Contact> contacts, const RollingPair& pair, std::size_t carrier) {
    constexpr int kParts = 16;
    Span span{pair.place(carrier), pair.place(carrier)};
    for (std::size_t i = 0; i < contacts.size(); ++i)
        if (pair.alike(i)) span.from = std::min(span.from, pair.place(i)), span.to = std::max(span.to, pair.place(i));
    if (!(span.to > span.from)) return span;
    unsigned found = 0;
    for (std::size_t i = 0; i < contacts.size(); ++i) {
        const double part = kParts * (pair.place(i) - span.from) / (span.to - span.from);
        if (pair.alike(i)) found |= 1u << std::min(static_cast<int>(part), kParts - 1);
    }
    span.corners = std::popcount(found);
    return span;
}

/// A body that rolls as if it were round: the load is right below the middle of its curvature now, and what comes down
/// next is left to the next step. `way`: m, of the step. False where its contacts are not those of a round side.
bool roll_round(std::span<const Contact> contacts, const RollingPair& pair, std::size_t carrier, double way,
                const RollingMotion& motion, std::span<ArcContact> arcs) {
    const Span span = span_of(contacts, pair, carrier);
    if (span.corners < kLeastCorners || !(span.side() < kRoundSteps * way)) return false;
    const std::optional<double> lowest = lowest_place(contacts, pair, carrier, motion.along);
    if (!lowest) return false;
    const auto carries = [&](std::size_t i) { return pair.alike(i) && pair.carries(i); };
    double last = pair.place(carrier);
    for (std::size_t i = 0; i < contacts.size(); ++i)
        if (carries(i)) last = std::max(last, pair.place(i));
    if (!(*lowest >= pair.place(carrier) - span.side() && *lowest <= last + span.side())) return false;
    for (std::size_t i = 0; i < contacts.size(); ++i) {
        if (pair.ahead(i, carrier)) arcs[i].approach = left_to_the_next_step(motion);
        if (!carries(i)) continue;
        arcs[i].closer = arcs[i].approach = 0;
        arcs[i].shift = (*lowest - pair.place(i)) * motion.along;
    }
    return true;
}

/// Steps of a side from which on a body stands on its corners, one after the other, as if there were no next one. Of
/// shorter ones load and landing are where they are in the mean: a cylinder of 256 sides that takes 4.7 steps for each
/// kept 1.0025 of its speed in 2 s standing, where 0.984 is due.
constexpr double kStepsOfSide = 8;

/// Whether a body slides over corners with so little friction that the arm of its load, half a side or less, would turn
/// it more than that friction: a ball of 2 cm and 320 triangles that swung without friction in a trough of 0.5 m, 1/24
/// s, had all of its energy as spin after half a swing. Where it lands within the step is not known to so much of a
/// side; its contacts carry where they are.
bool slides_on_corners(const RollingMotion& motion, double friction, double side) {
    return motion.slip > kSlides * motion.speed && 2 * friction * motion.arm < side;
}

/// Where one side of a pair lands in the step, moves its contacts to where they are when it does, and shares the load
/// of the step between them and those that carry now. `lowest`: the nearest contact; `arcs`: by contact, changed.
void share_load(std::span<const Contact> contacts, std::size_t lowest, const RollingMotion& motion, Standing& standing,
                std::span<ArcContact> arcs) {
    const RollingPair pair(contacts, lowest, motion);
    const std::size_t carrier = pair.carrier(lowest);
    const RollingPair::Landing landing = pair.next(carrier);
    const double dt = motion.time_step, time = landing.time;
    const auto shift_to = [&](std::size_t i, double way) {
        const Vec3 &n = contacts[i].normal, was = arcs[i].shift;
        if (!(length_sq(was) > 0)) return;
        arcs[i].shift = dot(was, n) * n + way * motion.along;
        arcs[i].approach += dot(n, cross(motion.turn, arcs[i].shift - was));
    };
    const bool lands = landing.contact != carrier && time < dt;
    const double way = motion.speed * dt;
    const double side = landing.contact != carrier ? pair.place(carrier) - pair.place(landing.contact) : way;
    // What gravity adds to the turn on the arm of a side: bodies that rest on their corners, or spin, do not roll.
    const bool rolls = motion.gravity * side * dt < motion.arm * motion.arm * pair.tilt();
    if (rolls && landing.contact != carrier && roll_round(contacts, pair, carrier, way, motion, arcs)) return;
    if (landing.contact != carrier && slides_on_corners(motion, contacts[lowest].friction, side)) {
        for (ArcContact& arc : arcs) arc.shift = {};
        return;
    }
    if (lands && motion.speed * time + side < way) return; // over several sides in the step
    if (!rolls) return standing.on_all(arcs);
    if (landing.contact == carrier && motion.slip > kSlides * motion.speed) stay(arcs, dt);
    const double near = 0.5 * side;
    if (landing.contact == carrier || kStepsOfSide * way <= side) standing.find();
    if (motion.bands.at_end && lands && standing.on(carrier, arcs[carrier])) {
        for (std::size_t i = 0; i < contacts.size(); ++i) {
            if (pair.same_corner(i, carrier, near)) standing.on(i, arcs[i]);
            if (pair.ahead(i, carrier)) arcs[i].approach = left_to_the_next_step(motion);
        }
        return;
    }
    for (std::size_t i = 0; i < contacts.size(); ++i)
        if (pair.same_corner(i, carrier, near)) {
            if (lands || !standing.on(i, arcs[i])) stand_on(arcs[i], lands ? time : dt, dt);
        }
    if (!lands) return;
    const bool stands = standing.stands(carrier);
    const double before = pair.place(carrier) + 0.5 * motion.speed * time,
                 after = pair.place(landing.contact) + 0.5 * motion.speed * (dt + time);
    for (std::size_t i = 0; i < contacts.size(); ++i) {
        const auto carries = [&](double share, double place) {
            arcs[i].carries = share;
            arcs[i].carries_at = (place - pair.place(i)) * motion.along;
        };
        if (pair.same_corner(i, carrier, near)) carries((stands ? 2 : 1) * time / dt, before);
        const bool lands_as_well = pair.same_corner(i, landing.contact, near);
        if (lands_as_well && !stands) carries(time / dt - 1, after);
        if (!lands_as_well && (!pair.ahead(i, carrier) || pair.place(i) < pair.place(landing.contact))) continue;
        shift_to(i, motion.speed * time);
    }
}

/// Of contacts of a body that tips over several sides in the step, without arcs that would take those ahead up again:
/// its load goes on with its contact. Half of it acts at the end of the step, where the contact then is, half at the
/// beginning, where it is now, so that the mean of both is in the middle (RATTLE for the height of the lowest point:
/// Euler's disk keeps 0.96 of its energy in 0.5 s at 1/120 s; with the first half in the middle of the way 0.83).
///
/// By the time of the half velocity that place rises. Friction, which would hold it, has to wait for the second half:
/// with it the disk's precession is off by 14 %, without by 2. That is for points that come down faster than gravity
/// would make bodies slide in the step; slower ones have the first half in the middle of the way, which stands then, or
/// boats that rock on their neighbours slide down from them.
///
/// False, with nothing changed, where arcs do take them up. Sides come down as far ahead as their curvature says, its
/// radius times the angle of the turn, and arcs take up those that are as far ahead as the points themselves go, by the
/// distance of the axis times the angle. On a round body both are one; where the first is more than twice the second,
/// arcs take up less than half of the approach. That is so however the mass is spread, and for prescribed bodies alike.
bool share_load_of_tipping(std::span<const Contact> contacts, std::size_t lowest, const RollingMotion& motion,
                           Standing& standing, std::span<ArcContact> arcs) {
    const RollingPair pair(contacts, lowest, motion);
    const std::size_t carrier = pair.carrier(lowest);
    std::size_t last = carrier;
    int sides = 0;
    for (auto landing = pair.next(last); landing.contact != last && landing.time < motion.time_step;
         landing = pair.next(last), ++sides)
        last = landing.contact;
    const double dt = motion.time_step;
    if (sides < 2) {
        standing.on_all(arcs);
        return true;
    }
    const double goes_on = pair.place(carrier) - pair.place(last); // m, the contact
    if (!(goes_on > 2 * motion.speed * dt)) return false;
    if (!(motion.gravity * (goes_on / sides) * dt < motion.arm * motion.arm * pair.tilt())) return true;
    const Vec3 whole_way = contacts[carrier].point - contacts[last].point;
    const bool fast = motion.gravity * dt < length(cross(motion.turn, whole_way));
    for (std::size_t i = 0; i < contacts.size(); ++i) {
        if (!pair.ahead(i, carrier)) continue;
        const Vec3& n = contacts[i].normal;
        const Vec3 way = contacts[carrier].point - contacts[i].point;
        if (motion.bands.at_end) {
            arcs[i].approach = left_to_the_next_step(motion);
            continue;
        }
        arcs[i].shift = fast ? way : 0.5 * way;
        (fast ? arcs[i].rises : arcs[i].approach) += dot(n, cross(motion.turn, arcs[i].shift));
        arcs[i].friction = fast ? 0 : 1;
    }
    return true;
}

/// Of what static contact leaves undone, what points move at most by the turning of their bodies where their arcs count
/// as straight lines, along which nothing rolls. 16 piles of 102 boats at rest take 22 sweeps a step, with a whole as
/// well; without this rule 36. A heap of bars creeps at 1.2e-4 sizes a second with a whole, 6e-6 with a quarter.
constexpr double kStraight = 0.25;

/// Whether a body turns by more than half a turn in the step about an axis along the surface. Its points are anywhere
/// by then, and a parabola through their place and velocity leads far away from it: a needle of 10 um that rolls at
/// 0.1 m/s turns 130 times in a frame. That is for thin bodies: a ball of 0.1 m that rolls so fast, at 8 m/s, hops by 8
/// mm with its arcs and by 61 without.
bool whirls(const VelocityArrays& bodies, const Contact& c, double time_step) {
    const auto turns = [&](std::int32_t body) {
        const Vec3& omega = bodies.turn_of(body);
        const double along = dot(omega, c.normal);
        return (length_sq(omega) - along * along) * (time_step * time_step) > std::numbers::pi * std::numbers::pi;
    };
    return turns(c.a) || turns(c.b);
}

/// m, of a body about an axis through its centre of mass. Where the axis passes a contact within half of that, the body
/// tips about it, as Euler's disk does. Else it rolls, however far along the axis the contact is: a cylinder of 512
/// sides three times as wide as high, which tipped by the length of its arm, lost 17 % of 0.5 m/s in a second at 1/24
/// s.
double gyration(const VelocityArrays& bodies, std::int32_t body, const Vec3& axis, double arm) {
    const double inverse_mass = bodies.inverse_mass[at(body)], square = length_sq(axis);
    if (!(inverse_mass > 0 && square > 0)) return arm;
    return std::sqrt(inverse_mass * dot(axis, bodies.inertia[at(body)] * axis) / square);
}

} // namespace

bool turn_little(const Model& model, std::int32_t a, std::int32_t b, const VelocityArrays& bodies, double still) {
    const auto fastest = [&](std::int32_t body) {
        return length(bodies.turn_of(body)) * model.shape_of(at(body)).radius;
    };
    return (fastest(a) + fastest(b)) * model.settings.time_step <= kStraight * still;
}

bool arcs_of_pair(const Model& model, std::span<const Contact> pair, const RollingBands& bands,
                  const VelocityArrays& bodies, const TurningBodies& turning, std::span<ArcContact> arcs) {
    const double dt = model.settings.time_step;
    const Contact& c = pair.front();
    if (turn_little(model, c.a, c.b, bodies, bands.still) || (bands.thin && whirls(bodies, c, dt))) {
        std::fill(arcs.begin(), arcs.end(), ArcContact{});
        return false;
    }
    const auto point = [&](const Contact& x, std::int32_t body) {
        return TurningPoint{turning.expected.on_arcs(bodies, body), point_on(x, body) - bodies.position[at(body)]};
    };
    for (std::size_t i = 0; i < pair.size(); ++i)
        arcs[i] = meet_on_arcs(point(pair[i], c.a), point(pair[i], c.b), pair[i].normal, dt);
    const auto lower = [](const Contact& x, const Contact& y) { return x.distance < y.distance; };
    const auto lowest = static_cast<std::size_t>(std::min_element(pair.begin(), pair.end(), lower) - pair.begin());
    const Vec3& n = pair[lowest].normal;
    const TurningPoint a = point(pair[lowest], c.a), b = point(pair[lowest], c.b);
    const bool of_b = 2 * dot(n, arc_acceleration(b.omega, b.arm)) >= arcs[lowest].apart;
    const TurningPoint& roller = of_b ? b : a;
    const Vec3 way = cross(roller.omega, roller.arm), along = way - dot(way, n) * n;
    const auto turning_speed = [&](std::int32_t body) {
        return length(bodies.angular_velocity[at(body)]) * model.shape_of(at(body)).radius;
    };
    const auto velocity = [&](const Contact& x, std::int32_t body) {
        const TurningPoint p = point(x, body);
        return bodies.velocity[at(body)] + cross(p.omega, p.arm);
    };
    const auto slip_of = [&](const Contact& x) {
        const Vec3 u = velocity(x, c.b) - velocity(x, c.a);
        return length(u - dot(u, x.normal) * x.normal);
    };
    RollingMotion motion{.turn = b.omega - a.omega,
                         .along = {},
                         .speed = length(along),
                         .slip = slip_of(pair[lowest]),
                         .arm = length(roller.arm),
                         .gravity = most_acceleration(model, c.a, c.b),
                         .time_step = dt,
                         .fastest = length(bodies.velocity[at(c.b)] - bodies.velocity[at(c.a)]) + turning_speed(c.a) +
                                    turning_speed(c.b),
                         .bands = bands};
    Standing standing(pair, bodies, turning, dt, bands.at_end);
    const Vec3 tip = cross(n, motion.turn); // points opposite to that come down
    if (2 * motion.speed < gyration(bodies, of_b ? c.b : c.a, cross(tip, n), motion.arm) * length(tip)) {
        motion.along = tip / length(tip);
        if (share_load_of_tipping(pair, lowest, motion, standing, arcs)) return false;
    }
    // What moves less than static contact leaves undone does not roll.
    if (!(arcs[lowest].apart > 0 && motion.speed * dt > bands.still)) {
        standing.on_all(arcs);
        return false;
    }
    motion.along = along / motion.speed;
    share_load(pair, lowest, motion, standing, arcs);
    return true;
}

} // namespace flotilla
