// SPDX-License-Identifier: MIT
#include "pair/ordered_sweep.hpp"

#include "base/index.hpp"
#include "parallel/compact.hpp"
#include "parallel/sweep_record.hpp"
#include "parallel/sweep_width.hpp"

namespace flotilla {
namespace {

/// Colours the list greedily and notes where the places of each colour begin in its order.
void color_greedily(std::size_t num_clusters, SweepBuffers& buffers) {
    const std::size_t size = buffers.things.size();
    buffers.used_colors.assign(num_clusters, 0);
    buffers.color.resize(size);
    std::vector<std::int32_t>& begin = buffers.color_begin;
    begin.assign(kColors + 1, 0);
    for (std::size_t i = 0; i < size; ++i) {
        const auto [a, b] = buffers.things[i];
        std::uint64_t none = 0;
        std::uint64_t& used_a = a >= 0 ? buffers.used_colors[at(a)] : none;
        std::uint64_t& used_b = b >= 0 ? buffers.used_colors[at(b)] : none;
        const int color = std::min(std::countr_one(used_a | used_b), kColors - 1);
        used_a |= std::uint64_t{1} << color;
        used_b |= std::uint64_t{1} << color;
        buffers.color[i] = static_cast<std::uint8_t>(color);
        ++begin[at(color) + 1];
    }
    for (std::size_t c = 1; c < begin.size(); ++c) begin[c] += begin[c - 1];
}

/// In the plain loop over the plan.
void order_plainly(const SweepPlan& plan, std::size_t num_clusters, SweepBuffers& buffers) {
    buffers.touched.assign(num_clusters, 0);
    buffers.tasks.clear();
    buffers.order.start(num_clusters);
    const auto touched = [&](std::int32_t c) { return c >= 0 && buffers.touched[at(c)] != 0; };
    for (int round = 0; round < plan.rounds; ++round)
        for (std::size_t i = 0; i < plan.size(); ++i) {
            const std::size_t k = plan.place(round, i);
            const auto [a, b] = buffers.things[k];
            if (buffers.open[k] == 0 && !touched(a) && !touched(b)) continue;
            if (a >= 0) buffers.touched[at(a)] = 1;
            if (b >= 0) buffers.touched[at(b)] = 1;
            buffers.tasks.push_back({static_cast<std::int32_t>(k), round});
            buffers.order.add(a, b);
        }
}

/// The same order, found colour by colour: pairs of one share no movable cluster, so that what the loop finds of one of
/// them depends on colours before alone. How many tasks these have is known in the end; until then a task is its place
/// in the plan.
class OrderByColors {
  public:
    OrderByColors(const SweepPlan& plan, SweepBuffers& buffers)
        : plan_(plan), buffers_(buffers), links_(buffers.links) {
        for (std::size_t c = 0; c < kColors; ++c)
            if (buffers.color_begin[c] != buffers.color_begin[c + 1]) colors_[num_colors_++] = c;
    }

    /// How many threads, at most `most`, this is worth.
    [[nodiscard]] int width(int most) const { return sweep_width(num_places() / kPlacesPerTask, num_phases(), most); }

    void run(Team& team, std::size_t num_clusters) {
        const std::size_t places = num_places();
        buffers_.touched.assign(num_clusters, 0);
        links_.last.assign(num_clusters, -1);
        links_.is_task.resize(places);
        links_.waits.resize(places);
        links_.successors.resize(places);
        links_.number.resize(places);
        find_links(team);
        number_tasks(team);
        buffers_.order.start(0);
        buffers_.order.resize(buffers_.tasks.size());
        team.for_each("order tasks", num_places(), kGrain, [&](std::size_t q, int) {
            if (links_.is_task[q] == 0) return;
            Successors successors = links_.successors[q];
            for (std::int32_t& s : successors)
                if (s >= 0) s = links_.number[at(s)];
            buffers_.order.set(at(links_.number[q]), successors, links_.waits[q]);
        });
        buffers_.order.list_first(team, links_.places);
    }

  private:
    static constexpr std::size_t kPlacesPerTask = 32; ///< take about as long as a task that sweep_width() is about
    static constexpr std::size_t kGrain = 2048;

    [[nodiscard]] std::size_t num_places() const { return at(plan_.rounds) * plan_.size(); }
    [[nodiscard]] std::size_t num_phases() const { return at(plan_.rounds) * num_colors_; }

