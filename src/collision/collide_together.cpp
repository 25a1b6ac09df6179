// SPDX-License-Identifier: MIT
#include "collision/collide_together.hpp"

#include <algorithm>
#include <limits>
#include <utility>

#include "base/index.hpp"
#include "collision/found_hits.hpp"

namespace flotilla {
namespace {

/// Velocities that part need no impulse: their ways are as sweeps left them, where nothing else is solved.
bool parts(const FoundHit& found) { return !found.landing || found.landing->parts; }

class CollideTogether {
  public:
    CollideTogether(const StepView& view, Movers movers, PairBook& book, Workers& workers, JointSolve& joint,
                    const Touching& touching, std::vector<std::uint8_t> bodies, double most_restitution,
                    std::vector<FoundHit>& found, StageCounters& counters)
        : view_(view),
          movers_(movers),
          book_(book),
          workers_(workers),
          left_(joint.left),
          touching_(touching),
          takes_part_(std::move(bodies)),
          most_restitution_(most_restitution),
          found_(found),
          counters_(counters),
          joint_(view, movers, workers, joint, kMostCollisionsTogether, counters) {}

    bool run() {
        for (int round = 0; round <= kMostRoundsTogether; ++round) {
            look_for_hits(view_, book_, workers_, counters_, found_, [&](std::int32_t a, std::int32_t b) {
                return (takes_part_[at(a)] | takes_part_[at(b)]) != 0 && !joint_.is_left(a) && !joint_.is_left(b);
            });
            if (found_.empty()) return std::ranges::find(left_, 1) == left_.end();
            if (joint_.hits().empty() && std::ranges::all_of(found_, parts)) return false;
            const bool hastened = hasten_parting(view_, movers_, counters_, found_);
            if (found_.empty() && !hastened) return std::ranges::find(left_, 1) == left_.end();
            if (found_.empty()) continue;
            keep(round >= kMostRoundsTogether);
            joint_.solve(true);
            for (const std::int32_t body : joint_.moved()) takes_part_[at(body)] = 1;
            delay();
        }
        return false;
    }

  private:
    /// What is met in the last round is left.
    void keep(bool at_last) {
        const bool at_first = joint_.hits().empty();
        const FoundHit* first = nullptr; // of the pair
        for (const FoundHit& found : found_) {
            if (first == nullptr || first->record != found.record) first = &found;
            const PairRecord& record = *found.record;
            const double restitution = pair_restitution(view_.model, record.a, record.b);
            if (at_last || !first->landing || restitution > most_restitution_) {
                joint_.leave(record.a, record.b);
                continue;
            }
            joint_.add(met_hit(found, *first->landing, at_first));
            counters_.rebound_lost = counters_.rebound_lost || restitution > 0;
        }
    }

    [[nodiscard]] MetHit met_hit(const FoundHit& found, const Landing& landing, bool at_first) const {
        const std::int32_t a = found.record->a, b = found.record->b;
        const ContactPoint& p = found.point;
        const auto rigid = [&](const Impulsive& of_a, const Impulsive& of_b) {
            return point_velocity(of_b, p.arm_b) - point_velocity(of_a, p.arm_a);
        };
        // Of the straight paths that points go on, on top of the rigid bodies' velocities.
        const Vec3 chords = p.relative_velocity - rigid(view_.clusters.impulsive(a), view_.clusters.impulsive(b));
        MetHit out;
        out.arm_a = p.arm_a, out.arm_b = p.arm_b;
        if (at_first) out.landing = landing;
        Contact& c = out.contact;
        c.a = a, c.b = b;
        c.normal = p.normal;
        c.target = -dot(p.normal, chords);
        c.slip = dot(p.normal, chords) * p.normal - chords;
        c.friction = p.friction;
        c.feature_key = static_cast<std::uint64_t>(joint_.tries(a, b));
        c.tolerance = kUndoneTogether * landing.lengths.rest / view_.dt;
        return out;
    }

    /// Whether what a body is given may be late: by all that it hits, or it would be driven into what gives at once.
    void find_who_may_be_late() {
        late_.assign(view_.model.size(), 1);
        for (const MetHit& hit : joint_.hits()) {
            const std::int32_t a = hit.contact.a, b = hit.contact.b;
            const auto [late_a, late_b] = touching_.may_be_late(view_.clusters, a, b, hit.contact.normal);
            if (!late_a) late_[at(a)] = 0;
            if (!late_b) late_[at(b)] = 0;
        }
    }

    /// The share of a hit's impulse that would be late for it alone.
    [[nodiscard]] double late_share(const MetHit& hit) const {
        const Contact& c = hit.contact;
        const auto change = [&](std::int32_t body, const Vec3& arm) {
            return dot(c.normal,
                       point_velocity(view_.clusters.impulsive(body), arm) - point_velocity(joint_.before(body), arm));
        };
        const OfBoth shares =
            late_shares(view_, touching_, {c.a, c.b}, *hit.landing, {-change(c.a, hit.arm_a), change(c.b, hit.arm_b)});
        return std::max(shares.a, shares.b);
    }

    /// The blows of an island go through it at once: what is late of them is the least of what its hits have.
    void delay() {
        find_who_may_be_late();
        const std::span<const MetHit> hits = joint_.hits();
        const std::span<const std::int32_t> island = joint_.islands();
        shares_.assign(joint_.num_islands(), kNone);
        for (std::size_t i = 0; i < hits.size(); ++i) {
            const Contact& c = hits[i].contact;
            if (!joint_.moved(island[i]) || !hits[i].landing || (late_[at(c.a)] | late_[at(c.b)]) == 0) continue;
            shares_[at(island[i])] = std::min(shares_[at(island[i])], late_share(hits[i]));
        }
        Clusters& clusters = movers_.clusters();
        for (std::size_t i = 0; i < hits.size(); ++i) {
            const Contact& c = hits[i].contact;
            const double share = shares_[at(island[i])];
            if (!(share > 0) || share == kNone) continue;
            if (late_[at(c.a)] != 0) clusters.delay(c.a, hits[i].arm_a, -share * joint_.impulse(i));
            if (late_[at(c.b)] != 0) clusters.delay(c.b, hits[i].arm_b, share * joint_.impulse(i));
        }
        for (const std::int32_t body : joint_.moved()) movers_.evolve(body);
    }

    static constexpr double kNone = std::numeric_limits<double>::infinity();
    const StepView& view_;
    Movers movers_;
    PairBook& book_;
    Workers& workers_;
    const std::vector<std::uint8_t>& left_;
    const Touching& touching_;
    std::vector<std::uint8_t> takes_part_; ///< by body, as flags
    double most_restitution_;
    std::vector<FoundHit>& found_;
    StageCounters& counters_;
    JointHits joint_;
    std::vector<std::uint8_t> late_; ///< by body, as flags
    std::vector<double> shares_;     ///< by island
};

} // namespace

bool collide_together(const StepView& view, Movers movers, PairBook& book, Workers& workers, JointSolve& joint,
                      const Touching& touching, std::vector<std::uint8_t> bodies, double most_restitution,
                      std::vector<FoundHit>& found, StageCounters& counters) {
    joint.left.assign(view.model.size(), 0);
    return CollideTogether(view, movers, book, workers, joint, touching, std::move(bodies), most_restitution, found,
                           counters)
        .run();
}

} // namespace flotilla
