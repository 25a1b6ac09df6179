// SPDX-License-Identifier: MIT
#include "support/ccd_random.hpp"

#include <gtest/gtest.h>

#include <unistd.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

#include "support/ccd_generator.hpp"
#include "support/ccd_oracle.hpp"

namespace flotilla::test {
namespace {

constexpr std::size_t kClasses = kQueryClassNames.size();
constexpr int kMaxReports = 10; // failures printed in full
constexpr std::uint64_t kChunk = 4096;

/// The query in a form that can be pasted into a test.
std::string describe(QueryClass query_class, std::uint64_t index, const CcdQuery& q) {
    std::string text = std::string(kQueryClassNames[static_cast<std::size_t>(query_class)]) + " " +
                       std::to_string(index) + (kind_of(index) == CcdKind::vertex_face ? " VF {" : " EE {");
    for (const auto* x : {&q.x0, &q.x1}) {
        text += "{";
        for (const Vec3& p : *x) {
            std::array<char, 128> buffer{};
            std::snprintf(buffer.data(), buffer.size(), "Vec3{%a, %a, %a}, ", p.x, p.y, p.z);
            text += buffer.data();
        }
        text += "}, ";
    }
    return text + "}";
}

/// "12345 of 100000", rewritten in place on a terminal, otherwise about every tenth.
class Progress {
  public:
    Progress(const char* what, std::uint64_t total)
        : what_(what), total_(total), step_(std::max<std::uint64_t>(total / 10, 1)) {}
    void report(std::uint64_t done) {
        if (total_ < 1'000'000 || done < next_) return;
        next_ = done + step_;
        std::fprintf(stderr, "%s: %llu of %llu queries\n", what_, static_cast<unsigned long long>(done),
                     static_cast<unsigned long long>(total_));
    }

  private:
    const char* what_;
    std::uint64_t total_, step_, next_ = 0;
};

bool same_bits(double a, double b) { return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b); }

bool same_bits(const CcdResult& a, const CcdResult& b) {
    return same_bits(a.direction.x, b.direction.x) && same_bits(a.direction.y, b.direction.y) &&
           same_bits(a.direction.z, b.direction.z) && same_bits(a.toi, b.toi) && a.hit == b.hit &&
           a.iterations == b.iterations;
}

std::vector<Isa> wide_isas() {
    std::vector<Isa> isas;
    for (const Isa isa : {Isa::avx2, Isa::avx512})
        if (isa <= best_isa()) isas.push_back(isa);
    return isas;
}

CcdOptions options_of(std::uint64_t round) {
    constexpr std::array<double, 5> kSeparations{0, 1e-4, 1e-2, 1e-9, 0.25};
    return {.separation = kSeparations[round % kSeparations.size()],
            .start = round / kSeparations.size() % 2 == 0 ? CcdStart::strict : CcdStart::relaxed};
}

/// One batch of one class and kind.
struct BitBatch {
    QueryClass query_class;
    CcdKind kind;
    std::vector<std::uint64_t> indices;
    std::vector<CcdQuery> queries;
};

/// Number of results that differ.
int compare_batch(const BitBatch& batch, const CcdOptions& options, Isa isa, const std::vector<CcdResult>& scalar,
                  std::vector<CcdResult>& wide, int reported) {
    // Whatever is left over from before must be overwritten.
    std::fill(wide.begin(), wide.end(), CcdResult{{7, 7, 7}, 7, false, 77});
    ccd_batch(batch.kind, batch.queries, options, wide, isa);
    int differences = 0;
    for (std::size_t i = 0; i < wide.size(); ++i) {
        if (same_bits(scalar[i], wide[i])) continue;
        if (++differences + reported <= kMaxReports)
            ADD_FAILURE() << "instruction set " << static_cast<int>(isa) << ", separation " << options.separation
                          << ", start " << static_cast<int>(options.start) << ": toi " << scalar[i].toi << " / "
                          << wide[i].toi << ", hit " << scalar[i].hit << " / " << wide[i].hit << ", iterations "
                          << scalar[i].iterations << " / " << wide[i].iterations << ": "
                          << describe(batch.query_class, batch.indices[i], batch.queries[i]);
    }
    return differences;
}

} // namespace

