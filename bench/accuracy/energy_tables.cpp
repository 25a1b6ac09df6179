// SPDX-License-Identifier: MIT
#include "energy_tables.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>
#include <map>
#include <ostream>
#include <string>
#include <vector>

#include "base/text.hpp"

namespace flotilla::survey {
namespace {

using Records = std::vector<const EnergyRecord*>;
constexpr std::size_t kShown = 10; // rows of a list of the worst

std::string short_text(double value) {
    std::array<char, 32> text{};
    std::snprintf(text.data(), text.size(), "%.3g", value);
    return text.data();
}

std::string percent(std::size_t part, std::size_t whole) {
    std::array<char, 32> text{};
    std::snprintf(text.data(), text.size(), "%.1f %%",
                  whole > 0 ? 100.0 * static_cast<double>(part) / static_cast<double>(whole) : 0);
    return text.data();
}

/// One line, safe between quotes of a CSV field and bars of a table.
std::string plain(const char* text) {
    std::string out = text;
    for (char& c : out)
        if (c == '"' || c == '|' || static_cast<unsigned char>(c) < 0x20) c = ' ';
    return out;
}

/// The smallest value that a share `q` of the sorted values does not exceed.
double quantile(const std::vector<double>& sorted, double q) {
    if (sorted.empty()) return 0;
    const auto rank = static_cast<std::size_t>(std::ceil(q * static_cast<double>(sorted.size())));
    return sorted[std::clamp<std::size_t>(rank, 1, sorted.size()) - 1];
}

std::string title(const EnergyRecord& r) {
    return r.index >= 0 ? "--only " + std::to_string(r.index) : plain(r.name.data());
}

double removed_share(const EnergyRecord& r) { return r.removed > 0 ? r.removed / r.scale : 0; }

void write_group(std::ostream& out, const std::string& name, const Records& group) {
    std::vector<double> rise, momentum, angular;
    std::size_t failed = 0, touching = 0, rising = 0, corrected = 0;
    std::int64_t merges = 0, held = 0, steps = 0, corrections = 0;
    double most_removed = 0, seconds = 0;
    for (const EnergyRecord* r : group) {
        failed += r->failure[0] != '\0' ? 1U : 0U;
        touching += r->collisions + r->contacts > 0 ? 1U : 0U;
        rising += rises(*r) ? 1U : 0U;
        corrected += r->corrections > 0 ? 1U : 0U;
        corrections += r->corrections;
        most_removed = std::max(most_removed, removed_share(*r));
        merges += r->merges, held += r->held, steps += r->steps, seconds += r->seconds;
        if (!r->scripted) rise.push_back(r->rise);
        if (!r->free || r->rung_changes + r->merges > 0) continue;
        momentum.push_back(r->momentum_drift);
        if (r->gravity == 0) angular.push_back(r->angular_drift);
    }
    std::sort(rise.begin(), rise.end());
    std::sort(momentum.begin(), momentum.end());
    std::sort(angular.begin(), angular.end());
    out << "| " << name << " | " << group.size() << " | " << touching << " | " << failed << " | " << rising << " ("
        << percent(rising, rise.size()) << ") | " << short_text(quantile(rise, 0.5)) << " | "
        << short_text(quantile(rise, 0.9)) << " | " << short_text(quantile(rise, 0.99)) << " | "
        << short_text(quantile(rise, 1)) << " | " << corrections << " in " << corrected << " scenes | "
        << short_text(most_removed) << " | " << short_text(quantile(momentum, 1)) << " in " << momentum.size() << " | "
        << short_text(quantile(angular, 1)) << " in " << angular.size() << " | " << merges << " | " << held << " | "
        << steps << " | " << short_text(steps > 0 ? 1e3 * seconds / static_cast<double>(steps) : 0) << " |\n";
}

void write_groups(std::ostream& out, const Records& all) {
    std::map<std::string, Records> groups;
    for (const EnergyRecord* r : all) groups[r->group.data()].push_back(r);
    out << "| group | scenes | with contact | failed | rises above " << short_text(kMostRise)
        << " | rise, median | 90 % | 99 % | largest | last resorts | J removed / scale, largest | momentum drift | "
           "angular"
        << " momentum drift | merges | held | steps | ms a step |\n"
        << "|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|\n";
    for (const auto& [name, group] : groups) write_group(out, name, group);
    out << "\nScenes with scripted bodies have no rises: the work of scripts is not known. Drifts are the largest in "
           "free scenes (angular:"
        << " without gravity) in which the failsafe did not act.\n";
}

void write_worst(std::ostream& out, Records all) {
    std::erase_if(all, [](const EnergyRecord* r) { return !rises(*r); });
    if (all.empty()) return;
    // Shares of energies that explode are all about 1: growth tells them apart.
    std::stable_sort(all.begin(), all.end(), [](const EnergyRecord* a, const EnergyRecord* b) {
        return std::pair(a->rise, a->growth) > std::pair(b->rise, b->growth);
    });
    out << "\nWorst " << std::min(kShown, all.size()) << " of " << all.size() << " scenes with a rise:\n\n"
        << "| group | scene | bodies | place | dt, s | g | friction | restitution | rise / scale | J | step | growth | "
           "merges |"
           " held |\n|---|---|---|---|---|---|---|---|---|---|---|---|---|---|\n";
    for (std::size_t i = 0; i < std::min(kShown, all.size()); ++i) {
        const EnergyRecord& r = *all[i];
        out << "| " << r.group.data() << " | " << title(r) << " | " << (r.index >= 0 ? r.name.data() : "") << " | "
            << r.place.data() << " | " << short_text(r.time_step) << " | " << short_text(r.gravity) << " | "
            << short_text(r.friction) << " | " << short_text(r.restitution) << " | " << short_text(r.rise) << " | "
            << short_text(r.rise_joule) << " | " << r.rise_step << " | " << short_text(r.growth) << " | " << r.merges
            << " | " << r.held << " |\n";
    }
}

void write_cut(std::ostream& out, const Records& all) {
    const auto cut = std::count_if(all.begin(), all.end(), [](const EnergyRecord* r) { return r->cut; });
    if (cut > 0) out << "\n" << cut << " scenes were so slow that they ended early.\n";
}

void write_failures(std::ostream& out, const Records& all) {
    std::size_t count = 0;
    for (const EnergyRecord* r : all) {
        if (r->failure[0] == '\0') continue;
        if (count++ == 0) out << "\n| group | scene | step | failure |\n|---|---|---|---|\n";
        if (count <= kShown)
            out << "| " << r->group.data() << " | " << title(*r) << " | " << r->steps << " | "
                << plain(r->failure.data()) << " |\n";
    }
    if (count > kShown) out << "\nand " << count - kShown << " more failures\n";
}

struct Property {
    const char* name;
    std::function<std::string(const EnergyRecord&)> value;
};

std::string kind_of(const EnergyRecord& r) {
    const std::string kinds = r.name.data();
    return kinds.find(',') == std::string::npos ? kinds.substr(kinds.find(' ') + 1) : "mixed";
}

std::string decade_of(double value) {
    const int low = static_cast<int>(std::floor(std::log10(value)));
    return "1e" + std::to_string(low) + " to 1e" + std::to_string(low + 1);
}

void write_property(std::ostream& out, const Records& all, const Property& property) {
    struct Count {
        std::size_t scenes = 0, rising = 0;
    };
    std::map<std::string, Count> counts;
    for (const EnergyRecord* r : all) {
        Count& count = counts[property.value(*r)];
        ++count.scenes;
        count.rising += rises(*r) ? 1U : 0U;
    }
    out << "| " << property.name << " |";
    for (const auto& [value, count] : counts)
        out << ' ' << value << ": " << percent(count.rising, count.scenes) << " of " << count.scenes << ";";
    out << " |\n";
}

void write_properties(std::ostream& out, Records all) {
    std::erase_if(all, [](const EnergyRecord* r) { return r->index < 0; });
    if (all.empty()) return;
    const Property properties[] = {
        {"bodies", kind_of},
        {"place", [](const EnergyRecord& r) { return std::string(r.place.data()); }},
        {"dt, s", [](const EnergyRecord& r) { return decade_of(r.time_step); }},
        {"gravity", [](const EnergyRecord& r) { return short_text(r.gravity); }},
        {"friction", [](const EnergyRecord& r) { return short_text(r.friction); }},
        {"restitution", [](const EnergyRecord& r) { return short_text(r.restitution); }},
        {"failsafe", [](const EnergyRecord& r) { return std::string(r.merges + r.rung_changes > 0 ? "yes" : "no"); }},
    };
    if (std::none_of(all.begin(), all.end(), [](const EnergyRecord* r) { return rises(*r); })) return;
    out << "\nRandom scenes with a rise, by what they were drawn from:\n\n| property | share with a rise "
           "|\n|---|---|\n";
    for (const Property& property : properties) write_property(out, all, property);
}

} // namespace

void write_csv(std::ostream& out, std::span<const EnergyRecord> records) {
    out << "group,index,name,place,bodies,scripted,time_step,gravity,friction,restitution,steps,rise,rise_joule,rise_"
           "step,growth,"
           "scale,allowance,momentum_drift,angular_drift,collisions,contacts,merges,rung_changes,held,warnings,"
           "corrections,removed,seconds,"
           "failure\n";
    for (const EnergyRecord& r : records) {
        out << r.group.data() << ',' << r.index << ",\"" << plain(r.name.data()) << "\"," << r.place.data() << ','
            << r.bodies << ',' << (r.scripted ? 1 : 0) << ',' << short_text(r.time_step) << ',' << short_text(r.gravity)
            << ',' << short_text(r.friction) << ',' << short_text(r.restitution) << ',' << r.steps;
        for (const double value : {r.rise, r.rise_joule}) out << ',' << short_text(value);
        out << ',' << r.rise_step;
        for (const double value : {r.growth, r.scale, r.allowance, r.momentum_drift, r.angular_drift})
            out << ',' << short_text(value);
        out << ',' << r.collisions << ',' << r.contacts << ',' << r.merges << ',' << r.rung_changes << ',' << r.held
            << ',' << r.warnings << ',' << r.corrections << ',' << short_text(r.removed) << ',' << short_text(r.seconds)
            << ",\"" << plain(r.failure.data()) << "\"\n";
    }
}

void write_summary(std::ostream& out, std::span<const EnergyRecord> records) {
    Records all;
    for (const EnergyRecord& r : records) all.push_back(&r);
    write_groups(out, all);
    write_worst(out, all);
    write_cut(out, all);
    write_failures(out, all);
    write_properties(out, all);
}

} // namespace flotilla::survey