    void find_links(Team& team) {
        const auto most = [&](int threads) { return width(threads); };
        const int shares = width(team.present());
        SweepRecord record(team.recorder(), "links of tasks", most, shares, 1);
        for_phases(&team, shares, num_phases(), [&](std::size_t phase, int share) {
            record.timed(share, 0, [&] { link_color(phase, share, shares); });
        });
        const auto visits = static_cast<std::int64_t>(num_phases());
        record.end([&](std::size_t) {
            const std::size_t tasks = num_places() / kPlacesPerTask / std::max<std::size_t>(num_phases(), 1);
            return GroupSpan{.tasks = static_cast<std::int32_t>(std::max<std::size_t>(tasks, 1)),
                             .visits = visits,
                             .barriers = visits};
        });
    }

    /// A share of the places that a colour has in a round.
    void link_color(std::size_t phase, int share, int shares) {
        const auto round = static_cast<int>(phase / num_colors_);
        const bool backwards = plan_.backwards_in(round);
        const std::size_t k = phase % num_colors_, c = colors_[backwards ? num_colors_ - 1 - k : k];
        const std::size_t first = at(buffers_.color_begin[c]), size = at(buffers_.color_begin[c + 1]) - first,
                          place = backwards ? plan_.size() - first - size : first;
        // Those that found no colour of their own may have a cluster in common.
        const bool alone = c + 1 == kColors;
        const auto cut = [&](int s) { return alone ? (s > 0 ? size : 0) : size * at(s) / at(shares); };
        for (std::size_t i = place + cut(share); i < place + cut(share + 1); ++i) link(round, i);
    }

    /// As TaskOrder::add().
    void link(int round, std::size_t i) {
        const std::size_t q = at(round) * plan_.size() + i, k = plan_.place(round, i);
        auto [a, b] = buffers_.things[k];
        if (b == a) b = -1;
        const auto touched = [&](std::int32_t c) { return c >= 0 && buffers_.touched[at(c)] != 0; };
        links_.is_task[q] = buffers_.open[k] != 0 || touched(a) || touched(b) ? 1 : 0;
        if (links_.is_task[q] == 0) return;
        const auto place = static_cast<std::int32_t>(q);
        links_.successors[q] = {-1, -1};
        std::int32_t waits_for = -1;
        links_.waits[q] = 0;
        for (std::int32_t slot = 0; slot < 2; ++slot) {
            const std::int32_t c = slot == 0 ? a : b;
            if (c < 0) continue;
            buffers_.touched[at(c)] = 1;
            const std::int32_t last = std::exchange(links_.last[at(c)], 2 * place + slot);
            if (last < 0 || last / 2 == waits_for) continue; // a task that had both is waited for once
            waits_for = last / 2;
            links_.successors[at(last / 2)][at(last % 2)] = place;
            ++links_.waits[q];
        }
    }

    void number_tasks(Team& team) {
        const auto count = [&](std::size_t begin, std::size_t end) {
            return static_cast<std::size_t>(std::count(links_.is_task.begin() + static_cast<std::ptrdiff_t>(begin),
                                                       links_.is_task.begin() + static_cast<std::ptrdiff_t>(end), 1));
        };
        const auto fill = [&](std::size_t begin, std::size_t end, std::size_t task) {
            for (std::size_t q = begin; q < end; ++q) {
                if (links_.is_task[q] == 0) continue;
                const auto round = static_cast<int>(q / plan_.size());
                const std::size_t place = plan_.place(round, q % plan_.size());
                links_.number[q] = static_cast<std::int32_t>(task);
                buffers_.tasks[task++] = {static_cast<std::int32_t>(place), round};
            }
        };
        compact(
            {&team, "number tasks", kGrain, links_.places}, num_places(), count,
            [&](std::size_t total) { buffers_.tasks.resize(total); }, fill);
    }

    const SweepPlan& plan_;
    SweepBuffers& buffers_;
    SweepBuffers::Links& links_;
    std::array<std::size_t, kColors> colors_{}; ///< that have pairs
    std::size_t num_colors_ = 0;
};

} // namespace

std::span<const std::int32_t> order_by_color(std::size_t num_clusters, SweepBuffers& buffers) {
    color_greedily(num_clusters, buffers);
    buffers.places.resize(buffers.color.size());
    std::array<std::int32_t, kColors> next;
    std::copy_n(buffers.color_begin.begin(), kColors, next.begin());
    for (std::size_t i = 0; i < buffers.places.size(); ++i)
        buffers.places[at(next[buffers.color[i]]++)] = static_cast<std::int32_t>(i);
    return buffers.places;
}

void order_tasks(const SweepPlan& plan, Team& team, SweepBuffers& buffers) {
    const std::size_t num_clusters = buffers.used_colors.size();
    if (team.division() == nullptr) {
        OrderByColors by_colors(plan, buffers);
        // One thread alone orders tasks for a recording, which is about many.
        if (by_colors.width(team.alone() ? std::numeric_limits<int>::max() : team.present()) > 1)
            return by_colors.run(team, num_clusters);
    }
    order_plainly(plan, num_clusters, buffers);
}

} // namespace flotilla