std::uint64_t count_from_environment(const char* variable, std::uint64_t standard) {
    const char* text = std::getenv(variable);
    return text == nullptr ? standard : static_cast<std::uint64_t>(std::strtod(text, nullptr));
}

void check_wide_against_scalar(std::uint64_t first, std::uint64_t count) {
    const std::vector<Isa> isas = wide_isas();
    if (isas.empty()) GTEST_SKIP() << "this processor has no wide instruction set";
    Progress progress("wide against scalar", count);
    std::array<std::uint64_t, kClasses> queries{}, hits{};
    int differences = 0;
    std::uint64_t done = 0;
    BitBatch batch;
    std::vector<CcdResult> scalar, wide;
    for (std::uint64_t round = 0; done < count; ++round) {
        // Class, kind, options and length run through all their combinations, one after the other.
        const std::size_t c = round % kClasses;
        const std::uint64_t odd = round / kClasses % 2;
        const std::uint64_t length = std::min(count - done, 1 + round * 7919 % 611);
        batch.query_class = static_cast<QueryClass>(c);
        batch.kind = kind_of(odd);
        batch.indices.clear();
        batch.queries.clear();
        for (std::uint64_t i = 0; i < length; ++i) {
            batch.indices.push_back(2 * (first + done + i) + odd);
            batch.queries.push_back(make_query(batch.query_class, batch.indices.back()));
        }
        const CcdOptions options = options_of(round / (2 * kClasses));
        scalar.resize(length);
        wide.resize(length);
        for (std::size_t i = 0; i < length; ++i) {
            scalar[i] = ccd(batch.kind, batch.queries[i], options);
            hits[c] += scalar[i].hit ? 1U : 0U;
        }
        for (const Isa isa : isas) differences += compare_batch(batch, options, isa, scalar, wide, differences);
        queries[c] += length;
        done += length;
        progress.report(done);
    }
    EXPECT_EQ(differences, 0);
    for (std::size_t c = 0; c < kClasses; ++c) {
        std::printf("%-10s  %10llu queries, %10llu hits\n", kQueryClassNames[c],
                    static_cast<unsigned long long>(queries[c]), static_cast<unsigned long long>(hits[c]));
        EXPECT_GE(hits[c], queries[c] / 50) << kQueryClassNames[c] << ": too few hits to tell";
        // Subnormal distances are below the rounding allowance: hits, nearly all.
        const bool all_hit = static_cast<QueryClass>(c) == QueryClass::denormal;
        EXPECT_TRUE(all_hit || queries[c] - hits[c] >= queries[c] / 50)
            << kQueryClassNames[c] << ": too few misses to tell";
    }
    std::printf("total       %10llu queries, %zu instruction sets, %d differences\n",
                static_cast<unsigned long long>(done), isas.size(), differences);
}

