// SPDX-License-Identifier: MIT
#include "pair/contact_search.hpp"

#include <algorithm>
#include <array>
#include <iterator>
#include <limits>

#include "base/index.hpp"
#include "pair/divided.hpp"
#include "pair/neighbour_lists.hpp"
#include "pair/pair_distance.hpp"
#include "parallel/compact.hpp"

namespace flotilla {
namespace {

/// Which features of a pair are known from the search before.
class KnownFeatures {
  public:
    KnownFeatures(const StepView& view, std::int64_t step, const std::vector<double>& stray)
        : model_(view.model), state_(view.state), step_(step), stray_(stray) {}

    /// Appends the features to `out` that were in contact in the last step, of a pair that is near enough to where they
    /// were searched for. Which pairs are is a pure function of State: their features are those of its impulses.
    void list(const PairRecord& record, std::vector<FeaturePair>& out) const {
        const std::vector<Searched>& searched = state_.searched;
        if (searched.empty() || searched[at(record.a)].step == step_ || searched[at(record.b)].step == step_) return;
        const double most = model_.settings.contact_reuse * record.lengths.rest;
        if (!(stray_[at(record.a)] + stray_[at(record.b)] < most)) return;
        const CandidatePair pair{record.a, record.b};
        const auto of = [](const WarmImpulse& w) { return CandidatePair{w.a, w.b}; };
        for (const WarmImpulses* stages : {&state_.warm, &state_.waiting}) {
            const std::vector<WarmImpulse>& impulses = (*stages)[ContactStage::final];
            auto w = std::ranges::lower_bound(impulses, pair, {}, of);
            for (; w != impulses.end() && of(*w) == pair; ++w) out.push_back(features_of(w->feature_key));
        }
    }

  private:
    const Model& model_;
    const State& state_;
    std::int64_t step_; ///< that ends, or ended, at the end poses
    const std::vector<double>& stray_;
};

void append_pair(const StepView& view, const KnownFeatures& known, Worker& worker, const ListedPair& listed,
                 ContactSet& out) {
    const CandidatePair& pair = listed.pair;
    PairRecord& record = *listed.record;
    if (far_by_bounds(view, record) || far_by_plane(view, record)) return;
    const BodyMotion a = view.trajectories.at_end(at(pair.a)), b = view.trajectories.at_end(at(pair.b));
    const double proximity = record.lengths.proximity;
    worker.points.clear();
    worker.features.clear();
    known.list(record, worker.features);
    double nearest = 0;
    if (!worker.features.empty() &&
        renew_contact_points(a, b, proximity, view.angle_cos, worker.features, nearest, worker.points)) {
        out.min_distance = std::min(out.min_distance, nearest);
        record_renewed_distance(view, record, nearest);
    } else {
        const QueryAid aid = kept_aid(view, worker, record);
        const auto result = find_contact_points(a, b, proximity, view.angle_cos, aid, worker.proximity, worker.points);
        if (result.near) out.min_distance = std::min(out.min_distance, result.distance);
        record_distance(view, record, result, aid.list);
    }
    record_plane(a, b, worker.points, record);
    for (const ProximityPoint& p : worker.points)
        out.add(contact_of(pair.a, pair.b, p, pair_friction(view.model, pair.a, pair.b)), record.lengths.rest,
                record.processed, false);
}

/// What a rank found: of each of its pairs with contacts its place, and how many.
struct FoundContacts {
    std::vector<std::array<std::int32_t, 2>> counts;
    ContactSet contacts;

