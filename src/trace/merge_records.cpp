// SPDX-License-Identifier: MIT
#include "trace/merge_records.hpp"

#include <algorithm>
#include <string_view>
#include <tuple>

namespace flotilla {
namespace {

/// A phase or a region within what holds it.
struct Item {
    std::string_view name;
    int kind = 0; ///< 0: phase; 1 + RegionKind
    std::size_t index = 0;
    std::int64_t begin = 0, end = 0;
    std::ptrdiff_t parent = -1; ///< an earlier item
    std::int64_t self = 0;      ///< duration outside the items that it holds
};

/// In order of time, outer ones first.
std::vector<Item> items_of(const TaskRecord& record) {
    std::vector<Item> items;
    for (std::size_t i = record.phases.size(); i-- > 0;) { // they are listed as they ended, so inner ones first
        const PhaseSpan& p = record.phases[i];
        items.push_back({p.name, 0, i, p.begin, p.end, -1, p.end - p.begin});
    }
    for (std::size_t i = 0; i < record.regions.size(); ++i) {
        const RegionRecord& r = record.regions[i];
        items.push_back({r.name, 1 + static_cast<int>(r.kind), i, r.begin, r.end, -1, r.end - r.begin});
    }
    std::stable_sort(items.begin(), items.end(), [](const Item& a, const Item& b) {
        return std::tuple(a.begin, a.kind > 0, -a.end) < std::tuple(b.begin, b.kind > 0, -b.end);
    });
    std::vector<std::ptrdiff_t> open;
    for (std::size_t i = 0; i < items.size(); ++i) {
        Item& item = items[i];
        while (!open.empty()) {
            const std::int64_t end = items[static_cast<std::size_t>(open.back())].end;
            if (end >= item.end && end > item.begin) break;
            open.pop_back();
        }
        if (!open.empty()) {
            item.parent = open.back();
            items[static_cast<std::size_t>(open.back())].self -= item.end - item.begin;
        }
        if (item.kind == 0) open.push_back(static_cast<std::ptrdiff_t>(i));
    }
    return items;
}

bool same_items(const std::vector<Item>& a, const std::vector<Item>& b) {
    return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](const Item& p, const Item& q) {
        return std::tie(p.name, p.kind, p.parent) == std::tie(q.name, q.kind, q.parent);
    });
}

bool same_tasks(const TaskRecord& a, const TaskRecord& b) {
    const auto same_region = [](const RegionRecord& p, const RegionRecord& q) {
        return p.tasks == q.tasks && p.step == q.step && p.first_link == q.first_link;
    };
    const auto same_span = [](const TaskSpan& p, const TaskSpan& q) {
        return p.region == q.region && p.task == q.task;
    };
    const auto same_group = [](const GroupSpan& p, const GroupSpan& q) {
        return p.region == q.region && p.tasks == q.tasks && p.visits == q.visits && p.barriers == q.barriers;
    };
    const auto equal = [](const auto& x, const auto& y, const auto& same) {
        return std::equal(x.begin(), x.end(), y.begin(), y.end(), same);
    };
    return a.threads.size() == 1 && b.threads.size() == 1 && equal(a.regions, b.regions, same_region) &&
           a.links == b.links && equal(a.threads[0], b.threads[0], same_span) && equal(a.groups, b.groups, same_group);
}

/// ns in the groups of each region.
std::vector<std::int64_t> busy_in_groups(const TaskRecord& record) {
    std::vector<std::int64_t> busy(record.regions.size());
    for (const GroupSpan& g : record.groups) busy[static_cast<std::size_t>(g.region)] += g.busy;
    return busy;
}

} // namespace

bool keep_shortest(TaskRecord& record, const TaskRecord& other) {
    std::vector<Item> items = items_of(record);
    const std::vector<Item> others = items_of(other);
    if (!same_items(items, others) || !same_tasks(record, other)) return false;

    const auto busy = busy_in_groups(record), other_busy = busy_in_groups(other);
    for (std::size_t i = 0; i < record.groups.size(); ++i)
        record.groups[i].busy = std::min(record.groups[i].busy, other.groups[i].busy);
    const auto shortest_busy = busy_in_groups(record);

    std::vector<std::int64_t> duration(items.size());
    for (std::size_t i = 0; i < items.size(); ++i) {
        const std::size_t k = items[i].index;
        duration[i] = items[i].kind == 0 // what sweeps spend outside their groups is a stretch of its own
                          ? std::min(items[i].self, others[i].self)
                          : std::min(items[i].self - busy[k], others[i].self - other_busy[k]) + shortest_busy[k];
    }
    for (std::size_t i = items.size(); i-- > 0;) // held items come later
        if (items[i].parent >= 0) duration[static_cast<std::size_t>(items[i].parent)] += duration[i];

    // One after the other from the begin of what holds them; what that spends by itself comes last.
    std::vector<std::int64_t> next(items.size());
    std::int64_t now = 0;
    for (std::size_t i = 0; i < items.size(); ++i) {
        Item& item = items[i];
        std::int64_t& cursor = item.parent >= 0 ? next[static_cast<std::size_t>(item.parent)] : now;
        item.begin = next[i] = cursor;
        item.end = cursor += duration[i];
    }
    for (const Item& item : items) {
        if (item.kind == 0) {
            record.phases[item.index].begin = item.begin;
            record.phases[item.index].end = item.end;
        } else {
            record.regions[item.index].begin = item.begin;
            record.regions[item.index].end = item.end;
        }
    }
    std::int32_t region = -1;
    for (std::size_t i = 0; i < record.threads[0].size(); ++i) {
        TaskSpan& span = record.threads[0][i];
        const TaskSpan& that = other.threads[0][i];
        if (span.region != region) now = record.regions[static_cast<std::size_t>(region = span.region)].begin;
        const std::int64_t shortest = std::min(span.end - span.begin, that.end - that.begin);
        span.begin = now;
        span.end = now += shortest;
    }
    return true;
}

} // namespace flotilla
