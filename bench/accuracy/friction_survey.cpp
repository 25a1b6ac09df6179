// SPDX-License-Identifier: MIT
// flotilla_friction_survey: frictional contact problems given by their matrix (data/friction), solved by each of the
// library's methods. How far does each get, and what does that cost? Tables go to stdout, progress to stderr.
#include <CLI/CLI.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <limits>
#include <sstream>
#include <string>
#include <vector>

#include <flotilla/error.hpp>

#include "static_contact/friction_problem.hpp"
#include "static_contact/matrix_program.hpp"

#include "friction_sweeps.hpp"

namespace {

using namespace flotilla;
using namespace flotilla::survey;
namespace fs = std::filesystem;

struct Arguments {
    fs::path data = fs::path(FLOTILLA_TEST_DATA) / "friction";
    double goal = 1e-8;
    int sweeps = 1'000'000, repetitions = 5;
};

/// A line of INDEX.csv.
struct Entry {
    std::string file, asymmetry, block_sweeps;
};

/// How far impulses are from the law.
struct Error {
    double natural_map = 0, residual = 0; ///< 1; m/s
};

/// `count`: sweeps or factorisations.
struct Solve {
    int count = 0;
    double seconds = 0;
    Error error;
};

struct Problem {
    Entry entry;
    FrictionProblem plain, turned; ///< in the file's tangents, and in those that the disc needs
    double speed = 0;              ///< m/s: largest |q|
    std::int32_t rank = 0;         ///< of W
    double factor_seconds = 0;
    Error reference;
    std::vector<Solve> solves; ///< of kSolvers
};

struct Solver {
    const char *name, *work;
    Cone cone; ///< whose residual is measured
};
constexpr std::array<Solver, 4> kSolvers{{{"exact", "exact: factorisations", Cone::disc},
                                          {"sweeps", "sweeps", Cone::disc},
                                          {"momentum", "momentum: sweeps", Cone::disc},
                                          {"pyramid", "pyramid: sweeps", Cone::pyramid}}};

double cpu_seconds() {
    timespec t{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
    return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

std::string text_of(const char* format, double value) {
    std::array<char, 32> text{};
    std::snprintf(text.data(), text.size(), format, value);
    return text.data();
}

std::vector<std::string> fields_of(const std::string& line) {
    std::vector<std::string> fields;
    std::istringstream stream(line);
    for (std::string field; std::getline(stream, field, ',');) fields.push_back(field);
    return fields;
}

std::vector<Entry> read_index(const fs::path& folder) {
    std::ifstream file(folder / "INDEX.csv");
    if (!file)
        throw InputError("no " + (folder / "INDEX.csv").string() +
                         ": the friction problems are external data; --data names their folder");
    std::string line;
    std::getline(file, line);
    const std::vector<std::string> names = fields_of(line);
    const auto column = [&](const char* name) {
        const auto found = std::find(names.begin(), names.end(), name);
        if (found == names.end()) throw InputError("INDEX.csv has no column " + std::string(name));
        return static_cast<std::size_t>(found - names.begin());
    };
    const std::size_t name = column("file"), asymmetry = column("asymmetry"), sweeps = column("nsgs_1e-8");
    std::vector<Entry> entries;
    while (std::getline(file, line)) {
        const std::vector<std::string> fields = fields_of(line);
        if (fields.size() != names.size()) throw InputError("INDEX.csv: a line has another number of fields: " + line);
        entries.push_back({fields[name], fields[asymmetry], fields[sweeps]});
    }
    return entries;
}

Error error_of(const FrictionProblem& p, Cone cone) {
    return {p.natural_map(), cone == Cone::disc ? p.residual<Cone::disc>() : p.residual<Cone::pyramid>()};
}

Problem read_problem(const fs::path& folder, const Entry& entry) {
    Problem p;
    p.entry = entry;
    p.plain = read_friction_problem(folder / entry.file);
    for (const Vec3& q : p.plain.q) p.speed = std::max(p.speed, length(q));
    p.turned = p.plain;
    p.turned.turn_tangents();
    FrictionProblem reference = p.plain;
    read_reference_impulses(folder / (entry.file + "ref"), reference);
    reference.turn_tangents();
    p.reference = error_of(reference, Cone::disc);
    return p;
}

int solve_by(std::size_t solver, const ConeProgram& program, const FrictionGoal& goal, int limit, FrictionProblem& p) {
    if (solver == 0) {
        ConeScratch scratch;
        return solve_by_factor(p, program, goal.natural_map, scratch).factorisations;
    }
    return solver == 3 ? sweep_pyramid(p, goal, limit) : sweep_disc(p, goal, limit, solver == 2);
}

Solve run_solver(const Arguments& arguments, const Problem& problem, const ConeProgram& program, std::size_t solver) {
    const Cone cone = kSolvers[solver].cone;
    // The pyramid's solution is not one of the cone: of it the map is not asked.
    const double map = cone == Cone::disc ? arguments.goal : std::numeric_limits<double>::infinity();
    std::vector<double> seconds;
    Solve solve;
    for (int k = 0; k < arguments.repetitions; ++k) {
        FrictionProblem p = cone == Cone::disc ? problem.turned : problem.plain;
        const double began = cpu_seconds();
        solve.count = solve_by(solver, program, {map, arguments.goal * problem.speed}, arguments.sweeps, p);
        seconds.push_back(cpu_seconds() - began);
        solve.error = error_of(p, cone);
    }
    std::sort(seconds.begin(), seconds.end());
    solve.seconds = seconds[seconds.size() / 2];
    return solve;
}

Problem run_problem(const Arguments& arguments, const Entry& entry) {
    Problem problem = read_problem(arguments.data, entry);
    const double began = cpu_seconds();
    const ConeProgram program = factor_matrix(problem.turned);
    problem.factor_seconds = cpu_seconds() - began;
    problem.rank = program.num_columns;
    for (std::size_t k = 0; k < kSolvers.size(); ++k) {
        std::cerr << "friction survey: " << entry.file << ", " << kSolvers[k].name << '\n';
        problem.solves.push_back(run_solver(arguments, problem, program, k));
    }
    return problem;
}

/// Whether the law of the exact cone holds to the goal.
bool is_solved(const Arguments& arguments, const Problem& problem, std::size_t solver) {
    const Error& error = problem.solves[solver].error;
    return kSolvers[solver].cone == Cone::disc && error.natural_map <= arguments.goal &&
           error.residual <= arguments.goal * problem.speed;
}

/// The clock itself takes about half a microsecond.
std::string milliseconds(double seconds) { return seconds < 2e-6 ? "< 0.002" : text_of("%.3g", 1e3 * seconds); }

void write_header(const std::vector<std::string>& names) {
    for (const std::string& name : names) std::cout << "| " << name << ' ';
    std::cout << "|\n";
    for (std::size_t k = 0; k < names.size(); ++k) std::cout << "|---";
    std::cout << "|\n";
}

/// A row per problem: its name, then the cells.
template <class Cells>
void write_rows(const std::vector<Problem>& problems, const Cells& cells) {
    for (const Problem& p : problems) {
        std::cout << "| " << fs::path(p.entry.file).stem().string();
        for (const std::string& cell : cells(p)) std::cout << " | " << cell;
        std::cout << " |\n";
    }
}

void write_work(const std::vector<Problem>& problems) {
    std::vector<std::string> names{"problem", "contacts"};
    for (const Solver& solver : kSolvers) {
        names.push_back(solver.work);
        names.push_back("ms");
    }
    write_header(names);
    write_rows(problems, [](const Problem& p) {
        std::vector<std::string> cells{std::to_string(p.plain.contacts.size())};
        for (const Solve& solve : p.solves) {
            cells.push_back(std::to_string(solve.count));
            cells.push_back(milliseconds(solve.seconds));
        }
        return cells;
    });
}

void write_errors(const std::vector<Problem>& problems) {
    std::vector<std::string> names{"problem", "largest q, m/s"};
    for (const Solver& solver : kSolvers) {
        names.push_back(std::string(solver.name) + ": map");
        names.push_back("m/s");
    }
    names.insert(names.end(), {"reference: map", "m/s"});
    write_header(names);
    write_rows(problems, [](const Problem& p) {
        std::vector<std::string> cells{text_of("%.3g", p.speed)};
        const auto add = [&](const Error& error) {
            cells.push_back(text_of("%.1e", error.natural_map));
            cells.push_back(text_of("%.1e", error.residual));
        };
        for (const Solve& solve : p.solves) add(solve.error);
        add(p.reference);
        return cells;
    });
}

void write_problems(const std::vector<Problem>& problems) {
    write_header(
        {"problem", "contacts", "blocks of W", "rank of W", "asymmetry", "factor of W, ms", "sweeps of local cones"});
    write_rows(problems, [](const Problem& p) {
        std::size_t blocks = 0;
        for (const auto& row : p.plain.row) blocks += row.size();
        return std::vector<std::string>{
            std::to_string(p.plain.contacts.size()), std::to_string(blocks), std::to_string(p.rank), p.entry.asymmetry,
            milliseconds(p.factor_seconds),          p.entry.block_sweeps};
    });
}

int survey_friction(const Arguments& arguments) {
    std::vector<Problem> problems;
    for (const Entry& entry : read_index(arguments.data)) problems.push_back(run_problem(arguments, entry));
    std::cout << "Solved to " << text_of("%g", arguments.goal) << ", of " << problems.size() << " problems:";
    for (std::size_t k = 0; k < kSolvers.size(); ++k) {
        if (kSolvers[k].cone != Cone::disc) continue;
        const auto count = std::count_if(problems.begin(), problems.end(),
                                         [&](const Problem& p) { return is_solved(arguments, p, k); });
        std::cout << (k > 0 ? ", " : " ") << kSolvers[k].name << ' ' << count;
    }
    std::cout << ".\n\nWork and CPU time:\n\n";
    write_work(problems);
    std::cout << "\nWhat is left, natural map and residual:\n\n";
    write_errors(problems);
    std::cout << "\nThe problems:\n\n";
    write_problems(problems);
    const bool all = std::all_of(problems.begin(), problems.end(), [&](const Problem& p) {
        for (std::size_t k = 0; k < kSolvers.size(); ++k)
            if (is_solved(arguments, p, k)) return true;
        return false;
    });
    return all ? 0 : 3;
}

} // namespace

int main(int argc, char** argv) {
    CLI::App app{"How far does each solver get with frictional contact problems, and at what cost?",
                 "flotilla_friction_survey"};
    app.footer("exit code: 0 every problem solved by some solver, 2 usage or no data, 3 a problem is solved by none");
    Arguments arguments;
    app.add_option("--data", arguments.data, "Folder of the problems and their INDEX.csv")->capture_default_str();
    app.add_option("--goal", arguments.goal, "Of the natural map, and of the residual as a share of the largest |q|")
        ->check(CLI::Range(0.0, 1.0))
        ->capture_default_str();
    app.add_option("--sweeps", arguments.sweeps, "At most, of one solve")
        ->check(CLI::PositiveNumber)
        ->capture_default_str();
    app.add_option("--repetitions", arguments.repetitions, "Of which times are the median")
        ->check(CLI::PositiveNumber)
        ->capture_default_str();
    try {
        app.parse(argc, argv);
        return survey_friction(arguments);
    } catch (const CLI::ParseError& error) {
        return app.exit(error) == 0 ? 0 : 2;
    } catch (const InputError& error) {
        std::cerr << "flotilla_friction_survey: " << error.what() << '\n';
        return 2;
    }
}
