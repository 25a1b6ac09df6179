// SPDX-License-Identifier: MIT
// The contact points of a run as CSV, one row per contact and step. Bodies are numbered in scene order from 0, body_a <
// body_b; p is the point (m, world; that on a where bodies are thinner than their rest distance: ContactState::across),
// n the unit normal from a to b, gap the distance there (m); normal_impulse and tangential_impulse (N s, along n and
// the length of the rest) are what the contact carried on b in the step (ContactState::impulse), and the opposite on a.
// Contacts that are asleep (1 in the last column) are those of the step in which their island fell asleep. A second
// file has the totals of every body with contacts: how many, the sums of their normal and tangential impulses, and the
// net impulse on the body (N s, world).
#pragma once

#include <filesystem>
#include <map>
#include <span>
#include <string_view>

#include <flotilla/report.hpp>

#include "run_folder/earlier_contacts.hpp"
#include "run_folder/file_stream.hpp"

namespace flotilla::io {

inline constexpr std::string_view kContactsHeader =
    "step,time,body_a,body_b,px,py,pz,nx,ny,nz,gap,normal_impulse,tangential_impulse,asleep";
inline constexpr std::string_view kContactTotalsHeader =
    "step,time,body,contacts,normal_impulse,tangential_impulse,impulse_x,impulse_y,impulse_z";

/// DIR/NAME-bodies.csv (.gz) for DIR/NAME.csv (.gz).
[[nodiscard]] std::filesystem::path contact_totals_path(const std::filesystem::path& contacts);

/// Written aside; both files are there once close() has been called. Compressed where the name ends with .gz.
class ContactsCsv {
  public:
    explicit ContactsCsv(const std::filesystem::path& path);
    /// Goes on with what an earlier part of the run left, but for the steps that are made again.
    ContactsCsv(const std::filesystem::path& path, const EarlierContacts& earlier);

    /// The contacts at the end of a step; `time` in s.
    void add(std::int64_t step, double time, std::span<const ContactState> contacts);
    /// Then sync(), of another thread maybe: a run that goes on from a checkpoint with what this returns finds the
    /// contacts of all steps so far, whatever happens to this one.
    [[nodiscard]] ContactRows flush();
    void sync();
    void close();

  private:
    struct Total {
        std::int64_t contacts = 0;
        double normal = 0, tangential = 0;
        Vec3 impulse;
    };
    void add_totals(std::int64_t step, double time);

    OutputStream out_, totals_out_;
    ContactRows rows_;
    std::map<std::int32_t, Total> totals_; ///< of the step at hand, by body
};

} // namespace flotilla::io