    void write(ByteWriter& out) const {
        out.add(counts), out.add(contacts.contacts), out.add(contacts.rest), out.add(contacts.processed);
        out.add(contacts.min_distance), out.add(contacts.counters);
    }
    template <class Reader>
    void read(Reader&& in) {
        in.read(counts), in.read(contacts.contacts), in.read(contacts.rest), in.read(contacts.processed);
        in.read(contacts.min_distance), in.read(contacts.counters);
        contacts.ahead.assign(contacts.size(), 0);
    }
};

/// Joins what ranks found, in the order of the pairs.
void join(const std::vector<FoundContacts>& found, ContactSet& out) {
    out.clear();
    out.counters = {};
    std::vector<std::array<std::size_t, 2>> next(found.size()); // pair and contact, by rank
    for (const FoundContacts& f : found) {
        out.min_distance = std::min(out.min_distance, f.contacts.min_distance);
        out.counters += f.contacts.counters;
    }
    for (;;) {
        std::size_t rank = found.size();
        for (std::size_t r = 0; r < found.size(); ++r)
            if (next[r][0] < found[r].counts.size() &&
                (rank == found.size() || found[r].counts[next[r][0]] < found[rank].counts[next[rank][0]]))
                rank = r;
        if (rank == found.size()) return;
        auto& [pair, contact] = next[rank];
        const std::size_t count = at(found[rank].counts[pair++][1]);
        out.append(found[rank].contacts, contact, contact + count);
        contact += count;
    }
}

/// The contacts of the pairs, each searched for by the rank that owns it.
void search_divided(const StepView& view, Workers& workers, const KnownFeatures& known,
                    const std::vector<ListedPair>& pairs, ContactSet& out) {
    Division& division = *workers.team.division();
    FoundContacts own;
    for (std::size_t i = 0; i < pairs.size(); ++i) {
        const CandidatePair& p = pairs[i].pair;
        if (!owns(division, view.model, p)) continue;
        const CostOf cost(division, Division::payer(shared_body(view.model, p.a), shared_body(view.model, p.b)));
        const std::size_t before = own.contacts.size();
        append_pair(view, known, workers[0], pairs[i], own.contacts);
        if (const std::size_t count = own.contacts.size() - before; count > 0)
            own.counts.push_back({static_cast<std::int32_t>(i), static_cast<std::int32_t>(count)});
    }
    own.contacts.counters = workers[0].proximity.counters;
    ByteWriter bytes;
    own.write(bytes);
    const GatheredBytes told = gather_bytes(division.ranks(), bytes.take());
    division.log_loop(told.all.size());
    std::vector<FoundContacts> found(at(division.size()));
    for (int rank = 0; rank < division.size(); ++rank) found[at(rank)].read(reader_of(told.of(rank)));
    join(found, out);
}

/// The contacts of the pairs.
void search_pairs(const StepView& view, Workers& workers, const std::vector<ListedPair>& pairs, std::int64_t step,
                  ContactSearchScratch& scratch, ContactSet& out) {
    constexpr std::size_t kGrain = 16;
    const KnownFeatures known(view, step, scratch.stray);
    const std::size_t chunks = (pairs.size() + kGrain - 1) / kGrain;
    scratch.parts.resize(std::max(scratch.parts.size(), chunks));
    for (Worker& worker : workers.each) worker.proximity.counters = {}; // stage 1 counts as well
    if (workers.team.division() != nullptr) return search_divided(view, workers, known, pairs, out);
    workers.team.for_chunks("contact points", pairs.size(), kGrain,
                            [&](std::size_t begin, std::size_t end, int thread) {
                                ContactSet& part = scratch.parts[begin / kGrain];
                                part.clear();
                                for (std::size_t i = begin; i < end; ++i)
                                    append_pair(view, known, workers[thread], pairs[i], part);
                            });
    const std::span<const ContactSet> parts(scratch.parts.data(), chunks);
    const auto put = [&](std::size_t place, const ContactSet& part) { out.put(place, part); };
    gather_parts({&workers.team, "gather contacts", kGrain, scratch.places}, parts, out, put);
    out.min_distance = std::numeric_limits<double>::infinity();
    for (const ContactSet& part : parts) out.min_distance = std::min(out.min_distance, part.min_distance);
    out.counters = {};
    for (const Worker& worker : workers.each) out.counters += worker.proximity.counters;
}

void list_near(const std::vector<ListedPair>& pairs, ContactSet& out) {
    out.near.clear();
    if (out.keeps_near)
        for (const ListedPair& pair : pairs) out.near.push_back(pair.pair);
}

} // namespace

void find_contacts(const StepView& view, PairBook& book, Workers& workers, const ContactSearch& search,
                   ContactSearchScratch& scratch, ContactSet& out) {
    const std::vector<ListedPair>& pairs = end_pairs(view, book, workers.team);
    list_near(pairs, out);
    if (!search.wanted) return search_pairs(view, workers, pairs, search.step, scratch, out);
    std::vector<ListedPair> some;
    std::copy_if(pairs.begin(), pairs.end(), std::back_inserter(some),
                 [&](const ListedPair& p) { return search.wanted(p.pair); });
    search_pairs(view, workers, some, search.step, scratch, out);
}

} // namespace flotilla