namespace {

struct OracleTally {
    std::uint64_t queries = 0, contacts = 0; ///< by exact arithmetic
    std::uint64_t hits = 0;                  ///< reported at separation 0
    std::uint64_t missed = 0, late = 0, near_missed = 0, false_witness = 0;
    std::uint64_t near = 0; ///< rows whose minimum distance is at most the separation they were asked for
};

struct OracleFailures {
    int count = 0;
    void add(const char* what, QueryClass query_class, std::uint64_t index, const CcdQuery& q, const CcdOptions& o,
             const CcdResult& r) {
        if (++count > kMaxReports) return;
        std::array<char, 96> toi{};
        std::snprintf(toi.data(), toi.size(), "hit %d, toi %a", r.hit ? 1 : 0, r.toi);
        ADD_FAILURE() << what << " (separation " << o.separation << ", start " << static_cast<int>(o.start) << ", "
                      << toi.data() << "): " << describe(query_class, index, q);
    }
};

/// Contact must be reported, and not after its exact time, whatever the separation.
void check_contact(QueryClass query_class, std::uint64_t index, const CcdQuery& q, const OracleToi& truth,
                   const CcdOptions& options, const CcdResult& r, OracleTally& tally, OracleFailures& failures) {
    if (!r.hit) {
        ++tally.missed;
        failures.add("missed", query_class, index, q, options, r);
    } else if (is_late(kind_of(index), q, truth, r.toi)) {
        ++tally.late;
        failures.add("late", query_class, index, q, options, r);
    }
}

void check_query(QueryClass query_class, std::uint64_t index, OracleTally& tally, OracleFailures& failures) {
    const CcdKind kind = kind_of(index);
    const CcdQuery q = make_query(query_class, index);
    const OracleToi truth = exact_ccd(kind, q, 60);
    ++tally.queries;
    tally.contacts += truth.hit ? 1U : 0U;
    const CcdOptions touching{.separation = 0}, separated = options_of(1 + index / 2 % 9);
    const CcdResult at_zero = ccd(kind, q, touching), apart = ccd(kind, q, separated);
    tally.hits += at_zero.hit ? 1U : 0U;
    if (truth.hit) {
        check_contact(query_class, index, q, truth, touching, at_zero, tally, failures);
        check_contact(query_class, index, q, truth, separated, apart, tally, failures);
        for (const Vec3& d : {at_zero.direction, apart.direction, Vec3{0, 0, 1}}) {
            if (!certified_along(kind, q, d, 0)) continue;
            ++tally.false_witness;
            failures.add("witness certifies contact", query_class, index, q, touching, at_zero);
        }
    } else if (separated.start == CcdStart::strict && index / 2 % 4 == 0) {
        const DistanceRange d = min_distance(
            kind, q, {.tolerance = 0, .above = separated.separation, .below = separated.separation, .budget = 2000});
        if (d.upper > separated.separation) return;
        ++tally.near;
        if (apart.hit) return;
        ++tally.near_missed;
        failures.add("missed within the separation", query_class, index, q, separated, apart);
    }
}

} // namespace

void check_against_oracle(std::uint64_t first, std::uint64_t count) {
    Progress progress("against the exact oracle", count);
    std::array<OracleTally, kClasses> tallies{};
    OracleFailures failures;
    std::uint64_t done = 0;
    for (; done < count; ++done) {
        const std::size_t c = done % kClasses;
        check_query(static_cast<QueryClass>(c), first + done / kClasses, tallies[c], failures);
        if (done % kChunk == 0) progress.report(done);
    }
    std::printf("%-10s  %9s  %9s  %9s  %7s  %6s  %7s  %11s  %13s\n", "class", "queries", "contacts", "hits", "missed",
                "late", "near", "near_missed", "false_witness");
    OracleTally total;
    for (std::size_t c = 0; c < kClasses; ++c) {
        const OracleTally& t = tallies[c];
        const auto n = [](std::uint64_t x) { return static_cast<unsigned long long>(x); };
        std::printf("%-10s  %9llu  %9llu  %9llu  %7llu  %6llu  %7llu  %11llu  %13llu\n", kQueryClassNames[c],
                    n(t.queries), n(t.contacts), n(t.hits), n(t.missed), n(t.late), n(t.near), n(t.near_missed),
                    n(t.false_witness));
        EXPECT_GE(t.contacts, t.queries / 50) << kQueryClassNames[c] << ": too few contacts to tell";
        EXPECT_GE(t.queries - t.contacts, t.queries / 50) << kQueryClassNames[c] << ": too few misses to tell";
        total.queries += t.queries;
        total.contacts += t.contacts;
        total.missed += t.missed;
        total.late += t.late;
        total.near += t.near;
        total.near_missed += t.near_missed;
        total.false_witness += t.false_witness;
    }
    std::printf("total: %llu queries, %llu contacts, %llu missed, %llu late\n",
                static_cast<unsigned long long>(total.queries), static_cast<unsigned long long>(total.contacts),
                static_cast<unsigned long long>(total.missed), static_cast<unsigned long long>(total.late));
    EXPECT_EQ(total.missed, 0U);
    EXPECT_EQ(total.late, 0U);
    EXPECT_EQ(total.near_missed, 0U);
    EXPECT_EQ(total.false_witness, 0U);
    EXPECT_GE(total.near, count / 500);
}

} // namespace flotilla::test
